"""A random order of 0 .. n - 1 of which every place is known without the others.

A Feistel network permutes the numbers of so many bits, whatever its round function is; a number
that comes out beyond n - 1 goes through it again until one does not (cycle walking), which leaves a
permutation of those below n. The network has less than 2 n numbers, so it takes two passes on the
average.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
