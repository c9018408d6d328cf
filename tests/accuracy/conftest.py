"""Pairs of the accuracy report for its tests."""

from collections.abc import Callable

import numpy as np
import pytest

from standoff_studies.accuracy.cases import Case, catalogue, draw_cases
from standoff_studies.accuracy.solids import KINDS, named


@pytest.fixture(scope="session")
def seed(rng_of: Callable[[str], np.random.Generator]) -> int:
    return int(rng_of("solids of the accuracy report").integers(2**31))


@pytest.fixture(scope="session")
def solids(seed: int):
    """Four solids of every kind; bodies are built when they are first asked for."""
    return catalogue(KINDS, seed)


@pytest.fixture(scope="session")
def cases_of(solids, seed: int):
    """All cases of a pair of names."""

    def cases(first: str, second: str, count: int = 1) -> list[Case]:
        kinds = named([first, second])
        pair = (kinds[0], kinds[-1])
        return list(draw_cases(pair, solids, count, seed))

    return cases
