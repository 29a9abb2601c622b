"""A shape or more of every family, each in its own discretization: problem and unknown."""

from functools import cache

import pearlbvp as pb
from support.pearls import at, path


@cache
def shape(family, c0, length, v, mode=None):
    """A point of a branch in its own discretization."""
    return pb.branch(pb.Tube(c0, length), family, mode, until={"v": v})[-1]


def known(*which):
    """The same, its problem and unknown."""
    point = shape(*which)
    return point.problem, point.u


def pearl(c0, period, v):
    """One period."""
    return at(path(c0, period, max(v, 1.05)), "v", v)


SHAPES = {
    "pearl": lambda: pearl(0.0, 10, 1.05),
    "short pearl": lambda: pearl(0.48, 7.5, 1.02),
    "pearl of negative c0": lambda: pearl(-0.8, 9.0, 1.03),
    "coil": lambda: known("coil", 0.3, 10, 0.93),
    "buckle": lambda: known("buckle", 0.3, 8, 0.97),
    "ring": lambda: known("ring", -1.0, 10, 0.9, (0, 3)),
}
