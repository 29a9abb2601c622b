"""One physical tube, measured in radii and in another unit: every column, option, sentence, surface and picture agrees.

The powers of length are derived here from what the quantities are, and the radius is no power of anything.
"""

import io
import pickle

import numpy as np
import pandas as pd
import pytest
from support.commands import run

from pearlbvp.dimensions import QUANTITIES
from pearlbvp.errors import InputError
from pearlbvp.figures import canvas
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.files import read_mesh
from pearlbvp.studies.saved import load
from pearlbvp.units import Sentence, Units

R = 0.37

LENGTH = 1
CURVATURE = -LENGTH  # H and c0, and wave numbers
AREA, VOLUME = 2 * LENGTH, 3 * LENGTH
ENERGY = 2 * CURVATURE + AREA  # E is the integral of (H - c0)^2 over the surface
BY_AREA = ENERGY - AREA  # the column E, and lambda1, of which lambda1 A is an energy
BY_VOLUME = ENERGY - VOLUME  # lambda2 V is an energy
VELOCITY = ENERGY - AREA - LENGTH  # -dF: the energy's change by area and displacement
TIME = LENGTH - VELOCITY
POWERS = {
    **dict.fromkeys(("L", "period", "amplitude", "wave", "r_min", "r_max"), LENGTH),
    **dict.fromkeys(("c0", "k"), CURVATURE),
    **dict.fromkeys(("E", "E_least_energy", "lambda1"), BY_AREA),
    **dict.fromkeys(("lambda2", "lambda2_pearl", "lambda2_upper"), BY_VOLUME),
    **dict.fromkeys(("mu_crit", "mu_error"), -TIME),
    "M": CURVATURE + AREA, "force": ENERGY - LENGTH, "torque": ENERGY,
    "area": AREA, "volume": VOLUME,
}  # fmt: skip
OF_FLOWS = {
    "area and volume": POWERS | {"area": 0, "t": TIME, "velocity": VELOCITY},
    # the velocity is the second derivative of that of the other flow
    "diffusion": POWERS | {"area": 0, "t": LENGTH - (VELOCITY - 2), "velocity": VELOCITY - 2},
}
SUPERSCRIPTS = {"⁰": 0, "²": 2, "³": 3, "⁴": 4, "⁵": 5, "⁶": 6}


def u(number, power):
    """A number in radii as a user with the other unit writes it."""
    return repr(number * R**power)


def table_of(out):
    return pd.read_csv(io.StringIO(out))


def check(one, other, powers, rtol=1e-6, noise=0.0):
    """Each column of the other table is that of the first times its power of the radius; those of zeros are known to 1e-9.

    ``noise`` is that of a column's numbers by the largest of them.
    """
    assert list(one) == list(other)
    assert len(one) == len(other) > 0
    for name in one:
        if pd.api.types.is_numeric_dtype(one[name]):
            expected = one[name] * R ** powers.get(name, 0)
            known = max(1e-9 * max(1.0, R ** powers.get(name, 0)), noise * float(expected.abs().max()))
            np.testing.assert_allclose(other[name], expected, rtol=rtol, atol=known, err_msg=name)
        else:  # on the straight tube several perturbations are equally critical
            first = 1 if name == "critical" and len(one) > 1 else 0
            assert one[name].astype(str).tolist()[first:] == other[name].astype(str).tolist()[first:], name


def power_of(label):
    """Power of length of the unit in an axis's label: ``... (1/unit³)``."""
    if not label.endswith(")"):
        return 0
    unit = label[label.rindex("(") + 1 : -1]
    if unit == "units":
        return 1
    raised = unit.removeprefix("1/").removeprefix("unit")
    assert raised == "" or len(raised) == 1, label
    return (-1 if unit.startswith("1/") else 1) * (SUPERSCRIPTS[raised] if raised else 1)


class Pictures:
    """The figures that commands save, in order."""

    def __init__(self):
        self.figures = []

    def keep(self, figure, path):
        self.figures.append(figure)
        path.write_bytes(b"drawn")


