"""Kept machine code: used where it can be trusted, made again where not, and the same numbers in any case."""

import os
import subprocess
import sys

import numpy as np
import pytest

from pearlbvp import compiled as room
from pearlbvp.mesh.polyhedron import _dot

DAMAGES = {
    "cut off": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "garbage": lambda content: b"garbage" * 100,
    "one bit": lambda content: content[:-9] + bytes([content[-9] ^ 4]) + content[-8:],
    "another's digest": lambda content: bytes(32) + content[32:],
}


CASE = (np.array([1 + 2.0**-27, 1, 0]), np.array([1 - 2.0**-27, -1, 0]))
"""A scalar product of the order of rounding: whether products and sums are one operation decides its digits."""


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A cache of our own."""
    monkeypatch.setattr(room.numba.config, "CACHE_DIR", str(tmp_path))
    forget()
    yield room.folder()
    monkeypatch.undo()
    forget()


def forget():
    room.folder.cache_clear()
    room.unusable.cache_clear()


def begun():
    """As a new process has it: nothing said, nothing looked up, the function not compiled."""
    forget()
    room.announcement.said = room.announcement.failed = room.announcement.damaged = False
    return room.compiled(_dot.py_func)


def loaded(function):
    return sum(function.stats.cache_hits.values())


def test_code_is_kept_and_used_again_without_a_word(home, capsys):
    first = begun()(*CASE)
    assert capsys.readouterr().err.count("pearlbvp: compiling its inner loops once after installation") == 1
    assert [file.suffix for file in home.iterdir()] == [".nbc"]
    again = begun()
    assert again(*CASE) == first
    assert loaded(again) == 1
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_is_made_again_with_one_word(home, capsys, damage):
    first = begun()(*CASE)
    (file,) = home.iterdir()
    whole = file.read_bytes()
    file.write_bytes(DAMAGES[damage](whole))
    capsys.readouterr()
    again = begun()
    assert again(*CASE) == first
    assert loaded(again) == 0
    assert capsys.readouterr().err.count("\n") == 1
    assert file.stat().st_size == pytest.approx(len(whole), rel=0.1)
    third = begun()
    assert third(*CASE) == first
    assert loaded(third) == 1


def test_code_that_others_could_have_written_is_not_run(home, capsys):
    begun()(*CASE)
    (file,) = home.iterdir()
    for spoil in (lambda: file.chmod(0o666), lambda: (file.rename(home / "x"), file.symlink_to(home / "x"))):
        spoil()
        again = begun()
        again(*CASE)
        assert loaded(again) == 0
        assert not file.is_symlink()
        assert file.stat().st_mode & 0o777 == 0o600
    home.chmod(0o777)
    capsys.readouterr()
    again = begun()
    again(*CASE)
    assert loaded(again) == 0
    assert "others can write to it; set NUMBA_CACHE_DIR" in capsys.readouterr().err


def test_without_a_place_to_keep_it_code_gives_the_same_digits(home, monkeypatch, capsys):
    kept = begun()
    first = kept(*CASE)
    monkeypatch.setattr(room.numba.config, "CACHE_DIR", "/dev/null/no")
    nowhere = begun()
    assert np.float64(nowhere(*CASE)).tobytes() == np.float64(first).tobytes()
    assert "in every run, for /dev/null/" in capsys.readouterr().err
    assert nowhere.targetoptions == kept.targetoptions


def test_a_full_disk_keeps_nothing_and_says_so(home, monkeypatch, capsys):
    def full(*arguments):
        raise OSError(28, "No space left on device")

    function = begun()
    monkeypatch.setattr(room.os, "replace", full)
    function(*CASE)
    assert list(home.iterdir()) == []
    assert "cannot be written to (No space left on device)" in capsys.readouterr().err


def test_processes_that_compile_at_once_do_not_meet(tmp_path):
    """Three processes with one empty folder agree, and a fourth finds it all there."""
    script = (
        "import numpy as np; from pearlbvp.mesh.polyhedron import _dot\n"
        "print(_dot(np.ones(3), np.ones(3)), sum(_dot.stats.cache_hits.values()))"
    )
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    call = {"env": environment, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    runs = [subprocess.Popen([sys.executable, "-c", script], **call) for _ in range(3)]
    said = [run.communicate() for run in runs]
    assert [out.split()[0] for out, _ in said] == ["3.0"] * 3, said
    out, err = subprocess.Popen([sys.executable, "-c", script], **call).communicate()
    assert (out.split(), err) == (["3.0", "1"], "")
