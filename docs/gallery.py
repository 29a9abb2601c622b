"""The pictures of docs/gallery.md: each is made by the block of code above it, when the site is built.

``python docs/gallery.py`` makes those in ``build/gallery`` that are not there for the block as it is, the program as it is and
the data that come with it, on two processes. ``docs/site.py`` does the same and puts them into the page. A block that fails, or
makes no picture, ends the build.
"""

from __future__ import annotations

import hashlib
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from multiprocessing import get_context
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/gallery.md"
PICTURES = ROOT / "build/gallery"
BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SHOWN = "assets/gallery/{}.png"
"""A picture's place in the site."""

PICTURE = re.compile(r"(?:--plot |savefig\(\")([\w-]+)\.png")


@dataclass(frozen=True)
class Example:
    """One block of the page.

    Attributes:
        language: ``python`` or ``sh``.
        code: its lines.
        name: of the picture that it makes, without the ending.
    """

    language: str
    code: str
    name: str

    def picture(self, program: bytes) -> Path:
        """Where its picture is kept: another name for another code or another program."""
        key = hashlib.sha256(program + self.code.encode()).hexdigest()[:16]
        return PICTURES / f"{self.name}-{key}.png"


def examples(markdown: str) -> list[Example]:
    """The blocks of a page.

    Raises:
        ValueError: one makes no picture, or more than one.
    """
    found = []
    for language, code in BLOCK.findall(markdown):
        names = PICTURE.findall(code)
        if len(names) != 1:
            raise ValueError(f"gallery: a block makes {len(names)} pictures; it is to make one:\n{code}")
        found.append(Example(language, code, names[0]))
    return found


def with_pictures(markdown: str) -> str:
    """The page with each block's picture below it, named by the heading above."""
    heading = ""
    parts = []
    for part in re.split(r"(?m)^(?=#+ )", markdown):
        heading = part.partition("\n")[0].lstrip("# ")
        shown = f"\n![{heading}]({SHOWN})\n"
        parts.append(BLOCK.sub(lambda block, shown=shown: block[0] + shown.format(PICTURE.findall(block[2])[0]), part))
    return "".join(parts)


def program() -> bytes:
    """A digest of all that a picture may depend on besides its code."""
    files = sorted(path for folder in ("pearlbvp", "data") for path in (ROOT / folder).rglob("*") if path.is_file())
    digest = hashlib.sha256()
    for path in files:
        if path.suffix != ".pyc":
            digest.update(str(path.relative_to(ROOT)).encode() + path.read_bytes())
    return digest.digest()


def execute(example: Example) -> None:
    """Execute a block in the folder where the process is, which has the archive's ``data``; commands in a shell.

    Raises:
        RuntimeError: a command fails; the message is what it said.
    """
    if example.language == "python":
        exec(compile(example.code, example.name, "exec"), {"__name__": example.name})
        return
    here = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    shell = subprocess.run(["bash", "-ec", example.code], env=here, capture_output=True, text=True, check=False)
    if shell.returncode:
        raise RuntimeError(shell.stderr)


def make(example: Example, path: Path) -> None:
    """Execute a block in a folder of its own and keep its picture.

    Raises:
        RuntimeError: it failed; the message has its name and what it said.
    """
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("data").symlink_to(ROOT / "data")
        try:
            with redirect_stdout(StringIO()):
                execute(example)
            picture = Path(f"{example.name}.png").read_bytes()
        except Exception as error:
            raise RuntimeError(f"gallery: {example.name}: {type(error).__name__}: {error}") from None
        finally:
            os.chdir(ROOT)
            plt.close("all")
    part = path.with_suffix(".part")
    part.write_bytes(picture)
    part.replace(path)


def pictures(processes: int = 2) -> dict[str, Path]:
    """Files of all pictures by name, made where they are not there yet; those of earlier code are removed."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    state = program()
    wanted = {example: example.picture(state) for example in examples(PAGE.read_text())}
    for path in set(PICTURES.iterdir()) - set(wanted.values()):
        path.unlink()
    missing = [(example, path) for example, path in wanted.items() if not path.exists()]
    if missing:
        with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
            for done in [pool.submit(make, *task) for task in missing]:
                done.result()
    return {example.name: path for example, path in wanted.items()}


if __name__ == "__main__":
    try:
        for name, path in pictures().items():
            print(name, path)
    except (RuntimeError, ValueError) as error:
        sys.exit(str(error))
