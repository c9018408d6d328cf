"""How a servo loop kept its time."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from standoff.kernels.dynamics import servo_arrays as V
from standoff.typing import Ints

QUANTILES: Final = (0.5, 0.99, 0.999, 0.9999)
NANO: Final = 1_000_000_000


class Spread(NamedTuple):
    """How long something took, over all ticks [s].

    Quantiles come from a histogram, and are the middles of bins that are 0.8 % wide or less; the
    worst is exact.

    Attributes
    ----------
    median, p99, p999, p9999, worst : float
    """

    median: float
    p99: float
    p999: float
    p9999: float
    worst: float


class ServoStatistics(NamedTuple):
    """How a servo loop kept its time.

    Attributes
    ----------
    period : Spread
        From a tick's start to the next.
    lateness : Spread
        From a tick's deadline to its start.
    work : Spread
        From a tick's start to the publication of its force.
    ticks : int
    missed : int
        Deadlines that passed while an earlier tick was still running: no tick was made for them.
    engaged : int
        Ticks with the coupler engaged.
    fresh : int
        Ticks that had a new reading.
    """

    period: Spread
    lateness: Spread
    work: Spread
    ticks: int
    missed: int
    engaged: int
    fresh: int


def end_of_bin(number: int) -> int:
    """Return the greatest time [ns] that a bin counts."""
    if number < V.EXACT:
        return number
    half = V.EXACT // 2
    doublings = (number - V.EXACT) // half + 1
    least = (number - V.EXACT) % half + half
    return ((least + 1) << doublings) - 1


def middle_of_bin(number: int) -> float:
    """Return the time [ns] in the middle of those that a bin counts."""
    before = end_of_bin(number - 1) if number else -1
    return 0.5 * (before + 1 + end_of_bin(number))


def spread_of(bins: Ints, worst: int) -> Spread:
    """Return the quantiles of a histogram, none beyond the worst."""
    counts = np.cumsum(bins)
    total = int(counts[-1])
    if total == 0:
        return Spread(0.0, 0.0, 0.0, 0.0, 0.0)
    found = [int(np.searchsorted(counts, np.ceil(share * total))) for share in QUANTILES]
    median, p99, p999, p9999 = (min(middle_of_bin(each), worst) / NANO for each in found)
    return Spread(median, p99, p999, p9999, worst / NANO)


def statistics_of(bins: Ints, tallies: Ints) -> ServoStatistics:
    """Return what a loop's histograms and tallies say."""
    spreads = [spread_of(bins[k], int(tallies[V.Y_WORST + k])) for k in range(V.N_MEASURED)]
    return ServoStatistics(
        period=spreads[V.H_PERIOD],
        lateness=spreads[V.H_LATE],
        work=spreads[V.H_WORK],
        ticks=int(tallies[V.Y_TICKS]),
        missed=int(tallies[V.Y_MISSED]),
        engaged=int(tallies[V.Y_ENGAGED]),
        fresh=int(tallies[V.Y_FRESH]),
    )
