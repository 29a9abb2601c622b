"""The public face: the ten lines of the README, and what is said of mistakes at this door."""

import numpy as np
import pytest

import pearlbvp as pb
import pearlbvp.flows.driver  # a room of that name must not hide the function
from pearlbvp.continuation.branch import Status
from pearlbvp.studies.branch import COLUMNS, branch_options, family_branch
from pearlbvp.studies.onward import switched


@pytest.fixture(scope="module")
def pearls():
    return pb.branch(pb.Tube(c0=0.48, L=15), "pearl", (2, 0), until={"v": 1.01})


def test_ten_lines(pearls, tmp_path):
    assert len(repr(pearls).splitlines()) == 3
    localized = pearls.switch(1, until={"v": 1.2})
    point = localized[-1]
    assert (point.observables["v"], point.spectrum.n_unstable) == (pytest.approx(1.2, abs=1e-12), 0)
    assert point.profile().x.iloc[-1] == pytest.approx(15, abs=1e-9)
    localized.plot().savefig(tmp_path / "l.png")
    localized.save(tmp_path / "l.h5")
    again = pb.load(tmp_path / "l.h5")
    assert again.table().equals(localized.table())
    assert again.status is Status.REACHED
    # The same by the rooms below.
    study = switched(
        family_branch(pb.Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01})), 1, branch_options({"v": 1.2})
    )
    np.testing.assert_array_equal(study.points[-1].u, point.u)
    assert list(localized.table())[: len(COLUMNS)] == COLUMNS


def test_what_varies_goes_towards_where_it_is_wanted(pearls):
    for c0 in (0.485, 0.475):
        assert pearls.vary("c0", until={"c0": c0})[-1].observables["c0"] == pytest.approx(c0, abs=1e-10)
    curve = pearls.follow("bp", 1, "c0", until={"c0": 0.47})
    assert curve[-1].observables["c0"] == pytest.approx(0.47, abs=1e-10)
    with pytest.raises(pb.InputError, match=r"^save: .*; write its table"):
        curve.save("c.h5")


def test_points_by_number_by_slice_and_by_kind(pearls):
    assert len(pearls) == len(list(pearls)) == len(pearls[:])
    assert pearls["bp:1"].observables == pearls["bp"][0].observables
    assert pearls["start"][0].observables["v"] == 1
    for unknown in ("nope", "v=1.005", "bp:x", "", "fold:q"):
        with pytest.raises(pb.InputError, match="^point: .* is no special point; give one like"):
            pearls[unknown]
    with pytest.raises(pb.InputError, match="has 1 special points bp"):
        pearls["bp:2"]


def test_growth_rates_of_a_branch_are_not_computed_again(pearls):
    """A point that is taken from a branch, by whatever way, has the very spectrum that the branch found."""
    for k, point in enumerate(pearls):
        assert point.spectrum is pearls.points[k].spectrum
        assert pearls[k].spectrum is point.spectrum


def test_a_pushed_pearl_flows_and_rests(pearls):
    for _ in range(2):
        result = pb.flow(pearls[-1], delta=0.05)
        assert result.status == "steady"


def test_branches_that_there_are_are_drawn_together(pearls):
    localized = pearls.switch(1, until={"v": 1.01})
    found = pb.diagram({"two": pearls, "one": localized})
    assert list(found.branches) == ["two", "one"]
    assert len(found.table()) == len(pearls) + len(localized)
    assert found.branches["one"][-1].observables == localized[-1].observables
    assert len(found.plot("v", "lambda2").axes[0].get_legend().get_texts()) == 2
    with pytest.raises(pb.InputError, match="tube: there are no branches in it"):
        pb.diagram({})


def test_a_diagram_draws_any_two_columns():
    found = pb.diagram(pb.Tube(c0=0.48, L=15), 0, until={"v": 1.01}, processes=1)
    axes = found.plot("v", "lambda2").axes[0]
    drawn = np.concatenate([line.get_ydata() for line in axes.lines])
    values = [point.observables["lambda2"] for branch in found.branches.values() for point in branch]
    assert (np.nanmin(drawn), np.nanmax(drawn)) == pytest.approx((min(values), max(values)), abs=1e-3)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("v", "lambda2 (1/radius³)")
    with pytest.raises(pb.InputError, match=r"^column: nope is not in the table; take one of branch, point,"):
        found.plot("nope")


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda pearls: pb.flow(pearls), r"^point: Branch must be a point of a branch; give one like"),
        (lambda pearls: pb.flow(pearls[1], time=1), r"^time: there is no such argument; there are until, "),
        (lambda pearls: pearls.vary("c0", foo=1), r"^foo: there is no such argument; there are max_points, step, max_step"),
        (lambda pearls: pearls.vary("c0", point=99), r"^point: there is no point 99; the branch has points 0 to"),
        (lambda pearls: pb.diagram("x"), r"^tube: str must be a tube"),
        (lambda pearls: pb.dispersion(0.48), r"^tube: float must be a tube"),
        (lambda pearls: pb.branch(pb.Tube(0, 10), "ring", (10, 0)), r"give 0,2$"),
        (lambda pearls: pb.branch(pb.Tube(0, 10), "pearl", nodes=200, tolerance=1e-9), r"^tolerance: meshes have none"),
        (lambda pearls: pearls.follow("fold:q", 1, "c0"), r"^follow: 'fold:q' is no turning point of a column"),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(pearls, call, said):
    with pytest.raises(pb.InputError, match=said):
        call(pearls)


def test_every_public_name_is_there():
    assert all(getattr(pb, name) is not None for name in dir(pb))
    with pytest.raises(AttributeError, match="see dir"):
        pb.nothing  # noqa: B018
