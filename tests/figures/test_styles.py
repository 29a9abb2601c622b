"""``--style``: what it changes, and what of it cannot be used is said on one line."""

import matplotlib
import pytest
from PIL import Image
from support.commands import run

from pearlbvp.errors import InputError
from pearlbvp.figures import canvas
from pearlbvp.figures.canvas import STYLE, new_figure
from pearlbvp.figures.style import styled

DISPERSION = ("dispersion", "--c0", 0.48, "--length", 30)


def drawn(capsys, folder, settings, monkeypatch):
    """The figure of a command with a style, its status and what it said."""
    (folder / "own.mplstyle").write_text(settings)
    figures = []
    monkeypatch.setattr(canvas, "save_figure", lambda figure, path: (figures.append(figure), path.write_bytes(b"")))
    status, _, err = run(capsys, *DISPERSION, "--plot", folder / "p.png", "--style", folder / "own.mplstyle")
    return (figures or [None])[0], status, err


def test_fonts_lines_sizes_and_the_grid_are_those_of_the_style(capsys, tmp_path, monkeypatch):
    settings = (
        "font.size: 6\nlines.linewidth: 0.7\nfigure.figsize: 3.4, 2.5\naxes.grid: False\nfont.family: monospace\n"
    )
    figure, status, err = drawn(capsys, tmp_path, settings, monkeypatch)
    assert (status, err) == (0, "")
    (axes,) = figure.axes
    assert figure.get_size_inches().tolist() == [3.4, 2.5]
    assert {line.get_linewidth() for line in axes.lines if line.get_linestyle() == "-"} == {0.7}
    assert axes.xaxis.label.get_fontsize() == 6
    assert axes.xaxis.label.get_fontfamily() == ["monospace"]
    assert not any(line.get_visible() for line in axes.get_xgridlines())
    assert not STYLE.get()  # it is over


def test_resolution_is_the_style_s(capsys, tmp_path):
    (tmp_path / "own.mplstyle").write_text("savefig.dpi: 40\n")
    assert run(capsys, *DISPERSION, "--plot", tmp_path / "p.png", "--style", tmp_path / "own.mplstyle")[0] == 0
    with Image.open(tmp_path / "p.png") as image:
        assert image.size == (280, 168)  # 7.0 by 4.2 inches


def test_colours_mean_families_and_stay(capsys, tmp_path, monkeypatch):
    plain, *_ = drawn(capsys, tmp_path, "", monkeypatch)
    red, status, err = drawn(capsys, tmp_path, "axes.prop_cycle: cycler(color=['red'])\ntoolbar: None\n", monkeypatch)
    assert (status, err) == (0, "")
    assert [line.get_color() for line in red.axes[0].lines] == [line.get_color() for line in plain.axes[0].lines]


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ("font.family: Nothing Such\n", "no font Nothing Such here"),
        ("font.family: serif\nfont.serif: Nothing Such, Nor This\n", "no font Nothing Such, Nor This here"),
        ("no such line\n", "line 1 ('no such line'); it is left out"),
        ("no.such: 1\n", "Bad key no.such"),
    ],
)
def test_what_cannot_be_used_is_left_out_with_a_word(capsys, tmp_path, monkeypatch, settings, said):
    figure, status, err = drawn(capsys, tmp_path, settings + "lines.linewidth: 3\n", monkeypatch)
    assert status == 0
    assert said in err
    assert err.count("\n") == 1
    assert 3 in {line.get_linewidth() for line in figure.axes[0].lines}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"lines.linewidth: abc\n", "Could not convert 'abc' to float"),
        (b"text.usetex: True\n", "there is no LaTeX here"),
        (b"\xff\xfe\x00", "is no text"),
        (None, "cannot be read"),
    ],
)
def test_a_style_that_cannot_be_used_is_refused_before_anything_is_computed(
    capsys, tmp_path, monkeypatch, content, said
):
    monkeypatch.setenv("PATH", "")  # and LaTeX is nowhere
    if content is not None:
        (tmp_path / "own.mplstyle").write_bytes(content)
    arguments = (*DISPERSION, "--plot", tmp_path / "p.png", "--style", tmp_path / "own.mplstyle")
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("pearlbvp: --style: ")
    assert said in err
    assert err.count("\n") == 1


def test_a_style_without_a_picture_says_nothing(capsys):
    status, _, err = run(capsys, *DISPERSION, "--style", "ggplot")
    assert status == 2
    assert "--style: it goes with --plot" in err


def test_matplotlib_s_own_styles_have_names():
    with styled("ggplot"):
        figure, axes = new_figure()
        assert matplotlib.colors.to_hex(axes.get_facecolor()) == "#e5e5e5"
        assert figure.style["axes.facecolor"] == "#E5E5E5"
    with pytest.raises(InputError, match="style: ggplott cannot be read"), styled("ggplott"):
        pass
