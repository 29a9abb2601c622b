"""Files are whole or not there."""

import os
import stat

import pytest

from pearlbvp.errors import InputError
from pearlbvp.files import writable, write_whole


def test_a_file_is_written_and_nothing_is_left_beside_it(tmp_path):
    target = tmp_path / "t.csv"
    target.write_text("old")
    write_whole("--out", target, lambda path: path.write_text("new") and None)
    assert target.read_text() == "new"
    assert os.listdir(tmp_path) == ["t.csv"]
    assert stat.S_IMODE(target.stat().st_mode) == 0o666 & ~_umask()


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_a_full_disk_leaves_the_old_file_and_one_line(tmp_path):
    target = tmp_path / "t.csv"
    target.write_text("old")

    def fail(path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match="^--out: .*No space left"):
        write_whole("--out", target, fail)
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["t.csv"]


def test_a_defect_leaves_nothing_behind_either(tmp_path):
    def fail(path):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_whole("--out", tmp_path / "t.csv", fail)
    assert os.listdir(tmp_path) == []


def test_places_that_cannot_be_written_to(tmp_path):
    with pytest.raises(InputError, match=r"^--out: the folder .* does not exist"):
        writable("--out", tmp_path / "no" / "t.csv")
    with pytest.raises(InputError, match="^--plot: .* is a folder"):
        writable("--plot", tmp_path)


def test_a_link_is_followed_and_a_device_is_written_to(tmp_path):
    target, link = tmp_path / "target.csv", tmp_path / "link.csv"
    target.write_text("old")
    link.symlink_to(target)
    write_whole("--out", writable("--out", link), lambda path: path.write_text("new") and None)
    assert link.is_symlink()
    assert target.read_text() == "new"
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole("--out", writable("--out", pipe), lambda path: path.write_text("new") and None)
    assert os.read(reader, 10) == b"new"
    os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
