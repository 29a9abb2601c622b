"""``pearlbvp growth``: a tube as it is measured, its onset, period and growth time; and what is said of mistakes."""

import io
import math

import numpy as np
import pandas as pd
import pytest
from support.commands import is_png, run

import pearlbvp as pb
from pearlbvp.studies.growth import COLUMNS

KT = 1.380649e-23 * 310  # J
TUBE = ["--radius", "0.7um", "--kappa", "20kT"]


def growth(capsys, *arguments):
    """The table of a call, with what was said."""
    status, out, err = run(capsys, "growth", *arguments)
    assert status == 0, err
    assert err.count("\n") == 1
    return pd.read_csv(io.StringIO(out)), err


def fastest(table):
    return table[table["role"] == "fastest"].iloc[0]


def test_a_tube_from_the_microscope(capsys, tmp_path):
    table, said = growth(capsys, *TUBE, "--tension", "1e-3mN/m", "--viscosity", "1mPa.s", "--plot", tmp_path / "g.png")
    row = fastest(table)
    R, kappa, sigma = 0.7e-6, 20 * KT, 1e-6
    assert row["lambda1_pearl[mN/m]"] == pytest.approx(1.5 * kappa / R**2 * 1e3, rel=1e-9)
    # The dimensionless tube, by hand: lambda1 = Sigma R^2/(2 kappa), rates in 2 kappa/(eta R^3).
    model = fastest(pb.growth(0.0, sigma * R**2 / (2 * kappa)))
    assert row["wavelength[um]"] == pytest.approx(2 * math.pi / model.k * 0.7, rel=1e-7)
    assert row["rate[1/s]"] == pytest.approx(model.rate * 2 * kappa / (1e-3 * R**3), rel=1e-9)
    assert row["mu[Pa/um]"] == pytest.approx(model.mu * 2 * kappa / R**4 * 1e-6, rel=1e-7)
    assert row["mu_diffusion[Pa/um^3]"] == pytest.approx(model.mu_diffusion * 2 * kappa / R**6 * 1e-18, rel=1e-7)
    # At c0 = 0 the tube is in equilibrium at p = Sigma/R - kappa/(2 R^3), and a piston holds 2 pi R Sigma + pi kappa/R - pi R^2 p.
    pressure = sigma / R - kappa / (2 * R**3)
    force = 2 * math.pi * R * (sigma + kappa / (2 * R**2)) - math.pi * R**2 * pressure
    np.testing.assert_allclose(table["force[pN]"], force * 1e12, rtol=1e-9)
    assert said.startswith(
        "pearlbvp: the fastest wave is 8.10076 um long and grows at 26.9521/s; the tube is straight at"
    )
    assert is_png(tmp_path / "g.png")


def test_a_tether_is_pulled_by_the_force_of_the_textbooks(capsys):
    """Without a pressure ``Sigma = kappa/(2 R^2)`` and ``f = 2 pi kappa/R`` (Derenyi, Juelicher, Prost, PRL 88 (2002) 238101)."""
    R, kappa = 20e-9, 20 * KT
    table, _ = growth(capsys, "--radius", "20nm", "--kappa", "20kT", "--tension", f"{kappa / (2 * R**2)!r}N/m")
    np.testing.assert_allclose(table["lambda2[Pa]"], 0, atol=1e-6)
    np.testing.assert_allclose(table["force[pN]"], 2 * math.pi * kappa / R * 1e12, rtol=1e-9)


def test_at_strong_tension_only_the_viscosity_counts(capsys):
    """A known figure in SI units: 0.03025 Sigma/(eta R) where kappa says nothing."""
    table, _ = growth(
        capsys, "--radius", "10um", "--kappa", "1kT", "--tension", "1mN/m", "--viscosity", "2mPa.s", "--max-n", 0
    )
    row = fastest(table)
    assert row["rate[1/s]"] == pytest.approx(0.03025 * 1e-3 / (2e-3 * 1e-5), rel=2e-4)
    assert row["k[1/um]"] * 10 == pytest.approx(0.6128, abs=1e-4)


