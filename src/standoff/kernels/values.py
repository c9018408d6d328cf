"""The values that kernels pass to each other, each with unit and frame; none is ever changed.

Everything stands in A's frame. A feature is a number among a body's faces, edges and vertices; a
chart is an absolute number, -1 for an edge or a vertex, which have none.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.compiler.decorators import kernel

Vector = tuple[float, float, float]

ORIGIN = (0.0, 0.0, 0.0)
STILL = (ORIGIN, ORIGIN, ORIGIN)  # (p, v, w) of A in its own frame
NO_RATES = (0.0, 0.0, 0.0, 0.0)
NO_CHART = np.int64(-1)


class Pair(NamedTuple):
    """Two packed bodies (``layout``), as pointers."""

    ints_a: Any
    reals_a: Any
    ints_b: Any
    reals_b: Any


class Pose(NamedTuple):
    """B's pose: x -> R x + p."""

    R: tuple[float, ...]  # 9 numbers by rows
    p: Vector  # length


class Motion(NamedTuple):
    """B's pose and twist, A at rest."""

    pose: Pose
    v: Vector  # of B's origin, length/s
    w: Vector  # rad/s


class Place(NamedTuple):
    """The witness points: a feature of each body, and where on it."""

    feature_a: int
    chart_a: int
    feature_b: int
    chart_b: int
    u: float  # on A: (u, v) of a face, u of an edge
    v: float
    r: float  # on B: (r, s) of a face, r of an edge
    s: float


class Side(NamedTuple):
    """One body's part of a place."""

    feature: int
    chart: int
    p: float
    q: float


class Hit(NamedTuple):
    """How much of a step fits, and what boundary stops it (``trimming``)."""

    s: float  # part of the step, at most 1
    kind: int
    index: int  # of the coedge, or the edge's end
    t: float  # parameter of the coedge or the edge


class Work(NamedTuple):
    """What is written on the way: counts and log of ``events``, as pointers; and the polytope that
    the frame before has kept, and the one that this frame keeps (``pair.polytope_layout``)."""

    counts: Any
    events: Any
    last_polytope: Any
    polytope: Any  # may be the same


class Found(NamedTuple):
    """Witness points and what is proven of them; lengths are those of the cores."""

    outcome: int  # of ``certified``
    place: Place
    distance: float  # signed
    lower: float  # at most the distance
    upper: float  # at least the distance
    normal: Vector  # unit, from A to B


class Depth(NamedTuple):
    """A direction and how far the bodies stand apart along it."""

    found: bool  # is it a local minimum of the depth?
    distance: float  # signed: less than 0 in penetration, the depth is -distance; nan: not known
    normal: Vector  # unit, from A to B
    place: Place  # points farthest along the normal


@kernel
def side_of(place, body):
    """The part of body 0 (A) or 1 (B)."""
    if body == 0:
        return Side(place.feature_a, place.chart_a, place.u, place.v)
    return Side(place.feature_b, place.chart_b, place.r, place.s)


@kernel
def with_side(place, body, side):
    """The place with one body's part replaced."""
    if body == 0:
        return Place(
            side.feature,
            side.chart,
            place.feature_b,
            place.chart_b,
            side.p,
            side.q,
            place.r,
            place.s,
        )
    return Place(
        place.feature_a, place.chart_a, side.feature, side.chart, place.u, place.v, side.p, side.q
    )


@kernel
def together(a, b):
    """The place of two sides."""
    return Place(a.feature, a.chart, b.feature, b.chart, a.p, a.q, b.p, b.q)


@kernel
def moved(place, s, step):
    """The place a part s of a step of all four parameters farther, on the same features."""
    return Place(
        place.feature_a,
        place.chart_a,
        place.feature_b,
        place.chart_b,
        place.u + s * step[0],
        place.v + s * step[1],
        place.r + s * step[2],
        place.s + s * step[3],
    )


@kernel
def body_of(pair, body):
    """The packed arrays of body 0 (A) or 1 (B)."""
    if body == 0:
        return pair.ints_a, pair.reals_a
    return pair.ints_b, pair.reals_b


@kernel
def of_origin(motion):
    """(p, v, w) of B's origin."""
    return motion.pose.p, motion.v, motion.w


@kernel
def resting(pose):
    """The motion of a body that stands still at a pose."""
    return Motion(pose, ORIGIN, ORIGIN)
