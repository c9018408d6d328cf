"""Pairs, and coordinates of their poses, that the tests of all frameworks use."""

from __future__ import annotations

from typing import Any

import numpy as np

import standoff as so

ELLIPSOID, LENS = so.shapes.ellipsoid(0.5, 0.3, 0.4), so.shapes.lens(1.0, 0.45)
BOX = so.shapes.box(1.0, 1.0, 1.0)
AXES = np.array([0.5, 0.3, 0.4])

# Rotation vector and position of A, then of B.
APART = np.array([-0.4, 0.2, 0.6, 0.1, 0.2, -0.3, 0.3, -0.5, 0.7, 2.0, 0.4, 0.3])
INSIDE = np.array([-0.4, 0.2, 0.6, 0.1, 0.2, -0.3, 0.3, -0.5, 0.7, 0.6, 0.4, 0.3])

STACKED = np.eye(4)
STACKED[2, 3] = 1.5
"""Of a box over another: parallel flat sides, so no derivatives by turns about x and y."""
LOST = np.array([[0, 0, 1, 0], [0, 0, 1, 0], [1, 1, 0, 0], [0, 0, 0, 0]], dtype=bool)
"""The entries that such turns change at R = I."""


def pose(q: np.ndarray) -> np.ndarray:
    """The matrix of a rotation vector and a position."""
    return so.Pose.exp(q[:3], q[3:]).matrix


def distance(q: np.ndarray) -> float:
    """Of the lens and the ellipsoid."""
    return so.distance(LENS, ELLIPSOID, pose(q[:6]), pose(q[6:])).distance


def differences(q: np.ndarray, step: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Gradient and Hessian by central differences of the fourth order."""
    weights = {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}
    unit = step * np.eye(len(q))
    gradient = [sum(w * distance(q + k * e) for k, w in weights.items()) / step for e in unit]
    hessian = [
        [
            sum(
                w * v * distance(q + k * e + m * f)
                for k, w in weights.items()
                for m, v in weights.items()
            )
            / step**2
            for f in unit
        ]
        for e in unit
    ]
    return np.array(gradient), np.array(hessian)


def close(found: Any, expected: np.ndarray, tolerance: float) -> None:
    np.testing.assert_allclose(np.asarray(found), expected, rtol=0.0, atol=tolerance)
