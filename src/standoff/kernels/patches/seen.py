"""A body as a patch sees it: along the normal, from the plane that supports it."""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import add, dot, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import edge_jet
from standoff.kernels.compiler.decorators import kernel

# Of a piece of an edge: the edge, and of both ends the parameter, the place across the normal, and
# how far below the supporting plane.
EDGE, FIRST, LAST, SEGMENT_REALS = 0, 1, 5, 9
# Of a vertex, or of a place on an edge: the feature, its parameter and the same; 1 where it is only
# the highest place of its edge.
FEATURE, NODE, PEAK, POINT_REALS = 0, 1, 5, 6
# Of a face: is it near, and if so a place on it.
NEAR, CHART, U, V, FACE_REALS = 0, 1, 2, 3, 4
# Of a node: its parameter, where it is across the normal, and how far below.
T, ACROSS_E, ACROSS_F, BELOW = 0, 1, 2, 3
N_COUNTS = 3
# A curved edge is looked at in so many parts, each cut once more at its highest place.
PARTS = 16


class Seen(NamedTuple):
    """A body in A's frame."""

    ints: Any
    reals: Any
    pose: Any  # of the body in A's frame
    up: Any  # unit, outward: the normal for A, its reverse for B
    base: Any  # the witness point of the core, length
    e: Any  # axes across the normal, the same for both bodies
    f: Any


class Room(NamedTuple):
    """Where what is near of a body is written, as pointers: its counts are those of the pieces of
    edges and of the points, and 1 where some of these stand for a rim that lies there."""

    counts: Any
    segments: Any
    points: Any
    faces: Any


@kernel
def placed(seen, x):
    """A point of the body in A's frame."""
    return add(rotate(seen.pose.R, x), seen.pose.p)


@kernel
def laid(seen, x):
    """(across e, across f, how far below the supporting plane) of a point in A's frame."""
    away = sub(x, seen.base)
    return dot(away, seen.e), dot(away, seen.f), -dot(away, seen.up)


@kernel
def edge_place(seen, feature, t):
    """A point of an edge and its tangent, in A's frame."""
    x, tangent, _ = edge_jet(seen.ints, seen.reals, feature, t)
    return placed(seen, x), rotate(seen.pose.R, tangent)


@kernel
def room_reals(ints):
    """How many numbers a body's room has."""
    edges, points = ints[L.N_EDGES], ints[L.N_VERTICES] + PARTS * ints[L.N_EDGES]
    return (
        2 * PARTS * SEGMENT_REALS * edges
        + POINT_REALS * points
        + FACE_REALS * (ints[L.N_FACES] + 1)
    )
