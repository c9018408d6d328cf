"""Bodies of n patches between two poles on the axis z."""

from __future__ import annotations

from itertools import pairwise
from numbers import Integral
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.isolines import along_v
from standoff.bodies.topology import Apex, Edge, Face
from standoff.checks.numbers import magnitude, magnitude_or_zero
from standoff.checks.real_numbers import shown
from standoff.errors import BodyError
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, RationalBezier
from standoff.geometry.nurbs import BezierPatch
from standoff.geometry.swept import Revolution
from standoff.typing import Array

# Fewer patches than this would not keep their normals within a hemisphere.
LEAST_PATCHES = 3
# Each is proven separately, in some 10 ms.
MOST_PATCHES = 1000
# If the bulge is below this fraction of half the length, it would be lost in the rounding of the
# arc's distant centre: a rational arc, which has no centre, is used instead.
SLENDER = 0.1


def spindle(radius: float, length: float, patches: int = 3, *, rounding: float = 0.0) -> Body:
    """A circular arc rotated about its chord: smooth except for its two pointed poles.

    Raises BodyError: the arc is a semicircle or more; `patches` is not a whole number from 3 to
    1000. Raises ValueError: a length that is not finite or not positive, a negative rounding.

    Parameters
    ----------
    radius : float
        Of the equator, length, positive and below length / 2 (there it would be a ball).
    length : float
        From pole to pole, length, positive.
    patches : int
        How many equal patches run from pole to pole, 3 to 1000; their seams are smooth.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    bulge, half = _bulge(radius, length, "spindle")
    n = _patches(patches, "spindle")
    rounding = magnitude_or_zero(rounding, "rounding")
    angles = FULL_TURN / n * np.arange(n + 1)
    edges = []
    for angle in angles[:-1]:
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        edges.append(Edge(_meridian(bulge, half, out), 0, 1))
    profile = _meridian(bulge, half, np.array([1.0, 0.0, 0.0]))
    faces = [
        _gore_face(Revolution(profile, low, high), j, n)
        for j, (low, high) in enumerate(pairwise(angles))
    ]
    return Body.from_brep(_poles(half), edges, faces, rounding=rounding, name="spindle")


def gore(radius: float, height: float, patches: int = 4, *, rounding: float = 0.0) -> Body:
    """A cloister vault and its mirror image: every horizontal section is a regular polygon.

    Its sharp edges are circular arcs from pole to pole. Between them are cylindrical patches with
    horizontal rulings. The first edge is in the half-plane y = 0, x >= 0.

    Raises BodyError: the arcs are semicircles or more; `patches` is not a whole number from 3 to
    1000. Raises ValueError: a length that is not finite or not positive, a negative rounding.

    Parameters
    ----------
    radius : float
        Of the edges at the equator, length, positive and below height / 2.
    height : float
        From pole to pole, length, positive.
    patches : int
        Sides of the polygon, 3 to 1000.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    bulge, half = _bulge(radius, height, "gore")
    n = _patches(patches, "gore")
    rounding = magnitude_or_zero(rounding, "rounding")
    arcs = []
    for angle in FULL_TURN / n * np.arange(n):
        points, weights = _rational_arc(bulge, half, np.array([np.cos(angle), np.sin(angle), 0.0]))
        arcs.append(points)
    edges = [Edge(RationalBezier(arc, weights), 0, 1) for arc in arcs]
    faces = []
    for j in range(n):
        control = np.array([arcs[j], arcs[(j + 1) % n]])
        patch = BezierPatch(control, np.array([weights, weights]))
        faces.append(_gore_face(patch, j, n))
    return Body.from_brep(_poles(half), edges, faces, rounding=rounding, name="gore")


def _gore_face(surface: Any, j: int, n: int) -> Face:
    """Face j between the edges j (least u) and j + 1 (greatest u), with poles at the ends of v."""
    u0, u1, v0, v1 = surface.domain
    return Face(
        (surface,),
        ((j, -1), ((j + 1) % n, 1)),
        (Apex(0, v0, u0, u1, side="v0"), Apex(1, v1, u0, u1, side="v1")),
        (along_v(u0), along_v(u1)),
    )


def _meridian(bulge: float, half: float, out: Array) -> Curve:
    """The circular arc from pole to pole through bulge * out, where `out` is a unit vector."""
    if bulge < SLENDER * half:
        return RationalBezier(*_rational_arc(bulge, half, out))
    radius = 0.5 * (half * half + bulge * bulge) / bulge
    centre = bulge - radius
    reach = float(np.arctan2(half, -centre))
    return ConicArc(centre * out, radius * out, [0.0, 0.0, radius], -reach, reach)


def _rational_arc(bulge: float, half: float, out: Array) -> tuple[Array, Array]:
    """Control points and weights of the arc from pole to pole through bulge * out.

    It turns by 2 alpha: its middle control point is where the tangents at the poles meet, its
    middle weight is cos alpha.
    """
    slope = 2.0 * bulge * half / (half * half - bulge * bulge)  # tan alpha
    points = np.array([[0.0, 0.0, -half], half * slope * out, [0.0, 0.0, half]])
    return points, np.array([1.0, 1.0 / np.hypot(1.0, slope), 1.0])


def _poles(half: float) -> Array:
    return np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])


def _bulge(radius: float, length: float, name: str) -> tuple[float, float]:
    bulge, half = magnitude(radius, "radius"), 0.5 * magnitude(length, "length")
    if bulge >= half:
        raise BodyError(
            f"{name}: radius = {bulge} is not below half of the length {2.0 * half}: the arc would "
            "be a semicircle or more. Make it longer, or scale it with body.transformed."
        )
    return bulge, half


def _patches(patches: int, name: str) -> int:
    given: Any = patches
    whole = isinstance(given, Integral) and not isinstance(given, bool)
    if not whole or not LEAST_PATCHES <= given <= MOST_PATCHES:
        raise BodyError(
            f"{name}: patches = {shown(patches)}: give a whole number, at least 3 and at most "
            f"{MOST_PATCHES}."
        )
    return int(patches)
