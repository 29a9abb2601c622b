"""What README and docs print is true: their Python runs, their commands run, their links lead somewhere."""

import ast
import json
import re
import shlex
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from support.commands import run

from pearlbvp.studies import families

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
GALLERY = ROOT / "docs/gallery.md"  # executed by the build of the site (docs/gallery.py)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\[[^]]*\]\(([^)\s]+)\)")


def named(page):
    return str(page.relative_to(ROOT))


def blocks(page, *languages):
    """Language, number of the first line and text of a page's blocks, in order."""
    text = page.read_text()
    found = [(match[1], text.count("\n", 0, match.start(2)), match[2]) for match in BLOCK.finditer(text)]
    return [block for block in found if block[0] in languages]


@pytest.fixture
def in_a_folder(tmp_path, monkeypatch):
    """An empty folder, pictures without a screen, and a registry that forgets what a page adds to it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(families, "_added", {})
    backend = matplotlib.get_backend()
    matplotlib.use("agg")
    yield
    import matplotlib.pyplot as plt

    plt.close("all")
    matplotlib.use(backend)


def executed(page, capsys, namespace):
    """Execute a page: Python in a namespace, commands in this process, all in the order and the folder that they stand in."""
    for language, line, text in blocks(page, "python", "sh"):
        if language == "python":
            exec(compile("\n" * line + text, named(page), "exec"), namespace)
            continue
        for command in text.splitlines():
            if command.startswith("pearlbvp "):
                status, _, err = run(capsys, *shlex.split(command, comments=True)[1:])
                # A branch that ends at what its shapes are is no failure; one that misses what was wanted is.
                assert status == 0, (named(page), command, err)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page != GALLERY and blocks(page, "python", "sh")], ids=named
)
def test_what_a_page_prints_runs(page, in_a_folder, capsys):
    executed(page, capsys, {"__name__": "page"})


def test_a_family_is_added_by_one_file_outside_of_the_package(in_a_folder, tmp_path, capsys, monkeypatch):
    """The guide's first block is that file; here it is a module that an installed package's entry point names."""
    import importlib
    import importlib.metadata

    import pearlbvp as pb

    (tmp_path / "screws_of_the_guide.py").write_text(blocks(ROOT / "docs/add_a_family.md", "python")[0][2])
    monkeypatch.syspath_prepend(tmp_path)
    entry = importlib.metadata.EntryPoint("screw", "screws_of_the_guide:SCREWS", families.GROUP)
    monkeypatch.setattr(families, "entry_points", lambda group: [entry] if group == families.GROUP else [])
    options = ["--c0=-1", "--length", "10", "--until", "v=0.98"]
    status, out, err = run(capsys, "branch", "screw", *options, "--save", "s.h5")
    assert (status, err) == (0, "")
    assert out.splitlines()[-1].split(",")[1] == "stop"
    assert pb.load("s.h5")[-1].problem.family == "screw"
    with monkeypatch.context() as without:
        without.setattr(families, "_added", {})
        without.setattr(families, "entry_points", lambda group: [])
        assert run(capsys, "show", "s.h5")[::2] == (
            2,
            "pearlbvp: FILE: s.h5 holds shapes of a family that is not here, 'screw'; install or register what adds it\n",
        )
    status, _, err = run(capsys, "branch", "screw", *options, "--mode", "1,2")
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("pearlbvp: --mode: 1,2 is none of a screw")
    for refused in (
        ["branch", "screw", *options, "--nodes", "500"],
        ["branch", "screw", *options, "--tolerance", "1e-9"],
    ):
        status, _, err = run(capsys, *refused)
        assert (status, err.count("\n")) == (2, 1), err


@pytest.mark.parametrize(("digits", "lambda1", "said"), [(2, -2.398, True), (3, -2.399, True), (12, -2.399, False)])
def test_profiles_of_few_digits_start_as_the_page_says(in_a_folder, capsys, digits, lambda1, said):
    """docs/files_and_tables.md: the first row of a flow from 41 rows of a profile."""
    x = np.linspace(0, 10 / 3, 41)
    rows = [f"{at:.12g},{1 + 0.1 * np.sin(2 * np.pi * at / x[-1]):.{digits}f}" for at in x]
    Path("p.csv").write_text("\n".join(["x,r", *rows]))
    how = ["--c0", "0", "--length", repr(10 / 3), "--time", "1e-9"]
    status, out, err = run(capsys, "flow", "--profile", "p.csv", *how)
    assert status == 0
    assert float(out.splitlines()[1].split(",")[2]) == pytest.approx(lambda1, abs=5e-4)
    assert ("smoothed" in err) == said


def test_each_example_of_the_gallery_makes_one_picture_by_at_most_ten_lines(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    import gallery

    markdown = GALLERY.read_text()
    examples = gallery.examples(markdown)
    names = [example.name for example in examples]
    assert len(names) == len(set(names)) >= 24
    assert max(sum(map(bool, example.code.splitlines())) for example in examples) <= 10
    shown = re.findall(r"^!\[[^]\n]+\]\(assets/gallery/([\w-]+)\.png\)$", gallery.with_pictures(markdown), re.MULTILINE)
    assert shown == names


def test_a_block_of_the_gallery_that_makes_no_picture_or_fails_is_refused(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(ROOT / "docs")
    import gallery

    with pytest.raises(ValueError, match="makes 0 pictures"):
        gallery.examples("```sh\npearlbvp dispersion --c0 0 --length 10\n```\n")
    (example,) = gallery.examples("```sh\nfalse\necho --plot a.png\n```\n")
    with pytest.raises(RuntimeError, match="gallery: a: "):
        gallery.make(example, tmp_path / "a.png")
    assert not list(tmp_path.iterdir())


def test_a_notebook_becomes_a_page_with_its_code_pictures_and_tables(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    import chapters
    from nbformat import v4

    table = '<div>\n<style scoped>\n  .dataframe {}\n</style>\n<table border="1" class="dataframe">\n\n<tr><td>7</td></tr></table></div>'
    outputs = [
        v4.new_output("stream", name="stderr", text="a bar"),
        v4.new_output("stream", name="stdout", text="printed\n"),
        v4.new_output("execute_result", data={"text/html": table, "text/plain": "7"}),
        v4.new_output("display_data", data={"image/png": "UE5H", "text/plain": "<Figure>"}),
    ]
    cells = [v4.new_markdown_cell("# A question\n\nWhy?"), v4.new_code_cell("answer()", outputs=outputs)]
    (place, picture), (uri, page) = chapters.page("why", v4.new_notebook(cells=cells))
    assert (place, picture, uri) == ("assets/chapters/why-1.png", b"PNG", "chapters/why.md")
    shown = ["# A question\n\nWhy?", "```python\nanswer()\n```", "```text\nprinted\n```",
             '<div class="result">\n<table>\n<tr><td>7</td></tr></table></div>', "![A question](../assets/chapters/why-1.png)"]  # fmt: skip
    assert page == "\n\n".join(shown) + "\n"


def test_every_notebook_is_a_chapter():
    names = {path.stem for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert names == set(re.findall(r"chapters/(\w+)\.md", (ROOT / "mkdocs.yml").read_text()))
    assert names == set(re.findall(r"\(\.\./notebooks/(\w+)\.ipynb\)", (ROOT / "docs/index.md").read_text()))


@pytest.mark.parametrize("path", sorted((ROOT / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_needs_the_public_names_alone(path):
    import pearlbvp as pb

    cells = [cell["source"] for cell in json.loads(path.read_text())["cells"] if cell["cell_type"] == "code"]
    lines = [line for source in cells for line in [*"".join(source).splitlines(), ""]]
    nodes = list(ast.walk(ast.parse("\n".join(line for line in lines if not line.startswith("%")))))
    rooms = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    rooms |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    names = {node.attr for node in nodes if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "pb"}
    assert names <= set(dir(pb))
    assert {room for room in rooms if room.startswith("pearlbvp.")} == set()


def test_the_readme_is_short():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 100


def anchors(page):
    """Names of a page's headings, as links have them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_to_files_and_headings(page):
    text = BLOCK.sub("", page.read_text())
    for link in LINK.findall(text):
        if link.startswith(("http:", "https:")):
            continue
        path, _, heading = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert not heading or heading in anchors(target), link


