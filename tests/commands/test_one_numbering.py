"""Special points have one numbering, from the branch's start: of --until, also where a branch goes on, of show and of --follow."""

import io

import pandas as pd
import pytest
from support.commands import run

from pearlbvp.continuation.branch import SpecialPoint
from pearlbvp.errors import InputError
from pearlbvp.helfrich import Tube
from pearlbvp.studies.branch import branch_options, family_branch
from pearlbvp.studies.onward import resumed, varied
from pearlbvp.studies.saved import load, save


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("numbering")
    save(family_branch(Tube(0.48, 30), "pearl", (4, 0), branch_options({"bp": 2})), folder / "pearl.h5")
    save(family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"fold:v": 1})), folder / "fold.h5")
    save(family_branch(Tube(-1.0, 10), "ring", (0, 2), branch_options({"bp": 1})), folder / "ring.h5")
    save(family_branch(Tube(0.48, 10), "coil", (1, 1), branch_options({"v": 0.88})), folder / "coil.h5")
    return folder


@pytest.mark.parametrize(
    ("name", "family", "kind", "number"),
    [("pearl", "pearl", "bp", 1), ("pearl", "pearl", "bp", 2), ("fold", "pearl", "fold:v", 1), ("ring", "ring", "bp", 1), ("coil", "coil", "bp", 1)],
)  # fmt: skip
def test_a_special_point_that_a_saved_branch_has_is_answered_at_once(
    capsys, folder, tmp_path, name, family, kind, number
):
    saved = folder / f"{name}.h5"
    branch = load(saved)
    place = branch.find(kind)[number - 1].index
    until = ("--until", f"{kind}:{number}", "--save", tmp_path / "again.h5")
    status, out, err = run(capsys, "resume", saved, *until)
    assert status == 0
    assert err == (
        f"pearlbvp: the wanted {kind} is point {place} of the branch already, at v = "
        f"{branch.points[place].observables['v']:.8g}; nothing was computed\n"
    )
    assert out == run(capsys, "show", saved)[1]
    assert load(tmp_path / "again.h5").reason == branch.reason
    shown = ("--point", f"{kind}:{number}", "--surface", tmp_path / "s.csv", "--out", tmp_path / "t.csv")
    assert run(capsys, "show", saved, *shown)[0] == 0
    surface = (tmp_path / "s.csv").read_bytes()
    assert run(capsys, "show", saved, "--point", place, *shown[2:])[0] == 0
    assert (tmp_path / "s.csv").read_bytes() == surface


def test_the_next_special_point_has_the_next_number(capsys, folder):
    status, out, _ = run(capsys, "resume", folder / "fold.h5", "--until", "fold:v:2")
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert (status, table.special.str.contains("fold:v").sum()) == (0, 2)
    assert table.special.iloc[-1].endswith("stop")
    assert "fold:v" in table.special.iloc[-1]
    at_once = family_branch(Tube(0.75, 10), "pearl", (1, 0), branch_options({"fold:v": 2}))
    assert table.v.iloc[-1] == pytest.approx(at_once.points[-1].observables["v"], abs=1e-9)


def test_what_was_seen_at_a_point_is_numbered_on_the_whole_branch(folder):
    seen = []
    branch = load(folder / "pearl.h5")
    options = branch_options({"bp": 3}, progress=lambda so_far: seen.append(len(so_far.find("bp"))))
    longer = resumed(branch, options)
    assert longer.find("bp")[2].index == len(longer.points) - 1
    assert (seen[0], seen[-1]) == (2, len(longer.find("bp")))


def test_a_special_point_that_was_not_located_is_said(folder):
    branch = load(folder / "pearl.h5")
    branch.special.append(SpecialPoint("fold:v", 3, converged=False))
    with pytest.raises(
        InputError, match=r"^until: the fold:v at point 3 was not located; follow the branch in shorter"
    ):
        resumed(branch, branch_options({"fold:v": 1}))


KEPT = [
    ("c0", "v", "v=0.9", "v stays as it is on this branch; keep lambda2 where it branches off (--keep lambda2)"),
    ("c0", "v", "fold:v", "v stays as it is on this branch"),
    ("c0", "v", "L=11", "L stays as it is on this branch; vary it from a point of a saved branch"),
    ("c0", "lambda2", "lambda2=0.1", "on this branch; keep v where it branches off (--keep v)"),
    ("L", "v", "v=0.9", "(--keep lambda2)"),
    ("L", "v", "c0=0.5", "c0 stays as it is on this branch"),
    ("L", "lambda2", "lambda2=0.1", "(--keep v)"),
    ("L", "lambda2", "c0=0.5", "vary it from a point"),
]


@pytest.mark.parametrize(("vary", "keep", "until", "said"), KEPT)
def test_what_is_kept_along_a_branch_cannot_be_waited_for(capsys, folder, vary, keep, until, said):
    status, out, err = run(capsys, "vary", folder / "coil.h5", vary, "--keep", keep, "--until", until)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("pearlbvp: --until: ")
    assert said in err


