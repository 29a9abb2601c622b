"""What the site needs beyond MkDocs: pages from outside of this folder, pages of docstrings, formulas as MathML.

MkDocs calls these functions (``hooks`` in ``mkdocs.yml``). The pages in this folder are written for readers of the repository,
too, so their links and formulas are translated here, and nothing is loaded from elsewhere when the site is read.
"""

import html
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import chapters
import gallery
from math_core import LatexError, LatexToMathML
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
OUTSIDE = {"README.md": "overview.md", "CHANGELOG.md": "changes.md"}
NOTEBOOK = re.compile(r"\]\(\.\./notebooks/(\w+)\.ipynb")
PAGE_NAMED = re.compile(r"\[[\w./]+\.md\]\(([\w./]+\.md)(#[\w-]+)?\)")
"""A link that says the name of a file in the repository."""

REFERENCE = "reference/"
CODE = re.compile(r"<(pre|code)\b.*?</\1>", re.DOTALL)
INLINE = re.compile(
    r'(<div class="language-sh .*?</div>)|<(?:pre|code class)\b.*?</(?:pre|code)>|<code>(.*?)</code>', re.DOTALL
)
OPTION, WHOLE = re.compile(r"--[a-z][\w-]*"), r'<span class="whole">\g<0></span>'

CELL = re.compile(r"<td\b.*?</td>", re.DOTALL)
POWER = re.compile(r"(?<![\w.])-?\d[\d.]*e-\d+")
"""A number that is not to be broken at the sign of its exponent."""

SCRIPTED = re.compile(r"(<msu[bp]+>)(<mo minsize[^>]*>.</mo>)")
"""A bracket of a given size with an exponent: Chromium sizes it as what stands in a row only."""

ARITHMATEX = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the README, the changes, pictures, the explorer, the notebooks, and pages of docstrings.

    There is one of docstrings for every ``reference/MODULE.md`` in the navigation.

    Raises:
        PluginError: an example of the gallery failed; the build ends there.
    """
    for name, uri in OUTSIDE.items():
        files.append(File.generated(config, uri, content=(ROOT / name).read_text()))
    files.append(File.generated(config, "assets/explorer.html", content=_explorer()))
    for name, path in _pictures():
        files.append(File.generated(config, gallery.SHOWN.format(name), abs_src_path=path))
    for uri, content in chapters.pages():
        files.append(File.generated(config, uri, content=content))
    for uri in _pages(config.nav):
        if uri.startswith(REFERENCE):
            module = uri.removeprefix(REFERENCE).removesuffix(".md")
            files.append(File.generated(config, uri, content=f"# `{module}`\n\n::: {module}\n"))
    return files


def _pictures() -> list[list[str]]:
    """Names and files of the gallery's pictures, made in a process of their own, from which others can be started."""
    made = subprocess.run([sys.executable, gallery.__file__], capture_output=True, text=True, check=False)
    if made.returncode:
        raise PluginError(made.stderr)
    return [line.split(maxsplit=1) for line in made.stdout.splitlines()]


def _explorer() -> str:
    """The page that docs/explore.md shows, computed in two seconds."""
    import pearlbvp as pb
    from pearlbvp.explorer.page import explorer

    wanted = {"pearl": ((1, 0), 1.05), "coil": ((1, 1), 0.93), "buckle": ((1, 1), 0.95), "ring": ((0, 2), 0.88)}
    branches = {
        f"{family}s": pb.branch(pb.Tube(0.0, 10.0), family, mode, until={"v": v})
        for family, (mode, v) in wanted.items()
    }
    return explorer(branches).text


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Links between the repository's folders, as links between the site's pages; pictures below the gallery's examples."""
    folder = ROOT if page.file.src_uri in OUTSIDE.values() else (ROOT / "docs" / page.file.src_uri).parent
    markdown = PAGE_NAMED.sub(lambda link: f"[{_title(folder / link[1])}]({link[1]}{link[2] or ''})", markdown)
    if page.file.src_uri == gallery.PAGE.name:
        return gallery.with_pictures(markdown)
    if page.file.src_uri in OUTSIDE.values():
        return markdown.replace("](docs/", "](")
    if page.file.src_uri.startswith("chapters/"):
        return markdown.replace("](../docs/", "](../")
    markdown = NOTEBOOK.sub("](" + chapters.PAGE.format(r"\1"), markdown)
    for name, uri in OUTSIDE.items():
        markdown = re.sub(rf"\]\(\.\./{re.escape(name)}(?=[#)])", f"]({uri}", markdown)
    return markdown


def _title(path: Path) -> str:
    """What a page is called: its first heading."""
    return path.read_text().partition("\n")[0].lstrip("# ")


def on_page_content(content: str, page: Page, **_: Any) -> str:
    """Formulas as MathML, which browsers draw themselves.

    Raises:
        PluginError: a formula that is no LaTeX, or a dollar sign that is left over; the build ends there.
    """
    converter = LatexToMathML()

    def converted(formula: re.Match[str]) -> str:
        tex = html.unescape(formula[2]).strip()
        try:
            mathml = converter.convert_with_local_state(tex, displaystyle=formula[1] == "div")
        except LatexError as error:
            raise PluginError(f"{page.file.src_uri}: {tex}: {error}") from error
        mathml = SCRIPTED.sub(r"\1<mrow>\2</mrow>", mathml)
        return f'<div class="formula">{mathml}</div>' if formula[1] == "div" else mathml

    content = INLINE.sub(_inline, ARITHMATEX.sub(converted, content))
    content = CELL.sub(lambda cell: POWER.sub(WHOLE, cell[0]), content)
    if "$" in CODE.sub("", content):
        raise PluginError(f"{page.file.src_uri}: a dollar sign that is neither code nor a formula")
    return content


def _inline(code: re.Match[str]) -> str:
    r"""Code at the end of a line: an option does not break at its hyphens, a list of columns does at its commas.

    Of a bar in a table's cell, which is written `\|`, there is the bar.
    """
    shell, text = code.groups()
    if shell:
        return OPTION.sub(WHOLE, shell)
    if text is None:
        return code[0]
    text = OPTION.sub(WHOLE, text.replace(r"\|", "|"))
    return f"<code>{re.sub(r',(?=[a-zA-Z])', ',<wbr>', text)}</code>"


def _pages(nav: Any) -> Iterator[str]:
    """The files that a navigation names, at any depth."""
    if isinstance(nav, str):
        yield nav
    elif nav:
        for entry in nav.values() if isinstance(nav, dict) else nav:
            yield from _pages(entry)