def test_every_page_is_in_the_contents():
    contents = {(ROOT / "docs" / link).resolve() for link in LINK.findall((ROOT / "docs/index.md").read_text())}
    assert {page.resolve() for page in PAGES} <= contents | {ROOT / "docs/index.md"}


def test_the_site_leads_to_every_page_and_to_the_docstrings_of_the_theory():
    """The build refuses what is named and not there; this is what is there and not named."""
    named_files = set(re.findall(r"[\w./]+\.md", (ROOT / "mkdocs.yml").read_text()))
    docs = ROOT / "docs"
    assert {str(page.relative_to(docs)) for page in docs.rglob("*.md")} <= named_files
    theory = {f"reference/pearlbvp.theory.{path.stem}.md" for path in (ROOT / "pearlbvp/theory").glob("[!_]*.py")}
    assert theory <= named_files


def test_the_code_refers_to_pages_that_are_here():
    for path in (ROOT / "pearlbvp").rglob("*.py"):
        text = path.read_text()
        assert "design, §" not in text, path
        assert "design §" not in text, path
        for page in re.findall(r"docs/[\w/]+\.md", text):
            assert (ROOT / page).exists(), (path, page)


def test_every_command_stands_in_the_docs():
    from pearlbvp.cli import cli

    known = "".join(text for page in PAGES for _, _, text in blocks(page, "sh"))
    for name in cli.commands:
        assert re.search(rf"^pearlbvp {name} ", known, re.MULTILINE), name
    columns = (ROOT / "docs/commands.md").read_text()
    assert set(re.findall(r"`([\w-]+)`", "".join(re.findall(r"^\| (`[^|]*`) \|", columns, re.MULTILINE)))) >= set(
        cli.commands
    )
