"""What a session shows of the objects that it gets: a few lines, with what a user wants to know."""

import os
import pty
import sys
import time

import numpy as np
import pytest

from pearlbvp import progress
from pearlbvp.collocation import PiecewisePolynomial
from pearlbvp.flows.driver import FlowOptions
from pearlbvp.helfrich import Tube
from pearlbvp.mesh.families import tube_mesh
from pearlbvp.studies.amplitude import predicted_branch
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.diagram import Diagram
from pearlbvp.studies.flow_start import pearl_start
from pearlbvp.studies.localized import PeriodicPearls

LONGEST, WIDEST = 20, 2000


def of_branches():
    yield family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 2}))
    yield family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"v": 0.9}))
    yield family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.98}))
    yield family_branch(Tube(0.0, 10), "pearl", (1, 0), branch_options(max_points=2), nodes=120)
    yield predicted_branch(0.0, 10, (1, 1))


def objects():
    for branch in of_branches():
        entry = branch.points[-1]
        yield from (branch, entry, entry, entry.problem, entry.spectrum, branch.special)
        if hasattr(entry.problem, "profile"):
            profile = entry.problem.profile(entry.u)
            yield from (profile, profile.states)
    yield Diagram({str(i): branch for i in range(40)}, {"1/1": "why"})
    pearls = PeriodicPearls.trace(0.48, 7.5)
    yield from (pearls, pearls.path, pearls.functions, pearls.path.points[0].problem.discretization)
    yield tube_mesh(10, 300)
    point = family_branch(Tube(0.48, 7.5), "pearl", (1, 0), branch_options({"v": 1.01})).points[-1]
    start = pearl_start(point.problem, point.u, points=32)
    result = start.flow(start.perturbed("bump", 0.01, keep=True), FlowOptions(until=1.0))
    yield from (start, start.problem, result, result.state, result.state.record, result.state.record.frames[0])
    yield from (PiecewisePolynomial(np.linspace(0, 1, 9), np.zeros((49, 4))), Tube(0, 1))


def test_no_object_fills_the_screen():
    for found in objects():
        text = repr(found)
        assert text.count("\n") < LONGEST, type(found).__name__
        assert len(text) < WIDEST, (type(found).__name__, len(text))
        assert "array([" not in text, type(found).__name__


def test_a_branch_says_what_it_is_where_it_goes_and_why_it_ends():
    branch = family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 2}))
    first, *special, last = repr(branch).splitlines()
    assert first == "pearl branch, 7 points, c0 = 0.48, L = 30, v = 1 to 1.0081107"
    assert [line.split(",")[0].strip() for line in special] == ["point 4: bp", "point 6: bp"]
    assert "+2 unstable" in special[0]
    assert last == "  end: the wanted special point is reached"
    many = type(branch)(branch.points, branch.special * 20, branch.reason, True)
    assert "and 26 more special points" in repr(many)


@pytest.mark.parametrize("shown", [True, False])
def test_a_bar_is_there_at_once_and_counts_by_itself(capsys, monkeypatch, shown):
    monkeypatch.setattr(progress, "SECONDS", 0.02)
    with progress.progress("tube", 3, shown=shown, doing="solving"):
        first = capsys.readouterr().err
        time.sleep(0.2)
        later = capsys.readouterr().err
    assert bool("solving" in first) == shown
    assert bool(later.count("0/3") >= 2) == shown
    assert (first + later == "") == (not shown)


def test_a_terminal_of_unknown_size_shows_the_bar(monkeypatch):
    ours, theirs = pty.openpty()  # its size is 0 by 0
    with os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress.progress("tube", 3):
            said = os.read(ours, 1000).decode()
    os.close(ours)
    assert "0/3" in said
