"""Angles of a boundary: dihedral angles along its edges, winding of faces around its vertices.

Both are sampled; extremes along edges are refined by minimisation. The *turn* of an edge is the
angle from one outward normal to the other, positive at a convex edge: the dihedral angle inside
the body is pi minus the turn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from standoff.bodies.charts import normal_noise, surface_normal
from standoff.bodies.orientation import chart_at
from standoff.bodies.packing import Assembled
from standoff.bodies.report import DihedralAngle
from standoff.bodies.tolerances import TURN_NOISE
from standoff.bodies.topology import Apex
from standoff.errors import BodyError
from standoff.geometry.surfaces import Surface
from standoff.long_loops import told
from standoff.motion.vectors import cross
from standoff.typing import Array

# Fractions of an edge at which its turn is sampled.
SHARES = np.linspace(0.0, 1.0, 17)
# The true extreme of a smooth turn differs from the sampled one by at most a few of the
# differences between neighbouring samples.
DOUBT = 4.0
# Faces wind around a vertex once, 2 pi, or at least twice: the threshold between (radians).
MOST_WINDING = 3.0 * np.pi
# Directions sampled along a collapsed side.
APEX_DIRECTIONS = 33


@dataclass(frozen=True)
class EdgeTurns:
    """The least and the greatest turn of an edge, radians, and the parameters where they occur.

    doubt : how far either may be from the true extreme between samples, radians.
    """

    edge: int
    faces: tuple[int, int]
    least: float
    at_least: float
    greatest: float
    at_greatest: float
    doubt: float


def edge_turns(body: Assembled, size: float) -> list[EdgeTurns]:
    """The turns of every edge between two faces, sampled; `size` is the size of the body."""
    users: list[list[int]] = [[] for _ in body.edges]
    for i, face in enumerate(body.faces):
        for j, _ in face.loop:
            users[j].append(i)
    return [
        _sampled(body, size, j, used[0], used[1])
        for j, used in enumerate(told(users, "measuring angles of edges"))
        if len(used) == 2 and used[0] != used[1]
    ]


def _sampled(body: Assembled, size: float, j: int, one: int, other: int) -> EdgeTurns:
    curve = body.edges[j].curve
    flat = all(body.faces[i].charts[0].flat for i in (one, other))
    shares = SHARES[8:9] if flat else SHARES
    times = curve.first + shares * (curve.last - curve.first)
    turns = np.array([_turn(body, size, j, one, other, float(t)) for t in times])
    k, m = int(turns.argmin()), int(turns.argmax())
    doubt = DOUBT * max(_rise(turns, k), _rise(-turns, m))
    least, greatest = float(turns[k]), float(turns[m])
    return EdgeTurns(j, (one, other), least, float(times[k]), greatest, float(times[m]), doubt)


def _rise(values: Array, k: int) -> float:
    """By how much the least value differs from its neighbours, at most."""
    return float(np.abs(values[max(k - 1, 0) : k + 2] - values[k]).max())


def refined(body: Assembled, found: Sequence[EdgeTurns], size: float) -> list[EdgeTurns]:
    """Extremes refined at edges that may be concave or have the least or greatest turn of all."""
    if not found:
        return []
    least = min(e.least for e in found)
    greatest = max(e.greatest for e in found)
    return [
        extremes(body, size, e)
        if e.doubt > TURN_NOISE
        and (e.least - e.doubt < max(least, 0.0) or e.greatest + e.doubt > greatest)
        else e
        for e in told(found, "refining angles of edges")
    ]


def extremes(body: Assembled, size: float, e: EdgeTurns) -> EdgeTurns:
    """An edge's extreme turns, by minimisation near the sampled ones."""
    curve = body.edges[e.edge].curve
    width = (curve.last - curve.first) / (len(SHARES) - 1)

    def best(t: float, sign: float, value: float) -> tuple[float, float]:
        result = scipy.optimize.minimize_scalar(
            lambda s: sign * _turn(body, size, e.edge, *e.faces, float(s)),
            bounds=(max(t - width, curve.first), min(t + width, curve.last)),
            method="bounded",
        )
        if result.fun < sign * value:
            return sign * float(result.fun), float(result.x)
        return value, t

    least, at_least = best(e.at_least, 1.0, e.least)
    greatest, at_greatest = best(e.at_greatest, -1.0, e.greatest)
    return EdgeTurns(e.edge, e.faces, least, at_least, greatest, at_greatest, doubt=0.0)


