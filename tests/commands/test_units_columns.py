"""Every column of every command in physical units: pint multiplies the table in radii by what is written out here.

The formulas are those of a tube of radius R and rigidity kappa of ``kappa/2 (2H - C0)^2``; units are those that the tables
themselves name, which pint reads, and the same in micrometres is what pint converts them to.
"""

import io
import re

import numpy as np
import pandas as pd
import pint
import pytest
from support.commands import run

from pearlbvp.dimensions import QUANTITIES
from pearlbvp.helfrich import Tube

REGISTRY = pint.UnitRegistry()
R = REGISTRY.Quantity(50, "nm")
KAPPA = 20 * REGISTRY.Quantity(1.380649e-23 * 310, "J")
PHYSICAL = {
    **dict.fromkeys(("L", "period", "amplitude", "wave", "r_min", "r_max", "x", "r", "A", "wave_predicted", "M", "wavelength",
                     "membrane_viscosity"), R),
    **dict.fromkeys(("k", "H"), 1 / R),
    "C0": 2 / R,
    **dict.fromkeys(("lambda1", "E", "E_least_energy", "E_other", "excess", "lambda1_predicted", "E_predicted", "lambda1_lower",
                     "lambda1_pearl"), 2 * KAPPA / R**2),
    **dict.fromkeys(("lambda2", "lambda2_pearl", "lambda2_upper", "lower_lambda2", "upper_lambda2", "lambda2_predicted", "lambda2_other",
                     "velocity", "rate"), 2 * KAPPA / R**3),  # rates in fluids, by their viscosity
    # velocities are pressures, so that rates are pressures by length, and times lengths by pressure
    **dict.fromkeys(("mu_crit", "mu_error", "mu"), 2 * KAPPA / R**4), "mu_diffusion": 2 * KAPPA / R**6,
    "t": R**4 / (2 * KAPPA),
    # dA/dt = A (a p + b A^2), lambda1 changes by 2 alpha2 A^2
    "a": 1 / R, **dict.fromkeys(("b", "b1", "b2"), 2 * KAPPA / R**6), "alpha2": 2 * KAPPA / R**4,
    "M0": R, "osmolarity": 2 * KAPPA / R**3, "area": R**2, "volume": R**3, "force": 2 * KAPPA / R, "torque": 2 * KAPPA,
}  # fmt: skip
NM = ["--radius", "50nm", "--kappa", "20kT"]
UM = ["--radius", "0.05um", "--kappa", "25kT", "--temperature", "248K"]


def heading(column):
    """A column's name, and its unit as pint reads it."""
    name, unit = re.fullmatch(r"([^\[]+)(?:\[(.*)\])?", column).groups()
    return name, REGISTRY.Quantity(unit or "1")


