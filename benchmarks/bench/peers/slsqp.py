"""SciPy's SLSQP on the parameters of both ellipsoids, begun at the last frame's answer."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from benchmarks.bench.contender import Array, Contender, Found, asked
from benchmarks.bench.motion import Frames, Pair
from standoff_studies.accuracy.solids import Solid

FTOL = 1e-16
"""``ftol`` of the squared distance (area): SLSQP stops where roundoff does."""


def contenders(pair: Pair, frames: Frames) -> list[Contender]:
    """One, on ellipsoids."""
    if "SLSQP" not in pair.more:
        return []
    axes = [np.array(list(solid.values.values())) for solid in (pair.a, pair.b)]
    last = [_toward(frames, pair.a, 0), _toward(frames, pair.b, 1)]
    guess = np.concatenate(last)

    def ask(pose_a: Array, pose_b: Array) -> tuple[Array, Array]:
        turns = pose_a[:3, :3] * axes[0], pose_b[:3, :3] * axes[1]
        places = pose_a[:3, 3], pose_b[:3, 3]

        def squared(q: Array) -> tuple[float, Array]:
            (point_a, partials_a), (point_b, partials_b) = (
                _jet(turn, place, *q[i : i + 2])
                for turn, place, i in zip(turns, places, (0, 2), strict=True)
            )
            apart = point_a - point_b
            slope = np.concatenate([apart @ partials_a, -apart @ partials_b])
            return 0.5 * float(apart @ apart), slope

        found = minimize(squared, guess, jac=True, method="SLSQP", options={"ftol": FTOL})
        guess[:] = found.x
        return _jet(turns[0], places[0], *guess[:2])[0], _jet(turns[1], places[1], *guess[2:])[0]

    def read(points: tuple[Array, Array]) -> Found:
        return Found(float(np.linalg.norm(points[1] - points[0])), *points)

    return [asked("SciPy SLSQP, warm", frames.pairs, ask, read)]


def _jet(turn: Array, place: Array, u: float, v: float) -> tuple[Array, Array]:
    """Point (3,) and first partials (3, 2) of an ellipsoid at longitude u and latitude v."""
    cu, su, cv, sv = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
    point = turn @ np.array([cv * cu, cv * su, sv]) + place
    return point, turn @ np.array([[-cv * su, -sv * cu], [cv * cu, -sv * su], [0.0, cv]])


def _toward(frames: Frames, solid: Solid, which: int) -> Array:
    """Longitude and latitude of a body's point toward the other's centre, at the start."""
    poses = frames.poses_a[0], frames.poses_b[0]
    own, other = poses[which], poses[1 - which]
    way = (own[:3, :3].T @ (other[:3, 3] - own[:3, 3])) / np.array(list(solid.values.values()))
    way /= np.linalg.norm(way)
    return np.array([np.arctan2(way[1], way[0]), np.arcsin(way[2])])
