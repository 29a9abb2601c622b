"""Saved trees: what was damaged, changed or lies about its size is refused in one line; other programs can read the rest."""

import fcntl
import hashlib

import h5py
import numpy as np
import pytest

from pearlbvp.errors import InputError
from pearlbvp.hdf5 import HEADER, load_tree, save_tree, sealed

KIND = "pearlbvp trial"
TREE = {
    "numbers": np.linspace(0, 1, 24).reshape(4, 6),
    "whole": np.arange(5),
    "none": np.zeros((0, 3)),
    "count": 3,
    "rate": 0.1,
    "done": True,
    "word": "Länge",
    "inner": {"0": {"u": np.array([1.5, -2.5]), "residual": np.nan}},
}


def load(path, **how):
    return load_tree("resume", path, KIND, lambda tree: tree, writer="pearlbvp", undefined=["residual"], **how)


@pytest.fixture
def path(tmp_path):
    save_tree("save", tmp_path / "t.h5", KIND, TREE)
    return tmp_path / "t.h5"


def refused(path):
    with pytest.raises(InputError, match=r"^resume: [^\n]*; [^\n]*$") as raised:
        load(path)
    return str(raised.value)


def changed(path, change):
    """The file with something in it changed by an honest program, and vouched for as if it had been written so."""
    with h5py.File(path, "r+") as file:
        change(file)
    path.write_bytes(sealed(KIND, path.read_bytes()[HEADER:]))


def test_a_tree_is_read_back_as_it_was(path):
    again = load(path)
    np.testing.assert_array_equal(again["numbers"], TREE["numbers"])
    np.testing.assert_array_equal(again["inner"]["0"]["u"], [1.5, -2.5])
    assert again["none"].shape == (0, 3)
    assert (again["count"], again["rate"], again["done"], again["word"]) == (3, 0.1, True, "Länge")
    assert np.isnan(again["inner"]["0"]["residual"])


