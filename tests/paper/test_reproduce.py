"""Figures of the paper: what is printed beside what is computed, and what the command writes."""

import numpy as np
import pandas as pd
import pytest
from support.commands import run

import pearlbvp as pb
from pearlbvp.paper import straight
from pearlbvp.paper.cases import at, primary
from pearlbvp.paper.catalogue import CATALOGUE, listing
from pearlbvp.paper.printed import AGREES, ERRATUM, OTHERWISE, agrees, beside_printed, printed_values
from pearlbvp.studies.displacement import normal_displacement
from pearlbvp.theory.dispersion import growth_rate


def test_every_printed_number_is_of_a_figure_and_the_paper_s_errors_are_named():
    printed = printed_values()
    assert set(printed["figure"]) <= set(CATALOGUE)
    assert not printed.duplicated(["figure", "label", "quantity"]).any()
    assert (printed.loc[printed["right"] != "", "why"] != "").all()
    wrong = printed[printed["right"] != ""]
    assert not any(agrees(float(right), given) for right, given in zip(wrong["right"], wrong["printed"], strict=True))


# The figures that are left out take ten seconds and more.
@pytest.mark.parametrize("figure", ["neigs", "ampc00f", "c00f", "cmf1b", "c05f1", "c05f1l", "c05f2", "ptt1"])
def test_a_figure_has_its_panels_and_every_difference_its_reason(figure):
    entry = CATALOGUE[figure]
    sheet = entry.compute()
    assert tuple(panel.letter for panel in sheet.panels) == entry.panels
    assert all(len(panel.table()) for panel in sheet.panels)
    beside = beside_printed(figure, sheet.values)
    assert (beside.loc[beside["verdict"] != AGREES, "why"] != "").all()
    named = beside["right"].notna()
    assert (beside.loc[named, "verdict"] == ERRATUM).all()


def test_a_verdict_is_the_word_for_the_digits():
    values = {("c0 = 0.48", "period"): 7.5, ("wrinkling (0,2)", "lambda2"): 1.75}
    rows = beside_printed("neigs", straight.neigs().values | values).set_index("label")
    assert rows.loc["c0 = 0.48", "verdict"] == AGREES
    assert rows.loc["wrinkling (0,2)", "verdict"] == OTHERWISE
    assert rows.loc["wrinkling (0,2)", "difference"] == pytest.approx(0.25)


def test_sectors_follow_from_the_jacobian_of_the_amplitude_system():
    """``A' = A (a s + b1 A^2 + b2 B^2)`` and ``B'`` alike: growth across a branch, at fixed area and volume."""
    for row in straight.stabfig().panels[0].table().itertuples():
        across_coil = row.b2 - row.b1  # of B on (A, 0), where a s = -b1 A^2
        jacobian = 2 * np.array([[row.b1, row.b2], [row.b2, row.b1]])  # on (A, A), by A^2
        across_buckle = np.array([1, -1]) @ jacobian @ np.array([1, -1]) / 2
        assert (across_coil < 0) == (row.stable == "coil")
        assert (across_buckle < 0) == (row.stable == "buckle")
        assert (row.coils == "supercritical") == (row.b1 < 0)


def test_regions_are_where_waves_grow():
    """Above the curve of a wave with ``k^2 + n^2 > 1`` it grows, below that of a pearl with ``k < 1``."""
    curves = straight.neigs().panels[2].table().dropna()
    for row in curves.iloc[::37].itertuples():
        side = 1 if row.k**2 + row.n**2 > 1 else -1
        assert growth_rate(row.k, row.n, row.lambda2 + 1e-3 * side, 0.48) > 0
        assert growth_rate(row.k, row.n, row.lambda2 - 1e-3 * side, 0.48) < 0


def test_samples_are_coloured_by_how_their_surface_moves():
    """Next to the straight tube pearls move by a cosine, outwards where they are thick; that keeps the area."""
    point = at(primary(0.0, 10.0, "pearl", (1, 0), "v", 1.02), "v=1.001")
    u = normal_displacement(point)
    x, y, z = point.problem.to_draw(point.u)
    r = np.hypot(y, z)
    assert np.ptp(u, axis=1).max() < 1e-6
    assert np.corrcoef(u.ravel(), r.ravel())[0, 1] < -0.98
    ahead, behind = (point.problem.observables(point.u + s * point.tangent)["v"] for s in (1e-5, -1e-5))
    volume = (ahead - behind) / 2e-5 * np.pi * 10
    weight = 2 * np.pi * (r[:-1, 0] + r[1:, 0]) / 2 * np.hypot(np.diff(x[:, 0]), np.diff(r[:, 0]))
    assert -np.sum(weight * (u[:-1, 0] + u[1:, 0]) / 2) == pytest.approx(volume, rel=2e-2)  # dV = - of u dS


def test_the_command_writes_panels_samples_and_printed_numbers(tmp_path, capsys):
    status, out, err = run(capsys, "reproduce", "c05f1l", "--out", str(tmp_path / "new"))
    assert status == 0
    assert "printed numbers" in err
    written = {path.name for path in (tmp_path / "new").iterdir()}
    assert {name for name in written if name.endswith(".json")} == {
        f"{name}-metadata.json" for name in written if name.endswith(".csv")
    }
    assert {name for name in written if not name.endswith(".json")} == {
        "c05f1l_a1.csv",
        "c05f1l_a1.png",
        "c05f1l_b.csv",
        "c05f1l_b.png",
        "c05f1l_samples.csv",
        "c05f1l_printed.csv",
    }
    samples = pd.read_csv(tmp_path / "new/c05f1l_samples.csv").set_index("sample")
    assert samples.loc["A", "v"] == pytest.approx(1.02)
    assert samples.loc["B", "n_unstable"] == 0
    assert out.startswith("figure,label,quantity,printed,computed,difference,verdict,right,why\n")


def test_a_sample_is_a_file_that_other_commands_take(tmp_path, capsys):
    status, _, _ = run(capsys, "reproduce", "c05f1l", "--point", "A", "--format", "pdf", "--out", str(tmp_path))
    assert status == 0
    point = pb.load(tmp_path / "c05f1l_A.h5")[0]
    assert point.observables["v"] == pytest.approx(1.02)
    assert float(pd.read_csv(tmp_path / "c05f1l_A.csv")["lambda2"].iloc[0]) == pytest.approx(
        point.observables["lambda2"]
    )
    assert run(capsys, "resume", str(tmp_path / "c05f1l_A.h5"), "--until", "v=1.021")[0] == 0


def test_the_list_has_every_figure(capsys):
    status, out, err = run(capsys, "reproduce", "--list")
    assert (status, err) == (0, "")
    assert len(out.splitlines()) == len(CATALOGUE) + 1
    assert listing()["printed_numbers"].sum() == len(printed_values())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fig7", "--out", "p"], "the paper has no 'fig7'"),
        (["c00f"], "--out: it is missing"),
        ([], "FIGURE|TABLE|all: it is missing"),
        (["all", "--out", "p", "--point", "A"], "--point: it is a sample of one figure"),
        (["stabfig", "--out", "p", "--point", "A"], "stabfig has no sample 'A'"),
    ],
)
def test_mistakes_are_said_in_a_line(words, said, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, _, err = run(capsys, "reproduce", *words)
    assert (status, err.count("\n")) == (2, 1)
    assert said in err
