"""The theory by its public names: examples in docstrings are true, and what cannot be used is said in one line."""

import doctest
import importlib

import pytest

import pearlbvp as pb

MODULES = [
    "amplitude",
    "codimension_two",
    "dispersion",
    "elastica",
    "meeting",
    "modulation",
    "osmotic",
    "resonance",
    "unduloid",
]


@pytest.mark.parametrize("module", ["", *(f".{name}" for name in MODULES)])
def test_examples_are_true(module):
    failed, tried = doctest.testmod(importlib.import_module(f"pearlbvp.theory{module}"))
    assert failed == 0 < tried


def test_every_public_name_is_there():
    assert all(getattr(pb.theory, name) is not None for name in pb.theory.__all__)
    assert dir(pb.theory) == pb.theory.__all__
    with pytest.raises(AttributeError, match=r"^module 'pearlbvp.theory' has no attribute 'nothing'; see dir"):
        pb.theory.nothing  # noqa: B018


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: pb.theory.growth_rate("a", 0, 0, 0), "^k: 'a' is no number"),
        (lambda: pb.theory.critical_lambda2(1, 0, None), "^c0: None is no number"),
        (lambda: pb.theory.stable_interval(0.48), "^tube: float must be a tube; give one like"),
        (lambda: pb.theory.stable_wave_numbers(0.48, "two"), "^pearls: 'two' is no number"),
        (lambda: pb.theory.amplitude_equation(0.48, (1, 0)), "^tube: float must be a tube"),
        (lambda: pb.theory.amplitude_equation(pb.Tube(0, 10), 1), "^mode: 1 must be two whole numbers"),
        (lambda: pb.theory.exchange_lengths("a"), "^c0: 'a' is not a number"),
        (lambda: pb.theory.exchange_lengths(0.4, 1.5), "^mode: .* must be two whole numbers"),
        (lambda: pb.theory.meeting_c0((0, 2), "x", 10), "^two: 'x' must be two whole numbers"),
        (lambda: pb.theory.meeting_c0((0, 2), (1, 1), 0), "^length: 0 must be positive"),
        (lambda: pb.theory.resonant_lengths(0.4, 0.5), "^m: 0.5 must be a whole number"),
        (lambda: pb.theory.Resonance(0.4), "^tube: float must be a tube"),
        (lambda: pb.theory.Resonance(pb.Tube(0.4, 17), "1"), "^m: '1' must be a whole number"),
        (lambda: pb.theory.WrinklesAndCoils(10), "^tube: int must be a tube"),
        (lambda: pb.theory.touching_ring(1), "^mode: rings have a whole number of lobes"),
        (lambda: pb.theory.touching_ring(10**9), "^mode: rings of 1000000000 lobes are too fine"),
        (lambda: pb.theory.ring_at(2, "v", "a"), "^v: 'a' is not a number"),
        (lambda: pb.theory.ring_at(2, "E", 1), "^name: rings are not found by 'E'"),
        (lambda: pb.theory.unduloid_of(-1), "^period: -1 must be positive"),
        (lambda: pb.theory.onset_sizes(0, "long"), "^period: 'long' is not a number"),
    ],
)
def test_mistakes_are_one_line(call, said):
    with pytest.raises(pb.InputError, match=said):
        call()
