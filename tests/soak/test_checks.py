"""Answers made wrong one number at a time: each check fires, and on the right frame."""

import numpy as np
import pytest

from standoff.kernels.body import layout as L
from standoff.kernels.state import arrays as K
from standoff.tracking.laws import PaperLaw, PredictorCorrector
from standoff.tracking.tracker import Tracker
from standoff_studies.soak.cases import draw_case
from standoff_studies.soak.checks import BLURRED, GLOBAL, LOCAL, judge, search
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.running import track
from standoff_studies.soak.shapes import Shape, made

TOLERANCE = 1e-10


def apart():
    """A pair that stays apart: its bodies, frames and right answers."""
    for number in range(100):
        case, a, b, frames = draw_case(5, number, 10)
        if case.family == "apart" and a.body.bounded and b.body.bounded:
            tracker = Tracker(
                a.body, b.body, case.motion.step, PredictorCorrector(tolerance=TOLERANCE)
            )
            return a, b, frames, track(tracker, frames, True).rows
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
    assert judge(a, b, frames, rows, TOLERANCE, True).faults == []
    rows[4, column] += change * (a.body.size + b.body.size + 1.0)
    faults = judge(a, b, frames, rows, TOLERANCE, True).faults
    assert faults
    assert faults[0].frame == 4


@pytest.mark.parametrize(
    ("columns", "value"),
    [
        (slice(K.OUT_RATE, K.OUT_RATE + 1), np.nan),
        (slice(K.VELOCITY_A, K.RESIDUAL), np.nan),
        (slice(K.VELOCITY_B, K.VELOCITY_B + 1), np.inf),
        (slice(K.RESIDUAL, K.RESIDUAL + 1), np.nan),
        (slice(K.RESIDUAL, K.RESIDUAL + 1), 1e9),
        (slice(K.OUT_MODE, K.OUT_Q), -7.0),
        (slice(K.OUT_MODE, K.OUT_MODE + 1), 1e6),
        (slice(K.OUT_MODE + 2, K.OUT_MODE + 3), 0.5),
        (slice(K.OUT_Q, K.OUT_RATE), np.nan),
        (slice(K.OUT_COUNTS, K.OUT_COUNTS + 1), -1.0),
    ],
)
def test_a_wrong_number_beside_the_distance_is_seen(columns, value):
    a, b, frames, rows = apart()
    rows[3, columns] = value
    faults = judge(a, b, frames, rows, TOLERANCE, True).faults
    assert [fault.frame for fault in faults] == [3] * len(faults)
    assert faults


@pytest.mark.parametrize(
    ("columns", "what"),
    [
        (slice(K.OUT_RATE, K.OUT_RATE + 1), "the rate is not that of the bodies' motion"),
        (slice(K.VELOCITY_A, K.VELOCITY_B), "point_a leaves its body"),
        (slice(K.VELOCITY_B, K.RESIDUAL), "point_b leaves its body"),
    ],
)
def test_doubled_rates_are_seen(columns, what):
    """Of all families: also in contact, and beside a half-space."""
    seen = 0
    for number in range(40):
        case, a, b, frames = draw_case(5, number, 10)
        if isinstance(case.law, PaperLaw) or {a.shape.kind, b.shape.kind} & BLURRED:
            continue  # their points need not be at rest to roundoff
        tracker = Tracker(a.body, b.body, case.motion.step, case.law)
        rows = track(tracker, frames, True).rows
        tolerance = tracker.law.tolerance
        assert judge(a, b, frames, rows, tolerance, True).faults == []
        rows[5, columns] *= 2.0
        doubled = rows[5, columns]
        along = doubled if len(doubled) == 1 else doubled @ rows[5, K.NORMAL : K.NORMAL + 3]
        if not np.abs(along) > 0.3 * np.linalg.norm(doubled):
            continue  # of no length, or along the surface: there it may have any
        faults = judge(a, b, frames, rows, tolerance, True).faults
        assert (5, what) in [(fault.frame, fault.what) for fault in faults], case
        seen += 1
    assert seen > 5