@pytest.fixture
def pictures(monkeypatch, tmp_path):
    kept = Pictures()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(canvas, "save_figure", kept.keep)
    return kept


def drawn(axes):
    """Finite points of all lines of some axes, by columns x and y."""
    points = np.concatenate([line.get_xydata() for line in axes.lines])
    return points[np.isfinite(points).all(axis=1)]


def check_axes(axes, x, y):
    """Lines reach exactly over the numbers of the table, all of which are in sight."""
    for found, wanted, limits in zip(drawn(axes).T, (x, y), (axes.get_xlim(), axes.get_ylim()), strict=True):
        assert (found.min(), found.max()) == pytest.approx((wanted.min(), wanted.max()), rel=1e-9)
        assert limits[0] <= wanted.min()
        assert wanted.max() <= limits[1]


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Two pearls, followed and saved in radii."""
    from pearlbvp.studies.branch import branch_options, family_branch
    from pearlbvp.studies.saved import save

    path = tmp_path_factory.mktemp("units") / "b.h5"
    save(family_branch(Tube(0.48, 15), "pearl", (2, 0), branch_options(max_points=5)), path)
    return path


def both(capsys, command, in_radii, in_units):
    """Tables of a command in radii and in the other unit, and the words of the second."""
    status, out, err = run(capsys, *command, *in_radii)
    assert status == 0, err
    status, other, err = run(capsys, *command, *in_units, "--radius", R)
    assert status == 0, err
    return table_of(out), table_of(other), err


def test_instabilities_of_the_straight_tube(capsys, pictures):
    one, other, _ = both(
        capsys, ["dispersion"], ["--c0", 0.48, "--length", 30],
        ["--c0", u(0.48, CURVATURE), "--length", u(30, LENGTH), "--plot", "p.png"],
    )  # fmt: skip
    check(one, other, POWERS, rtol=1e-9)
    (axes,) = pictures.figures[0].axes
    assert power_of(axes.get_xlabel()) == POWERS["k"]
    assert power_of(axes.get_ylabel()) == POWERS["lambda2"]
    marks = np.concatenate([line.get_xydata() for line in axes.lines if line.get_marker() == "o"])
    np.testing.assert_allclose(marks[np.lexsort(marks.T)], other[["k", "lambda2"]].to_numpy()[np.lexsort(other[["k", "lambda2"]].to_numpy().T)], rtol=1e-9)  # fmt: skip
    ends = other["lambda2"][other["role"].notna()]
    low, high = axes.get_ylim()
    assert low < ends.min() < ends.max() < high
    assert high - low < 4 * np.ptp(ends) + 2 * R**BY_VOLUME
    assert f"c0 = {0.48 / R:g}, L = {30 * R:g}" in axes.get_title()
    assert f"radius of the straight tube: {R:g} units" in [text.get_text() for text in pictures.figures[0].texts]
    # a curve passes through its own modes
    curve = next(line for line in axes.lines if line.get_marker() != "o").get_xydata()
    modes = other[(other["n"] == 0) & (other["k"] < 0.9 / R)]
    np.testing.assert_allclose(np.interp(modes["k"], *curve.T), modes["lambda2"], rtol=1e-3, atol=1e-3)


def test_growth_rates(capsys, pictures):
    one, other, said = both(
        capsys, ["growth", "--viscosity-ratio", 3], ["--c0", 0.2, "--tension", 1.1, "--length", 30, "--membrane-viscosity", 0.4],
        ["--c0", u(0.2, CURVATURE), "--tension", u(1.1, BY_AREA), "--length", u(30, LENGTH), "--membrane-viscosity", u(0.4, LENGTH),
         "--plot", "p.png"],
    )  # fmt: skip
    powers = POWERS | {"wavelength": LENGTH, "rate": BY_VOLUME, "mu": -TIME, "mu_diffusion": -TIME - 2,
                       "lambda1_lower": BY_AREA, "lambda1_pearl": BY_AREA}  # fmt: skip
    check(one, other, powers, rtol=1e-9)  # a stress, by a viscosity of 1, is a rate
    fastest = other[other["role"] == "fastest"].iloc[0]
    assert f"{fastest.wavelength:.6g} units long and grows at {fastest.rate:.6g}; " in said
    assert f"from {fastest.lambda1_lower:.6g} to {fastest.lambda1_pearl:.6g}, above" in said
    rates, flows = pictures.figures[0].axes
    assert [power_of(axes.get_xlabel()) for axes in (rates, flows)] == [CURVATURE, CURVATURE]
    assert (power_of(rates.get_ylabel()), power_of(flows.get_ylabel())) == (powers["rate"], 0)
    # a curve passes through the tube's waves, and is largest where the picture's scale says
    curve = rates.lines[0].get_xydata()
    waves = other[other["n"] == 0]
    np.testing.assert_allclose(np.interp(waves["k"], *curve.T), waves["rate"], rtol=1e-3, atol=1e-3 * fastest.rate)
    assert [line.get_ydata().max() for line in flows.lines[:3]] == pytest.approx([1, 1, 1])


def test_localized_pearls(capsys, pictures):
    one, other, _ = both(
        capsys, ["localized"], ["--c0", 0.48, "--period", 7.5, "--lengths", "15,30"],
        ["--c0", u(0.48, CURVATURE), "--period", u(7.5, LENGTH), "--lengths", f"{u(15, LENGTH)},{u(30, LENGTH)}",
         "--plot", "p.png"],
    )  # fmt: skip
    check(one, other, POWERS)
    left, right = pictures.figures[0].axes
    check_axes(left, other["L"], other["v"])
    check_axes(right, other["L"], other["lambda2"])
    assert [power_of(axes.get_xlabel()) for axes in (left, right)] == [LENGTH, LENGTH]
    assert [power_of(axes.get_ylabel()) for axes in (left, right)] == [0, BY_VOLUME]


def test_periods_of_pearls(capsys, pictures):
    one, other, _ = both(
        capsys, ["period", "--volume", 1.01], ["--c0", 0.48, "--lengths", "15,22.5"],
        ["--c0", u(0.48, CURVATURE), "--lengths", f"{u(15, LENGTH)},{u(22.5, LENGTH)}", "--plot", "p.png"],
    )  # fmt: skip
    check(one, other, POWERS)
    assert one[["lambda2_upper", "E_least_energy"]].notna().all(axis=None)
    top, middle, bottom = pictures.figures[0].axes
    check_axes(top, other["L"], other["period"])
    check_axes(middle, other["L"], other[["lambda2_pearl", "lambda2_upper"]].stack())
    check_axes(bottom, other["L"], other["v_localized"])
    assert [power_of(axes.get_ylabel()) for axes in (top, bottom)] == [LENGTH, 0]
    assert power_of(middle.get_ylabel()) == BY_VOLUME
    assert power_of(bottom.get_xlabel()) == LENGTH


def test_the_region_of_stable_pearls(capsys, pictures):
    one, other, _ = both(
        capsys, ["region", "--pearls", "2,3"], ["--c0", 0.48, "--periods", "7,7.5"],
        ["--c0", u(0.48, CURVATURE), "--periods", f"{u(7, LENGTH)},{u(7.5, LENGTH)}", "--plot", "p.png"],
    )  # fmt: skip
    check(one, other, POWERS)
    (axes,) = pictures.figures[0].axes
    ends = [end for bar in axes.patches for end in (bar.get_y(), bar.get_y() + bar.get_height())]
    assert sorted(ends) == pytest.approx(sorted(other[["v_from", "v_to"]].to_numpy().ravel()), rel=1e-9)
    for bars in axes.containers:
        places = sorted({bar.get_x() for bar in bars})
        assert np.diff(places) == pytest.approx(np.diff(sorted(set(other["period"]))), rel=1e-9)
    assert axes.get_xlim()[0] < other["period"].min() < other["period"].max() < axes.get_xlim()[1]
    assert (power_of(axes.get_xlabel()), power_of(axes.get_ylabel())) == (LENGTH, 0)


@pytest.mark.parametrize(
    ("family", "c0", "length", "until", "power"),
    [("pearl", 0.48, 15, ("mu_crit", -0.0652), -TIME), ("ring", -1.0, 10, ("lambda2", 1.51), BY_VOLUME),
     ("coil", 0.1, 10, ("E", 0.1605), BY_AREA)],
)  # fmt: skip
def test_branches(capsys, pictures, family, c0, length, until, power):
    name, value = until
    mode = ["--mode", "2,0"] if family == "pearl" else []
    one, other, _ = both(
        capsys, ["branch", family, *mode], ["--c0", c0, "--length", length, "--until", f"{name}={value}"],
        ["--c0", u(c0, CURVATURE), "--length", u(length, LENGTH), "--until", f"{name}={u(value, power)}", "--plot", "p.png"],
    )  # fmt: skip
    assert one[name].iloc[-1] == pytest.approx(value, rel=1e-9)
    check(one, other, POWERS)
    energy, pressure, multipliers, *shapes = pictures.figures[0].axes
    check_axes(energy, other["v"], other["E"])
    check_axes(pressure, other["v"], other["lambda2"])
    check_axes(multipliers, other["lambda2"], other["lambda1"])
    assert [power_of(axes.get_ylabel()) for axes in (energy, pressure, multipliers)] == [BY_AREA, BY_VOLUME, BY_AREA]
    assert [power_of(axes.get_xlabel()) for axes in (energy, pressure, multipliers)] == [0, 0, BY_VOLUME]
    if family != "coil":  # outlines and sections have axes
        across = drawn(shapes[0])
        assert power_of(shapes[0].get_xlabel()) == LENGTH
        first = shapes[0].lines[0].get_xydata()
        if family == "pearl":
            assert np.ptp(across[:, 0]) == pytest.approx(length * R, rel=1e-6)  # all periods
        assert np.abs(first[:, 1]).max() == pytest.approx(R, rel=1e-6)  # the straight tube


def test_a_branch_through_a_shape(capsys):
    one, other, _ = both(
        capsys, ["branch", "pearl", "--volume", 1, "--max-points", 3], ["--c0", 0.75, "--length", 10, "--shape=-0.28,0.47"],
        ["--c0", u(0.75, CURVATURE), "--length", u(10, LENGTH), f"--shape={u(-0.28, LENGTH)},{u(0.47, LENGTH)}"],
    )  # fmt: skip
    check(one, other, POWERS, rtol=1e-5)


def test_a_saved_branch_is_resumed_with_a_radius(capsys, saved):
    """What is saved is in radii, whatever the unit of the table."""
    status, out, err = run(capsys, "resume", saved, "--max-points", 6)
    assert status == 0, err
    status, other, err = run(capsys, "resume", saved, "--max-points", 6, "--radius", R)
    check(table_of(out), table_of(other), POWERS, rtol=1e-9)


@pytest.mark.parametrize("law", ["area and volume", "diffusion"])
def test_flows(capsys, pictures, saved, law):
    powers = OF_FLOWS[law]
    one, other, err = both(
        capsys, ["flow", "--from", saved, "--law", law],
        ["--point", "lambda2=-0.28", "--delta", 0.03, "--xi", 2.0, "--centre", 1.0, "--time", 0.5],
        ["--point", f"lambda2={u(-0.28, BY_VOLUME)}", "--delta", u(0.03, LENGTH), "--xi", u(2.0, -AREA), "--centre",
         u(1.0, LENGTH), "--time", u(0.5, powers["t"]), "--plot", "p.png"],
    )  # fmt: skip
    check(one, other, powers, rtol=1e-5, noise=1e-5)  # multipliers are known to the integration's tolerance
    assert f"at t = {0.5 * R ** powers['t']:.6g} the time asked for is reached" in err
    energy, multipliers, velocity = pictures.figures[0].axes[0], *pictures.figures[0].axes[1:3]
    moving = other[other["t"] > 0]
    check_axes(energy, moving["t"], moving["E"])
    check_axes(multipliers, moving["t"], moving[["lambda1", "lambda2"]].stack())
    assert velocity.lines[0].get_ydata() == pytest.approx(moving["velocity"])
    assert {power_of(axes.get_xlabel()) for axes in (energy, multipliers, velocity)} == {powers["t"]}
    assert power_of(energy.get_ylabel()) == BY_AREA
    assert [power_of(words) for words in multipliers.get_ylabel().split(",\n")] == [BY_AREA, BY_VOLUME]
    assert power_of(velocity.get_ylabel().split(",")[0]) == powers["velocity"]
    words = [text.get_text() for text in pictures.figures[0].texts]
    assert {"t = 0", f"t = {0.5 * R ** powers['t']:.4g}"} < set(words)


def test_flows_from_files_at_a_pressure(capsys, tmp_path):
    """Profiles, meshes and ``--pressure`` are read in the user's unit."""
    x = np.linspace(0, 12, 97)
    r = 1 + 0.1 * np.cos(np.pi * x / 6)
    for name, unit in (("one", 1.0), ("other", R)):
        pd.DataFrame({"x": unit * x, "r": unit * r}).to_csv(tmp_path / f"{name}.csv", index=False)
    one, other, _ = both(
        capsys, ["flow", "--law", "area"],
        ["--profile", tmp_path / "one.csv", "--c0", 0.2, "--length", 12.0, "--pressure", 0.3, "--time", 0.1],
        ["--profile", tmp_path / "other.csv", "--c0", u(0.2, CURVATURE), "--length", u(12.0, LENGTH),
         "--pressure", u(0.3, BY_VOLUME), "--time", u(0.1, TIME)],
    )  # fmt: skip
    check(one, other, OF_FLOWS["area and volume"], rtol=1e-5)
    assert one["lambda2"].to_numpy() == pytest.approx(0.3)


