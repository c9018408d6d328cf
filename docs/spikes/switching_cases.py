"""The starts of the switching spike: random bodies, poses, features and parameters, and a judge."""

import sys
from pathlib import Path

import numpy as np
from switching_rules import N_TALLY, descend

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_normal, chart_record, coedge_parameters
from standoff.kernels.body.trimming import on_face
from standoff.kernels.pair.certificate import certify
from standoff.kernels.pair.certified import CERTIFIED
from standoff.kernels.pair.cold_start import FIRST, at_samples, global_query
from standoff.kernels.pair.descent import pair_jets, settle
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, RESTARTS, new_counts
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.values import ORIGIN, Pair, Pose, Side, Work, resting, together

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from oracles.bounds import gap
from oracles.poses import draw_poses, size_of, tilted_pair
from standoff_studies import oracles as support

RIGHT = 1e-9  # gap to an independent bound, of the pair's size, up to which an answer is right
GOAL = 1e-10  # gap at which the certificate accepts, of the pair's size
STARTS_A_POSE = 5
POSES_A_PAIR = 20  # poses before new shapes are drawn
TILTS = (0.0, *(10.0**-k for k in range(9, 1, -1)))


# --- bodies, each with the support function that judges it -----------------------------------


def lengths(rng, count):
    return np.exp(rng.uniform(-1.0, 1.0, count))


def box(rng):
    x = lengths(rng, 3)
    return so.shapes.box(*x), support.Box(*x)


def cylinder(rng):
    x = lengths(rng, 2)
    return so.shapes.cylinder(*x), support.Cylinder(*x)


def cone(rng):
    x = lengths(rng, 2)
    return so.shapes.cone(*x), support.Cone(*x)


def lens(rng):
    r = lengths(rng, 1)[0]
    c = r * rng.uniform(0.05, 0.95)
    return so.shapes.lens(r, c), support.Lens(r, c)


def thin_lens(rng):
    r = lengths(rng, 1)[0]
    c = r * (1.0 - 10.0 ** rng.uniform(-3.0, -1.0))
    return so.shapes.lens(r, c), support.Lens(r, c)


def long_ellipsoid(rng):
    """Ratio of axes up to 100."""
    x = np.exp(rng.uniform(-np.log(10.0), np.log(10.0), 3))
    return so.shapes.ellipsoid(*x), support.Ellipsoid(*x)


def low_cap(rng):
    """Less than a hemisphere: one gnomonic chart, or an atlas where it is nearly a half."""
    r = lengths(rng, 1)[0]
    h = r * rng.uniform(0.05, 0.95)
    return so.shapes.cap(r, h), support.Cap(r, h)


def high_cap(rng):
    """More than a hemisphere: an atlas of charts, trimmed by a circle."""
    r = lengths(rng, 1)[0]
    h = -r * rng.uniform(0.05, 0.95)
    return so.shapes.cap(r, h), support.Cap(r, h)


BODIES = {
    "box": box,
    "cylinder": cylinder,
    "cone": cone,
    "lens": lens,
    "low cap": low_cap,
    "high cap": high_cap,
}


def poses(first, second, tilt, count, rng):
    """Poses of separated pairs; tilted boxes face each other, gaps 1e-4 to 2 sizes."""
    if tilt is None:
        yield from draw_poses(first, second, count, int(rng.integers(1 << 31)))
        return
    for _ in range(count):
        apart = size_of(first, second) * np.exp(rng.uniform(np.log(1e-4), np.log(2.0)))
        yield tilted_pair(first, second, tilt, apart, rng)


# --- random starts ---------------------------------------------------------------------------


def chart_range(body, chart):
    """(low, high) of (u, v) around a chart's part of its face."""
    r = chart_record(body.ints, chart)
    limit = body.reals[body.ints[r + L.CHART_REALS] + L.LIMIT]
    if limit < np.inf:
        return np.array([-limit, -limit]), np.array([limit, limit])
    spots = []
    first, count = body.ints[r + L.CHART_COEDGE], body.ints[r + L.CHART_N_COEDGES]
    for k in range(first, first + count):
        o = body.ints[body.ints[L.COEDGES] + L.COEDGE_STRIDE * k + L.COEDGE_REALS]
        for t in np.linspace(body.reals[o], body.reals[o + 1], 25):
            u, v, _, _, depth = coedge_parameters(body.ints, body.reals, k, t)
            if depth > 0.0:
                spots.append((u, v))
    return np.min(spots, axis=0), np.max(spots, axis=0)