def check_columns(radii, nm, um, relative=()):
    """Columns in nm and um against those in radii; ``relative`` ones are measured by the tube's own."""
    assert len(list(radii)) == len(list(nm)) == len(list(um))
    assert len(radii) == len(nm) == len(um) > 0
    for plain, one, other in zip(radii, nm, um, strict=True):
        if not pd.api.types.is_numeric_dtype(radii[plain]):
            continue
        (name, unit), (same, larger) = heading(one), heading(other)
        assert same == name == ("C0" if plain == "c0" else plain)
        factor = 1 if name in relative else PHYSICAL.get(name, 1)
        wanted = REGISTRY.Quantity(radii[plain].to_numpy(float), "dimensionless") * factor
        for found, size in ((nm[one], unit), (um[other], larger)):
            numbers = (found.to_numpy(float) * size).to(wanted.units)
            noise = 1e-9 * getattr(factor, "magnitude", 1)  # of what is zero in radii
            np.testing.assert_allclose(numbers.magnitude, wanted.magnitude, rtol=1e-6, atol=noise, err_msg=one)
        assert other == (
            one if name == "torque" else one.replace("nm", "um")
        )  # energies are in pN nm by any unit of length


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Two pearls, followed and saved in radii."""
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.saved import save

    path = tmp_path_factory.mktemp("columns") / "b.h5"
    save(family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options({"v": 1.01})), path)
    return path


FROM_A_TUBE = {
    "dispersion": (["--c0", "{c0}", "--length", "{L}"], ()),
    "growth": (["--c0", "{c0}", "--tension", "{tension}", "--length", "{L}"], ()),
    "localized": (["--c0", "{c0}", "--period", "{half}", "--lengths", "{L}"], ()),
    "region": (["--c0", "{c0}", "--periods", "{half}", "--pearls", "2"], ()),
    "period": (["--c0", "{c0}", "--lengths", "{L}", "--volume", "1.01", "--processes", "1"], ()),
    "amplitude": (["--c0", "{c0}", "--length", "{L}", "--mode", "2,0", "--mode", "1,1"], ("--branch",)),
    "amplitude-map": (["--c0", "{c0},{c1}", "--lengths", "{L},{L1}"], ("--meetings",)),
    "phases": (["--c0", "{c0}", "--length", "{L}", "--volumes", "1.005,1.02", "--mode", "2,0", "--starts", "4", "--processes", "1"],
               ("--transitions",)),
    "branch pearl": (["--c0", "{c0}", "--length", "{L}", "--mode", "2,0", "--max-points", "3", "--fix", "osmotic=90,ade=1"],
                     ()),
    "branch ring": (["--c0", "{c1}", "--length", "{L}", "--max-points", "3"], ()),
    "mesh": (["--c0", "{c0}", "--length", "{half}", "--nodes", "400"], ()),
}  # fmt: skip
RADII = {"c0": "0.48", "c1": "-0.5", "L": "15", "half": "7.5", "L1": "12", "tension": "0.5"}
IN_NM = {
    "c0": "1/(52.083333333333336nm)",
    "c1": "-0.02/nm",
    "L": "0.75um",
    "half": "375nm",
    "L1": "600",
    "tension": f"{20 * 1.380649e-23 * 310 / 50e-9**2 * 1e6!r}uN/m",
}
IN_UM = {
    "c0": "19.2/um",
    "c1": "-20",
    "L": "750nm",
    "half": "0.375",
    "L1": "0.6",
    "tension": f"{20 * 1.380649e-23 * 310 / 50e-9**2 * 1e3!r}",
}


@pytest.mark.parametrize("command", FROM_A_TUBE)
def test_columns_of_a_tube(capsys, tmp_path, command):
    options, files = FROM_A_TUBE[command]
    tables = []
    for words, units in ((RADII, []), (IN_NM, NM), (IN_UM, UM)):
        given = [f"{option.format(**words)}" for option in options]
        given = [f"{a}={b}" for a, b in zip(given[::2], given[1::2], strict=True)]
        more = [word for name in files for word in (name, tmp_path / "m.csv")]
        status, out, err = run(capsys, *command.split(), *given, *more, *units)
        assert status == 0, err
        tables.append([pd.read_csv(text) for text in (io.StringIO(out), *([tmp_path / "m.csv"] if files else []))])
    for several in zip(*tables, strict=True):
        check_columns(*several)


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("resume {b}", ["--max-points", "2"]),
        ("switch {b} 1", ["--max-points", "3"]),
        ("vary {b} L", ["--max-points", "2"]),
        ("follow {b} bp:1 c0", ["--max-points", "2"]),
        ("show {b}", []),
        ("diagram {b}", []),
        ("mesh", ["--from", "{b}", "--nodes", "400", "--solve"]),
        ("flow", ["--from", "{b}", "--perturb", "critical", "--delta", "{delta}", "--time", "{t}"]),
    ],
)
def test_columns_of_what_is_saved(capsys, saved, command, options):
    second = 1e-3 * (R**4 / (2 * KAPPA)).to("nm/Pa").magnitude
    in_radii, in_nm, in_um = (
        {"b": saved, "delta": delta, "t": time}
        for delta, time in (("0.01", "0.001"), ("0.5nm", f"{second!r}nm/Pa"), ("0.0005", f"{second!r} nm/Pa"))
    )
    tables = []
    for words, units in ((in_radii, []), (in_nm, NM), (in_um, UM)):
        given = [word.format(**words) for word in (*command.split(), *options)]
        status, out, err = run(capsys, *given, *units)
        assert status == 0, err
        tables.append(pd.read_csv(io.StringIO(out)))
    check_columns(*tables, relative=("area",) if command == "flow" else ())


@pytest.mark.parametrize(
    "question",
    ["dispersion --lengths {L}", "growth --tension {tension} --lengths {L}", "localized --period {half} --lengths {L}", "period --lengths {L}",
     "region --period {half} --pearls 2", "amplitude-map --lengths {L}", "branch coil --mode 1,1 --lengths {L1} --volumes 0.98", "phases --lengths {half} --volumes 1.01"],
)  # fmt: skip
def test_columns_of_scans(capsys, tmp_path, question):
    """Asked in radii and in nanometres, and written in all."""
    tables, scan = [], ["--workers", "1", "--store", tmp_path / "s.sqlite"]
    for words, units in ((RADII, []), (IN_NM, NM), (IN_UM, UM)):
        asked = [word.format(**words) for word in question.split()]
        (tmp_path / "s.sqlite").unlink(missing_ok=True)
        status, out, err = run(capsys, "scan", *asked, f"--c0={words['c0']}", *scan, *units)
        assert status == 0, err
        tables.append(pd.read_csv(io.StringIO(out)))
    check_columns(*tables)
    status, out, err = run(
        capsys, "scan", "--store", tmp_path / "s.sqlite", "--export", "-", *NM, "--plot", tmp_path / "s.png"
    )
    assert status == 0, err
    check_columns(tables[0], pd.read_csv(io.StringIO(out)), tables[2])


def test_all_columns_are_here():
    """A quantity with a dimension that is no column is an option, a coordinate of a picture, or a surface's."""
    elsewhere = {"length", "lengths", "periods", "y", "z", "gap", "delta", "centre", "shape", "edge", "pressure", "xi", "c0",
                 "volume_by_length", "wave_numbers", "tension", "viscosity"}  # fmt: skip
    assert {name for name, dimension in QUANTITIES.items() if any(dimension)} - elsewhere == set(PHYSICAL) - {"C0"}