def test_meshes(capsys, pictures, saved, tmp_path):
    one, other, _ = both(
        capsys, ["mesh", "--from", saved, "--solve", "--nodes", 600], ["--point", "r_max=1.1", "--out", tmp_path / "one.ply"],
        ["--point", f"r_max={u(1.1, LENGTH)}", "--out", tmp_path / "other.ply", "--plot", "p.png"],
    )  # fmt: skip
    assert one["r_max"].iloc[0] == pytest.approx(1.1, rel=5e-3)
    check(one, other, POWERS)
    small, large = read_mesh(tmp_path / "other.ply", 15 * R), read_mesh(tmp_path / "one.ply", 15.0)
    np.testing.assert_allclose(small.vertices, R * large.vertices, atol=1e-6)
    surface, colours = pictures.figures[0].axes
    seen = np.concatenate([path.vertices for path in surface.collections[0].get_paths()])
    assert np.ptp(seen[:, 0]) == pytest.approx(15 * R, rel=1e-2)  # the triangles are not cut off at the ends
    assert seen[:, 1].max() == pytest.approx(other["r_max"].iloc[0], rel=0.02)
    assert {power_of(label) for label in (surface.get_xlabel(), surface.get_ylabel(), colours.get_xlabel())} == {LENGTH}
    low, high = colours.get_xlim()
    assert (low, high) == pytest.approx((other["r_min"].iloc[0], other["r_max"].iloc[0]), rel=0.02)


