"""Answers made wrong one number at a time: each check fires, and on the right frame."""

import numpy as np
import pytest

from standoff.kernels import frame as K
from standoff.soak.cases import draw_case
from standoff.soak.checks import judge
from standoff.soak.running import track
from standoff.tracking.tracker import Tracker

TOLERANCE = 1e-10


def apart():
    """A pair that stays apart: its bodies, frames and right answers."""
    for number in range(100):
        case, a, b, frames = draw_case(5, number, 10)
        if case.family == "apart" and a.body.bounded and b.body.bounded:
            tracker = Tracker(a.body, b.body, case.motion.step, tolerance=TOLERANCE)
            return a, b, frames, track(tracker, frames, case.motion.twists).rows
    raise AssertionError("no such pair")


@pytest.mark.parametrize(
    ("column", "change"),
    [
        (K.DISTANCE, 1e-6),
        (K.DISTANCE, -1e-6),
        (K.DISTANCE, np.nan),
        (K.LOWER_BOUND, 1e-6),
        (K.LOWER_BOUND, np.inf),
        (K.POINT_A, 1e-6),
        (K.POINT_B + 1, np.inf),
        (K.NORMAL, 1e-3),
        (K.STATUS, 17.0),
    ],
)
def test_a_wrong_number_is_seen(column, change):
    a, b, frames, rows = apart()
    assert judge(a, b, frames, rows, TOLERANCE).faults == []
    rows[4, column] += change * (a.body.size + b.body.size + 1.0)
    faults = judge(a, b, frames, rows, TOLERANCE).faults
    assert faults
    assert faults[0].frame == 4


def test_a_silent_zero_is_seen():
    a, b, frames, rows = apart()
    rows[6, [K.DISTANCE, K.LOWER_BOUND]] = 0.0
    faults = judge(a, b, frames, rows, TOLERANCE).faults
    assert "a silent zero" in [fault.what for fault in faults if fault.frame == 6]
