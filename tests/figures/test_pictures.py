"""Pictures are the same whatever surrounds them: settings of matplotlib, backends, folders, ways of saving."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from cycler import cycler
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from PIL import Image
from support.commands import run

import pearlbvp as pb
from pearlbvp.figures import canvas
from pearlbvp.helfrich import Tube

ROOT = Path(__file__).parents[2]

HOSTILE = {
    "text.usetex": True, "font.family": ["no such font"], "font.size": 30, "savefig.bbox": "tight", "savefig.dpi": 17,
    "figure.dpi": 1000, "axes.prop_cycle": cycler(linestyle=["-", "--"]), "interactive": True, "toolbar": "None",
    "savefig.transparent": True, "figure.autolayout": True, "axes.facecolor": "red", "lines.linewidth": 9.0,
    "path.sketch": (1, 100, 2), "axes.formatter.limits": (0, 1), "axes.unicode_minus": False, "svg.fonttype": "none",
    "pdf.fonttype": 42, "legend.frameon": True, "axes3d.grid": False, "image.cmap": "gray", "savefig.format": "pdf",
}  # fmt: skip
"""Settings that a user's session may have."""

BROKEN = b"text.usetex: True\nfont.family: Nothing Such\nno such line\nlines.linewidth: abc\nbackend: TkAgg\n\xff\xfe"
"""A ``matplotlibrc`` with settings that are wrong, unknown, or no text at all."""


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Saved branches of two pearls and of coils."""
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.saved import save

    folder = tmp_path_factory.mktemp("pictures")
    save(family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options(max_points=4)), folder / "pearl.h5")
    save(family_branch(Tube(0.0, 10), "coil", (1, 1), branch_options(max_points=3)), folder / "coil.h5")
    return folder


def pictures(capsys, saved, folder):
    """Pictures of commands of every kind, written into a folder: their bytes by name."""
    folder.mkdir()
    resumed = ("--max-points", 2, "--out", folder / "t.csv")
    for name, arguments in {
        "dispersion.png": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.pdf": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.svg": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.eps": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.jpg": ("dispersion", "--c0", 0.48, "--length", 30),
        "pearl.png": ("resume", saved / "pearl.h5", *resumed),
        "coil.png": ("resume", saved / "coil.h5", *resumed),
        "mesh.png": ("mesh", "--from", saved / "coil.h5", "--nodes", 300),
        "flow.png": ("flow", "--from", saved / "pearl.h5", "--time", 1e-5, "--points", 32, "--movie", folder / "f.gif"),
    }.items():
        status, _, err = run(capsys, *arguments, "--plot", folder / name)
        assert status == 0, err
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.suffix not in (".csv", ".json")}


def words_of(figure):
    """All words and numbers that are to be seen in a figure, each with its box in pixels."""
    FigureCanvasAgg(figure).draw()
    ticks = {}
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                seen = low - 1e-9 * abs(low) <= tick.get_loc() <= high + 1e-9 * abs(high)
                ticks |= {
                    id(label): seen and axis.get_visible() and axes.axison for label in (tick.label1, tick.label2)
                }
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    return [(text.get_text(), text.get_window_extent()) for text in shown if ticks.get(id(text), True)]


def content(path):
    """Height and width of what is not white in a picture."""
    with Image.open(path) as image:
        found = np.argwhere((np.asarray(image.convert("RGB")) < 250).any(axis=2))
    return np.ptp(found, axis=0) + 1


LAYOUTS = {
    "dispersion": ("dispersion", "--c0", 9.6, "--length", 1.5, "--radius", 0.05),
    "growth": ("growth", "--c0", 9.6, "--tension", 600, "--length", 1.5, "--radius", 0.05),
    "rest": ("growth", "--tension", 0.1),
    "localized": ("localized", "--c0", 0.48, "--period", 7.5, "--lengths", "15,30,45", "--compare",
                  ROOT / "data" / "paper_localized.csv"),
    "period": ("period", "--c0", 480, "--lengths", "0.015,0.0225", "--radius", 0.001),
    "region": ("region", "--c0", 0.48, "--periods", "7,7.5", "--pearls", "2,3"),
    "map": ("amplitude-map", "--c0=-1:0.48:0.04", "--lengths", "6.5:40:0.5"),
    "amplitude": ("amplitude", "--c0", 0.48, "--length", 10, "--mode", "1,1"),
    "pearls": ("branch", "pearl", "--c0", 0, "--length", 10, "--max-points", 12),
    "long pearls": ("branch", "pearl", "--c0", 0.00048, "--length", 75000, "--radius", 1000, "--mode", "10,0",
                    "--max-points", 4),
    "ring": ("branch", "ring", "--c0=-1", "--length", 10, "--max-points", 8),
    "coil": ("branch", "coil", "--c0", 0, "--length", 10, "--until", "v=0.9"),
    "short coil": ("branch", "coil", "--c0", 0, "--length", 2, "--max-points", 3),
    "mesh": ("mesh", "--length", 10, "--nodes", 300),
    "long mesh": ("mesh", "--length", 200, "--nodes", 4000),
    "short mesh": ("mesh", "--length", 0.1, "--radius", 0.05, "--nodes", 300),
    "flow": ("flow", "--c0", 9.6, "--length", 0.75, "--radius", 0.05, "--mode", "2,0", "--point", "v=1.002", "--delta",
             -0.002, "--time", 1e-7),
}  # fmt: skip


@pytest.mark.parametrize("name", LAYOUTS)
def test_nothing_is_cut_off_and_no_words_overlap_however_a_figure_is_saved(capsys, tmp_path, monkeypatch, name):
    figures = []
    monkeypatch.setattr(canvas, "save_figure", lambda figure, path: (figures.append(figure), path.write_bytes(b"")))
    status, _, err = run(capsys, *LAYOUTS[name], "--plot", tmp_path / "p.png")
    assert status == 0, err
    (figure,) = figures
    words = words_of(figure)
    width, height = figure.get_size_inches() * figure.dpi
    assert [text for text, box in words if min(box.x0, box.y0, width - box.x1, height - box.y1) < 0] == []
    shrunk = [(text, box.padded(-1.5)) for text, box in words]
    assert [(one, other) for (one, a), (other, b) in itertools.combinations(shrunk, 2) if a.overlaps(b)] == []
    figure.savefig(tmp_path / "whole.png")
    figure.savefig(tmp_path / "tight.png", bbox_inches="tight")
    np.testing.assert_allclose(content(tmp_path / "whole.png"), content(tmp_path / "tight.png"), atol=2)


def test_settings_of_a_session_change_no_byte_of_a_picture_or_movie(capsys, saved, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")  # as the command line has it in a process of its own
    plain = pictures(capsys, saved, tmp_path / "plain")
    with matplotlib.rc_context(HOSTILE):
        hostile = pictures(capsys, saved, tmp_path / "hostile")
        assert matplotlib.rcParams["text.usetex"]  # the session keeps its own
    assert len(plain) == 10
    assert [name for name in plain if plain[name] != hostile[name]] == []
    with Image.open(tmp_path / "plain" / "f.gif") as movie:
        assert movie.size == (540, 288)
        assert 5 < movie.n_frames <= 30
        assert (movie.info["duration"], movie.info["loop"]) == (100, 0)


def test_a_picture_in_python_is_the_same_wherever_it_is_saved(saved, tmp_path):
    """Ticks are made while a figure is drawn, when a session's own settings are in force."""
    branch = pb.load(saved / "pearl.h5")
    branch.plot().savefig(tmp_path / "plain.png", dpi=50)
    with matplotlib.rc_context(HOSTILE | {"savefig.bbox": None, "savefig.transparent": False}):
        branch.plot().savefig(tmp_path / "hostile.png", dpi=50)
    assert (tmp_path / "plain.png").read_bytes() == (tmp_path / "hostile.png").read_bytes()


