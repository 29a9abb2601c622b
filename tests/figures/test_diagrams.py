"""Diagrams: what is drawn is the branches, energies less a reference, shapes that hide nothing, colours for all eyes."""

import itertools

import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

import pearlbvp as pb
from pearlbvp.errors import InputError
from pearlbvp.figures.canvas import FAMILIES, OTHERS
from pearlbvp.figures.diagram import draw_plane, shades
from pearlbvp.figures.equilibria import draw_equilibria
from pearlbvp.figures.places import covered, free_places
from pearlbvp.figures.region import draw_region
from pearlbvp.figures.scan import draw_scan
from pearlbvp.studies.energies import Reference
from pearlbvp.studies.names import Name
from pearlbvp.units import Units


@pytest.fixture(scope="module")
def branches():
    """Two pearls and the localized one that crosses them, of one tube."""
    two = pb.branch(pb.Tube(0.48, 15), "pearl", (2, 0), until={"v": 1.04})
    return {"two": two, "one": two.switch(1, until={"v": 1.04})}


def lines_of(axes, colour):
    """Points of the lines of a colour, in data coordinates."""
    lines = [line for line in axes.lines if line.get_color() == colour and line.get_linestyle() in ("-", "--")]
    points = np.concatenate([line.get_xydata() for line in lines if len(line.get_xdata())])
    return points[np.isfinite(points).all(axis=1)]


def test_lines_go_through_every_computed_point_and_signs_stand_at_the_special_ones(branches):
    (axes,) = draw_plane(branches, "lambda2", "lambda1").axes
    names = {key: Name("", kind) for key, kind in (("two", "pearl"), ("one", "unequal"))}
    for key, colour in shades(names).items():
        table = branches[key].table()
        drawn = lines_of(axes, colour)
        gaps = np.abs(table[["lambda2", "lambda1"]].to_numpy()[:, None] - drawn[None]).max(axis=2).min(axis=1)
        assert gaps.max() == 0
    (circles,) = (line for line in axes.lines if line.get_marker() == "o")
    at = branches["two"]["bp:1"].observables
    np.testing.assert_array_equal(circles.get_xydata(), [[at["lambda2"], at["lambda1"]]])


def test_energies_less_the_straight_tube_s_are_that_of_the_branch_less_its_closed_form(branches):
    units = Units.of("50nm", "20kT")
    (axes,) = draw_plane(branches, units=units, reference=Reference.of("tube")).axes
    table = branches["one"].table()
    straight = (1 - 2 * 0.48) ** 2 / 4  # (H - c0)^2 of H = 1/2
    drawn = lines_of(axes, shades({"one": Name("", "unequal")})["one"])
    wanted = np.column_stack((table["v"], units.to_user("E", table["E"] - straight)))
    assert np.abs(wanted[:, None] - drawn[None]).max(axis=2).min(axis=1).max() < 1e-12
    assert axes.get_ylabel() == "E/A less E/A of the straight tube (mN/m)"


def test_energies_less_a_branch_s_are_the_difference_from_its_shape_of_that_volume(branches):
    tube = pb.Tube(0.48, 15)
    fine = pb.branch(tube, "pearl", (2, 0), until={"v": 1.04}, max_step=0.1)
    points = [point for point in branches["one"]][1:]
    beside = [pb.branch(tube, "pearl", (2, 0), until={"v": point.observables["v"]})[-1] for point in points]
    exact = [one.observables["E"] - two.observables["E"] for one, two in zip(points, beside, strict=True)]
    assert max(exact) < -1e-5
    for reference, error in ((Reference.of("two", branches), 3e-7), (Reference.of(fine), 3e-9)):
        assert reference.above(branches["one"].table())["E"].tolist()[1:] == pytest.approx(exact, abs=error)
    own = Reference.of("two", branches).above(branches["two"].table())["E"]
    assert np.abs(own).max() < 1e-15