def test_units_of_length_and_viscosity_are_a_matter_of_writing(capsys):
    slippery = ["--tension", "2e-3mN/m", "--length", "30um", "--c0", "1/(2um)"]
    one, _ = growth(capsys, *TUBE, *slippery, "--viscosity", "1mPa.s", "--membrane-viscosity", "5e-9Pa.s.m")
    other, _ = growth(
        capsys, "--radius", "700nm", "--kappa", f"{20 * KT}J", *slippery, "--viscosity", "0.001Pa.s",
        "--membrane-viscosity", "5e-3mPa.s.mm",
    )  # fmt: skip
    np.testing.assert_allclose(other["rate[1/s]"], one["rate[1/s]"], rtol=1e-9)
    np.testing.assert_allclose(other["wavelength[nm]"], 1e3 * one["wavelength[um]"], rtol=1e-9)
    # Without the viscosity the membrane's is by that, and rates are viscosity times rate.
    bare, _ = growth(capsys, *TUBE, *slippery, "--membrane-viscosity", "5um")
    np.testing.assert_allclose(bare["rate[Pa]"], 1e-3 * one["rate[1/s]"], rtol=1e-9)


def test_columns_without_units(capsys):
    table, said = growth(capsys, "--tension", 0.3, "--wave-numbers", "0.1:0.3:0.1", "--max-n", 1)
    assert list(table) == COLUMNS
    assert table["k"].tolist() == pytest.approx([0.1, 0.2, 0.3] * 2)
    assert (
        said == "pearlbvp: no wave grows: the tube is straight at tensions from -0.75 to 0.75, above which it pearls\n"
    )
    assert "no tension keeps the tube straight" in growth(capsys, "--tension", 0.3, "--c0", 0.7)[1]
    wrinkled = growth(capsys, "--tension=-3", "--c0=-0.6")[1]
    assert wrinkled.startswith(
        "pearlbvp: the fastest wave is as long as the tube, with 2 around it, and grows at 0.695;"
    )
    assert "the tube is straight at tensions above" in growth(capsys, "--tension", 1, "--length", 6)[1]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--viscosity", "1mPa.s"], "--viscosity: 1mPa.s needs the radius, like 50nm, and kappa, like 20kT"),
        (["--radius", "1um", "--viscosity", "1mPa.s"], "--viscosity: 1mPa.s needs"),
        ([*TUBE, "--viscosity", "1"], "--viscosity: 1.0 has no unit; give one like 1mPa.s"),
        ([*TUBE, "--viscosity", "1mPa"], "--viscosity: 1mPa is a pressure; give a viscosity, like 1mPa.s"),
        ([*TUBE, "--viscosity=-1mPa.s"], "--viscosity: -1mPa.s is not above 0; give one like 1mPa.s"),
        ([*TUBE, "--viscosity-ratio", "0"], "--viscosity-ratio: 0.0 must be positive"),
        ([*TUBE, "--max-n", "99999999999999999999"], "--max-n: "),
        ([*TUBE, "--viscosity-ratio", "1e300"], "--viscosity-ratio: 1e+300 is beyond 1e+12"),
        ([*TUBE, "--membrane-viscosity", "1e300"], "e+300 is beyond 1e+12 by"),
        ([*TUBE, "--viscosity", "1mPa.s", "--membrane-viscosity", "1Pa"], "--membrane-viscosity: 1Pa is a pressure"),
        (
            [*TUBE, "--membrane-viscosity", "5e-9Pa.s.m"],
            "--membrane-viscosity: 5e-9Pa.s.m needs the viscosity of the fluid, like 1mPa.s; give that, too, or a length",
        ),
        (
            ["--convention", "mem3dg"],
            "--convention: it says what kappa is, and there is none; give --radius and --kappa",
        ),
        (["--temperature", "300K"], "--temperature: it says what kappa is, and there is none"),
        (["--length", "10", "--wave-numbers", "1"], "--wave-numbers: it does not go with --length"),
        (["--max-m", "4"], "--max-m: it goes with --length"),
        (["--c0", "1e5"], "--c0: 100000 is beyond 10000"),
    ],
)
def test_mistakes_are_one_line(capsys, options, said):
    status, out, err = run(capsys, "growth", "--tension", "1", *options)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert said in err


@pytest.mark.parametrize(
    ("tension", "said"),
    [("1e20mN/m", "check its unit"), ("-1N/m", "; give more than -0.3493"), ("1mN", "1mN is a force")],
)
def test_tensions_that_no_tube_has(capsys, tension, said):
    status, _, err = run(capsys, "growth", *TUBE, f"--tension={tension}")
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("pearlbvp: --tension: ")
    assert said in err