@pytest.mark.parametrize(("vary", "keep"), [("c0", "v"), ("c0", "lambda2"), ("L", "v"), ("L", "lambda2")])
@pytest.mark.parametrize("name", ["coil", "pearl"])
def test_what_is_not_kept_is_reached_or_was_from_the_start(folder, vary, keep, name):
    """And turning points are looked for of nothing that stays as it is."""
    branch = load(folder / f"{name}.h5")
    start = branch.points[-1].observables
    options = branch_options({vary: start[vary] * 1.002}, max_step=0.1)
    moved = varied(branch, -1, vary, options, keep=keep)
    assert moved.complete
    assert moved.find(f"fold:{keep}") == []
    assert moved.points[-1].observables[keep] == pytest.approx(start[keep], abs=1e-11)
    free = "lambda2" if keep == "v" else "v"
    assert moved.points[-1].observables[free] != pytest.approx(start[free], abs=1e-6)
    for constant in (keep, {"c0": "L", "L": "c0"}[vary]):
        at_once = varied(branch, -1, vary, branch_options({constant: start[constant]}), keep=keep)
        assert (len(at_once.points), at_once.complete) == (1, True)
    again = resumed(moved, branch_options({vary: start[vary] * 1.004}, max_step=0.1))
    assert again.complete
    with pytest.raises(InputError, match=f"^until: {keep} stays "):
        resumed(moved, branch_options({keep: start[keep] + 0.01}))


def test_a_curve_in_two_parameters_keeps_neither(capsys, folder):
    follow = ["follow", folder / "coil.h5", "bp:1", "c0"]
    for option in (["--keep", "v"], ["--point", "3"]):
        status, out, err = run(capsys, *follow, *option)
        assert (status, out, err.count("\n")) == (2, "", 1)
        assert option[0] in err
    status, _, err = run(capsys, *follow, "--until", "L=11")
    assert (status, "--until: L stays as it is on this branch" in err) == (2, True)


@pytest.mark.parametrize(
    ("family", "more"), [("pearl", []), ("ring", []), ("coil", []), ("buckle", []), ("pearl", ["--nodes", 200])]
)
@pytest.mark.parametrize(("name", "own", "other"), [("c0", 0.3, 0.4), ("L", 5, 6)])
def test_c0_and_length_of_a_branch_are_those_of_its_start(capsys, family, more, name, own, other):
    """In the user's unit."""
    tube = ["branch", family, "--c0", 0.3, "--length", 5, "--radius", 0.5, *more]
    status, out, err = run(capsys, *tube, "--until", f"{name}={own}")
    table = pd.read_csv(io.StringIO(out))
    assert (status, err, len(table), table.special.iloc[0]) == (0, "", 1, "start,stop")
    status, out, err = run(capsys, *tube, "--until", f"{name}={other}")
    assert (status, out) == (2, "")
    assert err == (f"pearlbvp: --until: {name} stays as it is on this branch; vary it from a point of a saved branch\n")


FAILED = [
    (["coil", "--c0", 0, "--length", 0.3, "--mode", "10,1"], "take fewer waves in the mode, or a longer tube"),
    (["buckle", "--c0", -90, "--length", 30], "take a c0 nearer to 1/2, or a shorter tube"),
    (["buckle", "--c0", 0, "--length", 300, "--mode", "10,10"], "take fewer waves in the mode, or a shorter tube"),
    (["ring", "--c0", 0, "--length", 3000, "--mode", "0,40"], "take a shorter tube, of at most"),
    (["pearl", "--c0", 0, "--length", 0.3, "--mode", "40,0"], "take fewer, or a longer tube"),
    (
        ["pearl", "--c0", 50, "--length", 300, "--max-step", 0.5],
        "change their sign in one step; take a smaller --max-step",
    ),
]


@pytest.mark.parametrize(("words", "advice"), FAILED)
def test_a_branch_that_cannot_begin_is_written_with_advice_that_fits_and_exit_status_one(
    capsys, tmp_path, words, advice
):
    saved = tmp_path / "b.h5"
    status, out, err = run(capsys, "branch", *words, "--max-points", 4, "--save", saved)
    table = pd.read_csv(io.StringIO(out), keep_default_na=False)
    assert (status, list(table.special)) == (1, ["start,end"])
    assert err.startswith("pearlbvp: the branch ends: ")
    assert advice in err
    if "step" not in advice:
        return
    assert load(saved).failed


@pytest.mark.parametrize(
    "words",
    [
        ["coil", "--c0", 0, "--length", 3, "--mode", "10,1"],
        ["buckle", "--c0", -50, "--length", 10],
        ["buckle", "--c0", 0, "--length", 30, "--mode", "1,10"],
        ["pearl", "--c0", 0, "--length", 0.3, "--mode", "1,0"],
    ],
)
def test_who_takes_the_advice_gets_on(capsys, words):
    status, out, err = run(capsys, "branch", *words, "--max-points", 3)
    assert status == 0, err
    assert out.count("\n") > 3


def test_a_branch_that_fails_on_its_way_is_kept_with_exit_status_one_and_one_that_ends_with_its_shapes_is_not(
    capsys, tmp_path
):
    saved = tmp_path / "b.h5"
    status, out, err = run(
        capsys, "branch", "pearl", "--c0", 0, "--length", 3, "--mode", "40,0", "--max-points", 8, "--save", saved
    )
    assert (status, "grow: its tension is" in err, "; stop before" in err) == (1, True, True)
    assert 2 < out.count("\n") - 1 < 8
    assert load(saved).failed
    for words in (["ring", "--c0=-1", "--length", 3], ["pearl", "--c0", 0, "--length", 10, "--max-points", 3]):
        status, _, err = run(capsys, "branch", *words)
        assert status == 0, err
        assert "the branch ends: " in err


def test_a_diagram_says_which_of_its_branches_failed(capsys):
    status, out, err = run(
        capsys, "diagram", "--c0", 0, "--length", 3, "--depth", 0, "--mode", "40,0", "--mode", "1,0", "--processes", 1,
        "--until", "amplitude=0.4",
    )  # fmt: skip
    assert status == 1
    assert err.startswith("pearlbvp: 40 ends: waves of more than n = 64 around the tube grow")
    assert set(pd.read_csv(io.StringIO(out)).branch) == {1, 40}
