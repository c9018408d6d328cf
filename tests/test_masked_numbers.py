"""Masked numbers have no value: no public call may take what lies beneath the mask for data."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import standoff as so
from families.masked import masked_versions
from public_calls import DISC, HOME, Call, calls, pair_calls
from standoff import geometry

AWAY = so.Pose(np.eye(3), [3.0, 0.0, 0.0])
TWIST = so.Twist([0.1, 0.0, 0.0], [0.0, 0.0, 1.0])
SPHERE, BOX = so.shapes.sphere(0.5), so.shapes.box(1.0, 1.0, 1.0)
TRACKER = so.Tracker(SPHERE, BOX)
POINTS, SPATIAL = so.PointTracker(DISC), so.points.SpatialPointTracker(BOX)


def method_calls() -> list[Call]:
    """Methods that take numbers, which the table of public calls has not."""
    moved = {"pose_a": HOME, "pose_b": AWAY, "twist_a": TWIST, "twist_b": TWIST}
    pair = {name: (pose.rotation, pose.translation) for name, pose in [("pose_b", AWAY)]}
    state = TRACKER.start(**moved)
    placed = {
        "pose_a": HOME,
        "pose_b": AWAY,
        "place_a": (("vertex", 0), ()),
        "place_b": (("face", 0), (0.1, 0.2)),
    }
    surface = geometry.BezierPatch([[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]])
    curve = geometry.RationalBezier([[0, 0, 0], [1, 0, 0], [1, 1, 0]])
    feedback: list[tuple[Any, dict[str, Any]]] = [
        (so.feedback.GainMatrix, {"gains": [1.0, 2.0, 3.0, 4.0]}),
        (so.feedback.GainMatrix, {"gains": np.eye(4)}),
        (so.feedback.Linear, {"gain": 10.0}),
        (so.feedback.PI, {"gain": 10.0, "integral": 1.0}),
    ]
    plain: list[tuple[Any, dict[str, Any]]] = [
        (TRACKER.start, moved),
        (TRACKER.start, moved | pair),
        (TRACKER.start, {**moved, "twist_a": (np.array(TWIST.v), np.array(TWIST.omega))}),
        (TRACKER.step, {"state": state, **moved, "dt": 1e-3}),
        (TRACKER.start_from, placed),
        (POINTS.start, {"point": [2.0, 0.1], "velocity": [1.0, 0.0]}),
        (SPATIAL.start, {"point": [2.0, 0.1, 0.2], "velocity": [1.0, 0.0, 0.0]}),
        (BOX.transformed, {"affine": np.diag([1.0, 2.0, 3.0])}),
        (BOX.transformed, {"affine": (np.eye(3), np.ones(3))}),
        (AWAY.apply, {"points": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]}),
        (so.voronoi_regions(BOX).feature_at, {"point": [2.0, 0.1, 0.2]}),
        (so.voronoi_regions(DISC).feature_at, {"point": [2.0, 0.1]}),
        (surface.restricted, {"u0": 0.1, "u1": 0.5, "v0": 0.2, "v1": 0.8}),
        (curve.transformed, {"linear": np.eye(3), "shift": np.ones(3)}),
        (surface.transformed, {"linear": np.eye(3), "shift": np.ones(3)}),
        *feedback,
    ]
    return [
        Call(f"{k}: {public.__name__}", public, given) for k, (public, given) in enumerate(plain)
    ]


def refusal(call: Call, arguments: dict[str, Any]) -> str:
    """What a call says of its arguments; "" where it takes them."""
    try:
        call.public(**arguments)
    except (ValueError, TypeError) as error:
        return str(error) or repr(error)
    return ""


ALL = [*calls(), *pair_calls(), *method_calls()]


@pytest.mark.filterwarnings("ignore::UserWarning:numpy")
@pytest.mark.parametrize("call", ALL, ids=lambda call: call.name)
def test_masked_numbers_are_refused(call: Call) -> None:
    for key, value in call.arguments.items():
        for how, masked in masked_versions(value):
            said = refusal(call, {**call.arguments, key: masked})
            assert "mask" in said, f"{key} as {how}: {said or 'taken'}"
            assert len(said) < 2000, f"{key} as {how}"


@pytest.mark.parametrize("call", ALL, ids=lambda call: call.name)
def test_masked_arrays_without_a_masked_number_are_arrays(call: Call) -> None:
    for key, value in call.arguments.items():
        if isinstance(value, np.ndarray):
            assert refusal(call, {**call.arguments, key: np.ma.array(value)}) == "", key


def test_the_message_says_what_to_do() -> None:
    rows = [[0.0, 0.0, 0.0], np.ma.array([1.0, 0.0, 0.0], mask=[False, True, False])]
    for refused in (
        lambda: so.shapes.polytope(rows),
        lambda: so.Pose(np.eye(3), rows[1]),
        lambda: so.Pose.of(np.ma.masked_equal(np.eye(4), 1.0)),
        lambda: so.feedback.GainMatrix(np.ma.masked_equal(np.eye(4), 0.0)),
    ):
        with pytest.raises(ValueError, match="has masked numbers; fill them, or leave them out"):
            refused()
