"""The stability region against other ways to its limits, and pearls of least energy against their own branches."""

import math
from dataclasses import replace

import pytest

from pearlbvp.continuation.events import first_wanted
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.stability.bloch import growth_rates
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.period import least_energies, pearl_periods
from pearlbvp.studies.region import stability_region
from pearlbvp.studies.shape import shape_branch
from pearlbvp.theory.unduloid import unduloid_of


def test_where_it_begins_at_the_straight_tube_it_is_the_localized_table():
    table = stability_region(0.48, [6.8], [2, 4], starts=0)
    assert table.status.tolist() == ["found", "unstable_at_onset"]
    for row in table.itertuples():
        alone = localized_pearls(0.48, row.period, row.L).iloc[0]
        assert (alone.status, alone.pearls) == (row.status, row.pearls)
        if row.status == "found":
            assert (row.v_from, row.from_limit, row.to_limit, row.n_to) == (1, "straight tube", "wave", 0)
            assert row.theta_to == pytest.approx(2 * math.pi / row.pearls)
            assert [alone.v, alone.v] == pytest.approx([row.v, row.v_to], abs=1e-10)


def pearl_at(branch, v):
    """The shape of a volume on the first part of a branch, on which the volume falls or rises."""
    index = next(i for i, point in enumerate(branch.points) if (point.value("v") - v) * (1 - v) <= 0)
    return first_wanted(*branch.points[index - 1 : index + 1], {"v": v}).point


@pytest.fixture(scope="module")
def pearls():
    return family_branch(Tube(0.55, 5), "pearl", (1, 0), branch_options({"v": 0.9722}))


def test_limits_are_those_of_the_spectrum_of_several_periods_as_one(pearls):
    """Four periods as one shape, whose spectrum knows nothing of Bloch waves."""
    (island,) = stability_region(0.55, 5, [4], starts=0).itertuples()
    assert (island.n_from, island.n_to) == (1, 0)

    def largest(v):
        problem, u = (pearl := pearl_at(pearls, v)).problem, pearl.u
        four, (u,) = replace(problem, cells=4).repeated(4, "pearl", u)
        found = four.spectrum(u)
        return max(float(rates[0]) for rates in found.rates.values()), found.critical.n

    for v, n, inwards in ((island.v_from, 1, 1e-5), (island.v_to, 0, -1e-5)):
        (inside, _), (at, _), (outside, critical) = map(largest, (v + inwards, v, v - inwards))
        assert abs(at) < 1e-7
        assert inside < -1e-5
        assert outside > 1e-5
        assert critical == n


def test_on_a_tube_of_any_length_compression_and_long_waves_are_the_limits():
    """Long waves across the axis grow under an axial force below zero; along it where they do on 400 periods."""
    (endless,) = stability_region(0.7, 3.25, [math.inf], starts=0).itertuples()
    assert (endless.n_from, endless.theta_from, endless.n_to, endless.theta_to) == (1, 0, 0, 0)
    branch = family_branch(Tube(0.7, 3.25), "pearl", (1, 0), branch_options({"v": 0.83817}))
    assert pearl_at(branch, endless.v_from).value("force") == pytest.approx(0, abs=1e-6)
    width = endless.v_to - endless.v_from
    theta = 2 * math.pi / 400
    rates = []
    for share in (0.5, 1.5):
        pearl = pearl_at(branch, endless.v_from + share * width)
        rates.append(growth_rates(pearl.problem.profile(pearl.u), 0, theta)[0])
    assert rates[0] < 0 < rates[1]


def test_pearls_that_no_branch_leads_to_are_those_of_least_energy_up_to_a_wave_around():
    """At c0 = 0.7 and a period of 6 the straight tube's pearls end at the unduloid; others are found downhill."""
    table = stability_region(0.7, 6, [1], starts=0)
    joined, apart = table.itertuples()
    assert (joined.from_limit, joined.to_limit) == ("unduloid", "straight tube")
    assert joined.v_from == pytest.approx(unduloid_of(6).v, abs=1e-12)
    assert (apart.from_limit, apart.n_from, apart.to_limit) == ("wave", 1, "thin neck")
    for v, unstable in ((apart.v_from + 1e-4, 0), (apart.v_from - 1e-4, 2)):
        shape = shape_branch(0.7, 6, v, [0.5, -0.1], branch_options(max_points=2)).points
        at = min(shape, key=lambda point: abs(point.value("v") - v))
        assert at.spectrum.n_unstable == unstable


def test_a_period_of_no_pearls_is_a_row_that_says_so():
    row = stability_region(0.6, 2 * math.pi, [1]).iloc[0]
    assert row.status == "failed"
    assert "k = 1" in row.message


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("0:7:0.5", [2]), "length"),
        (("7", [0]), "pearls"),
        (("7", [2.5]), "pearls"),
        (("7", []), "pearls"),
        (("7", "2,x"), "pearls"),
    ],
)
def test_mistakes(arguments, name):
    with pytest.raises(InputError, match=f"^{name}: "):
        stability_region(0.48, *arguments)


@pytest.mark.parametrize("v", [1.02, 1.1])
def test_least_energy_is_that_of_the_best_branch(v):
    (found,) = least_energies(0.48, [20.0], v)
    energies = {}
    for m in (1, 2, 3):
        last = family_branch(Tube(0.48, 20), "pearl", (m, 0), branch_options({"v": v})).table().iloc[-1]
        assert last.v == pytest.approx(v, abs=1e-12)
        energies[m] = last.E
    best = min(energies, key=energies.get)
    assert found["pearls_least_energy"] == best
    assert found["E_least_energy"] == pytest.approx(energies[best], abs=1e-10)


def test_period_with_a_volume_has_both_numbers():
    table = pearl_periods(0.48, [15, 30], v=1.05, progress=False)
    assert list(table.columns[-3:]) == ["v", "pearls_least_energy", "E_least_energy"]
    # At v = 1.05 three pearls have less energy on L = 30 than the four that appear first.
    assert table.pearls.tolist() == [2, 4]
    assert table.pearls_least_energy.tolist() == [2, 3]
    with pytest.raises(InputError, match="^v: "):
        pearl_periods(0.48, 15, v=1.0)
