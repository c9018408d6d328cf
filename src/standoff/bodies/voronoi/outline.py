"""A planar body's boundary as one counterclockwise sequence of smooth arcs.

A *place* on it is (n, u): arc n, where counting continues after the last arc on a path that passes
it, and the arc's own parameter u, which increases counterclockwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.voronoi.tolerances import CORNER_TURN, OUTLINE_SAMPLES
from standoff.errors import BodyError
from standoff.geometry.curves import Curve
from standoff.kernels.body import layout as L
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

Place: TypeAlias = tuple[int, float]

# A closed curve is split into this many pieces, so that no arc meets itself.
PIECES_OF_CLOSED = 4


class BoundaryFoot(NamedTuple):
    """A boundary point: x, outward normal n, unit tangent counterclockwise, all (2,); curvature
    and speed |dx/du|."""

    x: Array
    n: Array
    tangent: Array
    curvature: float
    speed: float


@dataclass(frozen=True)
class Arc(KeepsReadOnly):
    """A smooth piece of an edge: u = sign times the curve's own parameter, from lo to hi."""

    edge: int
    curve: Curve
    sign: float
    lo: float
    hi: float

    def jet(self, u: float) -> tuple[Array, Array, Array]:
        """(x, x_u, x_uu), each (2,)."""
        t = self.sign * u
        # at a knot, a kernel evaluates the span after it; this arc needs the span before it
        last = max(self.sign * self.lo, self.sign * self.hi)
        if t >= last and last < self.curve.last:
            t = np.nextafter(last, -np.inf)
        x, xt, xtt = self.curve.jet(t)
        return x[:2], self.sign * xt[:2], xtt[:2]

    def foot(self, u: float) -> BoundaryFoot:
        x, xu, xuu = self.jet(u)
        speed = float(np.hypot(xu[0], xu[1]))
        tangent = xu / speed
        curvature = (tangent[0] * xuu[1] - tangent[1] * xuu[0]) / speed**2
        normal = np.array([tangent[1], -tangent[0]])
        return BoundaryFoot(x, normal, tangent, float(curvature), speed)

    @cached_property
    def us(self) -> Array:
        return np.linspace(self.lo, self.hi, OUTLINE_SAMPLES)

    @cached_property
    def samples(self) -> tuple[Array, Array, Array]:
        """Points and tangents x_u (m, 2) and curvatures (m,) at `us`."""
        return self.sampled(self.us)

    @cached_property
    def chord(self) -> float:
        """The longest chord between neighbouring samples, length."""
        return float(np.linalg.norm(np.diff(self.samples[0], axis=0), axis=1).max())

    def sampled(self, us: Array) -> tuple[Array, Array, Array]:
        jets = np.array([self.jet(float(u)) for u in us])
        x, xu, xuu = jets[:, 0], jets[:, 1], jets[:, 2]
        cross = xu[:, 0] * xuu[:, 1] - xu[:, 1] * xuu[:, 0]
        return x, xu, cross / np.linalg.norm(xu, axis=1) ** 3


@dataclass(frozen=True)
class ArcOutline(KeepsReadOnly):
    """arcs, counterclockwise; joints[n], the vertex before arc n (-1 for none); turns[n] of the
    normal there, radians; size of the body, length."""

    arcs: tuple[Arc, ...]
    joints: tuple[int, ...]
    turns: tuple[float, ...]
    size: float

    def arc(self, n: int) -> Arc:
        return self.arcs[n % len(self.arcs)]

    def foot(self, place: Place) -> BoundaryFoot:
        return self.arc(place[0]).foot(place[1])

    def corner(self, n: int) -> bool:
        """Is there a corner before arc n?"""
        return self.turns[n % len(self.arcs)] > CORNER_TURN

    def stretches(self, start: Place, stop: Place) -> list[tuple[int, float, float]]:
        """(arc, first u, last u) of the pieces of the path from start to stop."""
        found = []
        for n in range(start[0], stop[0] + 1):
            lo = start[1] if n == start[0] else self.arc(n).lo
            hi = stop[1] if n == stop[0] else self.arc(n).hi
            if lo < hi:
                found.append((n, lo, hi))
        return found


def outline_of(body: Body) -> ArcOutline:
    """The outline of a planar body's core.

    Raises BodyError: the body is not planar.
    """
    if body.dimension != 2:
        raise BodyError(
            f"{body!r} is not planar: only a body with dimension 2 has an outline.", "body", body
        )
    runs = [_arcs_of(body, j) for j in range(body.n_edges)]
    order, joints = _in_order(body, [run[0].sign > 0.0 for run in runs])
    arcs: list[Arc] = []
    vertices: list[int] = []
    for j, vertex in zip(order, joints, strict=True):
        arcs += runs[j]
        vertices += [vertex] + [-1] * (len(runs[j]) - 1)
    turns = [_turn(arcs[n - 1], arc) for n, arc in enumerate(arcs)]
    return ArcOutline(tuple(arcs), tuple(vertices), tuple(turns), float(body.reals[L.SIZE]))


def _arcs_of(body: Body, j: int) -> list[Arc]:
    curve = body.edge_parts[j].curve
    row = int(body.ints[L.EDGES]) + L.EDGE_STRIDE * j
    sign = 1.0 if body.ints[row + L.EDGE_FLAGS] & L.OUTWARD_RIGHT else -1.0
    ends = [float(t) for t in curve.spans()]
    if body.edge_parts[j].first is None and len(ends) == 2:
        ends = [float(t) for t in np.linspace(ends[0], ends[1], PIECES_OF_CLOSED + 1)]
    us = sorted(sign * t for t in ends)
    return [Arc(j, curve, sign, a, b) for a, b in pairwise(us)]


def _in_order(body: Body, forward: Sequence[bool]) -> tuple[list[int], list[int]]:
    """Edges counterclockwise, and the vertex before each."""
    if body.n_edges == 1 and body.edge_parts[0].first is None:
        return [0], [-1]
    starts: dict[int, int] = {}
    for j, edge in enumerate(body.edge_parts):
        start = edge.first if forward[j] else edge.last
        if start is not None:
            starts[start] = j
    order: list[int] = []
    joints: list[int] = []
    vertex: int | None = next(iter(starts))
    for _ in range(body.n_edges):
        if vertex is None or vertex not in starts:
            raise BodyError(
                f"{body!r}: no single loop of curves leads on from vertex {vertex}.", "body", body
            )
        j = starts[vertex]
        order.append(j)
        joints.append(vertex)
        vertex = body.edge_parts[j].last if forward[j] else body.edge_parts[j].first
    return order, joints


def _turn(before: Arc, after: Arc) -> float:
    a, b = before.foot(before.hi).n, after.foot(after.lo).n
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))