def _turn(body: Assembled, size: float, j: int, one: int, other: int, t: float) -> float:
    """Angle from face `one`'s outward normal to the other's, positive where the edge is convex.

    A negative angle is moved towards zero by as much as roundoff may turn the normals
    (`normal_noise`).
    """
    tangent = body.edges[j].curve.jet(t)[1]
    length = float(np.linalg.norm(tangent))
    if length == 0.0:
        return 0.0
    chart, u, v = chart_at(body.charts, one, j, t)
    n0 = chart.outward * surface_normal(chart.surface, u, v)
    side = next(c.side for c in chart.coedges if c.edge == j) * chart.outward
    inward = side * cross(n0, tangent / length)
    noise = normal_noise(chart.surface, u, v, size)
    chart, u, v = chart_at(body.charts, other, j, t)
    n1 = chart.outward * surface_normal(chart.surface, u, v)
    turn = float(np.arctan2(-inward @ n1, n0 @ n1))
    if turn < 0.0:
        turn = min(turn + noise + normal_noise(chart.surface, u, v, size), 0.0)
    return turn


def dihedral(body: Assembled, j: int, turn: float, t: float) -> DihedralAngle:
    x, y, z = (float(c) for c in body.edges[j].curve.point(t))
    return DihedralAngle(np.pi - turn, j, t, (x, y, z))


def check_vertices(body: Assembled) -> None:
    """Raise BodyError where the faces wind around a vertex more than once.

    Such a boundary crosses itself somewhere, although all its patches and edges may be convex.
    """
    axes = [np.sum(cone, axis=0) if cone else np.zeros(3) for cone in body.cones]
    total = np.zeros(len(body.vertices))
    for i, face in enumerate(told(body.faces, "checking corners of faces")):
        for vertex, directions in _face_directions(body, i):
            total[vertex] += _swept(directions, axes[vertex])
        for apex in face.apexes:
            total[apex.vertex] += _swept(_generators(face.charts[0], apex), axes[apex.vertex])
    for k in np.flatnonzero(total > MOST_WINDING):
        raise BodyError(
            f"The faces around vertex {k} {body.vertices[k]} wind around it "
            f"{total[k] / (2.0 * np.pi):.2g} times: the boundary crosses itself.",
            part=("vertex", int(k)),
        )


def _face_directions(body: Assembled, i: int) -> Iterator[tuple[int, list[Array]]]:
    """(vertex, directions of the two edges there) at the corners of a face."""
    ends: dict[int, list[Array]] = {}
    for j, _ in body.faces[i].loop:
        edge = body.edges[j]
        for vertex, t, sign in (
            (edge.first, edge.curve.first, 1.0),
            (edge.last, edge.curve.last, -1.0),
        ):
            if vertex is not None:
                ends.setdefault(vertex, []).append(sign * edge.curve.jet(t)[1])
    apexes = {apex.vertex for apex in body.faces[i].apexes}
    for vertex, out in ends.items():
        if vertex not in apexes and len(out) == 2:
            yield vertex, out


def _generators(surface: Surface, apex: Apex) -> list[Array]:
    """Directions that leave a collapsed side, in order."""
    along_u = apex.side[0] == "v"
    ts = [float(t) for t in np.linspace(apex.lo, apex.hi, APEX_DIRECTIONS)]
    spots = [(t, apex.level) if along_u else (apex.level, t) for t in ts]
    return [surface.jet(u, v)[2 if along_u else 1] for u, v in spots]


def _swept(directions: list[Array], axis: Array) -> float:
    """The angle about an axis from the first direction to the last, radians."""
    length = float(axis @ axis)
    if length == 0.0:
        return 0.0
    flat = [d - (d @ axis) / length * axis for d in directions]
    return sum(float(np.arctan2(np.linalg.norm(cross(a, b)), a @ b)) for a, b in pairwise(flat))
