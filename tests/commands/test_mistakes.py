"""Plain mistakes from Python: one line each, with what to give instead."""

import pytest

from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies import saved
from pearlbvp.studies.amplitude import coefficients, predicted_branch
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import diagram
from pearlbvp.studies.dispersion import branch_points, instability_curves
from pearlbvp.studies.export import profile_table, stored, surface_table
from pearlbvp.studies.flow import load as load_flow
from pearlbvp.studies.mesh import meshed, shape_mesh
from pearlbvp.studies.normal_form import normal_forms
from pearlbvp.studies.onward import followed, resumed, switched, varied
from pearlbvp.studies.period import pearl_periods
from pearlbvp.studies.phases import phases
from pearlbvp.studies.point import chosen
from pearlbvp.studies.ring_onsets import ring_onsets
from pearlbvp.studies.shape import shape_branch

FEW = branch_options(max_points=2)
OTHERS = ["x", None, float("nan"), {"v": 1.1}, (1,), object()]
"""What somebody may give in another's place."""


@pytest.fixture(scope="module")
def pearls():
    return family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 1}))


def calls(pearls):
    """Functions with good arguments, and those among them in whose place another may be given."""
    last, tube = pearls.points[-1], Tube(0.0, 10)
    return [
        (branch_options, {"until": {}, "max_points": 2, "step": 0.1, "max_step": 0.5}),
        (Tube, {"c0": 0.0, "L": 10}),
        (family_branch, {"tube": tube, "family": "pearl", "mode": (1, 0), "options": FEW, "tolerance": 1e-9, "fix": "area,pressure"}),
        (family_branch, {"tube": tube, "family": "ring", "mode": (0, 2), "options": FEW, "tolerance": 1e-9, "fix": "area,pressure"}),
        (family_branch, {"tube": tube, "family": "coil", "mode": (1, 1), "options": FEW, "fix": "area,pressure"}),
        (family_branch, {"tube": tube, "family": "coil", "mode": (1, 1), "nodes": 200, "options": FEW,
                         "discretization": "cotangent", "fix": "area,pressure"}),
        (shape_branch, {"c0": 0.75, "length": 10, "v": 1.0, "cosines": [-0.28, 0.47], "options": FEW, "cells": 1}),
        (varied, {"branch": pearls, "index": -1, "vary": "c0", "options": FEW, "keep": "v"}),
        (followed, {"branch": pearls, "kind": "bp", "number": 1, "vary": "c0", "options": FEW}),
        (switched, {"branch": pearls, "number": 1, "options": FEW, "centre": "pearl"}),
        (resumed, {"branch": pearls, "options": FEW}),
        (saved.load, {"path": "no such file"}),
        (load_flow, {"path": "no such file"}),
        (saved.save, {"branch": pearls, "path": "no such folder/b.h5"}),
        (diagram, {"c0": 0.0, "length": 10, "depth": 0, "options": FEW, "modes": [(0, 2)], "processes": 1}),
        (phases, {"tube": tube, "volumes": [1.01], "depth": 0, "modes": [(1, 0)], "unstable": 2, "processes": 1}),
        (coefficients, {"c0": 0.0, "length": 10, "modes": [(1, 1)]}),
        (predicted_branch, {"c0": 0.0, "length": 10, "mode": (1, 1), "family": "coil", "largest": 0.1, "points": 5}),
        (branch_points, {"c0": 0.0, "length": 10, "max_m": 2, "max_n": 2}),
        (instability_curves, {"c0": 0.0, "k_max": 2.0, "max_n": 2, "points": 20}),
        (pearl_periods, {"c0": 0.48, "lengths": [15], "v": None, "processes": 1}),
        (stored, {"branch": pearls, "name": "bp"}),
        (profile_table, {"point": last, "samples": 20}),
        (surface_table, {"point": last, "nodes": 50}),
        (chosen, {"branch": pearls, "name": "bp"}),
        (normal_forms, {"branch": pearls}),
        (ring_onsets, {"c0": -1.0, "n": 2, "lengths": [10]}),
        (meshed, {"point": last, "nodes": 600}),
        (shape_mesh, {"point": last, "nodes": 600}),
    ]  # fmt: skip


@pytest.mark.parametrize("other", OTHERS, ids=lambda other: repr(other)[:8])
def test_something_else_in_an_argument_s_place_is_refused_in_one_line(pearls, tmp_path, monkeypatch, other):
    """Or taken: what a function makes of it is its own affair, but nothing ends in a TypeError or AttributeError."""
    monkeypatch.chdir(tmp_path)
    for function, arguments in calls(pearls):
        for name in arguments:
            if (name, other) in (("path", "x"), ("options", None)):
                continue  # which is a name, or means 200 points
            try:
                function(**{**arguments, name: other})
            except InputError as refusal:
                assert str(refusal).count("\n") == 0, (function, name)
                assert "; " in str(refusal), (function, name, str(refusal))


def coil(mode, options=FEW, family="coil"):
    return family_branch(Tube(0.0, 10), family, mode, options)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: coil((1,)), r"^mode: \(1,\) must be two whole numbers, .*; give a pair"),
        (lambda: coil(5), r"^mode: 5 must be two whole numbers"),
        (lambda: coil((1, 1), {"v": 0.9}), r"^options: dict .*; make them by branch_options\(...\)"),
        (lambda: coil((1, 1), FEW, "helix"), r"^family: 'helix' is none; choose one of pearl, ring, coil, buckle"),
        (lambda: coil((1, 0)), r"^mode: 1,0 is none of a coil, but of a pearl; give another"),
        (lambda: saved.load(7), r"^path: 7 is no name of a file; give a text or a Path"),
        (lambda: resumed("b.h5", FEW), r"^branch: str must be a branch; follow one, or load it"),
    ],
)  # fmt: skip
def test_what_is_said_of_a_mistake(call, said):
    with pytest.raises(InputError, match=said):
        call()
