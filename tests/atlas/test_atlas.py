"""The atlas against continuations at random places, against its own script, and what it says where it has nothing."""

import math

import numpy as np
import pytest

import pearlbvp as pb
from pearlbvp.atlas import series
from pearlbvp.atlas.lookup import MARGIN
from pearlbvp.errors import InputError
from pearlbvp.studies import pearl_series
from pearlbvp.studies.localized import SQUARE, losses_at
from pearlbvp.studies.pearl_series import PearlSeries, band
from pearlbvp.theory.dispersion import stable_wave_numbers


def places(count, seed):
    """Values of ``c0``, periods and numbers of pearls, half of them next to the ends of what the atlas has."""
    random = np.random.default_rng(seed)
    c0 = random.uniform(0.26, 0.49, count)
    pearls = np.where(random.random(count) < 0.4, 2, random.integers(2, 41, count))
    low, high = stable_wave_numbers(c0, pearls)
    end = MARGIN * 1.001
    share = random.uniform(end, 1 - end, count)
    share[::2] = np.where(random.random(len(share[::2])) < 0.5, end, 1 - end)
    return c0, 2 * math.pi / (low + share * (high - low)), pearls


def test_the_atlas_gives_what_continuations_give():
    c0, period, pearls = places(20, 0)
    found = np.array(pb.atlas.localized(c0, period, pearls)).T
    alone = [losses_at(*case, [int(count)])[0] for *case, count in zip(c0, period, pearls, strict=True)]
    assert {one.status for one in alone} == {"found"}
    np.testing.assert_allclose(found, [one.values for one in alone], atol=1e-8)


def test_it_has_an_answer_everywhere_that_it_says_it_has():
    c0, period, pearls = places(5000, 1)
    assert pb.atlas.holds(c0, period, pearls).all()
    found = pb.atlas.localized(c0, period, pearls)
    assert np.isfinite(found).all()
    assert (found.v > 1 - 1e-9).all()


def test_the_script_gives_what_is_in_the_file(tmp_path):
    atlas = series.Atlas.load()
    assert series.FILE.stat().st_size < 2_000_000
    assert max(piece.error for piece in atlas.pieces) < series.TOLERANCE
    c0 = 0.3971
    (piece,) = (one for one in atlas.pieces if one.low <= series.scaled(np.array(c0)) <= one.high)
    reach = float(atlas.reach(np.array(c0)))
    here = PearlSeries.over(c0, *band(c0), reach=reach, degrees=(24, 24), tolerance=1e-9)
    periods = np.array([pearl_series.unscaled(u) for u in np.linspace(here.low, here.high, 5)])
    ours, theirs = here.at(periods), piece.at(np.full(5, c0), periods)
    others = [i for i in range(ours.shape[2]) if i != SQUARE]
    np.testing.assert_allclose(theirs[:, :, others], ours[: len(theirs), :, others], atol=1e-8)
    atlas.save(tmp_path / "again.npz")
    again = series.Atlas.load(tmp_path / "again.npz")
    assert (again.pieces[0].coefficients == atlas.pieces[0].coefficients).all()


def test_two_pieces_agree_where_they_meet():
    first, second = series.Atlas.load().pieces[:2]
    c0 = series.unscaled(first.high)
    beside = [pb.atlas.localized(c0 + step, 11.0, [2, 3, 5]) for step in (-1e-12, 1e-12)]
    np.testing.assert_allclose(*beside, atol=1e-9)
    assert first.high == second.low


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((0.5, 7.5, 2), "c0: the atlas has 0.26 to 0.49, not 0.5"),
        ((0.2599, 40, 2), "c0: "),
        ((0.48, 7.5, 1), "pearls: 1 is no number"),
        ((0.48, 7.5, 2.5), "pearls: "),
        ((0.48, 7.5, math.nan), "pearls: nan is no number"),
        ((0.48, 7.5, math.inf), "pearls: inf is no number"),
        ((0.48, math.inf, 2), "period: "),
        ((math.inf, 7.5, 2), "c0: "),
        (
            (0.48, 10.2, 2),
            "period: 2 pearls of period 10.2 radii are not stable at their onset.* from 6.63526 to 10.1051",
        ),
        ((0.48, -7.5, 2), "period: "),
        ((0.48, math.nan, 2), "period: "),
        ((math.nan, 7.5, 2), "c0: "),
        ((0.48, [7.5, 9.5], 5), "period: 5 pearls of period 9.5 radii"),
    ],
)
def test_where_it_has_nothing_it_says_what_it_has(arguments, said):
    with pytest.raises(InputError, match=said):
        pb.atlas.localized(*arguments)
    assert not np.all(pb.atlas.holds(*arguments))


def test_arguments_broadcast():
    found = pb.atlas.localized(0.48, np.array([[7.4], [7.5]]), [2, 4, 6])
    assert found.v.shape == (2, 3)
    assert pb.atlas.localized(0.48, 7.5, 4).v == pytest.approx(found.v[1, 1], abs=1e-14)
    assert pb.atlas.localized(0.48, np.zeros(0), 2).v.shape == (0,)
