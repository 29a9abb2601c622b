"""Random small scans, interrupted and resumed: the rows that they export are those of the plain commands' studies."""

import contextlib
import random
from itertools import product

import numpy as np
import pandas as pd
import pytest

import pearlbvp as pb
from pearlbvp.scans.engines import Here
from pearlbvp.scans.scan import scan
from pearlbvp.studies.amplitude import instability_map
from pearlbvp.studies.dispersion import branch_points
from pearlbvp.studies.localized import localized_pearls
from pearlbvp.studies.period import pearl_periods


def _branch(c0, L, family, mode, v):
    table = pb.branch(pb.Tube(c0, L), family, tuple(map(int, mode.split(":"))), until={"v": v}).table().tail(1)
    return table.assign(family=family, mode=mode)


PLAIN = {
    "dispersion": lambda c0, L: branch_points(c0, L),
    "growth": lambda c0, lambda1, L, viscosity_ratio, membrane_viscosity: pb.growth(
        c0, lambda1, None if L == "any" else L, viscosity_ratio=viscosity_ratio, membrane_viscosity=membrane_viscosity
    ),
    "localized": lambda c0, period, L: localized_pearls(c0, period, [L]),
    "period": lambda c0, L: pearl_periods(c0, [L], progress=False),
    "region": lambda c0, period, pearls: localized_pearls(c0, period, [pearls * period]),
    "amplitude-map": lambda c0, L: instability_map(c0, L, progress=False),
    "branch": _branch,
}
"""What answers a case of a question without a scan."""


def grid(question, dice):
    """A few values of each parameter, on none of which a study has been looked at before."""

    def some(low, high, most=3):
        return sorted(round(dice.uniform(low, high), 3) for _ in range(dice.randint(1, most)))

    period = round(dice.uniform(6.8, 9.0), 2)
    whole = sorted(dice.sample(range(2, 12), 3))
    return {
        "dispersion": lambda: {"c0": some(-2, 0.48), "L": some(5, 40)},
        "growth": lambda: {
            "c0": some(-0.5, 0.4), "lambda1": some(-1, 3), "L": dice.choice(["any", some(5, 40)]),
            "viscosity_ratio": some(0.1, 10, 2), "membrane_viscosity": some(0, 5, 2),
        },
        "localized": lambda: {"c0": some(0.4, 0.49), "period": period, "L": [count * period for count in whole]},
        "period": lambda: {"c0": some(0.3, 0.49, 2), "L": some(8, 90)},
        "region": lambda: {"c0": some(0.3, 0.49, 2), "period": some(6.5, 11, 2), "pearls": whole},
        "amplitude-map": lambda: {"c0": some(-1, 0.48, 2), "L": some(6, 20, 2)},
        "branch": lambda: {"c0": some(0.2, 0.4, 2), "L": [8.0], "family": "coil", "mode": "1:1", "v": some(0.97, 0.99, 2)},
    }[question]()  # fmt: skip


class Interrupted(Here):
    """An executor in which Ctrl-C is pressed after so many units."""

    def __init__(self, units):
        self.left = units

    def submit(self, fn, /, *arguments):
        self.left -= 1
        if self.left < 0:
            raise KeyboardInterrupt
        return super().submit(fn, *arguments)


@pytest.mark.parametrize("question", PLAIN)
@pytest.mark.parametrize("seed", range(3))
def test_a_scan_that_is_interrupted_exports_the_rows_of_the_plain_command(tmp_path, question, seed):
    dice = random.Random(f"{question} {seed}")
    parameters, store = grid(question, dice), tmp_path / "s.sqlite"
    for units in (0, dice.randint(1, 3)):
        with contextlib.suppress(KeyboardInterrupt):
            scan(question, store, executor=Interrupted(units), **parameters)
    found = scan(question, store, workers=1, **parameters)
    values = [value if isinstance(value, list) else [value] for value in parameters.values()]
    plain = [PLAIN[question](*case) for case in product(*values)]
    expected = pd.concat(plain, ignore_index=True)
    assert len(found) == len(expected)
    for name in set(found) & set(expected):
        ours, theirs = found[name], expected[name]
        if pd.api.types.is_numeric_dtype(theirs):
            np.testing.assert_allclose(ours.astype(float), theirs.astype(float), rtol=1e-7, atol=1e-8, err_msg=name)
        else:
            assert ours.fillna("").tolist() == theirs.fillna("").tolist(), name
