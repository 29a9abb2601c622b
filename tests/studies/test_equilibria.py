"""Equilibria in physical units: the laws in SI units, the same case in other units, and what was published of axons."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from support.commands import is_png, run

from pearlbvp.continuation.path import PathEnd
from pearlbvp.errors import InputError
from pearlbvp.studies import equilibria as study
from pearlbvp.studies.cases import cases_of
from pearlbvp.studies.equilibria import RESULTS, equilibria
from pearlbvp.theory.osmotic import onset_sizes

DATA = Path(__file__).parents[2] / "data" / "axon_pearls.csv"
KT, RT = 1.380649e-23 * 310, 8.31446261815324 * 310


def axons(*cases):
    """Rows of the published table by tension, osmolarity and rigidity."""
    table = pd.read_csv(DATA, comment="#")
    keys = ["tension[mN/m]", "osmolarity[mM]", "kappa[kT]"]
    return pd.concat([table[(table[keys] == list(case)).all(axis=1)] for case in cases], ignore_index=True)


def computed(table, **how):
    return equilibria(table, **{"convention": "mem3dg", "progress": False} | how)


@pytest.fixture(scope="module")
def found():
    return computed(axons((0.01, 400, 100), (0.01, 300, 30), (0.01, 500, 60)))


def test_each_row_says_what_there_is(found):
    assert list(found.columns) == [*pd.read_csv(DATA, comment="#").columns, *RESULTS]
    assert found.status.tolist() == ["found", "straight", "none"]
    pearls, straight, none = (row for _, row in found.iterrows())
    assert (pearls["pearls"], pearls["n_unstable"]) == (6, 0)
    assert pearls["neck[nm]"] < pearls["straight[nm]"] < pearls["bead[nm]"]
    assert pearls["excess"] == pytest.approx(212 / pearls["bead[nm]"] - 1)
    assert straight["bead[nm]"] == straight["neck[nm]"] == straight["straight[nm]"]
    assert (straight["straight_unstable"], straight["energy[pN]"]) == (0, 0)
    assert none["straight_unstable"] > 0
    assert np.isnan(none["bead[nm]"])
    assert none["stable_spacings[nm]"] == "408.1"


def test_pressures_are_those_of_the_law_in_si_units(found):
    for _, row in found.dropna(subset=["bead[nm]"]).iterrows():
        law = RT / 700 * (900 / row["volume"] - row["osmolarity[mM]"])
        assert row["pressure[Pa]"] == pytest.approx(law, rel=1e-9)


def test_a_straight_tube_is_pulled_by_its_energy_by_length(found):
    # Membrane and water come from reservoirs: a longer tube costs bending and tension of its area, and gains p by volume.
    row = found.iloc[1]
    kappa, tension, radius = 30 * KT, 1e-5, row["bead[nm]"] * 1e-9 / 2
    c0 = math.sqrt(1 / (4 * 50e-9**2) - tension / kappa)
    by_area = kappa * (1 / (2 * radius) - c0) ** 2 + tension
    force = 2 * math.pi * radius * by_area - row["pressure[Pa]"] * math.pi * radius**2
    assert row["force[pN]"] == pytest.approx(1e12 * force, rel=1e-9)
    # and its radius is where that is least at this pressure
    slope = (
        math.pi * (2 * (tension + kappa * c0**2) - kappa / (2 * radius**2)) - 2 * math.pi * radius * row["pressure[Pa]"]
    )
    assert slope == pytest.approx(0, abs=1e-9 * 2 * math.pi * radius * row["pressure[Pa]"])


def test_the_energy_by_length_gives_the_force():
    """The energy ``e`` of pearls above the straight tube's: ``d(e L)/dL``, the solute by length kept, is the work of the force
    less what bringing the solute into pearls gains, ``n log v`` by length.
    """  # fmt: skip
    case, h = axons((0.01, 400, 100)).assign(**{"length[nm]": 361.0}), 0.1
    spacings = (360 - h, 360, 360 + h)
    table = computed(pd.concat([case.assign(**{"spacing[nm]": one}) for one in spacings], ignore_index=True))
    energy, row = table["energy[pN]"], table.iloc[1]
    by_length = energy[1] + 360 * (energy[2] - energy[0]) / (2 * h)
    kappa, tension, radius = 100 * KT, 1e-5, row["straight[nm]"] * 1e-9 / 2
    c0 = math.sqrt(1 / (4 * 50e-9**2) - tension / kappa)
    size = (radius / 50e-9) ** 2  # volume of the straight tube, as ``volume`` counts
    pressure = RT / 700 * (900 / size - 400)
    straight = 2 * math.pi * radius * (kappa * (1 / (2 * radius) - c0) ** 2 + tension) - pressure * math.pi * radius**2
    gained = RT / 700 * 900 * math.pi * 50e-9**2 * math.log(row["volume"] / size)
    assert by_length == pytest.approx(row["force[pN]"] - 1e12 * (straight + gained), abs=2e-6)


def test_tubes_that_are_similar_have_similar_pearls(found):
    # Lengths twice and energies three times as large: forces 3/2, tensions 3/4, pressures and osmolarities 3/8 times.
    powers = {"radius[nm]": 2, "length[nm]": 2, "spacing[nm]": 2, "kappa[kT]": 3, "tension[mN/m]": 3 / 4,
              "osmolarity[mM]": 3 / 8, "solute[mM]": 3 / 8}  # fmt: skip
    table = axons((0.01, 400, 100))
    row = computed(table.assign(**{name: factor * table[name] for name, factor in powers.items()})).iloc[0]
    factors = {"bead[nm]": 2, "neck[nm]": 2, "best_spacing[nm]": 2, "straight[nm]": 2, "pressure[Pa]": 3 / 8,
               "force[pN]": 3 / 2, "energy[pN]": 3 / 2, "volume": 1, "n_unstable": 1}  # fmt: skip
    for name, factor in factors.items():
        assert row[name] == pytest.approx(factor * found.iloc[0][name], rel=1e-9)


def test_other_units_and_conventions_say_the_same(found):
    same = pd.DataFrame({
        "tension[uN/m]": [10.0], "kappa[J]": [50 * KT], "osmolarity[M]": [0.4], "solute[mol/l]": [0.9], "dilution": [700],
        "length[um]": [2.040524], "radius[um]": [0.05], "spacing[um]": [0.36], "measured[um]": [0.212],
    })  # fmt: skip
    row = computed(same, convention="physicists").iloc[0]
    c0 = math.sqrt(1 / (4 * 50**2) - 1e-5 * 1e-18 / (100 * KT))
    bare = same.drop(columns="radius[um]")
    others = [
        computed(bare.assign(**{name: value}), convention="physicists").iloc[0]
        for name, value in (("C0[1/nm]", 2 * c0), ("c0[1/um]", 1e3 * c0))
    ]
    for name in RESULTS:
        for answer in (row, *others):
            expected = found.iloc[0][name]
            assert answer[name] == (pytest.approx(expected, rel=1e-7) if isinstance(expected, float) else expected)


def test_one_large_bead_is_what_was_published_where_it_is_the_only_stable_shape():
    row = computed(axons((0.01, 100, 40))).iloc[0]
    assert row["n_unstable"] > 0  # at the spacing that was published
    assert row["best_spacing[nm]"] == pytest.approx(2040.524)
    assert row["best_bead[nm]"] == pytest.approx(row["measured[nm]"], rel=0.01)


def test_where_pearls_have_become_straight_there_are_none():
    # The straight tube, of 123 nm, is thinner than where these pearls leave it, 129 nm; shorter ones lead along it to here.
    tube = {"radius[nm]": 50.0, "length[nm]": 3480.0, "tension[mN/m]": 0.01, "kappa[kT]": 40.0, "osmolarity[mM]": 300.0}
    row = computed(
        pd.DataFrame([tube | {"solute[mM]": 900 * 340 / 580, "dilution": 700.0, "spacing[nm]": 580.0}]),
        convention="physicists",
    ).iloc[0]
    assert (row["status"], row["equilibria"]) == ("none", 0)
    assert row["straight[nm]"] < 100 * onset_sizes(math.sqrt(0.25 - 1e-5 * 50e-9**2 / (80 * KT)), 11.6)[0]


def test_without_a_spacing_the_best_one_is_shown():
    row = computed(axons((0.01, 400, 100)).drop(columns="spacing[nm]")).iloc[0]
    assert row["bead[nm]"] == row["best_bead[nm]"]
    assert f"{row['best_spacing[nm]']:.5g}" in row["stable_spacings[nm]"].split()


def test_a_failure_is_a_row_with_its_reason(monkeypatch, capsys, tmp_path):
    def failing(tube, periods):
        raise PathEnd("the step fell below its least; stop before")

    monkeypatch.setattr(study, "pearls_of_periods", failing)
    axons((0.01, 400, 100)).to_csv(tmp_path / "c.csv", index=False)
    status, out, err = run(capsys, "equilibria", tmp_path / "c.csv", "--convention", "mem3dg", "--processes", 1)
    assert status == 1
    assert "failed" in out
    assert "the step fell below its least" in out
    assert "1 of 1 rows failed" in err


def test_command(capsys, tmp_path):
    axons((0.01, 600, 90), (0.01, 600, 30)).to_csv(tmp_path / "c.csv", index=False)
    outputs = "--out", tmp_path / "e.csv", "--plot", tmp_path / "e.png"
    assert run(capsys, "equilibria", tmp_path / "c.csv", "--convention", "mem3dg", *outputs) == (0, "", "")
    table = pd.read_csv(tmp_path / "e.csv")
    assert table.status.tolist() == ["found", "straight"]
    assert list(table.columns[-len(RESULTS) :]) == RESULTS
    assert is_png(tmp_path / "e.png")


CASE = {"tension[mN/m]": 0.01, "kappa[kT]": 50.0, "osmolarity[mM]": 400.0, "solute[mM]": 900.0, "length[nm]": 2000.0,
        "radius[nm]": 50.0}  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"tension[mN/m]": 0.1}, "row 1, tension: 0.1 mN/m is above 0.0428 mN/m"),
        ({"osmolarity[mM]": 0.0}, "row 1, osmolarity: it is missing, or no number above 0; give one"),
        ({"osmolarity[mM]": math.nan}, "row 1, osmolarity: it is missing"),
        ({"osmolarity[M]": 0.4}, "osmolarity is there twice, as osmolarity[mM] and osmolarity[M]"),
        ({"kappa[kT]": None}, "the column kappa[kT] holds what is no number"),
        ({"osmolarity[kg]": 0.4}, "osmolarity is there twice, as osmolarity[mM] and osmolarity[kg]"),
        ({"spacing[mM]": 300.0}, "the column spacing[mM] has no unit of its quantity; write it like spacing[nm]"),
        ({"spacing": 300.0}, "the column spacing has no unit of its quantity; write it like spacing[nm]"),
        (
            {"temperature[degF]": 98.6},
            "the column temperature[degF] has no unit of its quantity; write it like temperature[K]",
        ),
        ({"temperature[degC]": 310.0}, "row 1, temperature: no membrane is in water at 583.15 K"),
        ({"measured[nm]": -1.0}, "row 1, measured: no bead has a diameter of 0 or less; leave it empty"),
        ({"spacng[nm]": 300.0}, "the column spacng[nm] is none that is known; rename it to spacing[nm], or remove it"),
        ({"radius[nm]": math.nan}, "row 1, radius: it is missing, and so is c0"),
        ({"temperature[K]": 37.0}, "row 1, temperature: no membrane is in water at 37 K"),
        ({"C0[1/nm]": 0.01}, "row 1, radius: by c0 and the tension it is "),
        ({"spacing[nm]": 3000.0}, "row 1, spacing: it is longer than the tube"),
        ({"length[nm]": 1e9}, "row 1, length: 2e+07 radii are beyond 500"),
        ({"c0[1/nm]": 0.0, "tension[mN/m]": -0.01}, "row 1, tension: no straight tube is in equilibrium"),
    ],
)
def test_what_cannot_be_used_is_named_with_its_row(changed, words):
    row = CASE | {name: "soft" if value is None else value for name, value in changed.items()}
    with pytest.raises(InputError) as refused:
        equilibria(pd.DataFrame([row]))
    assert words in str(refused.value)


def test_a_missing_column_is_named_with_its_units():
    with pytest.raises(InputError, match=r"no column of the solute; give one, called solute\[mM\]"):
        equilibria(pd.DataFrame([CASE]).drop(columns="solute[mM]"))


def test_kt_and_concentrations_are_those_of_the_row_s_temperature():
    # At 387.5 K each particle pushes 1.25 times as hard, and kT is as much larger: less of both, at the same tension.
    table = axons((0.01, 400, 100)).astype(float)
    names = ["osmolarity[mM]", "solute[mM]", "kappa[kT]"]
    hot = table.assign(**{name: table[name] / 1.25 for name in names}, **{"temperature[K]": 387.5})
    celsius = hot.drop(columns="temperature[K]").assign(**{"temperature[degC]": 387.5 - 273.15})
    assert next(cases_of(celsius, "mem3dg")).rigidity == pytest.approx(
        next(cases_of(hot, "mem3dg")).rigidity, rel=1e-14
    )
    row, hot_row = (next(cases_of(one, "mem3dg")) for one in (table, hot))
    for name in ("unit", "rigidity", "period"):
        assert getattr(hot_row, name) == pytest.approx(getattr(row, name), rel=1e-13)
    for name in ("c0", "solute", "osmolarity", "length"):
        assert getattr(hot_row.tube, name) == pytest.approx(getattr(row.tube, name), rel=1e-13)
    assert row.rigidity == pytest.approx(100 * KT, rel=1e-14)
    assert row.tube.osmolarity == pytest.approx(400 * RT / 700 * row.unit**3 / row.rigidity, rel=1e-14)