@pytest.mark.parametrize("foreign", ["module://matplotlib_inline.not_here", "nonsense"])
def test_neither_a_foreign_backend_nor_broken_settings_nor_an_unwritable_folder_stop_a_picture(
    capsys, tmp_path, foreign
):
    """All at once, from the start of the interpreter: a notebook's ``!pearlbvp`` in a folder with a broken ``matplotlibrc``."""
    (tmp_path / "matplotlibrc").write_bytes(BROKEN)
    (tmp_path / "home").mkdir()
    surroundings = {"MPLBACKEND": foreign, "MATPLOTLIBRC": str(tmp_path), "SOURCE_DATE_EPOCH": "yesterday",
                    "MPLCONFIGDIR": str(tmp_path / "matplotlibrc"), "HOME": str(tmp_path / "home"), "PYTHONPATH": str(ROOT)}  # fmt: skip
    if foreign == "nonsense":  # and the font cache of this machine, to be quick
        del surroundings["MPLCONFIGDIR"], surroundings["HOME"]
    arguments = ["dispersion", "--c0", "0.48", "--length", "30", "--out"]
    done = subprocess.run(
        [sys.executable, "-m", "pearlbvp", *arguments, "t.csv", "--plot", "p.png"], cwd=tmp_path, env=os.environ | surroundings,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    run(capsys, *arguments, tmp_path / "t.csv", "--plot", tmp_path / "own.png")
    assert (tmp_path / "p.png").read_bytes() == (tmp_path / "own.png").read_bytes()
