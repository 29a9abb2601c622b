"""Pictures are the same whatever surrounds them: settings of matplotlib, backends, folders, ways of saving."""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest
from commands import run
from cycler import cycler
from PIL import Image

ROOT = Path(__file__).parents[1]

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
    from pearlbvp.studies.branch import branch_options, pearl_branch
    from pearlbvp.studies.saved import save
    from pearlbvp.studies.tube import tube_branch

    folder = tmp_path_factory.mktemp("pictures")
    save(pearl_branch(0.48, 15, 2, branch_options(max_points=4)), folder / "pearl.h5")
    save(tube_branch(0.0, 10, "coil", (1, 1), branch_options(max_points=3)), folder / "coil.h5")
    return folder


def pictures(capsys, saved, folder):
    """Pictures of commands of every kind, written into a folder: their bytes by name."""
    folder.mkdir()
    resumed = ("--max-points", 2, "--out", folder / "t.csv")
    for name, arguments in {
        "dispersion.png": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.pdf": ("dispersion", "--c0", 0.48, "--length", 30),
        "dispersion.svg": ("dispersion", "--c0", 0.48, "--length", 30),
        "noending": ("dispersion", "--c0", 0.48, "--length", 30),
        "period.jpg": ("period", "--c0", 0.48, "--lengths", "15,22.5"),
        "region.png": ("region", "--c0", 0.48, "--periods", "7,7.5", "--pearls", 2),
        "map.png": ("amplitude-map", "--c0", "0,0.3", "--lengths", "10,15"),
        "amplitude.png": ("amplitude", "--c0", 0, "--length", 10, "--mode", "1,1"),
        "pearl.png": ("branch", "pearl", "--resume", saved / "pearl.h5", *resumed),
        "coil.png": ("branch", "coil", "--resume", saved / "coil.h5", *resumed),
        "mesh.png": ("mesh", "--from", saved / "coil.h5", "--nodes", 300),
        "flow.png": ("flow", "--from", saved / "pearl.h5", "--time", 0.1, "--points", 32, "--movie", folder / "f.gif"),
    }.items():
        status, _, err = run(capsys, *arguments, "--plot", folder / name)
        assert status == 0, err
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.suffix != ".csv"}


def test_settings_of_a_session_change_no_byte_of_a_picture_or_movie(capsys, saved, tmp_path):
    plain = pictures(capsys, saved, tmp_path / "plain")
    with matplotlib.rc_context(HOSTILE):
        hostile = pictures(capsys, saved, tmp_path / "hostile")
        assert matplotlib.rcParams["text.usetex"]  # the session keeps its own
    assert len(plain) == 13
    assert [name for name in plain if plain[name] != hostile[name]] == []
    with Image.open(tmp_path / "plain" / "f.gif") as movie:
        assert movie.size == (540, 288)
        assert 10 < movie.n_frames <= 30
        assert (movie.info["duration"], movie.info["loop"]) == (100, 0)


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
    arguments = ["dispersion", "--c0", "0.48", "--length", "30", "--out", "t.csv", "--plot"]
    done = subprocess.run(
        [sys.executable, "-m", "pearlbvp", *arguments, "p.png"], cwd=tmp_path, env=os.environ | surroundings,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    run(capsys, *arguments, tmp_path / "own.png", "--out", tmp_path / "t.csv")
    assert (tmp_path / "p.png").read_bytes() == (tmp_path / "own.png").read_bytes()