def test_where_a_reference_has_no_such_volume_nothing_is_drawn(branches):
    short = pb.branch(pb.Tube(0.48, 15), "pearl", (2, 0), until={"v": 1.02})
    reference = Reference.of(short)
    rows = reference.above(branches["two"].table())
    assert rows["E"].isna().tolist() == (rows["v"] > 1.02 + 1e-9).tolist()
    assert reference.misses(branches["two"])
    assert not reference.misses(short)
    coil = pb.branch(pb.Tube(0.0, 10), "coil", until={"v": 0.98})
    with pytest.raises(InputError, match=r"reference: coils \(1,1\) has none of the volumes"):
        Reference.of(coil).above(branches["one"].table())
    with pytest.raises(InputError, match="reference: there is no 'three'; give one of tube, two, one"):
        Reference.of("three", branches)


def boxes_of(figure):
    """Boxes of the pictures in a picture, in pixels."""
    return [inset.get_window_extent() for inset in figure.axes[1:]]


@pytest.mark.parametrize("plane", [("v", "E"), ("lambda2", "lambda1")])
def test_shapes_hide_neither_curves_nor_each_other_nor_names(branches, plane):
    figure = draw_plane(branches, *plane, shapes=True)
    FigureCanvasAgg(figure).draw()
    (axes, *_), boxes = figure.axes, boxes_of(figure)
    assert 4 <= len(boxes) <= 8
    for line in axes.lines:
        points = axes.transData.transform(line.get_xydata())
        points = points[np.isfinite(points).all(axis=1)]
        if line.get_linestyle() != "None" and len(points):  # and everything between them
            points = np.concatenate([np.linspace(a, b, 50) for a, b in itertools.pairwise(points)])
        inside = [((points > box.min) & (points < box.max)).all(axis=1).any() for box in boxes]
        assert not any(inside)
    boxes.append(axes.get_legend().get_window_extent())
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    frame = axes.get_window_extent()
    assert all(frame.contains(*corner) for box in boxes for corner in (box.min, box.max))


def test_shapes_stand_for_points_of_their_branches(branches):
    figure = draw_plane({"": branches["one"]}, shapes=True)
    axes = figure.axes[0]
    table = branches["one"].table()[["v", "E"]].to_numpy()
    ends = np.array([text.xy for text in axes.texts])
    assert len(ends) == len(figure.axes) - 1 >= 3
    assert np.abs(ends[:, None] - table[None]).max(axis=2).min(axis=1).max() == 0
    np.testing.assert_array_equal(ends[0], table[-1])  # the last, and others
    # All periods: the tube is 15 radii long, and one large pearl's two halves are at its ends or in its middle.
    limits = [np.ptp(inset.get_xlim()) for inset in figure.axes[1:]]
    assert min(limits) > 0.85 * 15


def test_a_place_is_the_nearest_free_one():
    taken = np.zeros((40, 30), dtype=bool)
    taken[:, 10:20] = True
    first, second, none = free_places(taken, [(10, 8), (10, 8), (50, 2)], [(20.0, 15.0), (20.0, 15.0), (20.0, 15.0)])
    assert {first[1], second[1]} <= {2, 20}
    assert abs(first[0] - 15) <= 5
    assert none is None
    line = covered((40, 30), [np.array([[0.0, 0.0], [39.0, 29.0], [np.nan, np.nan], [0.0, 29.0], [0.0, 20.0]])])
    assert line[20, 14]
    assert line[0, 25]
    assert not line[30, 5]
    assert not line[20, 29]  # nothing between the two pieces


def test_a_line_to_a_place_runs_over_no_picture_where_it_can_go_elsewhere():
    """Of two points on a curve along the upper edge, each has its picture below, and the first one's is in the other's way."""
    taken = np.zeros((120, 60), dtype=bool)
    taken[:, 50:] = True
    wide = np.argwhere(np.ones((30, 10))).astype(float)
    points = [(70.0, 52.0), (55.0, 52.0)]
    first, second = free_places(taken, [(30, 10), (30, 10)], points, [wide, wide])
    near = wide[np.square(wide + second - points[1]).sum(axis=1).argmin()] + second
    line = np.array(points[1]) + np.linspace(0, 1, 200)[:, None] * (near - points[1])
    assert not ((line >= first) & (line < np.add(first, (30, 10)))).all(axis=1).any()
    assert np.hypot(*(near - points[1])) < 30


