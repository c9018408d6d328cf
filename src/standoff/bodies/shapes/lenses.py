"""Intersections of balls."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.quadrics import SINGLE_CHART_REACH
from standoff.bodies.tolerances import THIN_LENS
from standoff.bodies.topology import Edge, Face
from standoff.checks.numbers import magnitude, magnitude_or_zero
from standoff.errors import StandoffError
from standoff.geometry.curves import ConicArc
from standoff.geometry.quadrics import Sphere, sphere_atlas
from standoff.typing import Array


def lens(radius: float, offset: float, *, rounding: float = 0.0) -> Body:
    """The paper's body: the intersection of three balls centred `offset` from the origin.

    The centres are -offset (cos 120°i, sin 120°i, 0), i = 0, 1, 2. Three spherical faces, three
    edges, two vertices.

    Raises ValueError: a number that is not finite or not positive; an offset with which the lens is
    empty, too thin or too close to a ball; a rounding that is negative.

    Parameters
    ----------
    radius : float
        Of the balls, length, positive.
    offset : float
        Of their centres from the origin, length, positive and below `radius`; offset / radius
        from 1e-9 to 1 - 1e-9.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    r, c = magnitude(radius, "radius"), magnitude(offset, "offset")
    rounding = magnitude_or_zero(rounding, "rounding")
    if c >= r:
        raise StandoffError(
            f"Empty lens: offset = {c} is not below radius = {r}, so the balls share no interior.",
            "offset",
            c,
        )
    if c < THIN_LENS * r or r - c < THIN_LENS * r:
        raise StandoffError(
            f"lens({r}, {c}): offset / radius must be from {THIN_LENS:g} to 1 - {THIN_LENS:g}; "
            "below it is a ball (so.shapes.sphere), above it is thinner than roundoff."
        )
    top = np.array([0.0, 0.0, np.sqrt((r - c) * (r + c))])
    angles = 2.0 * np.pi / 3.0 * np.arange(3)
    centres = [-c * np.array([np.cos(t), np.sin(t), 0.0]) for t in angles]
    edges, faces = _edges(r, centres, top[2]), _faces(r, centres, c, top[2])
    return Body.from_brep([-top, top], edges, faces, rounding=rounding, name="lens")


def _edges(r: float, centres: list[Array], height: float) -> list[Edge]:
    """Where balls i and i + 1 meet: arcs from the lower vertex to the upper one, at `height`."""
    edges = []
    for i in range(3):
        # on the side opposite the centre of ball i + 2: a circle around the midpoint of the two
        # centres, in their perpendicular bisecting plane
        a, b = centres[i], centres[(i + 1) % 3]
        middle = 0.5 * (a + b)
        out = -middle / np.linalg.norm(middle)
        reach = np.sqrt(r * r - 0.25 * float((a - b) @ (a - b)))
        x_axis, z_axis = reach * out, np.array([0.0, 0.0, reach])
        half = float(np.arctan2(height, float(-middle @ out)))
        edges.append(Edge(ConicArc(middle, x_axis, z_axis, -half, half), 0, 1))
    return edges


def _faces(r: float, centres: list[Array], c: float, height: float) -> list[Face]:
    """The three spherical faces; a large one gets an atlas instead of a single chart."""
    faces = []
    for i in range(3):
        z = -centres[i] / c
        x = np.cross([0.0, 0.0, 1.0], z)
        frame = r * np.column_stack([x, np.array([0.0, 0.0, 1.0]), z])
        charts: tuple[Sphere, ...] = (Sphere(frame, centres[i]),)
        if height / c > SINGLE_CHART_REACH:
            charts = sphere_atlas(frame, centres[i])
        # seen from outside, edge i is at the larger angle about z, edge i - 1 at the smaller
        faces.append(Face(charts, ((i, 1), ((i + 2) % 3, -1))))
    return faces
