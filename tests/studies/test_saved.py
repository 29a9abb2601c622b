"""Saved branches of every family: read back whole, continued as if never saved, refused where they are damaged."""

import h5py
import numpy as np
import pandas as pd
import pytest

from pearlbvp.continuation.storage import KIND
from pearlbvp.errors import InputError
from pearlbvp.hdf5 import HEADER, sealed
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import resumed, switched
from pearlbvp.studies.saved import kind_of, load, save


@pytest.fixture(scope="module")
def pearls():
    return family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01}))


@pytest.fixture(scope="module")
def rings():
    return family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.87}))


@pytest.fixture(scope="module")
def coils():
    return family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.9}))


@pytest.mark.parametrize(
    ("family", "kind", "further", "off"),
    [("pearls", "pearl", 1.02, 1.015), ("rings", "ring", 0.86, 0.873), ("coils", "tube", 0.89, 0.9066)],
)
def test_a_saved_branch_continues_identically(tmp_path, request, family, kind, further, off):
    branch = request.getfixturevalue(family)
    save(branch, tmp_path / "b.h5")
    again = load(tmp_path / "b.h5")
    assert kind_of(again) == kind
    assert again.table().equals(branch.table())
    assert again.special == branch.special
    assert (again.reason, again.complete) == (branch.reason, True)
    options = branch_options({"v": further})
    assert resumed(again, options).table().equals(resumed(branch, options).table())
    options = branch_options({"v": off})
    one, other = (switched(b, 1, options) for b in (again, branch))
    pd.testing.assert_frame_equal(one.table(), other.table(), atol=1e-9, rtol=0)
    save(one, tmp_path / "mixed.h5")
    assert load(tmp_path / "mixed.h5").table().equals(one.table())


def test_resuming_goes_where_one_run_goes(pearls):
    two_runs = resumed(pearls, branch_options({"v": 1.05})).table().iloc[-1]
    one_run = family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.05})).table().iloc[-1]
    for name in ("lambda1", "lambda2", "E", "mu_crit"):
        assert two_runs[name] == pytest.approx(one_run[name], abs=1e-8)
    assert two_runs.special == "stop"


@pytest.mark.parametrize("family", ["pearls", "rings", "coils"])
def test_files_that_are_no_branches(tmp_path, request, family):
    path = tmp_path / "b.h5"
    save(request.getfixturevalue(family), path)
    whole = path.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", b"text", whole[:100] + b"x" * 300 + whole[400:]):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match="^path: ") as raised:
            load(path)
        assert "\n" not in str(raised.value)
    with pytest.raises(InputError, match="^path: there is no file"):
        load(tmp_path / "none.h5")
    with h5py.File(path, "w") as file:
        file["anything"] = np.zeros(3)
    with pytest.raises(InputError, match="^path: .*no branch"):
        load(path)
    for change in (_shorten, _rename, _empty, _nowhere):
        path.write_bytes(whole)
        with h5py.File(path, "r+") as file:
            change(file)
        path.write_bytes(sealed(KIND, path.read_bytes()[HEADER:]))
        said = (
            "holds shapes of a family that is not here"
            if change is _rename
            else "something is missing or misplaced in it"
        )
        with pytest.raises(InputError, match=rf"^path: .*{said}"):
            load(path)


def _shorten(file):
    del file["points/3/u"]
    file.create_dataset("points/3/u", data=np.zeros(7), chunks=(7,), fletcher32=True)


def _empty(file):
    del file["points"], file["special"]
    file.create_group("points")
    file.create_group("special")


def _nowhere(file):
    file["special/0"].attrs["index"] = 10**9


def _rename(file):
    file.attrs["kind"] = np.bytes_("__import__")


def test_checkpoints_of_a_resumed_branch_hold_all_of_it(pearls):
    lengths = []
    resumed(pearls, branch_options({"v": 1.03}, progress=lambda so_far: lengths.append(len(so_far.points))))
    assert lengths
    assert min(lengths) >= len(pearls.points)