def test_without_a_radius_axes_are_in_radii(capsys, pictures):
    run(capsys, "dispersion", "--c0", 0.48, "--length", 30, "--plot", "p.png")
    (axes,) = pictures.figures[0].axes
    assert axes.get_xlabel() == "wave number k (1/radius)"
    assert axes.get_ylabel() == "lambda2 at which the mode is neutral (1/radius³)"
    assert not pictures.figures[0].texts


def test_mistakes_are_said_in_the_user_s_unit(capsys, saved):
    for arguments, words in (
        (["localized", "--c0", 0.48 / R, "--period", 7.5 * R, "--lengths", 31 * R],
         f"--lengths: {31 * R:g} units is no multiple of the period {7.5 * R:g}; the nearest is {30 * R:.12g}"),
        (["branch", "pearl", "--c0", 0, "--length", 2 * np.pi * R], f"(k = {1 / R:.12g})"),
        (["branch", "coil", "--c0", 0, "--length", 1e6 * R, "--nodes", 500], f"--length: {1e6 * R:g} units are too long"),
        (["flow", "--c0", 0.48 / R, "--length", 7 * R, "--point", f"E={u(100, BY_AREA)}", "--time", 1],
         f"--point: E = {100 * R**BY_AREA:.9g} is not reached"),
        (["branch", "pearl", "--c0", 0, "--length", 10, "--radius", 0], "--radius: '0' must be positive"),
    ):  # fmt: skip
        given = arguments if "--radius" in arguments else [*arguments, "--radius", R]
        status, _, err = run(capsys, *given)
        assert status == 2
        assert words in err
        assert err.count("\n") == 1


