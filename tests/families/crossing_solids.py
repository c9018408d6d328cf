"""Solids whose boundary crosses itself, or just does not, by what they are made of."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from standoff.bodies import Boundary, Edge, Face
from standoff.geometry import Cylinder, Line, NurbsSurface, RationalBezier, Revolution, Torus
from standoff.typing import Array
from standoff_studies.soak import solid_parts
from standoff_studies.soak.solid_outlines import Arc, Outline, Segment

X, Y, Z = np.eye(3)
QUARTER = 0.5 * math.pi


def prism(half: Array, low: float, high: float, first: int) -> tuple[Array, list[Edge], list[Face]]:
    """Vertices, edges and faces of a prism over a square, numbered from `first`: its bottom, its
    top, its four sides."""
    return solid_parts._prism(half, low, high, first)


def pocket(depth: float) -> Boundary:
    """A box of 2 x 2 x 1 with a square pocket of half width 0.4 from its top: face 0 is the
    bottom, 6 the pocket's floor, 7 to 10 its walls."""
    points, edges, faces = prism(solid_parts.square(1.0), 0.0, 1.0, 0)
    more = prism(solid_parts.square(0.4), 1.0 - depth, 1.0, len(points))
    top = Face(faces[1].charts, (*faces[1].loop, *more[2][1].loop))
    every = [faces[0], top, *faces[2:], more[2][0], *more[2][2:]]
    return Boundary.from_brep(
        np.concatenate([points, more[0]]), edges + more[1], every, name="pocket"
    )


def cavity(centre: tuple[float, float], half: float) -> Boundary:
    """A cube of half width 1 with a square cavity of a half width about a point: faces 6 to 11."""
    points, edges, faces = prism(solid_parts.square(1.0), -1.0, 1.0, 0)
    more = prism(solid_parts.square(half) + np.asarray(centre), -0.5, 0.5, len(points))
    return Boundary.from_brep(
        np.concatenate([points, more[0]]), edges + more[1], faces + more[2], name="cavity"
    )


def hook(leg: float, bend: float = 0.5, radius: float = 0.2) -> Boundary:
    """A rod bent by three quarters of a turn, with straight legs: they meet where they are longer
    than bend - radius."""
    turn = 3.0 * QUARTER
    patches = [
        Torus(bend, radius, u, u + 0.5 * turn, v, v + math.pi)
        for v in (-QUARTER, QUARTER)
        for u in (0.0, 0.5 * turn)
    ]
    out, along = np.array([0.0, -1.0, 0.0]), X
    for axes, origin in (
        (np.column_stack([X, Z, -Y]), bend * X),
        (np.column_stack([out, -Z, along]), bend * out),
    ):
        for half in (-QUARTER, QUARTER):
            over = (half, half + math.pi, 0.0, leg)
            patches.append(Cylinder(axes @ np.diag([radius, radius, 1.0]), origin, over))
            rim = Revolution(Line([0, 0, leg], [radius, 0, leg]), half, half + math.pi)
            patches.append(rim.transformed(axes, origin))
    return Boundary.from_patches(patches, name="hook")


def bezier(net: Array, weights: Array | None = None) -> NurbsSurface:
    knots = [[0.0] * n + [1.0] * n for n in np.shape(net)[:2]]
    return NurbsSurface(net, *knots, weights)


def dented_wedge(dent: float) -> Boundary:
    """A wedge under z = x / 2 over the unit square, whose top (face 0) is pressed down in its
    middle by `dent` times the middle Bernstein product; above 1.5 it crosses the bottom
    (face 1), away from the edge x = 0 that both have in common."""
    grid = np.linspace(0.0, 1.0, 5)
    top = np.array([[[x, y, 0.5 * x] for y in grid] for x in grid])
    top[2, 2, 2] -= dent
    a, b, c, d = ([x, y, 0.0] for x in (0.0, 1.0) for y in (0.0, 1.0))
    e, f = [1.0, 0.0, 0.5], [1.0, 1.0, 0.5]
    sides = [[[a, b], [c, d]], [[c, d], [e, f]], [[a, a], [c, e]], [[b, b], [d, f]]]
    patches = [bezier(top), *(bezier(np.array(side)) for side in sides)]
    return Boundary.from_patches(patches, name="wedge")


def wedge_top(x: float, y: float, dent: float) -> float:
    """The height of its top."""
    return 0.5 * x - dent * 36.0 * (x * (1.0 - x) * y * (1.0 - y)) ** 2


def goblet(middle: float) -> Boundary:
    """Turned: a groove of half a circle about (1, 1/2), then a cone from its upper end (1, 1) to
    (0.3, middle): below 1 the cone cuts the groove again."""
    arc = Arc(np.array([1.0, 0.5]), 0.5, -QUARTER, -3.0 * QUARTER)
    corners = np.array([[1.0, 1.0], [0.3, middle], [0.0, middle]])
    lid = [Segment(p, q) for p, q in pairwise(corners)]
    foot = Segment(np.zeros(2), np.array([1.0, 0.0]))
    return solid_parts.turned(Outline([foot, arc, *lid]), "goblet")


def looped_tube(rise: float, radius: float = 0.1) -> Boundary:
    """A tube of NURBS along a cubic that crosses itself, seen from above, at x = 1/2; each control
    section is `rise` above the one before."""
    path = np.array([[0.0, 0.0, 0.0], [3.0, 2.0, 0.0], [-2.0, 2.0, 0.0], [1.0, 0.0, 0.0]])
    path[:, 2] = rise * np.arange(4)
    first = math.atan2(2.0, 3.0)
    angles = np.linspace(first, 2.0 * math.pi - first, 4) + QUARTER
    outward = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(4)])
    corner = math.sqrt(0.5)
    round_it = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    patches = []
    for k in range(4):
        quarter = np.array(round_it[2 * k : 2 * k + 3], dtype=float)
        net = path[:, None] + radius * (
            quarter[None, :, :1] * outward[:, None] + quarter[None, :, 1:] * Z
        )
        weights = np.tile([1.0, corner, 1.0], (4, 1))
        patches.append(bezier(net, weights))
        for end in (0, -1):
            cap = np.array([[path[end]] * 3, net[end]])
            patches.append(bezier(cap, weights[:2]))
    return Boundary.from_patches(patches, name="looped tube")


def crossing_profile(pull: float) -> Boundary:
    """Turned: a disc with a raised ring whose profile, a cubic, makes a loop where `pull` is above
    0.4."""
    control = np.array([[0.6, 0.0], [1.0 + pull, 1.2], [1.0 - pull, 1.2], [1.4, 0.0]])
    ring = Revolution(RationalBezier(np.insert(control, 1, 0.0, axis=1)))
    corners = [(1.4, 0.0), (1.4, -0.5), (0.0, -0.5)]
    lines = [((0.0, 0.0), (0.6, 0.0)), *pairwise(corners)]
    turned = [Revolution(Line([p[0], 0.0, p[1]], [q[0], 0.0, q[1]])) for p, q in lines]
    return Boundary.from_patches([ring, *turned], name="ring")
