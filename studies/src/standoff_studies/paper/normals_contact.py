"""Two ellipsoids moved through contact, into each other and out again, with a known answer."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from standoff.typing import Array
from standoff_studies.paper.normals_study import (
    AXES_A,
    AXES_B,
    NORMAL,
    TURN_A,
    TURN_B,
    Ellipsoid,
    Pair,
    corrected,
    exact,
    predicted,
    witness_error,
)

DURATION = 1.0
"""Duration of the motion through contact [s]."""

DEEPEST = 0.1
"""Greatest distance and depth of that motion [length]."""

RATE_A, RATE_B = np.array([0.3, -0.5, 0.4]), np.array([-0.4, 0.6, 0.8])
"""Turning rates of the bodies [rad/s]."""

RATE_NORMAL = np.array([-0.5, 0.4, 0.6])
"""Turning rate of the common normal [rad/s]."""

# Central differences of eighth order for the velocity of B's centre: with steps of 1e-2 s their
# error is below 1e-12.
OFFSETS = np.array([1, 2, 3, 4])
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
STEP = 1e-2


def passing(time: float) -> Pair:
    """Both bodies turn, and B's distance is 0.1 cos 2 pi t: contact at 0.25 s and at 0.75 s."""

    def placed(t: float) -> Pair:
        return Pair(
            Ellipsoid(AXES_A, (Rotation.from_rotvec(RATE_A * t) * TURN_A).as_matrix()),
            Ellipsoid(AXES_B, (Rotation.from_rotvec(RATE_B * t) * TURN_B).as_matrix()),
            Rotation.from_rotvec(RATE_NORMAL * t).apply(NORMAL),
            DEEPEST * np.cos(2.0 * np.pi * t / DURATION),
        )

    pair = placed(time)
    velocity = np.zeros(3)
    for offset, weight in zip(OFFSETS * STEP, WEIGHTS / STEP, strict=True):
        velocity += weight * (placed(time + offset).centre - placed(time - offset).centre)
    zero = np.zeros(3)
    return pair._replace(motion=np.array([zero, zero, RATE_A, pair.centre, velocity, RATE_B]))


class Track(NamedTuple):
    """A tracked motion by frame: time [s], exact distance, witness error, and |dR| [length]."""

    time: Array
    distance: Array
    error: Array
    apart: Array


def tracked(form: str, dt: float, first: float = 0.0) -> Track:
    """Track `passing` from the exact points: a feedforward, then one Newton step a frame."""
    times = np.arange(first, DURATION + 0.5 * dt, dt)
    pair = passing(float(times[0]))
    points = exact(pair)
    rows: list[tuple[float, float, float, float]] = []
    for time in times.tolist():
        if rows:
            points = predicted(pair, form, points, dt)
            pair = passing(time)
            points = corrected(pair, form, points)
        x, y = points.a @ pair.a.map.T, points.b @ pair.b.map.T + pair.centre
        apart = float(np.linalg.norm(x - y))
        rows.append((time, pair.distance, float(witness_error(pair, points)[0]), apart))
    return Track(*np.array(rows).T)
