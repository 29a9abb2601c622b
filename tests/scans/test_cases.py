"""Cases of scans: one canonical form, one order, and beginnings that are coarse maps."""

import itertools
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlbvp.errors import InputError
from pearlbvp.scans.case import Case, coarse_first
from pearlbvp.scans.questions import QUESTIONS
from pearlbvp.scans.run import units_of
from pearlbvp.scans.scan import cases_of

NUMBERS = st.floats(-50, 50) | st.integers(0, 40) | st.text(max_size=5)


@given(st.lists(NUMBERS, max_size=4))
def test_the_canonical_form_holds_every_digit(values):
    question, parameters, settings, version = json.loads(Case("q", tuple(values)).canonical({"tolerance": 1e-9}, "1.0"))
    assert (question, parameters, settings, version) == ("q", values, {"tolerance": 1e-9}, "1.0")


def test_other_digits_settings_versions_and_questions_are_other_cases_but_a_zero_s_sign_is_none():
    case = Case("q", (0.1, 10.0))
    others = [Case("q", (math.nextafter(0.1, 1), 10.0)), Case("r", (0.1, 10.0)), Case("q", (10.0, 0.1))]
    ours = [case.key({}, "1.0"), case.key({"tolerance": 1e-9}, "1.0"), case.key({}, "1.1")]
    assert len({*ours, *(other.key({}, "1.0") for other in others)}) == 6
    assert Case("q", (0.0,)).key({}, "1.0") == Case("q", (-0.0,)).key({}, "1.0")


@given(st.integers(0, 300))
def test_every_number_comes_once(count):
    assert sorted(coarse_first(count)) == list(range(count))


@given(st.integers(3, 300), st.data())
def test_a_beginning_leaves_no_gap_that_is_more_than_twice_another(count, data):
    begun = data.draw(st.integers(3, count))
    known = sorted(list(coarse_first(count))[:begun])
    gaps = [b - a for a, b in itertools.pairwise(known)]
    assert max(gaps) <= 2 ** math.ceil(math.log2(2 * (count - 1) / (begun - 1)))


def test_cases_of_one_period_belong_together_and_so_do_critical_ones_of_one_c0():
    question = QUESTIONS["localized"]
    lengths = [15.0, 22.5, 30.0]
    assert len(units_of(question, cases_of(question, {"c0": [0.3, 0.48], "period": 7.5, "L": lengths}))) == 2
    assert len(units_of(question, cases_of(question, {"c0": [0.3, 0.48], "period": "critical", "L": lengths}))) == 2


def test_cases_are_all_combinations_in_order_whatever_the_order_given():
    question = QUESTIONS["dispersion"]
    cases = cases_of(question, {"c0": [0.48, -1], "L": "20,10"})
    assert [case.parameters for case in cases] == [(-1.0, 10.0), (-1.0, 20.0), (0.48, 10.0), (0.48, 20.0)]


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"c0": 0.3}, "L: dispersion needs it"),
        ({"c0": 0.3, "L": -1}, "L: "),
        ({"c0": 0.3, "L": 10, "period": 7}, "period: dispersion has no such parameter; it has c0, L"),
        ({"c0": "0:1:0.0001", "L": "1:200:0.5"}, "are too many"),
        ({"c0": "x", "L": 10}, "c0: "),
    ],
)
def test_parameters_that_make_no_cases_are_refused(parameters, said):
    with pytest.raises(InputError, match=said):
        cases_of(QUESTIONS["dispersion"], parameters)