def test_a_profile_in_nanometres_has_the_energy_of_the_table(capsys, saved, tmp_path):
    """E is the integral of kappa/2 (2H - C0)^2 over the surface by its area, and c0 of Mem3DG kappa (H - c0)^2."""
    show = ["show", saved, "--point", "-1", "--profile", tmp_path / "p.csv", "--samples", 2000, "--radius", "50nm"]
    for kappa, convention in (("20kT", "physicists"), ("40kT", "mem3dg")):
        status, out, err = run(capsys, *show, "--kappa", kappa, "--convention", convention)
        assert status == 0, err
        table, curve = pd.read_csv(io.StringIO(out)).iloc[-1], pd.read_csv(tmp_path / "p.csv")
        x, r, H = (curve[name].to_numpy()[:-1] for name in ("x[nm]", "r[nm]", "H[1/nm]"))
        dS = r * np.hypot(np.diff(curve["x[nm]"]), np.diff(curve["r[nm]"]))  # of equal arcs, to second order
        joules = KAPPA.to("J").magnitude
        if convention == "physicists":
            density = joules / 2 * (2 * H - table["C0[1/nm]"]) ** 2
        else:
            density = 2 * joules * (H - table["c0[1/nm]"]) ** 2
        energy = (density * dS).sum() / dS.sum() * 1e18  # J/nm^2 in J/m^2
        assert 1e3 * energy == pytest.approx(table["E[mN/m]"], rel=1e-4)
        assert x[-1] < 750 < x[-1] + 5


