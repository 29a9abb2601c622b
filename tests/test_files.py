"""Files are whole or not there."""

import os
import stat
import zlib

import h5py
import pytest

from pearlbvp.errors import InputError
from pearlbvp.files import read_whole, readable, writable, write_whole


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


def test_a_library_that_stumbles_on_a_full_disk_is_one_line_all_the_same(tmp_path):
    """matplotlib closes a PDF by writing to it again, and fails with an error of its own."""

    def fail(path):
        try:
            raise OSError(28, "No space left on device")
        finally:
            raise zlib.error("buffer error")

    with pytest.raises(InputError, match="^--plot: .*No space left"):
        write_whole("--plot", tmp_path / "t.pdf", fail)
    assert os.listdir(tmp_path) == []


def test_names_up_to_the_longest_are_written_and_longer_ones_refused(tmp_path):
    longest = tmp_path / ("n" * 251 + ".csv")
    write_whole("--out", writable("--out", longest), lambda path: path.write_text("new") and None)
    assert os.listdir(tmp_path) == [longest.name]
    for long in (tmp_path / ("n" * 300), tmp_path / ("n" * 300) / "t.csv"):
        with pytest.raises(InputError, match="^--out: .*(characters|folder)") as raised:
            writable("--out", long)
        assert "standard output" not in str(raised.value)
    with pytest.raises(InputError, match=r"^--out: .*[0-9]+ characters\) cannot be written \(File name too long"):
        writable("--out", "n" * 303)
    with pytest.raises(InputError, match=r"^--resume: .*\(File name too long"):
        readable("--resume", tmp_path / ("n" * 300))


def test_a_write_protected_file_stays_and_the_rights_of_others_are_kept(tmp_path):
    """For the superuser, too, whom the system lets do anything."""
    target = tmp_path / "t.csv"
    target.write_text("old")
    target.chmod(0o444)
    with pytest.raises(InputError, match="^--out: .*write-protected"):
        writable("--out", target)
    (tmp_path / "link").symlink_to(target)
    with pytest.raises(InputError, match="^--out: .*write-protected"):
        writable("--out", tmp_path / "link")
    target.chmod(0o600)
    write_whole("--out", writable("--out", target), lambda path: path.write_text("new") and None)
    assert (target.read_text(), stat.S_IMODE(target.stat().st_mode)) == ("new", 0o600)


def test_standard_output_is_no_file_s_name():
    with pytest.raises(InputError, match="^--save: - is standard output"):
        writable("--save", "-")


def test_inputs_are_regular_files_of_bounded_size(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes(b"0123456789")
    assert read_whole("--compare", path, 10) == b"0123456789"
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    for name, said in (
        ("none", "there is no file"), ("pipe", "a device or a pipe"), ("endless", "a device or a pipe"), ("", "a folder"),
        ("t.csv/x", "cannot be read"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=rf"^--compare: [^\n]*{said}"):
            read_whole("--compare", tmp_path / name)
    with pytest.raises(InputError, match="^--compare: .*has 10 bytes, more than 9"):
        read_whole("--compare", path, 9)
    with pytest.raises(InputError, match="^--compare: .*more than 9 bytes|has 0 bytes"):
        read_whole("--compare", "/proc/self/status", 9)  # says that it has 0 bytes


def test_a_file_that_another_program_is_writing_is_not_replaced_and_one_that_it_reads_is(tmp_path):
    """By HDF5's own locks, as another program has them: what it still writes would go into a file without a name."""
    path = tmp_path / "f.h5"
    with h5py.File(path, "w"):
        pass
    with h5py.File(path, "r"):
        assert writable("--save", path) == path
    with h5py.File(path, "r+"):
        with pytest.raises(
            InputError, match=r"^--save: another program has .* open for writing; close it there first, or"
        ):
            writable("--save", path)
        assert writable("--save", path, locked=True) == path
    assert writable("--save", path) == path


def test_a_name_that_ends_like_a_folder_s_is_no_file_s(tmp_path):
    for check in (writable, readable):
        with pytest.raises(InputError, match=r"^path: .*new/ ends as a folder's name does; give a file's name"):
            check("path", f"{tmp_path}/new/")
        with pytest.raises(InputError, match=r"^path: .* is a folder; give a file's name"):
            check("path", f"{tmp_path}/")
