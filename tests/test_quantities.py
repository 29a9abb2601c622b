"""Quantities as they are written: read by pint, compared with powers of ten that are written out here."""

import math
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as some
from support.commands import run

from pearlbvp.errors import InputError
from pearlbvp.quantities import Dimension, Measured, has_unit, kelvins, read, unit_text
from pearlbvp.units import Units

KT = 1.380649e-23 * 310  # J
IN_SI = {
    "nm": (1e-9, Dimension(1)),
    "um": (1e-6, Dimension(1)),
    "µm": (1e-6, Dimension(1)),
    "Å": (1e-10, Dimension(1)),
    "/nm": (1e9, Dimension(-1)),
    "nm^-1": (1e9, Dimension(-1)),
    "/um^3": (1e18, Dimension(-3)),
    "kT": (KT, Dimension(energy=1)),
    "pN nm": (1e-21, Dimension(energy=1)),
    "mN/m": (1e-3, Dimension(-2, energy=1)),
    "kT/nm^2": (KT * 1e18, Dimension(-2, energy=1)),
    "Pa": (1.0, Dimension(-3, energy=1)),
    "kPa": (1e3, Dimension(-3, energy=1)),
    "pN": (1e-12, Dimension(-1, energy=1)),
    "mPa.s": (1e-3, Dimension(-3, 1, 1)),
    "mPa s": (1e-3, Dimension(-3, 1, 1)),
    "nm/(Pa s)": (1e-9, Dimension(4, -1, -1)),
    "/s": (1.0, Dimension(time=-1)),
    "um/min": (1e-6 / 60, Dimension(1, -1)),
}


@given(
    some.floats(1e-6, 1e6) | some.floats(-1e6, -1e-6), some.sampled_from(sorted(IN_SI)), some.sampled_from(["", " "])
)
def test_a_number_and_its_unit_are_read(number, unit, space):
    size, dimension = IN_SI[unit]
    found = read("x", f"{number!r}{space}{unit}", 310.0)
    assert found.dimension == dimension
    assert found.value == pytest.approx(number * size, rel=1e-14)
    assert has_unit(f"{number!r}{unit}")


def test_a_number_by_a_length():
    for text in ("1/(150nm)", "1 / (150 nm)", "1/(0.15um)", "0.00666666666666666667/nm"):
        assert read("c0", text).value == pytest.approx(1 / 150e-9, rel=1e-14), text


def test_temperatures():
    assert kelvins("temperature", "310K") == 310
    assert kelvins("temperature", "37degC") == kelvins("temperature", "37 °C") == pytest.approx(310.15)
    assert read("kappa", "20kT", 300.0).value == pytest.approx(20 * 1.380649e-23 * 300, rel=1e-14)
    for wrong in ("310", "0K", "-3K", "3nm", "5000K", "K"):
        with pytest.raises(InputError, match=r"^temperature: .*; "):
            kelvins("temperature", wrong)


@pytest.mark.parametrize(
    "text",
    ["1 2nm", "3'nm", "3;4nm", "1nm+2nm", "9^9^9nm", "9**9**9 nm", "5nm^99", "5nm^0.5", "1e999nm", "inf nm", "nan nm", "nm",
     "3abc", "(1nm", "1/(0nm)", "1/150nm", "__import__('os')", "{x}nm", "1" * 100 + "nm", "20K", "1M", "3V", "20kcal/mol", ""],
)  # fmt: skip
def test_what_is_no_quantity_is_refused_at_once(text):
    """pint alone reads ``1 2nm`` as 2 nm and works on ``9^9^9nm`` for ever."""
    with pytest.raises(InputError, match=r"^c0: .*; ") as refused:
        read("c0", text)
    assert "\n" not in str(refused.value)


