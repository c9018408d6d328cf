"""One message for one mistake: numbers, arrays and words as all of the library reads them."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from standoff.checks.arrays import direction, finite
from standoff.checks.names import choice, did_you_mean
from standoff.checks.numbers import (
    GREATEST,
    LEAST,
    magnitude,
    magnitude_or_zero,
    not_negative,
    number,
    positive,
    whole_number,
    yes_or_no,
)
from standoff.checks.real_numbers import SHOWN_CHARACTERS, shown
from standoff.errors import StandoffError
from standoff.kernels.tolerances import FARTHEST

READERS = (number, positive, not_negative, magnitude, magnitude_or_zero)
"""Of one number."""


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (np.eye(2), "array([[1., 0.], [0., 1.]])"),
        (np.zeros((100, 3)), "an array of 100 by 3 numbers"),
        ((np.eye(2), "x"), "(array([[1., 0.], [0., 1.]]), 'x')"),
        ([3, np.zeros((100, 3))], "[3, an array of 100 by 3 numbers]"),
        ("two\n lines", r"'two\n lines'"),
    ],
)
def test_a_value_is_repeated_on_one_line(value: Any, text: str) -> None:
    assert shown(value) == text


@pytest.mark.parametrize(
    "value", [{"a": np.zeros((100, 3))}, [np.zeros(20)] * 50, np.ma.masked_all((9, 9)), "x" * 999]
)
def test_a_value_is_cut_where_it_is_long(value: Any) -> None:
    assert len(shown(value)) <= SHOWN_CHARACTERS
    assert "\n" not in shown(value)


def refusal(read: Callable[..., Any], value: Any, *more: Any) -> str:
    with pytest.raises(StandoffError) as caught:
        read(value, "size", *more)
    assert caught.value.argument == "size"
    assert caught.value.value is value
    return str(caught.value)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    "value", [2, 2.0, np.float32(2.0), np.int8(2), np.array(2.0), Fraction(2), Decimal(2)]
)
def test_whatever_is_a_real_number_is_read(read: Callable[..., float], value: Any) -> None:
    found = read(value, "size")
    assert (found, type(found)) == (2.0, float)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    "value",
    [
        *(None, "2", b"2", True, np.True_, 2j, np.complex128(2), [2.0], {}, object(), 10**400),
        *(np.timedelta64(2, "s"), np.array([2.0]), np.array(True), np.array("2")),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_is_no_number_is_told_so(read: Callable[..., float], value: Any) -> None:
    assert refusal(read, value).endswith(" is not a number.")


@pytest.mark.parametrize("read", READERS)
def test_masked_numbers_have_no_value(read: Callable[..., float]) -> None:
    for value in (np.ma.masked, np.ma.array(2.0, mask=True)):
        assert "fill them" in refusal(read, value)
    assert read(np.ma.array(2.0), "size") == 2.0


@pytest.mark.parametrize("read", READERS)
def test_a_number_is_finite_and_of_a_size_whose_powers_are(read: Callable[..., float]) -> None:
    for value in (math.nan, math.inf, np.float64(math.nan)):
        assert refusal(read, value) == f"size = {float(value)}: must be finite."
    assert refusal(read, 2e50) == "size = 2e+50: beyond 1e+50; choose a larger unit."
    assert read(GREATEST, "size") == GREATEST


def test_the_kernels_take_what_is_read_and_its_powers_are_numbers() -> None:
    assert 3.0 * GREATEST < FARTHEST
    assert math.isfinite(GREATEST**6)
    assert LEAST**6 > 0.0


def test_signs() -> None:
    assert (number(-1, "size"), not_negative(0, "size"), positive(1e-300, "size")) == (
        -1,
        0,
        1e-300,
    )
    for value in (0.0, -1.0):
        assert refusal(positive, value) == f"size = {value}: must be positive."
        assert refusal(magnitude, value) == f"size = {value}: must be positive."
    for read in (not_negative, magnitude_or_zero):
        assert refusal(read, -1) == "size = -1.0: must be zero or positive."
    assert positive(math.inf, "size", infinite=True) == math.inf
    for value in (math.nan, -math.inf):
        with pytest.raises(StandoffError, match="must be finite"):
            positive(value, "size", infinite=True)


def test_a_magnitude_has_powers_that_are_not_zero() -> None:
    assert refusal(magnitude, 1e-51) == "size = 1e-51: below 1e-50; choose a smaller unit."
    assert "or give 0" in refusal(magnitude_or_zero, 1e-51)
    assert magnitude_or_zero(0, "size") == 0.0


def test_whole_numbers() -> None:
    for value in (3, np.int16(3), np.uint64(3)):
        found = whole_number(value, "size")
        assert (found, type(found)) == (3, int)
    for value in (0, -1, 3.0, "3", True, None, np.timedelta64(3), np.array(3)):
        said = refusal(whole_number, value)
        assert said == f"size = {value!r}: must be a whole number of at least 1."
    assert whole_number(0, "size", 0) == 0
    assert whole_number(20, "size", 0, 20) == 20
    assert refusal(whole_number, 21, 0, 20) == "size = 21: must be a whole number from 0 to 20."


def test_yes_and_no() -> None:
    assert (yes_or_no(np.True_, "size"), yes_or_no(False, "size")) == (True, False)
    for value in (0, 1, "yes", None, 1.0):
        assert refusal(yes_or_no, value) == f"size = {value!r}: must be True or False."


def test_arrays() -> None:
    given = [[1, 2.0, 3], [4, 5, np.float32(6)]]
    found = finite(given, "size", (-1, 3))
    np.testing.assert_array_equal(found, [[1, 2, 3], [4, 5, 6]])
    assert not found.flags.writeable
    source = np.ones(3)
    assert finite(source, "size", (3,)) is not source
    for shape, told in (((3,), "3 numbers"), ((-1, 2), "an array of n by 2 numbers")):
        said = refusal(finite, np.ones((2, 3)), shape)
        assert said == f"size has shape (2, 3): give {told}."
    assert "; give 2 numbers, all of them real." in refusal(finite, ["1", 2.0], (2,))
    nan = "size has a NaN or infinite number: [ 1. nan]; give finite ones."
    assert refusal(finite, [1.0, math.nan], (2,)) == nan
    assert "beyond 1e+50: [1.e+00 2.e+50]; choose" in refusal(finite, [1.0, -2e50, 2e50][::2], (2,))


def test_directions_have_any_length_but_zero() -> None:
    for length in (1e-300, 1.0, 1e300):
        np.testing.assert_allclose(
            direction([0.0, 3.0 * length, 4.0 * length], "size"), [0, 0.6, 0.8]
        )
    for value in ([0.0, 0.0, 0.0], [math.inf, 0.0, 0.0], [math.nan, 1.0, 0.0]):
        assert "a finite length above zero" in refusal(direction, value)


def test_words() -> None:
    known = ("euler", "heun", "rk4")
    assert choice("heun", "size", known) == "heun"
    said = "size = 'huen': give 'euler', 'heun' or 'rk4'. Did you mean 'heun'?"
    assert refusal(choice, "huen", known) == said
    for value in (None, 3, np.array(["heun"]), ["heun"], "x"):
        assert refusal(choice, value, known).endswith(": give 'euler', 'heun' or 'rk4'.")
    assert did_you_mean("EULER", known) == " Did you mean 'euler'?"