def test_rates_are_known_only_where_twists_are():
    a, b, frames, rows = apart()
    faults = judge(a, b, frames, rows, TOLERANCE, False).faults
    assert [fault.what for fault in faults] == ["a rate or velocity without twists"]
    rows[:, K.OUT_RATE : K.RESIDUAL] = np.nan
    assert judge(a, b, frames, rows, TOLERANCE, False).faults == []


def test_a_chart_of_another_face_is_seen():
    for number in range(100):
        _, a, b, frames = draw_case(5, number, 10)
        if a.shape.kind == "superellipsoid" and b.body.bounded:
            break
    rows = track(Tracker(a.body, b.body), frames, True).rows
    on_face = rows[:, K.OUT_MODE] < a.body.n_faces
    assert on_face.any()
    k = int(on_face.argmax())
    rows[k, K.OUT_MODE + 1] = a.body.ints[L.N_CHARTS]
    faults = judge(a, b, frames, rows, TOLERANCE, True).faults
    assert (k, "no feature of A") in [(fault.frame, fault.what) for fault in faults]


def test_a_silent_zero_is_seen():
    a, b, frames, rows = apart()
    rows[6, [K.DISTANCE, K.LOWER_BOUND]] = 0.0
    faults = judge(a, b, frames, rows, TOLERANCE, True).faults
    assert "a silent zero" in [fault.what for fault in faults if fault.frame == 6]


def balls(offset, turn=0.0):
    """Balls of radii 2 and 1 whose centres are `offset` apart: the answer along a normal that is
    turned away from their line, called GLOBAL."""
    a, b = made(Shape("sphere", {"r": 2.0})), made(Shape("sphere", {"r": 1.0}))
    pose = np.eye(3, 4).T.ravel()[None]
    poses_b = pose.copy()
    poses_b[0, 9] = offset
    frames = Frames(pose, poses_b, np.zeros((1, 6)), np.zeros((1, 6)), np.ones(1))
    n = np.array([np.cos(turn), np.sin(turn), 0.0])
    row = np.zeros(K.N_OUT)
    row[[K.DISTANCE, K.LOWER_BOUND]] = offset * n[0] - 3.0
    row[K.UPPER_BOUND] = offset - 3.0
    row[K.POINT_A : K.POINT_A + 3] = 2.0 * n
    row[K.POINT_B : K.POINT_B + 3] = 2.0 * n + row[K.DISTANCE] * n
    row[K.NORMAL : K.NORMAL + 3] = n
    row[K.STATUS] = GLOBAL
    return a, b, frames, row[None]


def deep_faults(a, b, frames, rows):
    judged = judge(a, b, frames, rows, TOLERANCE, True)
    found = judged.faults + search(a, b, frames, rows, judged, np.array([0]))
    return [fault.what for fault in found]


def test_a_depth_is_judged_by_its_normal_and_by_all_others():
    assert deep_faults(*balls(2.5)) == []
    # along another normal the push is longer; that alone is no fault, to call it GLOBAL is
    a, b, frames, rows = balls(2.5, turn=0.3)
    assert "GLOBAL, but a lesser depth exists" in deep_faults(a, b, frames, rows)
    n = rows[0, K.NORMAL : K.NORMAL + 3]
    rows[0, K.POINT_B : K.POINT_B + 3] = np.array([2.5, 0.0, 0.0]) - n
    assert "the points are not on the normal" in deep_faults(a, b, frames, rows)
    rows[0, K.STATUS] = LOCAL
    assert deep_faults(a, b, frames, rows) == []
    assert judge(a, b, frames, rows, TOLERANCE, True).unrest[0] > 1e3
    # balls that are apart, along a normal that does not part them
    assert "said to overlap, but a plane separates them" in deep_faults(*balls(3.1, turn=0.9))


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (0.1, "the depth does not part the bodies"),
        (-0.1, "the depth is not that along the normal"),
    ],
)
def test_a_wrong_depth_is_seen(change, what):
    a, b, frames, rows = balls(2.5)
    rows[0, K.DISTANCE] += change
    assert what in deep_faults(a, b, frames, rows)