def test_names_that_are_given_stand_in_the_picture(branches):
    words = [
        text.get_text() for text in pb.diagram({"my own": branches["two"]}).plot().axes[0].get_legend().get_texts()
    ]
    assert words == ["my own"]


def test_numbers_of_pearls_keep_their_colours_and_places_from_panel_to_panel():
    """In the second panel there are none of two pearls; those of four look as in the first, and none lies on another."""
    rows = [(0.5, 6.0, 2, 1.0, 1.2), (0.5, 6.0, 4, 1.1, 1.3), (0.6, 6.0, 4, 1.1, 1.3)]
    table = pd.DataFrame(rows, columns=["c0", "period", "pearls", "v_from", "v_to"]).assign(status="found")
    left, right = draw_region(table).axes[:2]
    bars = {axes: {bar.get_facecolor(): bar.get_x() for bar in axes.patches} for axes in (left, right)}
    assert bars[right].items() <= bars[left].items()
    (_, end), (start, _) = sorted((bar.get_x(), bar.get_x() + bar.get_width()) for bar in left.patches)
    assert end <= start + 1e-12


MACHADO = {
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    "all colours": np.eye(3),
}
"""G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1."""


def lab(linear):
    """CIELAB of linear RGB (IEC 61966-2-1, D65)."""
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear
    f = np.cbrt(np.maximum(xyz / np.array([0.9505, 1.0, 1.089]), 0.008856))
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", MACHADO)
def test_families_have_colours_that_all_eyes_tell_apart(vision):
    seen = []
    for colour in (*FAMILIES.values(), OTHERS, "#ffffff"):
        srgb = np.array(to_rgb(colour))
        linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        seen.append(lab(np.clip(np.array(MACHADO[vision]) @ linear, 0, 1)))
    apart = [np.linalg.norm(one - other) for one, other in itertools.combinations(seen, 2)]
    assert min(apart) > 12  # 2.3 is the least that is noticed side by side


def test_branches_of_one_family_have_shades_of_its_colour():
    found = shades({str(i): Name(str(i), kind) for i, kind in enumerate(("pearl", "coil", "pearl", "pearl"))})
    assert len(set(found.values())) == 4
    assert found["1"] == FAMILIES["coil"]
    light = [sum(to_rgb(found[key])) for key in ("0", "2", "3")]
    assert light == sorted(light)


def test_a_scan_in_nanometres_is_labelled_as_its_columns_are():
    units = Units.of("50nm", "20kT")
    rows = [{"c0": c0, "L": L, "period": 7.5, "v": 1 + c0 / L} for c0 in (0.45, 0.48) for L in (15.0, 30.0, 45.0)]
    figure = draw_scan(units.columns(pd.DataFrame(rows)), "localized", ("c0", "period", "L"), ("v",), units)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "length L (nm)"
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names == ["C0 = 0.018/nm", "C0 = 0.0192/nm"]
    rows = [row | {"L": 15.0} for row in rows]
    (axes,) = draw_scan(units.columns(pd.DataFrame(rows)), "localized", ("c0", "period", "L"), ("v",), units).axes
    assert axes.get_xlabel() == "spontaneous curvature C0 (1/nm)"
    assert axes.get_title() == "localized, period = 375 nm, L = 750 nm"


def test_what_a_table_of_tubes_brings_is_called_by_its_column():
    row = {"status": "found", "n_unstable": 0, "bead[nm]": 300.0, "neck[nm]": 20.0, "straight[nm]": 250.0,
           "stable_spacings[nm]": "400 500", "measured[um]": 0.31, "spacing[nm]": 450.0}  # fmt: skip
    top, bottom = draw_equilibria(pd.DataFrame([row])).axes
    assert "measured[um] of the table" in [text.get_text() for text in top.get_legend().get_texts()]
    assert "spacing[nm] of the table" in [text.get_text() for text in bottom.get_legend().get_texts()]
    (crosses,) = (line for line in top.lines if line.get_label() == "measured[um] of the table")
    assert crosses.get_ydata() == pytest.approx([310.0])