def test_units_are_written_as_they_are_read():
    for powers, text in (
        ({"nm": 1}, "nm"), ({"nm": -3}, "1/nm^3"), ({"Pa": 1, "nm": -1}, "Pa/nm"), ({"nm": 4, "s": -1}, "nm^4/s"), ({"nm": 0}, ""),
    ):  # fmt: skip
        assert unit_text(powers) == text
    assert f"{Measured(50, 'nm'):g} {Measured(0.01, '1/nm'):.2f} {Measured(2, ''):g}" == "50 nm 0.01/nm 2"


def test_multipliers_of_textbooks():
    """Kappa = 20 kT, R = 50 nm; a straight tube at c0 = 0 and k -> 0 has lambda1 = 3/4; wrinkles n = 2 lambda2 = 3/2."""
    units, kappa, radius = Units.of("50nm", "20kT"), 20 * KT, 50e-9
    assert units.unit("lambda1") == units.unit("E") == "mN/m"
    assert units.to_user("lambda1", 0.75) == pytest.approx(
        1e3 * 1.5 * kappa / radius**2, rel=1e-13
    )  # Bar-Ziv and Moses
    assert units.unit("lambda2") == "Pa"
    assert units.to_user("lambda2", 1.5) == pytest.approx(3 * kappa / radius**3, rel=1e-13)  # Levy
    # Of the straight tube without pressure and tension, kappa/2 (1/R - C0)^2 = 0.
    assert units.from_user("c0", 1 / 50) == pytest.approx(0.5, rel=1e-14)
    assert units.symbol("c0") == "C0"


def test_60_kt_of_mem3dg_are_30_kt_of_the_physicists():
    """And their c0 is half of the physicists' C0: kappa (H - c0)^2 = (kappa/2)/2 (2H - 2 c0)^2."""
    mine, theirs = Units.of("50nm", "30kT"), Units.of("50nm", "60kT", convention="mem3dg")
    for name in ("lambda1", "lambda2", "E", "mu_crit", "t", "L"):
        assert (mine.to_user(name, 0.7), mine.unit(name)) == (
            pytest.approx(theirs.to_user(name, 0.7)),
            theirs.unit(name),
        )
    assert mine.number("c0", "1/(150nm)", "c0") == theirs.number("c0", "1/(150nm)", "c0") == pytest.approx(1 / 150)
    assert mine.tube("1/(150nm)", "2um").c0 == pytest.approx(50 / 300)
    assert theirs.tube("1/(150nm)", "2um").c0 == pytest.approx(50 / 150)
    assert theirs.symbol("c0") == "c0"


def test_a_tube_in_units_is_the_one_in_radii():
    tube = Units.of("50nm").tube("1/(100nm)", "2um")
    assert (tube.c0, tube.L) == (pytest.approx(0.25), 40.0)
    assert Units.of("50nm").tube(1 / 100, 2000) == tube  # numbers are in the radius's unit
    assert Units.of(50).tube(1 / 200, 2000) == tube  # and c0 is that of (H - c0)^2 where there is no unit


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--length 2um", "--length: 2um has a unit, so the radius needs one; give --radius"),
        ("--length 2000 --kappa 20kT", "--kappa: it needs the radius with its unit; give --radius"),
        ("--length 2000 --radius 50 --kappa 20kT", "--kappa: it needs the radius with its unit; give"),
        ("--length 2um --radius 50nm --kappa 20nm", "--kappa: 20nm is a length; give an energy, like 20kT"),
        ("--length 2um --radius 50nm --kappa 20", "--kappa: '20' is no number with a unit"),
        ("--length 2um --radius 50nm --kappa 0kT", "--kappa: 0kT must be positive; give an energy"),
        ("--length 2um --radius 50nm --kappa 1e30kT", "--kappa: 1e30kT is not between"),
        ("--length 2um --radius 20kT", "--radius: 20kT is an energy; give a length, like 50nm"),
        ("--length 2um --radius -50nm", "--radius: -50nm must be positive"),
        ("--length 2um --radius 1e-300m", "--radius: 1e-300m is not between"),
        ("--length 2um --radius 1e999nm", "--radius: 1e999nm is not finite"),
        ("--length 2um --radius nan", "--radius: 'nan' is not finite"),
        ("--length 2um --radius 50nm --temperature 5", "--temperature: 5 is no temperature of a membrane"),
        ("--length 2kT --radius 50nm", "--length: 2kT is an energy; give a length, like 50nm"),
        ("--length=-2um --radius 50nm", "--length: -2000.0 must be positive"),
        ("--length 2um --radius 50nm --c0 3nm", "--c0: 3nm is a length; give a curvature, like 1/(150nm)"),
        ("--length 2um --radius 50nm --c0 1/150nm", "put what it is divided by in brackets, like 1/(150nm)"),
        ("--length 2um --radius 50nm --convention others", "--convention"),
    ],
)
def test_mistakes_of_units_are_one_line(capsys, options, words):
    c0 = [] if "--c0" in options else ["--c0", "0"]
    status, _, err = run(capsys, "dispersion", *c0, *options.split())
    assert (status, err.count("\n")) == (2, 1)
    assert words in err


