"""Physical tubes from Python: the same tables as the command line's, by the names of columns that pandas shows."""

import io

import numpy as np
import pandas as pd
import pytest
from support.commands import run

import pearlbvp as pb

KAPPA = 20 * 1.380649e-23 * 310  # J
R = 50e-9  # m


@pytest.fixture(scope="module")
def units():
    return pb.Units.of("50nm", "20kT")


@pytest.fixture(scope="module")
def pearls(units):
    return pb.branch(units.tube("1/(150nm)", "400nm"), "pearl", until=units.radii(r_min="45nm"), max_step=0.1)


def test_a_tube_and_quantities_in_radii(units):
    tube = units.tube("1/(150nm)", "400nm")
    assert (tube.c0, tube.L) == (pytest.approx(1 / 6, rel=1e-14), pytest.approx(8, rel=1e-14))
    found = units.radii(
        c0="1/(150nm)", lengths=["0.4um", 800], lambda1="0.05mN/m", lambda2="-1kPa", v=1.1, bp=1, t="1nm/Pa"
    )
    assert found == {
        "c0": pytest.approx(1 / 6), "lengths": pytest.approx([8, 16]), "lambda1": pytest.approx(0.05e-3 * R**2 / (2 * KAPPA)),
        "lambda2": pytest.approx(-1e3 * R**3 / (2 * KAPPA)), "v": 1.1, "bp": 1, "t": pytest.approx(1e-9 * 2 * KAPPA / R**4),
    }  # fmt: skip
    assert pb.Units.of("50nm", "40kT", convention="mem3dg").radii(c0="1/(300nm)")["c0"] == pytest.approx(1 / 6)
    for wrong, words in (({"L": "2kT"}, "^L: 2kT is an energy; give a length"), ({"v": "2nm"}, "^v: 2nm is a length; give a plain"),
                         ({"lengths": ["x"]}, "^lengths: 'x' is not a number")):  # fmt: skip
        with pytest.raises(pb.InputError, match=words):
            units.radii(**wrong)


def test_a_branch_has_the_columns_of_the_command(capsys, units, pearls, tmp_path):
    assert pearls.table(units)["r_min[nm]"].iloc[-1] == pytest.approx(45, rel=1e-9)
    assert list(pearls.table())[:4] == ["point", "special", "lambda1", "lambda2"]
    pearls.save(tmp_path / "b.h5", units)
    assert pb.Units.of_file(tmp_path / "b.h5") == units
    assert pb.Units.of_file(tmp_path / "none.h5") == pb.Units()
    _, out, _ = run(capsys, "show", tmp_path / "b.h5")
    pd.testing.assert_frame_equal(
        pd.read_csv(io.StringIO(out)), pearls.table(units), check_dtype=False, check_exact=False, rtol=1e-11
    )
    figure = pearls.plot(units=units)
    assert [axes.get_ylabel() for axes in figure.axes[:3]] == [
        "energy by area E/A (mN/m)", "pressure lambda2 (Pa)", "tension lambda1 (mN/m)",
    ]  # fmt: skip
    figure = pearls.plot(units=pb.Units.of("50nm"))  # without a rigidity energies are numbers
    assert [axes.get_ylabel().rpartition(" ")[2] for axes in figure.axes[:3]] == ["(1/nm²)", "(1/nm³)", "(1/nm²)"]
    assert "radius of the straight tube: 50 nm" in [text.get_text() for text in figure.texts]


def test_pictures_name_the_rigidity(units, pearls):
    figure = pearls.plot(units=units)
    assert "radius of the straight tube: 50 nm, bending rigidity: 20kT" in [text.get_text() for text in figure.texts]


def test_tables_of_functions_and_flows(units, pearls):
    straight = units.table(pb.dispersion(units.tube(0, "400nm")))
    assert straight["k[1/nm]"].iloc[0] == pytest.approx(2 * np.pi / 400)
    assert units.table(pearls[-1].profile())["r[nm]"].min() == pytest.approx(45, rel=1e-6)
    flow = pb.flow(pearls[-1], until=units.radii(t="0.01nm/Pa")["t"])  # before it rests
    table = flow.table(units)
    assert table["t[nm/Pa]"].iloc[-1] == pytest.approx(0.01)
    assert table["area"].iloc[0] == pytest.approx(1, rel=1e-2)  # by that of the straight tube, in any unit
    assert list(flow.table()) == [name.partition("[")[0] for name in table]


def test_without_units_nothing_changes(pearls):
    pd.testing.assert_frame_equal(pearls.table(pb.Units()), pearls.table())
