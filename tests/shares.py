"""Which of a test's parametrised cases are tried in every run; `make soak` tries the others."""

from collections.abc import Iterable
from itertools import product
from typing import Any

import pytest


def only(kept: Iterable[Any], cases: Iterable[Any]) -> list[Any]:
    """Return the cases; those that are not among the kept are for `make soak`."""
    kept, cases = list(kept), list(cases)
    unknown = [each for each in kept if each not in cases]
    if unknown or not kept:
        raise ValueError(f"no case is kept by {unknown or kept}")
    return [each if each in kept else pytest.param(each, marks=pytest.mark.soak) for each in cases]


def share(one_in: int, *factors: Iterable[Any]) -> list[Any]:
    """Return all combinations of the factors' values; one in so many is tried in every run.

    Along each factor it is every so many-th value, so that each value of a factor is tried with
    some value of another factor that has at least so many.
    """
    values = [list(factor) for factor in factors]
    if sum(len(each) >= one_in for each in values) < 2:
        raise ValueError("some values would not be tried: two factors must have as many values")
    return [
        pytest.param(
            *(each[k] for each, k in zip(values, place, strict=True)),
            marks=[pytest.mark.soak] if sum(place) % one_in else [],
        )
        for place in product(*(range(len(each)) for each in values))
    ]