def test_every_number_in_it_has_a_checksum_that_other_programs_know(path):
    """Every dataset has fletcher32; attributes are among the bytes whose SHA-256 stands in the first lines of the file."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item.fletcher32}) if hasattr(item, "shape") else None)
        np.testing.assert_array_equal(file["numbers"][()], TREE["numbers"])
        assert file["inner/0/u"].dtype == float
        assert file.attrs["rate"] == 0.1
        assert file.attrs["word"].decode() == "Länge"
    assert found == {"numbers": True, "whole": True, "none": False, "inner/0/u": True}
    content = path.read_bytes()
    assert hashlib.sha256(content[512:]).hexdigest().encode() in content[:512]


def test_a_flipped_bit_anywhere_is_seen(path):
    """At 300 places, and at every one of the first lines."""
    whole = path.read_bytes()
    random = np.random.default_rng(13)
    used = len(whole[:HEADER].rstrip(b"\0"))
    for place in [*range(used), *random.integers(HEADER, len(whole), 300)]:
        damaged = bytearray(whole)
        damaged[place] ^= 1 << random.integers(8)
        path.write_bytes(damaged)
        assert refused(path).isascii()  # whatever byte it is, it is not shown
        assert "save it again" not in refused(path)  # of the only copy


def test_a_file_that_was_cut_off_grown_or_replaced_is_refused(path):
    whole = path.read_bytes()
    for length in (*range(0, len(whole), 211), len(whole) - 1):
        path.write_bytes(whole[:length])
        refused(path)
    path.write_bytes(b"text")
    assert "it is no HDF5 file" in refused(path)
    for other in (whole + b"\0", b"\x89HDF\r\n\x1a\n" + bytes(600), whole[:HEADER], whole[HEADER:]):
        path.write_bytes(other)
        refused(path)
    save_tree("save", path, "pearlbvp other", TREE)
    assert "is no trial saved by this version, but a saved other" in refused(path)


def test_a_damaged_first_line_is_said_to_be_so(path):
    whole = path.read_bytes()
    path.write_bytes(whole.replace(b"trial", b"tr\xe9al", 1))
    assert "is no trial saved by this version: its first line is damaged; give" in refused(path)
    path.write_bytes(whole.replace(b"format 2", b"format 9", 1))
    assert "is no trial saved by this version, but by another, whose format is 9; give" in refused(path)


def _huge(file):
    del file["whole"]
    file.create_dataset("whole", (10**9,), "f8", chunks=(10**6,), fletcher32=True)


def _huge_in_one_piece(file):
    del file["whole"]
    file.create_dataset("whole", (10**9,), "f8")


def _missing_piece(file):
    del file["whole"]
    file.create_dataset("whole", (5,), "f8", chunks=(5,), fletcher32=True)


def _compressed(file):
    del file["whole"]
    file.create_dataset("whole", data=np.zeros(10**8, "i1"), chunks=(10**7,), compression="gzip", fletcher32=True)


def _without_checksum(file):
    del file["whole"]
    file["whole"] = np.arange(5)


def _external_storage(file):
    del file["whole"]
    file.create_dataset("whole", (4,), "f8", external=[("/etc/hostname", 0, 32)])


def _virtual(file):
    layout = h5py.VirtualLayout((10**9,), "f8")
    layout[:5] = h5py.VirtualSource(file["whole"])
    del file["whole"]
    file.create_virtual_dataset("whole", layout)


def _external_link(file):
    del file["whole"]
    file["whole"] = h5py.ExternalLink("/etc/hostname", "/")


def _soft_link(file):
    file["more"] = h5py.SoftLink("/whole")


def _second_name(file):
    file["more"] = file["whole"]


def _circle(file):
    file["inner/outer"] = file["/"]


def _deep(file):
    file.create_group("/".join("abcdefghij"))


def _words(file):
    file["more"] = np.array([b"word"] * 3)


def _records(file):
    file["more"] = np.zeros(3, [("a", "f8"), ("b", "i4")])


def _references(file):
    file["more"] = np.array([file.ref] * 2, dtype=h5py.ref_dtype)


def _words_of_any_length(file):
    file.attrs["word"] = "any"


def _empty_attribute(file):
    file.attrs["rate"] = h5py.Empty("f8")


def _named_type(file):
    file["more"] = np.dtype("f8")


def _nan(file):
    file["numbers"][1, 2] = np.nan


def _infinite(file):
    file["inner/0/u"][0] = -np.inf


def _nan_in_an_attribute(file):
    file.attrs["rate"] = np.nan


CHANGES = [
    _huge, _huge_in_one_piece, _missing_piece, _compressed, _without_checksum, _external_storage, _virtual, _external_link,
    _soft_link, _second_name, _circle, _deep, _words, _records, _references, _words_of_any_length, _empty_attribute,
    _named_type, _nan, _infinite, _nan_in_an_attribute,
]  # fmt: skip


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__.lstrip("_"))
def test_what_is_never_written_is_refused_even_where_the_file_vouches_for_it(path, change, monkeypatch):
    changed(path, change)
    allocated = []
    zeros = np.zeros
    monkeypatch.setattr(np, "zeros", lambda shape, *dtype: allocated.append(np.prod(shape)) or zeros(shape, *dtype))
    assert "something is missing or misplaced" in refused(path)
    assert max(allocated, default=0) < 1000


def test_a_change_that_is_allowed_is_read(path):
    changed(path, lambda file: file["numbers"].__setitem__((1, 2), 7.0))
    assert load(path)["numbers"][1, 2] == 7.0


def test_files_that_another_program_has_locked_are_read(path):
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        assert load(path)["count"] == 3
    with h5py.File(path, "r"):
        assert load(path)["count"] == 3


def test_files_that_another_program_is_writing_are_said_to_be_open_there(path):
    with h5py.File(path, "r+"):
        assert "another program has" in refused(path)


def test_a_tree_that_another_does_not_expect_is_named_as_such(path):
    for error in (KeyError("x"), MemoryError(), ZeroDivisionError()):

        def fail(tree, error=error):
            raise error

        with pytest.raises(InputError, match=r"^resume: .* cannot be read as a saved trial: "):
            load_tree("resume", path, KIND, fail, writer="pearlbvp")
