"""Points of the unit cube by their numbers: any row by itself, without those before it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.random import Generator, Philox
from numpy.typing import NDArray

from standoff.errors import StandoffError
from standoff.typing import Array

WORDS = 4
"""Numbers that Philox makes of one state of its counter."""

CUBE, ORDERS = 0, 1
"""What a seed's random numbers are for, the other half of Philox's key: the cube's points, and the
orders of a Latin hypercube's strata."""

SOBOL_BITS = 52
"""Digits of a Sobol' number: all that a double has, and more rows than anybody computes."""

SOBOL_TABLE = 12
"""Digits of a row's number whose part of the point is kept in a table: 200 kB of six parameters."""

SOBOL_CHECKED = 16
"""Points that are compared with SciPy's own when a sampler is made."""


class Sampler(Protocol):
    """A sequence of points of the unit cube.

    Attributes
    ----------
    rows : int
        Number of points.
    """

    @property
    def rows(self) -> int: ...

    def points(self, first: int, end: int) -> Array:
        """Return the points first .. end - 1, shape (end - first, dimension)."""


def _philox(seed: int, purpose: int) -> Philox:
    return Philox(key=np.array([seed, purpose], dtype=np.uint64))


@dataclass(frozen=True)
class RandomSampler:
    """Independent uniform points: row k has the numbers of Philox's counters from k c on, c of
    them for its dimension."""

    rows: int
    dimension: int
    seed: int

    def points(self, first: int, end: int) -> Array:
        blocks = -(-self.dimension // WORDS)
        source = _philox(self.seed, CUBE)
        source.advance(first * blocks)
        drawn = Generator(source).random((end - first, blocks * WORDS))
        return np.ascontiguousarray(drawn[:, : self.dimension])


@dataclass(frozen=True)
class LatinHypercubeSampler:
    """In each parameter, one point in each of as many equal strata as there are rows.

    Which row has which stratum is a random order (`permuted`) for each parameter; where in it the
    point is, is as in `RandomSampler`.
    """

    rows: int
    dimension: int
    seed: int

    @cached_property
    def _keys(self) -> NDArray[np.uint64]:
        return _philox(self.seed, ORDERS).random_raw((self.dimension, ROUNDS))

    def points(self, first: int, end: int) -> Array:
        found = RandomSampler(self.rows, self.dimension, self.seed).points(first, end)
        numbers = np.arange(first, end, dtype=np.uint64)
        for j, key in enumerate(self._keys):
            stratum = permuted(numbers, self.rows, key).astype(np.float64)
            # Of 2 ** 53 strata and more, a sum could round to the next stratum.
            found[:, j] = np.minimum(stratum + found[:, j], np.nextafter(stratum + 1.0, 0.0))
        found /= self.rows
        return found


class SobolSampler:
    """Sobol' points with the direction numbers and the scrambling of `scipy.stats.qmc.Sobol`.

    Point k is the exclusive or of those direction numbers that the Gray code of k has, and of a
    shift: some fifty steps for any k. SciPy's ``fast_forward`` takes k steps, which for the last
    shards of 10⁹ rows is longer than their distances.

    Raises StandoffError if SciPy keeps its direction numbers otherwise than this class knows: its
    points are compared with SciPy's.
    """

    def __init__(self, rows: int, dimension: int, seed: int, bits: int = SOBOL_BITS) -> None:
        from scipy.stats.qmc import Sobol

        self.rows, self.dimension, self.seed, self.bits = rows, dimension, seed, bits
        engine = Sobol(dimension, scramble=True, bits=bits, rng=np.random.default_rng(seed))
        self._directions = np.array(engine._sv, dtype=np.uint64)
        self._shift = np.array(engine._quasi, dtype=np.uint64)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about numbers of points that are no power of two
            own = engine.random(SOBOL_CHECKED)
        if not np.array_equal(self.points(0, SOBOL_CHECKED), own):
            raise StandoffError(
                "this SciPy keeps the numbers of its Sobol' sequence in another way: take another "
                "kind of sampler, or SciPy 1.17",
                "sampler",
            )

    def points(self, first: int, end: int) -> Array:
        # The last digits of k take their part from a table. The Gray code has beside each digit of
        # k the one before it: the first digit of the table's also depends on the last above it.
        above = np.arange(first >> SOBOL_TABLE, (max(first, end - 1) >> SOBOL_TABLE) + 1)
        heads = self._combined(above, SOBOL_TABLE) ^ self._shift
        heads ^= (above & 1).astype(np.uint64)[:, None] * self._directions[:, SOBOL_TABLE - 1]
        numbers = np.arange(first, end)
        found = self._table[numbers & ((1 << SOBOL_TABLE) - 1)]
        found ^= heads[(numbers >> SOBOL_TABLE) - above[0]]
        points: Array = found * 2.0**-self.bits
        return points

    @cached_property
    def _table(self) -> NDArray[np.uint64]:
        return self._combined(np.arange(1 << SOBOL_TABLE), 0)

    def _combined(self, numbers: NDArray[np.int64], first: int) -> NDArray[np.uint64]:
        """The direction numbers, from one on, that the Gray codes have, shape (n, dimension)."""
        gray = (numbers ^ (numbers >> 1)).astype(np.uint64)
        found = np.zeros((len(gray), self.dimension), dtype=np.uint64)
        for bit in range(int(gray.max(initial=0)).bit_length()):
            has = (gray >> np.uint64(bit)) & np.uint64(1)
            found ^= has[:, None] * self._directions[:, first + bit]
        return found


@dataclass(frozen=True)
class GridSampler:
    """All combinations of so many values of each parameter, both ends among them; the last
    parameter changes first.

    Attributes
    ----------
    steps : tuple of int
        Number of values of each, at least 2.
    """

    steps: tuple[int, ...]

    @property
    def rows(self) -> int:
        rows = 1
        for steps in self.steps:
            rows *= steps
        return rows

    def points(self, first: int, end: int) -> Array:
        rest = np.arange(first, end)
        found = np.empty((end - first, len(self.steps)))
        for j in reversed(range(len(self.steps))):
            rest, digit = np.divmod(rest, self.steps[j])
            found[:, j] = digit / (self.steps[j] - 1)
        return found


# A random order of 0 .. n - 1 of which every place is known without the others.
#
# A Feistel network permutes the numbers of so many bits, whatever its round function is; a number
# that comes out beyond n - 1 goes through it again until one does not (cycle walking), which leaves
# a permutation of those below n. The network has less than 2 n numbers, so it takes two passes on
# the average.

Words = NDArray[np.uint64]

ROUNDS = 6
"""Even: both halves are mixed equally often. Four are enough against an adversary who may choose
what to ask (Luby and Rackoff 1988); two more are for halves of few bits."""

LEAST_BITS = 2
"""So that each half has one."""


def permuted(rows: Words, n: int, key: Words) -> Words:
    """Return the places of rows in a random order.

    Parameters
    ----------
    rows : (m,) array
        Below n.
    n : int
        Number of rows in all, at least 1.
    key : (ROUNDS,) array
        Says which order.

    Returns
    -------
    (m,) array
        Below n; all n rows have different ones.
    """
    bits = max(LEAST_BITS, int(n - 1).bit_length())
    found = _network(rows, bits, key)
    while True:
        beyond = np.flatnonzero(found >= n)
        if not len(beyond):
            return found
        found[beyond] = _network(found[beyond], bits, key)


def _network(numbers: Words, bits: int, key: Words) -> Words:
    """A permutation of the numbers of so many bits."""
    low = np.uint64(bits // 2)
    of_low, of_high = (np.uint64((1 << n) - 1) for n in (bits // 2, bits - bits // 2))
    high, lower = numbers >> low, numbers & of_low
    for k in range(0, ROUNDS, 2):
        high = high ^ (_mixed(lower ^ key[k]) & of_high)
        lower = lower ^ (_mixed(high ^ key[k + 1]) & of_low)
    return (high << low) | lower


def _mixed(x: Words) -> Words:
    """The last steps of SplitMix64 (Steele, Lea and Flood 2014): every bit depends on all."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))
