"""The stability region against the localized tables, and pearls of least energy against their own branches."""

import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.period import least_energies, pearl_periods
from pearlbvp.studies.region import stability_region


def test_region_is_the_localized_table_of_each_period():
    table = stability_region(0.48, "7:8:0.5", [2, 4])
    assert len(table) == 6
    for row in table.itertuples():
        alone = localized_pearls(0.48, row.period, row.L).iloc[0]
        assert (alone.status, alone.pearls) == (row.status, row.pearls)
        if row.status == "found":
            assert alone.v == pytest.approx(row.v, abs=1e-10)
    # More pearls lose their stability earlier.
    found = table[table.status == "found"].pivot(index="period", columns="pearls", values="v")
    assert (found[2] > found[4]).all()


@pytest.mark.parametrize(
    ("arguments", "name"),
    [(("6:7:0.5", [2]), "period"), (("7", [1]), "pearls"), (("7", [2.5]), "pearls"), (("7", []), "pearls")],
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
