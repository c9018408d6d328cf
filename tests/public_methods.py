"""Calls of methods that take numbers, and of runs: beside the table of `public_calls`."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import standoff as so
from public_calls import DISC, HOME, Call
from standoff import geometry

AWAY = so.Pose(np.eye(3), [3.0, 0.0, 0.0])
TWIST = so.Twist([0.1, 0.0, 0.0], [0.0, 0.0, 1.0])
SPHERE, BOX = so.shapes.sphere(0.5), so.shapes.box(1.0, 1.0, 1.0)
TRACKER = so.Tracker(SPHERE, BOX)
WORLD = so.World({"ball": SPHERE, "box": BOX}, within=0.5, fixed={"box": HOME})
POINTS, SPATIAL = so.PointTracker(DISC), so.PointTracker(BOX)


regions_of = cache(so.voronoi_regions)


def method_calls() -> list[Call]:
    """One call that works for each."""
    moved = {"pose_a": HOME, "pose_b": AWAY, "twist_a": TWIST, "twist_b": TWIST}
    pair = {name: (pose.rotation, pose.translation) for name, pose in [("pose_b", AWAY)]}
    state = TRACKER.start(**moved)
    stacked = np.stack([HOME, HOME])
    flat = np.tile(np.append(np.eye(3).ravel(), [3.0, 0.0, 0.0]), (2, 1))
    rows = {"poses_a": stacked, "poses_b": flat, "twists_a": np.ones((2, 6))}
    several = TRACKER.start_many(stacked, flat)
    one = {"twists_b": (np.array(TWIST.v), np.array(TWIST.omega))}
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
        (TRACKER.run, {"state": state, **rows, "dt": np.full(2, 1e-3)}),
        (TRACKER.run, {"state": state, **rows, **one}),
        (TRACKER.start_many, {**rows, **one}),
        (TRACKER.step_many, {"states": several, **rows, **one, "dt": np.full(2, 1e-3)}),
        (so.distances, {"a": SPHERE, "b": BOX, "poses_a": stacked, "poses_b": flat}),
        (so.distances, {"a": SPHERE, "b": BOX, "poses_a": np.eye(4).tolist(), "poses_b": AWAY}),
        (TRACKER.start_from, placed),
        (WORLD.changed, {"add": {"more": SPHERE}, "remove": ["ball"], "within": 0.3}),
        (WORLD.start_from, {"world": WORLD, "state": WORLD.start({"ball": AWAY}), "poses": None}),
        (POINTS.start, {"point": [2.0, 0.1], "velocity": [1.0, 0.0]}),
        (SPATIAL.start, {"point": [2.0, 0.1, 0.2], "velocity": [1.0, 0.0, 0.0]}),
        (BOX.transformed, {"affine": np.diag([1.0, 2.0, 3.0])}),
        (BOX.transformed, {"affine": (np.eye(3), np.ones(3))}),
        (AWAY.apply, {"points": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]}),
        (regions_of(BOX).feature_at, {"point": [2.0, 0.1, 0.2]}),
        (regions_of(DISC).feature_at, {"point": [2.0, 0.1]}),
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