def test_tables_with_units_are_read_back(capsys, saved, tmp_path):
    """Of localized pearls, branches and profiles, into other units and the other convention."""
    tube = ["--c0", "1/(52.083333333333336nm)", "--period", "375nm", "--lengths", "750nm"]
    run(capsys, "localized", *tube, *NM, "--out", tmp_path / "l.csv")
    columns = pd.read_csv(tmp_path / "l.csv")[["C0[1/nm]", "period[nm]", "L[nm]", "v", "E[mN/m]", "amplitude[nm]"]]
    renamed = {"v": "v_there", "E[mN/m]": "E_there[mN/m]", "amplitude[nm]": "neck[nm]"}
    columns.rename(columns=renamed).to_csv(tmp_path / "l.csv", index=False)
    other = ["--c0", "9.6/um", "--period", "0.375", "--lengths", "0.75", "--radius", "0.05um", "--convention", "mem3dg"]
    status, out, err = run(capsys, "localized", *other, "--compare", tmp_path / "l.csv")
    assert status == 0, err
    found = pd.read_csv(io.StringIO(out))
    assert found["v_there"].to_numpy() == pytest.approx(found["v"].to_numpy(), rel=1e-9)
    assert found["neck[nm]"].to_numpy() == pytest.approx(1000 * found["amplitude[um]"].to_numpy(), rel=1e-9)
    assert "E_there[mN/m]" in found  # whose unit nobody asked to convert
    status, _, err = run(
        capsys, "localized", "--c0", 0.48, "--period", 7.5, "--lengths", 15, "--compare", tmp_path / "l.csv"
    )
    assert (status, err) == (2, "pearlbvp: --compare: column C0[1/nm]: 1/nm has a unit, so the radius needs one; give "
                                "--radius 50nm or the like, too\n")  # fmt: skip


def test_a_branch_in_nanometres_is_compared_in_micrometres(capsys, saved, tmp_path):
    run(capsys, "show", saved, *NM, "--out", tmp_path / "b.csv")
    compare = ["amplitude", "--mode", "2,0", "--compare", tmp_path / "b.csv", "--branch", tmp_path / "e.csv"]
    status, _, err = run(capsys, *compare, "--c0", "9.6", "--length", "0.75", "--convention", "mem3dg", "--radius", "0.05um",
                         "--kappa", "40kT")  # fmt: skip
    assert status == 0, err
    errors = pd.read_csv(tmp_path / "e.csv")
    assert errors["wave[um]"].to_numpy() == pytest.approx(2 * errors["A[um]"].to_numpy(), rel=0.05)
    assert (errors[["lambda1_error", "lambda2_error", "E_error", "wave_error"]] < 0.1).all(axis=None)
    for options, words in (
        (["--radius", "50nm"], "--compare: column lambda1[mN/m]: 1mN/m takes the bending rigidity; give --kappa"),
        (
            [*NM, "--convention", "mem3dg"],
            "--compare: the table is of c0 = 0.0096/nm, not 0.0192/nm; give that of this tube",
        ),
    ):
        status, _, err = run(capsys, *compare, "--c0", "0.0192", "--length", "750", *options)
        assert (status, err.count("\n")) == (2, 1)
        assert words in err


def test_a_profile_s_columns_may_have_units(capsys, tmp_path):
    x = np.linspace(0, 600, 97)
    rows = pd.DataFrame({"x[nm]": x, "r[um]": 0.05 * (1 + 0.1 * np.cos(np.pi * x / 300))})
    rows.to_csv(tmp_path / "p.csv", index=False)
    rows.set_axis(["x", "r"], axis=1).assign(r=1000 * rows["r[um]"]).to_csv(tmp_path / "n.csv", index=False)
    flow = ["flow", "--c0", 0, "--length", "0.6um", *NM, "--time", "1nm/Pa"]
    one, other = (run(capsys, *flow, "--profile", tmp_path / f"{name}.csv") for name in "pn")
    assert one[0] == other[0] == 0, one[2]
    np.testing.assert_allclose(
        *(pd.read_csv(io.StringIO(out)).to_numpy(float) for _, out, _ in (one, other)), rtol=1e-6, atol=1e-9
    )
    status, _, err = run(capsys, "flow", "--c0", 0, "--length", 12, "--profile", tmp_path / "p.csv", "--time", 1)
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("pearlbvp: --profile: column x[nm]: 1nm has a unit, so the radius needs one; give --radius")
