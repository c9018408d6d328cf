"""Bodies of the paper's simulations: curves and four-sided patches with parameters in [0, 1]."""

from __future__ import annotations

import math

import numpy as np

from standoff.bodies import Body, shapes
from standoff.checks.numbers import magnitude
from standoff.geometry.curves import RationalBezier
from standoff.geometry.nurbs import BezierPatch
from standoff.typing import Array

PLANAR_CONTROL = (
    ((1.0, 0.0), (0.775, 0.645), (0.175, 1.005), (-0.5, 0.9)),
    ((-0.5, 0.9), (-0.87, 0.41), (-0.91, -0.27), (-0.6, -0.8)),
    ((-0.6, -0.8), (0.12, -1.04), (0.76, -0.72), (1.0, 0.0)),
)
"""Control points of the planar body of three cubic Bézier curves, counter-clockwise [length]."""

LEAF_CONTROL = (
    ((-0.7, 0.0), (0.0, -0.75), (0.7, 0.0)),
    ((0.7, 0.0), (0.5, 0.35), (0.1, 0.45)),
    ((0.1, 0.45), (-0.4, 0.45), (-0.7, 0.0)),
)
"""Control points of the leaf's three Bézier curves, counter-clockwise [length]."""

LEAF_WEIGHTS = ((1.0, 0.8, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
"""Weights of the leaf: its lower curve is an arc of an ellipse, the others are parabolas."""


def planar_body() -> Body:
    """The planar body of simulations B and C: three convex cubics and three vertices.

    Curve i goes from vertex i to vertex i + 1 (modulo 3).
    """
    return shapes.planar_loop([RationalBezier(points) for points in PLANAR_CONTROL])


def leaf() -> Body:
    """The moving planar body of simulation C: three curves and three vertices, two of them sharp.

    Curve i goes from vertex i to vertex i + 1 (modulo 3).
    """
    pairs = zip(LEAF_CONTROL, LEAF_WEIGHTS, strict=True)
    return shapes.planar_loop([RationalBezier(points, weights) for points, weights in pairs])


def lens_of_patches(radius: float = 1.0, offset: float = 0.45) -> Body:
    """The lens of Fig. 16: the intersection of three balls, each face a biquadratic Bézier patch.

    The body is that of ``so.shapes.lens``, but its faces have the parameters of the paper.
    u = 0 and u = 1 are a face's two edges, v = 0 and v = 1 its vertices, at −z and at +z. The
    curves of constant u are circles through both vertices.

    Parameters
    ----------
    radius : float
        Of the balls [length].
    offset : float
        Of their centres −offset (cos 120°i, sin 120°i, 0), i = 0, 1, 2, from the origin [length].

    Returns
    -------
    Body
        Three faces, three edges, two vertices. Face i belongs to ball i.

    Raises
    ------
    ValueError
        If a number is not positive, or the offset is not below the radius.
    """
    r, c = magnitude(radius, "radius"), magnitude(offset, "offset")
    if c >= r:
        raise ValueError(
            f"Empty lens: offset = {c} is not below radius = {r}, so the balls share no interior."
        )
    points, weights = _face_of_ball(c / r)
    points = r * points - [c, 0.0, 0.0]
    patches = [BezierPatch(points @ _about_z(120.0 * i).T, weights) for i in range(3)]
    return Body.from_patches(patches, name="lens of patches")


def _face_of_ball(offset: float) -> tuple[Array, Array]:
    """Return control points (3, 3, 3) and weights (3, 3) of a face of the unit ball.

    It is centred on +x, between the planes at ±60° to it that meet in the line x = offset, y = 0.

    Notes
    -----
    Stereographic projection from the south pole maps the circles through both poles to rays from
    the origin. The point at distance ρ on the ray of azimuth θ is, in homogeneous coordinates,
    (2 ρ cos θ, 2 ρ sin θ, ρ² − 1; ρ² + 1). With ρ = v/(1 − v) and a rational quadratic arc
    (C, S; w)(u) for θ this is biquadratic. A boost along x, the projective map

        (X, Y, Z; W) ↦ (γ(X + βW), Y, Z; γ(W + βX)),  γ = 1/√(1 − β²),

    maps the sphere to itself and the poles to x = β = offset, z = ∓1/γ; planes through the poles at
    azimuth θ are then at the azimuth atan(γ tan θ) around that line, which must be 60°.
    """
    gamma = 1.0 / math.sqrt((1.0 - offset) * (1.0 + offset))
    half = math.atan(math.sqrt(3.0) / gamma)
    # Bernstein coefficients of the arc in u and of v(1 − v), v² ∓ (1 − v)² in v.
    along = np.array([math.cos(half), 1.0, math.cos(half)])
    across = np.array([-math.sin(half), 0.0, math.sin(half)])
    weight = np.array([1.0, math.cos(half), 1.0])
    bulge, rise, sum_of_squares = (
        np.array(row) for row in ([0.0, 0.5, 0.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0])
    )
    x, y = (2.0 * np.outer(arc, bulge) for arc in (along, across))
    z, w = np.outer(weight, rise), np.outer(weight, sum_of_squares)
    weights = gamma * (w + offset * x)
    points = np.stack([gamma * (x + offset * w), y, z], axis=2) / weights[..., None]
    return points, weights


def _about_z(degrees: float) -> Array:
    """Return the rotation about z."""
    turn = math.radians(degrees)
    return np.array(
        [
            [math.cos(turn), -math.sin(turn), 0.0],
            [math.sin(turn), math.cos(turn), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
