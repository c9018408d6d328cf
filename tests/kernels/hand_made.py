"""A box of half width 1 and a point, as the kernels take them, with its features by name.

The top's parameters are (u, v) = (-y, x); the edge runs along y = 1 - 2 t at x = z = 1.
"""

import numpy as np
from pointed import pointed

import standoff as so
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, new_counts
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.values import NO_CHART, Pair, Place, Pose, Side, Work, together

BOX, POINT = so.shapes.box(2.0, 2.0, 2.0), so.shapes.point()
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
FACES, EDGES = BOX.n_faces, BOX.n_edges
TOP = next(k for k, f in enumerate(BOX.face_parts) if f.charts[0].jet(0.0, 0.0)[0][2] == 1.0)
FRONT = next(k for k, f in enumerate(BOX.face_parts) if f.charts[0].jet(0.0, 0.0)[0][0] == 1.0)
CORNER_AT = next(k for k, x in enumerate(BOX.vertex_points) if (x == 1.0).all())
CORNER = FACES + EDGES + CORNER_AT


def edge_between(first: tuple, second: tuple) -> int:
    """The feature's number of the box's edge between two corners, in either order."""
    ends = {first, second}
    for k, edge in enumerate(BOX.edge_parts):
        if {tuple(BOX.vertex_points[v]) for v in (edge.first, edge.last)} == ends:
            return FACES + k
    raise LookupError(ends)


EDGE = edge_between((1, 1, 1), (1, -1, 1))
ALONG_X = edge_between((-1, 1, 1), (1, 1, 1))

ON_POINT = Side(np.int64(0), NO_CHART, 0.0, 0.0)


def on_top(x: float, y: float) -> Side:
    return Side(np.int64(TOP), np.int64(TOP), -y, x)


def on_edge(t: float) -> Side:
    return Side(np.int64(EDGE), NO_CHART, t, 0.0)


def at_vertex(k: int) -> Side:
    return Side(np.int64(FACES + EDGES + k), NO_CHART, 0.0, 0.0)


def beside(x: tuple, body: so.Body = BOX) -> tuple[Pair, Pose]:
    """The body at rest and a point at x."""
    both = body.ints, body.reals, POINT.ints, POINT.reals
    pair = Pair(*map(pointed, both))
    return pair, Pose(IDENTITY, tuple(map(float, x)))


def place_of(side: Side) -> Place:
    return together(side, ON_POINT)


def new_work() -> Work:
    polytope = pointed(np.zeros(N_POLYTOPE))
    events = pointed(np.zeros(MAX_EVENTS * EVENT_COLUMNS))
    return Work(pointed(new_counts()), events, polytope, polytope)


def unit(*x: float) -> tuple[float, float, float]:
    return tuple((np.array(x) / np.linalg.norm(x)).tolist())