def test_a_tension_needs_the_rigidity(capsys):
    tube = ["branch", "pearl", "--c0", "0", "--length", "500nm", "--radius", "50nm"]
    status, _, err = run(capsys, *tube, "--until", "lambda1=0.05mN/m")
    assert (status, err) == (
        2, "pearlbvp: --until: 0.05mN/m takes the bending rigidity; give --kappa 20kT or the like, too\n"
    )  # fmt: skip
    status, _, err = run(capsys, *tube, "--kappa", "20kT", "--until", "lambda1=0.05Pa")
    assert (status, err) == (2, "pearlbvp: --until: 0.05Pa is a pressure; give a tension, like 0.01mN/m\n")


def test_lists_and_ranges_have_units():
    from click import Option

    from pearlbvp.commands.arguments import Numbers

    option = Option(["--lengths"], type=Numbers("length"))
    units = Units.of("50nm")
    for text, wanted in (
        ("0.5um,750nm,1000", [500, 750, 1000]), ("0.4um:1um:200nm", [400, 600, 800, 1000]), ("100:300:0.1um", [100, 200, 300]),
    ):  # fmt: skip
        found = option.type.in_units(option.type.convert(text, option, None), units, option)
        assert found == wanted
    assert option.type.convert("15,30", option, None) == [15, 30]


def test_times_count_in_a_mobility_of_1_or_in_seconds():
    """A velocity of the gradient flow is a pressure times the mobility; by diffusion, a pressure by two lengths."""
    units = Units.of("50nm", "20kT")
    energy, radius = 40 * KT, 50.0
    assert units.unit("velocity") == "Pa"
    assert units.to_user("velocity", 1.0) == pytest.approx(energy / 50e-9**3)
    assert (units.unit("mu_crit"), units.unit("t")) == ("Pa/nm", "nm/Pa")
    assert units.to_user("mu_crit", 1.0) == pytest.approx(energy / 50e-9**3 / radius)
    assert units.to_user("t", 1.0) * units.to_user("mu_crit", 1.0) == pytest.approx(1)
    assert units.of_flow("diffusion").unit("velocity") == "Pa/nm^2"
    timed = units.in_time(2.0)
    assert (timed.unit("t"), timed.unit("rate"), timed.unit("velocity")) == ("s", "1/s", "nm/s")
    assert timed.to_user("t", 3.0) == pytest.approx(6.0)
    assert timed.to_user("velocity", 1.0) == pytest.approx(25.0)
    assert timed.number("t", "0.1min", "time") == pytest.approx(6.0)
    assert math.isclose(timed.from_user("t", 6.0), 3.0)


def test_pint_is_loaded_for_units_only(capsys, monkeypatch):
    """Its import takes a third of a second, which commands without units do not pay."""
    from pearlbvp import quantities

    quantities._registry.cache_clear()
    monkeypatch.setitem(sys.modules, "pint", None)  # importing it raises
    assert run(capsys, "dispersion", "--c0", "0.48", "--length", 30, "--radius", 0.5, "--max-n", 1)[0] == 0
    with pytest.raises(ImportError):
        read("radius", "50nm")
