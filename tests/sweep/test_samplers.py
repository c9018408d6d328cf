"""Samplers: a row by itself is the row in a block, strata and grids are complete."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy.stats import kstest
from scipy.stats.qmc import Sobol

from standoff.errors import StandoffError
from standoff.sweep import samplers
from standoff.sweep.samplers import (
    ROUNDS,
    SOBOL_BITS,
    GridSampler,
    LatinHypercubeSampler,
    RandomSampler,
    Sampler,
    SobolSampler,
    permuted,
)

BIG = 3_000_000_000
MAKERS: dict[str, Callable[[int], Sampler]] = {
    "random": lambda d: RandomSampler(BIG, d, 7),
    "latin-hypercube": lambda d: LatinHypercubeSampler(BIG, d, 7),
    "sobol": lambda d: SobolSampler(BIG, d, 7),
    "grid": lambda d: GridSampler((90,) * d),
}


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("d", [1, 3, 4, 9])
def test_a_row_by_itself_is_the_row_in_a_block(kind: str, d: int) -> None:
    made = MAKERS[kind](d)
    for first in (0, 1, 1021, made.rows - 40):
        block = made.points(first, first + 40)
        assert block.shape == (40, d)
        assert block.min() >= 0.0
        assert block.max() <= 1.0
        for k in (0, 1, 17, 39):
            alone = MAKERS[kind](d).points(first + k, first + k + 1)
            assert alone.tobytes() == block[k].tobytes()


def test_random_rows_are_uniform_and_depend_on_the_seed() -> None:
    points = RandomSampler(5000, 5, 3).points(0, 5000)
    for column in points.T:
        assert kstest(column, "uniform").pvalue > 1e-4
    assert np.abs(np.corrcoef(points.T) - np.eye(5)).max() < 0.08
    assert len(np.unique(points)) == points.size
    assert not np.isin(RandomSampler(5000, 5, 4).points(0, 5000), points).any()


def scipy_s(d: int, seed: int, bits: int) -> Sobol:
    warnings.simplefilter("ignore")  # about numbers of points that are no power of two
    return Sobol(d, scramble=True, bits=bits, rng=np.random.default_rng(seed))


def test_sobol_is_scipy_s() -> None:
    with warnings.catch_warnings():
        for d, seed in ((1, 0), (6, 11)):
            expected = scipy_s(d, seed, SOBOL_BITS).random(73_000)
            assert np.array_equal(SobolSampler(BIG, d, seed).points(0, 73_000), expected)
        # far on, SciPy can go only with few digits
        engine = scipy_s(4, 3, 30)
        engine.fast_forward(20_000_000)
        found = SobolSampler(BIG, 4, 3, bits=30).points(20_000_000, 20_003_000)
        assert np.array_equal(found, engine.random(3000))


def test_another_scipy_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(samplers.SobolSampler, "points", lambda self, a, b: np.zeros((b - a, 2)))
    with pytest.raises(StandoffError, match="another kind of sampler"):
        SobolSampler(8, 2, 0)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 17, 1000, 4096, 4097])
def test_a_latin_hypercube_has_each_stratum_once(n: int) -> None:
    made = LatinHypercubeSampler(n, 4, 5)
    points = np.concatenate([made.points(k, min(k + 100, n)) for k in range(0, n, 100)])
    strata = np.floor(points * n).astype(int)
    for column in strata.T:
        assert sorted(column) == list(range(n))
    if n == 1000:
        assert np.abs(np.corrcoef(strata.T) - np.eye(4)).max() < 0.15
        # inside its stratum a point is anywhere
        assert kstest((points * n - strata).ravel(), "uniform").pvalue > 1e-4


def test_orders_differ_by_key_and_have_no_pattern() -> None:
    rows, rng = np.arange(5000, dtype=np.uint64), np.random.default_rng(1)
    orders = [permuted(rows, 5000, rng.integers(0, 2**64, ROUNDS, np.uint64)) for _ in range(40)]
    fixed = [int((order == rows).sum()) for order in orders]
    assert 10 <= sum(fixed) <= 80  # one fixed point on the average
    for order in orders:
        assert abs(np.corrcoef(order[:-1], order[1:])[0, 1]) < 0.08


def test_a_grid_is_complete() -> None:
    made = GridSampler((3, 2, 4))
    points = made.points(0, made.rows)
    assert made.rows == 24
    expected = list(product([0.0, 0.5, 1.0], [0.0, 1.0], [0.0, 1 / 3, 2 / 3, 1.0]))
    assert [tuple(row) for row in points.tolist()] == expected
