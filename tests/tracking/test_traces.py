"""Committed runs over all kinds of bodies and laws: the answers stay as they were."""

import numpy as np
import pytest

import standoff as so
from families import traces
from standoff.kernels.tolerances import DEPTH_PROOF

SAME = 1e-12
"""Most that a number may differ by: the lengths are about 1."""
# Rates of points jump where a feature changes, and are known to the digits of the curvature.
SAME_RATE = 1e-8
LENGTHS = np.r_[0:2, 4:13]
# The bound of the least depth is where a search stopped: any value within what it was to prove.
# Where it stops may turn on the last digit, and differs from one processor to another.
UPPER_BOUND = 2
RADII = 0.9
"""Greatest sum of the radii that two bodies of these runs are rounded by."""
RATES = np.r_[3, 13:19]
DISCRETE = np.r_[19:22]

committed = np.load(traces.FILE)


@pytest.mark.parametrize("run", traces.runs(), ids=" ".join)
def test_answers_are_those_recorded(run):
    then, now = committed["|".join(run)], traces.trace(*run)
    same = ((then == now) | (np.isnan(then) & np.isnan(now)))[:, DISCRETE].all(axis=1)
    # an event may fall one frame earlier or later: there the points differ
    changed = np.flatnonzero(~same)
    for k in changed:
        near = then[max(k - 1, 0) : k + 2, DISCRETE]
        assert (near == now[k, DISCRETE]).all(axis=1).any(), (k, then[k], now[k])
    assert np.abs(np.where(np.isnan(then), 0.0, then - now))[same][:, LENGTHS].max() <= SAME
    off = np.abs(np.where(np.isnan(then), 0.0, then - now))[same][:, RATES]
    # where features are all but parallel a rate is 1e6, and known to as many digits
    assert (off <= SAME_RATE * np.maximum(1.0, np.abs(np.nan_to_num(then[same][:, RATES])))).all()
    assert (np.isnan(then) == np.isnan(now))[same].all()
    bounds = np.abs(then - now)[same, UPPER_BOUND]
    searched = now[same, DISCRETE[0]] == so.Status.GLOBAL.value
    assert (bounds <= np.where(searched, DEPTH_PROOF * (RADII - now[same, 0]), SAME)).all()


def test_the_runs_meet_what_they_are_to_meet():
    """Every body and law, frames in contact and apart, and switches."""
    runs = traces.runs()
    assert {body for a, b, _ in runs for body in (a, b)} == set(traces.BODIES)
    assert {law for *_, law in runs} == set(traces.LAWS)
    rows = np.concatenate([committed["|".join(run)] for run in runs])
    assert 0.1 < (rows[:, 0] < 0.0).mean() < 0.9
    assert (np.diff(rows[:, DISCRETE], axis=0) != 0.0).any(axis=1).sum() > 60