def test_a_sentence_reads_in_any_unit_and_keeps_its_numbers_on_its_way_through_another_process():
    neck = Sentence("a neck of {r:.3g} {r_unit} at {place}", r=0.5, place="{x}")
    whole = Sentence.joined("shape {0}: ", neck, Sentence("; t = {t:g}", t=2.0))
    assert whole == "shape {0}: a neck of 0.5 radii at {x}; t = 2"
    assert Units(2.0, given=True).said("(" + neck + ")") == "(a neck of 1 units at {x})"
    error = pickle.loads(pickle.dumps(InputError("flow", whole)))
    assert str(error) == f"flow: {whole}"
    assert Units(10.0, given=True).said(str(error)) == "flow: shape {0}: a neck of 5 units at {x}; t = 20000"
    tall = Units(10.0, given=True)
    assert tall.said(error.what) == "shape {0}: a neck of 5 units at {x}; t = 20000"
    assert tall.of_flow("diffusion").said(error.what).endswith("t = 2e+06")
    assert tall.said("as it is {r}") == "as it is {r}"


@pytest.mark.parametrize("name", sorted(QUANTITIES))
def test_what_is_written_is_read_back_as_it_was(name):
    """To the last digit or two, also at radii in metres, for every quantity and every flow."""
    for radius in (R, 2.5e-8, 1e6):
        for law in ("area and volume", "area", "diffusion"):
            units = Units(radius, law=law)
            assert units.from_user(name, units.to_user(name, 0.7)) == pytest.approx(0.7, rel=1e-14)


