"""The notebooks as pages of the site: what they say, their code, and what came out of it.

``python docs/chapters.py`` executes those that were not executed yet as they are, by the program as it is, into
``build/chapters``; one that fails ends it. The site shows these copies, so that nothing is executed twice, and where there are
none the results that the notebooks came with.
"""

from __future__ import annotations

import base64
import hashlib
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import nbformat
from gallery import ROOT, program

NOTEBOOKS = ROOT / "notebooks"
EXECUTED = ROOT / "build/chapters"
SECONDS = 900
"""Longest time of one cell."""

PAGE = "chapters/{}.md"
PICTURE = "assets/chapters/{}-{}.png"
"""Places in the site."""

STYLES = re.compile(r"<style.*?</style>", re.DOTALL)
ATTRIBUTES = re.compile(r' (?:border|class|style)="[^"]*"')
"""What pandas gives to tables for notebooks; the site has its own."""


def executed(path: Path, state: bytes) -> Path:
    """Where the executed copy of a notebook is kept: another name for other code or another program."""
    sources = "\0".join(cell.source for cell in nbformat.read(path, 4).cells)
    key = hashlib.sha256(state + sources.encode()).hexdigest()[:16]
    return EXECUTED / f"{path.stem}-{key}.ipynb"


def execute(path: Path, copy: Path) -> None:
    """Execute a notebook in its own folder and keep it with its results.

    Raises:
        RuntimeError: a cell failed; the message has the notebook's name and what the cell said.
    """
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    notebook = nbformat.read(path, 4)
    try:
        NotebookClient(notebook, timeout=SECONDS, resources={"metadata": {"path": str(path.parent)}}).execute()
    except CellExecutionError as error:
        raise RuntimeError(f"chapters: {path.name}: {error}") from None
    for cell in notebook.cells:  # bars on standard error were for those who waited
        cell.get("outputs", [])[:] = [out for out in cell.get("outputs", []) if out.get("name") != "stderr"]
    part = copy.with_suffix(".part")
    nbformat.write(notebook, part)
    part.replace(copy)


def execute_all(processes: int = 2) -> None:
    """Execute the notebooks that are not there executed; copies of earlier ones are removed."""
    EXECUTED.mkdir(parents=True, exist_ok=True)
    state = program()
    wanted = {path: executed(path, state) for path in sorted(NOTEBOOKS.glob("*.ipynb"))}
    for path in set(EXECUTED.iterdir()) - set(wanted.values()):
        path.unlink()
    missing = [(path, copy) for path, copy in wanted.items() if not copy.exists()]
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        for done in [pool.submit(execute, *task) for task in missing]:
            done.result()


def pages() -> Iterator[tuple[str, str | bytes]]:
    """Places in the site and contents of all chapters and their pictures."""
    state = program()
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        copy = executed(path, state)
        yield from page(path.stem, nbformat.read(copy if copy.exists() else path, 4))


def page(name: str, notebook: Any) -> Iterator[tuple[str, str | bytes]]:
    """A notebook's pictures and, last, its page."""
    parts: list[str] = []
    heading, count = name, 0
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            heading = next(iter(re.findall(r"^#+ (.*)$", cell.source, re.MULTILINE)[::-1]), heading)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            data = output.get("data", {})
            if output.output_type == "stream" and output.name == "stdout":
                parts.append(f"```text\n{output.text.rstrip()}\n```")
            elif "image/png" in data:
                count += 1
                place = PICTURE.format(name, count)
                yield place, base64.b64decode(data["image/png"])
                parts.append(f"![{heading}](../{place})")
            elif "text/html" in data:
                table = ATTRIBUTES.sub("", STYLES.sub("", data["text/html"])).replace(
                    "<div>", '<div class="result">', 1
                )
                parts.append("\n".join(line for line in table.splitlines() if line.strip()))
            elif "text/plain" in data:
                parts.append(f"```text\n{data['text/plain'].rstrip()}\n```")
    yield PAGE.format(name), "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    try:
        execute_all()
    except RuntimeError as error:
        sys.exit(str(error))
