"""Lists of numbers as users write them."""

from decimal import Decimal

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pearlbvp.errors import InputError
from pearlbvp.numbers import as_numbers, as_whole, parse_numbers


def test_lists_and_ranges():
    assert parse_numbers("x", "15,30, 45") == [15, 30, 45]
    assert parse_numbers("x", "7.5:9:0.5") == [7.5, 8, 8.5, 9]
    assert parse_numbers("x", "3:1:-1,10") == [3, 2, 1, 10]
    assert parse_numbers("x", "-0.25") == [-0.25]
    assert len(parse_numbers("x", "7.5:120:0.5")) == 226


@given(st.integers(-1000, 1000), st.integers(1, 500), st.integers(1, 400))
def test_a_range_has_both_ends_and_decimal_steps(start, step, count):
    first, by = Decimal(start) / 100, Decimal(step) / 100
    numbers = parse_numbers("x", f"{first}:{first + count * by}:{by}")
    assert numbers == [float(first + i * by) for i in range(count + 1)]


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1))
def test_numbers_survive_the_round_trip(values):
    assert parse_numbers("x", ",".join(map(repr, values))) == values


@pytest.mark.parametrize(
    "text", ["", " ", "a", "1,", "nan", "inf,2", "1:2", "1:2:0", "1:2:-1", "1:2:0.3", "0:1e9:1", "1:2:3:4", "1;2"]
)
def test_mistakes_name_the_argument(text):
    with pytest.raises(InputError, match="^--lengths: ") as raised:
        parse_numbers("--lengths", text)
    assert "\n" not in str(raised.value)


@given(st.text(max_size=30))
def test_any_text_is_numbers_or_one_clear_line(text):
    try:
        numbers = parse_numbers("--lengths", text)
    except InputError as error:
        assert str(error).startswith("--lengths: ")
    else:
        assert all(isinstance(number, float) for number in numbers)


@pytest.mark.parametrize(
    ("text", "number"),
    [("7", 7), ("+7", 7), (" -7 ", -7), ("+-7", None), ("\u00b2", None), ("1.5", None), ("", None), ("5" * 5000, None)],
)
def test_whole_numbers_in_texts(text, number):
    assert as_whole(text) == number


@pytest.mark.parametrize("text", ["1e400", "0:1e999999:1e-999999", "1e999999:1e999999:1"])
def test_numbers_that_no_computer_has_are_not_finite(text):
    with pytest.raises(InputError, match="^x: .* is not a finite number"):
        parse_numbers("x", text)


def test_wrong_values_are_told_on_a_line():
    for value in (10**400, pd.Series([1.0, 2.0]), "5" * 500, np.ones((9, 9))):
        with pytest.raises(InputError) as refused:
            as_numbers("x", [value])
        assert len(str(refused.value)) < 160
        assert "\n" not in str(refused.value)
    assert as_numbers("x", np.array(3.0)) == [3]