def test_a_column_whose_dimension_nobody_said_is_not_written():
    with pytest.raises(KeyError, match="new"):
        Units(R).columns(pd.DataFrame({"v": [1.0], "new": [2.0]}))


def test_the_growth_rate_to_all_perturbations_is_that_of_the_flow_s_own_discretization(capsys, saved, tmp_path):
    """The shape has less area than the tube: its rates come from a similar shape of a branch, and from the flow itself."""
    out = tmp_path / "f.csv"
    status, _, err = run(capsys, "flow", "--from", saved, "--point", 3, "--delta", 0.15 * R, "--xi", 0.1 / R**2, "--out", out,
                         "--radius", R)  # fmt: skip
    assert status == 0, err
    own, whole = (float(err.split(words)[1].split()[0]) for words in ("the largest growth rate is ", "mu_crit = "))
    assert pd.read_csv(out)["area"].iloc[-1] < 0.95
    assert whole == pytest.approx(own, rel=5e-3)


def test_why_a_branch_ends_is_said_in_the_user_s_unit_and_saved_in_radii(capsys, tmp_path):
    """These pearls end where their spectrum is not resolved, at a neck that the table has, too."""
    arguments = [
        "branch",
        "pearl",
        "--c0",
        0.75 / R,
        "--length",
        5 * R,
        "--max-points",
        80,
        "--save",
        tmp_path / "b.h5",
    ]
    _, out, err = run(capsys, *arguments, "--radius", R)
    neck = table_of(out)["r_min"].iloc[-1]
    assert 0.1 < neck / R < 0.9
    assert f"at a neck of {neck:.1e}" in err
    assert f"at a neck of {neck / R:.1e}" in load(tmp_path / "b.h5").reason