def random_start(body, rng):
    """The side of a kind of feature, then one of the kind, then a point on it."""
    faces, edges, vertices = body.n_faces, body.n_edges, body.n_vertices
    kinds = [k for k, n in enumerate((faces, edges, vertices)) if n]
    kind = kinds[rng.integers(len(kinds))]
    if kind == 2:
        return Side(faces + edges + int(rng.integers(vertices)), -1, 0.0, 0.0)
    if kind == 1:
        edge = int(rng.integers(edges))
        curve = body.edge_parts[edge].curve
        return Side(faces + edge, -1, float(rng.uniform(curve.first, curve.last)), 0.0)
    face = int(rng.integers(faces))
    first, count = body.ints[body.ints[L.FACES] + L.FACE_STRIDE * face :][:2]
    while True:  # rejection; an atlas's chart may see little or nothing of its face
        chart = int(first + rng.integers(count))
        low, high = chart_range(body, chart)
        for _ in range(50):
            u, v = (float(x) for x in rng.uniform(low, high))
            if on_face(body.ints, body.reals, chart, u, v):
                return Side(face, chart, u, v)


# --- one descent and its judgement -----------------------------------------------------------


def faces_away(pair, pose, place):
    """Does a face's outward normal point away from the other witness point?"""
    jet_a, jet_b = pair_jets(pair, pose, place)
    between = np.subtract(jet_b[0], jet_a[0])
    n_a = n_b = ORIGIN
    if place.chart_a >= 0:
        n_a = chart_normal(pair.ints_a, pair.reals_a, place.chart_a, place.u, place.v)
    if place.chart_b >= 0:
        n_b = chart_normal(pair.ints_b, pair.reals_b, place.chart_b, place.r, place.s)
    in_a = np.reshape(pose.R, (3, 3)) @ n_b
    return bool(between @ n_a < 0.0 or between @ in_a > 0.0)


def new_work():
    none = np.zeros(N_POLYTOPE)
    return Work(new_counts(), np.empty(EVENT_COLUMNS * MAX_EVENTS), none, none)


class Case:
    """A pair at a pose, seen from A, with the start of a descent."""

    def __init__(self, body_a, body_b, drawn, rng):
        (self.rotation, origin), (turn, at) = drawn.pose_a, drawn.pose_b
        self.pair = Pair(body_a.ints, body_a.reals, body_b.ints, body_b.reals)
        self.pose = Pose(
            tuple(float(x) for x in (self.rotation.T @ turn).ravel()),
            tuple(float(x) for x in self.rotation.T @ (at - origin)),
        )
        self.drawn, self.size = drawn, body_a.size + body_b.size
        self.start = together(random_start(body_a, rng), random_start(body_b, rng))

    def begin_at_samples(self, i, j):
        """Take samples i of A and j of B as the start."""
        self.start = at_samples(self.pair, i, j)

    def descend(self, rule):
        """(how it ended, place, tally) under a rule."""
        tally = np.zeros(N_TALLY, dtype=np.int64)
        outcome, place = descend(rule, self.pair, self.pose, self.start, new_work(), tally)
        return outcome, place, tally

    def settle(self):
        """(place, counts) of the library's own descent."""
        work = new_work()
        settled = settle(self.pair, resting(self.pose), self.start, 0.0, 0.0, work)
        return settled.place, work.counts

    def certify(self, place):
        """(accepted, distance, normal) by the library's certificate."""
        jet_a, jet_b = pair_jets(self.pair, self.pose, place)
        d, bound, n, _ = certify(self.pair, self.pose, place, (jet_a, jet_b), ORIGIN)
        return bound > 0.0 and d - bound <= GOAL * (self.size + d), d, n

    def restart(self):
        """(accepted, distance, normal, restarts) of the library's global query."""
        work = new_work()
        found = global_query(self.pair, self.pose, FIRST, GOAL, work)
        accepted = found.outcome == CERTIFIED
        return accepted, found.distance, found.normal, int(work.counts[RESTARTS])

    def right(self, d, n):
        """The independent judge: distance d against the supports along n (A's frame)."""
        world = self.rotation @ np.array(n)
        return gap(d, self.drawn.a, self.drawn.b, world) <= RIGHT * self.size


def cases(first, second, tilt, starts, rng, starts_a_pose=STARTS_A_POSE):
    made = 0
    while made < starts:
        (body_a, oracle_a), (body_b, oracle_b) = first(rng), second(rng)
        count = min(POSES_A_PAIR, -(-(starts - made) // starts_a_pose))
        for pose in poses(oracle_a, oracle_b, tilt, count, rng):
            for _ in range(min(starts_a_pose, starts - made)):
                yield Case(body_a, body_b, pose, rng)
                made += 1
