"""All symmetry blocks of perturbations of a tube, up to the largest wave numbers that may grow."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from itertools import product

from pearlbvp.tube.modes import Mode
from pearlbvp.tube.symmetry import TubeBlock, TubeSymmetry, ellipse
from pearlbvp.tube.waves import ModeWaves

MOST_WAVES = 20000
"""Waves along times waves around, beyond which a spectrum is not tried."""

MOST_WORK = 4e10
"""Cubes of the sizes of all symmetry blocks, up to which a spectrum is computed: eight seconds."""


@lru_cache(maxsize=16)
def blocks_up_to(
    symmetry: TubeSymmetry, k: float, kappa: float, reach: tuple[int, int]
) -> Mapping[TubeBlock, ModeWaves]:
    """Blocks of perturbations; none where they are too many.

    Args:
        symmetry: of the tube that is perturbed.
        k, kappa: unit of the wave numbers along it, and the rate at which its frame turns.
        reach: largest wave numbers along it and around it.
    """
    along, around = reach
    if along * around >= MOST_WAVES:
        return {}
    waves = ellipse(1, 1, reach) if symmetry.period else list(product(range(along + 1), range(around + 1)))
    blocks = symmetry.blocks(waves)
    if not waves or sum(len(modes) ** 3 for modes in blocks.values()) > MOST_WORK:
        return {}
    return _shared(symmetry, k, kappa, blocks)


def _shared(
    symmetry: TubeSymmetry, k: float, kappa: float, blocks: Mapping[TubeBlock, list[Mode]]
) -> dict[TubeBlock, ModeWaves]:
    """Blocks as sums of waves, which those share that differ in parities alone."""
    alike: dict[object, list[TubeBlock]] = {}
    for block in blocks:
        alike.setdefault(symmetry.wave_class(block), []).append(block)
    found: dict[TubeBlock, ModeWaves] = {}
    for group in alike.values():
        families = ModeWaves.of(k, kappa, *(blocks[block] for block in group))
        found |= dict(zip(group, families, strict=True))
    return found
