"""Overlapping pairs that tests of the search of depths share, and hulls over their seeds."""

import math

import numpy as np
from hand_made import new_work
from hand_made_pairs import Placed, Z, ball, box, ellipsoid, pair_of, turn, unit
from hull_making import hull_of
from pointed import pointed

import standoff as so
from standoff.geometry import Line
from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.difference_hull import POINT_REALS
from standoff.kernels.depth.penetration import begin_along, contact_scale
from standoff.kernels.depth.search import seed_hull
from standoff.kernels.pair.events import KEEPING
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.values import Depth, Pose, Work

TOLERANCE = 1e-10
P = (0.4, 0.3, 1.2)
BALLS = Placed(ball(1.0), ball(0.7), P)
WAY = unit(*P)
BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
DEEP = 0.6 + 0.5 - 0.3
"""Of BOXES: along -z. Along x it is 0.4, the least; along y 0.7."""
TURNED = Placed(box(1.0, 0.8, 0.6), box(0.5, 0.4, 0.3), (0.7, 0.2, 0.1), turn((1, 2, 3), 0.9))
EGGS = Placed(
    ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (0.3, 0.2, 0.9), turn((1, 2, 3), 0.9)
)
INSIDE = EGGS.at(0.1, 0.0, 0.05)
ROUND = Placed(box(1.0, 0.8, 0.6), ball(0.5), (0.9, 0.5, -0.3))
CASES = [BALLS, BOXES, TURNED, EGGS, INSIDE, ROUND]
NOTHING = Depth(False, -math.inf, Z, begin_along(*BALLS.both, Z))


def begun(case, n, distance=math.nan):
    return Depth(False, distance, n, begin_along(*case.both, n))


def minimum_below(case, n):
    found = descend(*case.both, begun(case, n), TOLERANCE, new_work())
    assert found.found
    return found


def seeded_hull(case):
    hull = hull_of(np.zeros((0, 3)))
    solid, way = seed_hull(*case.both, hull, contact_scale(case.pair), False)
    return hull, solid, way


def vertices(hull):
    return hull.points.reshape(-1, POINT_REALS)[: hull.sizes[0]]


CORNERS = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
SQUARE = so.shapes.planar_loop(
    [Line(x, y) for x, y in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)]
)


def planar(x, y):
    """Two squares of half width 1, the second at (x, y)."""
    return pair_of(SQUARE, SQUARE), Pose(BOXES.R, (x, y, 0.0))


SOLIDS = [TURNED.a, TURNED.b, EGGS.a, EGGS.b]


def drawn(rng, lift):
    """A turned pair of boxes or ellipsoids, and a direction along which their cores are `lift`
    apart."""
    a, b = (SOLIDS[rng.integers(4)] for _ in range(2))
    R = turn(rng.normal(size=3).tolist(), float(rng.uniform(0.0, 3.0)))
    n = unit(*rng.normal(size=3))
    here = Placed(a, b, (0.0, 0.0, 0.0), R)
    sideways = np.cross(n, rng.normal(size=3)) * 0.1
    p = sideways + (here.depth(n) + lift) * np.array(n)
    return here.at(*p), n


def keeping_work(last):
    """Of a frame that may keep its polytope, and has one kept."""
    work = new_work()
    work.counts[KEEPING] = 1
    return Work(work.counts, work.events, *map(pointed, (last, np.zeros(N_POLYTOPE))))
