"""The lens of simulations D and E in three parametrisations, and its stretched images."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from standoff.bodies import Body, shapes
from standoff.bodies.topology import Face
from standoff.geometry.curves import ConicArc, Curve
from standoff.geometry.nurbs import BezierPatch
from standoff.geometry.pcurves import Pcurve
from standoff.typing import Array
from standoff_studies.paper.bodies import lens_of_patches

RADIUS, OFFSET = 1.0, 0.45
"""Radius of the lens's balls, and offset of their centres [length]: those of D and E."""

PARAMETRISATIONS = {
    "patches": "biquadratic Bézier patches",
    "gnomonic": "gnomonic charts, trimmed",
    "stereographic": "stereographic patches, trimmed",
}
"""The name of each, by key."""

REACH = 0.7
"""Half the width of a stereographic patch: tan(θ/2) at the angle θ from its middle. The vertices
are at 63°, where it is 0.62."""


@dataclass(frozen=True, eq=False)
class Lens:
    """The lens in one parametrisation under a linear map.

    Attributes
    ----------
    parametrisation : str
        A key of `PARAMETRISATIONS`.
    body : Body
    linear : ndarray, shape (3, 3)
        The map from the lens of D to this body.
    """

    parametrisation: str
    body: Body
    linear: Array

    def place(self, face: int, point: Array) -> tuple[float, float]:
        """Return the parameters of a point of a face [length], shape (3,)."""
        x = np.linalg.solve(self.linear, point)
        angle = math.radians(120.0 * face)
        radial = np.array([math.cos(angle), math.sin(angle), 0.0])
        across = np.array([-math.sin(angle), math.cos(angle), 0.0])
        ahead = x @ radial + OFFSET
        if self.parametrisation == "gnomonic":
            return float(x @ across / ahead), float(x[2] / ahead)
        if self.parametrisation == "stereographic":
            wide = 2.0 * REACH * (RADIUS + ahead)
            return float(0.5 + x @ across / wide), float(0.5 + x[2] / wide)
        raise ValueError("the patches' own parameters are the ones that are drawn")


@cache
def _at_home(parametrisation: str) -> Body:
    if parametrisation == "patches":
        return lens_of_patches(RADIUS, OFFSET)
    if parametrisation == "gnomonic":
        return shapes.lens(RADIUS, OFFSET)
    made = shapes.lens(RADIUS, OFFSET)
    faces = []
    for face in made.face_parts:
        sides = tuple(_projected(made.edge_parts[edge].curve, face) for edge, _ in face.loop)
        faces.append(Face((_stereographic(face),), face.loop, pcurves=sides))
    return Body.from_brep(made.vertex_points, made.edge_parts, faces, name="lens, stereographic")


def lens(parametrisation: str, linear: Array | None = None) -> Lens:
    """Return the lens, or its image under a linear map (3, 3), in one parametrisation."""
    by = np.eye(3) if linear is None else np.asarray(linear, dtype=np.float64)
    body = _at_home(parametrisation)
    return Lens(parametrisation, body if linear is None else body.transformed(by), by)


def _stereographic(face: Face) -> BezierPatch:
    """The part of a gnomonic face's ball around its middle, projected from the opposite pole.

    In homogeneous coordinates (2x, 2y, 1 − x² − y²; 1 + x² + y²), for x and y from −REACH to REACH.
    """
    one, line, square = (
        np.array(row) for row in ([1.0, 1.0, 1.0], [-1.0, 0.0, 1.0], [1.0, -1.0, 1.0])
    )
    x, y = REACH * np.outer(line, one), REACH * np.outer(one, line)
    squares = REACH**2 * (np.outer(square, one) + np.outer(one, square))
    weights, ball = 1.0 + squares, face.charts[0]
    points = np.stack([2.0 * x, 2.0 * y, 1.0 - squares], axis=2) / weights[..., None]
    return BezierPatch(points @ ball.linear.T + ball.shift, weights)


def _projected(curve: Curve, face: Face) -> Pcurve:
    """A circle of the ball in the patch's (u, v): x, y and 1 + z are affine on it."""
    assert isinstance(curve, ConicArc)
    ball = face.charts[0]
    to_ball = curve.basis() - np.outer(ball.shift, [0.0, 0.0, 1.0])
    rows = np.linalg.solve(ball.linear, to_ball) + np.diag([0.0, 0.0, 1.0])
    half = 0.5 / REACH
    return Pcurve(
        curve.kind, np.array([[half, 0.0, 0.5], [0.0, half, 0.5], [0.0, 0.0, 1.0]]) @ rows
    )
