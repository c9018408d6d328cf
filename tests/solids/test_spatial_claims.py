"""What an answer in space claims: touching, bounds with the slack, the horizon, heights in closed
form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import ball, bolt, peg, prism, tube, x, y, z
from standoff.bodies import Edge, Face
from standoff.geometry import ConicArc, Line, Plane
from standoff.kernels.body import layout as L
from standoff.kernels.solids import spatial_heights
from standoff.kernels.solids import spatial_layout as S
from standoff.solids import OpenPair, Solid, distance
from standoff.solids.of_pieces import turned
from standoff.solids.spatial import distance as spatial_distance_module
from standoff.solids.spatial.minimum import SearchOptions
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair
from standoff.tracking.status import Status

STILL = so.Pose.identity()
STRAIGHT = np.eye(3)
SLOT = prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)


def test_what_cannot_be_moved_away_is_not_said_to_touch(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball that touches one wall of a slot, with two tolerances to the other one: moved off by
    four it meets that one."""
    monkeypatch.setattr(spatial_distance_module, "depth_bound", lambda pair, tolerance: np.inf)
    tolerance = 1e-10 * (SLOT.size + ball(1.0).size)
    tight = ball(1.0 - tolerance)
    at = so.Pose(STRAIGHT, (1.0 - tolerance, 1.5, 1.5))
    answer = distance(SLOT, tight, STILL, at)
    assert answer.status is Status.WITHIN
    assert answer.lower_bound == -np.inf
    loose = ball(1.0 - 1e3 * tolerance)
    at = so.Pose(STRAIGHT, (1.0 - 1e3 * tolerance, 1.5, 1.5))
    assert distance(SLOT, loose, STILL, at).status is Status.TOUCHING


def test_the_distance_of_a_contact_is_that_of_its_own_points(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Boundaries that cross elsewhere are nearer there than where they touch."""
    pair = PlacedPair(
        as_model(SLOT), as_model(ball(0.5)), STILL, so.Pose(STRAIGHT, (1.0, 0.5, 1.5))
    )
    found = pair.least((S.OUTSIDE, S.OUTSIDE), SearchOptions(1e-9, on_meeting=False))
    crossing, touching = found.best.copy(), found.best.copy()
    crossing[0], touching[0] = 0.0, 8e-11
    found = replace(found, upper=0.0, minima=np.array([crossing, touching]), best=crossing)
    monkeypatch.setattr(
        spatial_distance_module, "is_stationary", lambda pair, place, most: place.distance > 0.0
    )
    told = spatial_distance_module._contacts(pair, found, (S.OUTSIDE, S.OUTSIDE))
    assert told.upper == told.best[0] == 8e-11


def brick(off: float) -> Solid:
    """A unit cube, one of whose vertices is off by a length."""
    corners = np.array([(i, j, k) for k in (0.0, 1.0) for j in (0.0, 1.0) for i in (0.0, 1.0)])
    ends = [(0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4)]
    ends += [(0, 4), (1, 5), (2, 6), (3, 7)]
    edges = [Edge(Line(corners[a], corners[b]), a, b) for a, b in ends]
    rings = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 9, 4, 8], [2, 10, 6, 11], [3, 8, 7, 10], [1, 11, 5, 9]]
    planes = [(0, x, y), (4, x, y), (0, x, z), (2, x, z), (0, y, z), (1, y, z)]
    faces = []
    for ring, (at, u, v) in zip(rings, planes, strict=True):
        loop, here = [], ends[ring[0]][0] if ends[ring[0]][1] in ends[ring[1]] else ends[ring[0]][1]
        for k in ring:
            loop.append((k, 1 if ends[k][0] == here else -1))
            here = ends[k][1] if ends[k][0] == here else ends[k][0]
        faces.append(Face((Plane.through(corners[at], u, v),), tuple(loop)))
    moved = corners.copy()
    moved[7] += off
    return Solid.from_brep(moved, edges, faces, tolerance=1e-4)


def test_bounds_are_wider_by_the_slack() -> None:
    exact, rough = brick(0.0), brick(1e-6)
    assert exact.slack == 0.0
    assert 1e-7 < rough.slack < 1e-5
    at = so.Pose(STRAIGHT, (2.0, 0.2, 0.3))
    plain, answer = (distance(each, ball(0.3), STILL, at) for each in (exact, rough))
    assert answer.slack == rough.slack
    assert answer.upper_bound == answer.distance + rough.slack
    width = plain.upper_bound - plain.lower_bound
    assert answer.upper_bound - answer.lower_bound == pytest.approx(
        width + 2.0 * rough.slack, rel=1e-3
    )
    assert answer.minima[0].lower_bound == pytest.approx(answer.lower_bound, abs=1e-12)
    far = distance(rough, ball(0.3), STILL, at, within=0.1)
    assert far.lower_bound <= 0.1 + 3e-10 * (rough.size + 1.1)
    assert far.slack == rough.slack


def test_beyond_the_horizon_only_that_is_told() -> None:
    a, b, at = bolt(), ball(0.5), so.Pose(STRAIGHT, (4.0, 0.0, 3.5))
    true = distance(a, b, STILL, at).distance
    assert true == pytest.approx(1.5, abs=1e-12)
    far = distance(a, b, STILL, at, within=1.2)
    assert far.status is Status.FAR
    assert 1.2 <= far.lower_bound <= true
    assert far.distance == far.upper_bound == np.inf
    assert np.isnan(far.point_a).all()
    assert far.minima == far.open == ()
    near = distance(a, b, STILL, at, within=1.6)
    assert near.status is Status.CONVERGED
    assert near.distance == pytest.approx(true, abs=1e-12)
    assert distance(a, b, STILL, at, within=true).status is Status.CONVERGED


def test_a_horizon_that_is_not_proven_is_not_far() -> None:
    """Of a peg in its hole no pair within the horizon is found, and little is proven before the
    deadline."""
    a, b = tube(0.5, 0.8, -0.6, 0.6), peg(0.45, -0.7, 0.7)
    few = distance(a, b, STILL, STILL, within=0.04, deadline=1)
    assert few.status is Status.DEADLINE
    assert few.lower_bound < 0.04
    assert few.distance == np.inf
    assert few.open
    assert distance(a, b, STILL, STILL, within=0.04).status is Status.FAR


KINDS = {
    "plane": (L.PLANE, lambda u, v, d: np.stack([u, v, 0 * u])),
    "cylinder": (L.CYLINDER, lambda u, v, d: np.stack([np.cos(u), np.sin(u), v])),
    "cone": (L.CONE, lambda u, v, d: np.stack([v * np.cos(u), v * np.sin(u), v])),
    "torus": (
        L.TORUS,
        lambda u, v, d: np.stack(
            [
                (d[0] + d[1] * np.cos(v)) * np.cos(u),
                (d[0] + d[1] * np.cos(v)) * np.sin(u),
                d[1] * np.sin(v),
            ]
        ),
    ),
}


@pytest.mark.parametrize("name", KINDS)
def test_the_greatest_height_of_a_face_is_that_of_samples(name: str, rng) -> None:
    """Over boxes of parameters of surfaces under affine maps: no sample is higher, and one is
    nearly as high."""
    kind, point = KINDS[name]
    for _ in range(60):
        linear, shift = rng.normal(size=(3, 3)), rng.normal(size=3)
        data = np.array([1.7, 0.6])
        reals = np.zeros(40)
        reals[:9], reals[9:12] = linear.ravel(), shift
        reals[L.SURFACE_DATA : L.SURFACE_DATA + 2] = data
        first = rng.uniform(-3.0, 3.0, size=2)
        wide = rng.uniform(0.05, 6.0, size=2)
        (u0, v0), (u1, v1) = first, first + wide
        n = rng.normal(size=3)
        side = S.Side(None, reals, None, None, None, None)
        box = S.Box(u0, u1, v0, v1)
        known, most = greatest_over(kind, side, n, box)
        u, v = np.meshgrid(np.linspace(u0, u1, 160), np.linspace(v0, v1, 160))
        heights = np.tensordot(n, np.tensordot(linear, point(u, v, data), 1), 1) + n @ shift
        assert known
        assert heights.max() <= most + 1e-12
        if name != "torus":  # there it may be a bound only
            assert most <= heights.max() + 2e-2 * np.abs(heights).max()


def greatest_over(kind: int, side: S.Side, n: np.ndarray, box: S.Box) -> tuple[bool, float]:
    function = spatial_heights.over_face
    return getattr(function, "py_func", function)(kind, side, 0, tuple(n), box)


def test_a_wave_is_highest_within_or_at_an_end(rng) -> None:
    wave = getattr(spatial_heights.wave_max, "py_func", spatial_heights.wave_max)
    for _ in range(200):
        a, b, first = rng.normal(size=3) * [1.0, 1.0, 5.0]
        last = first + rng.uniform(0.0, 7.0)
        t = np.linspace(first, last, 4000)
        heights = a * np.cos(t) + b * np.sin(t)
        assert heights.max() - 1e-12 <= wave(a, b, first, last) <= heights.max() + 1e-5


def test_an_answer_of_the_pair_turned_round_has_its_open_pieces_turned() -> None:
    a, b = SLOT, peg(0.4, 0.5, 3.4)
    answer = distance(a, b, STILL, so.Pose(STRAIGHT, (0.9, 0.8, 0.0)), deadline=300)
    assert answer.open
    other = turned(answer)
    pair: OpenPair = other.open[0]
    np.testing.assert_array_equal(pair.corners_a, answer.open[0].corners_b)
    assert pair.feature_b == answer.open[0].feature_a


def test_an_arc_s_circle_counts_in_full() -> None:
    """The distance of a plane and a disc whose rim is tilted: the rim's lowest point."""
    disc = Solid.from_brep(
        edges=[Edge(ConicArc(h * z, x, y)) for h in (0.0, 0.2)],
        faces=[
            Face((Plane.through(0.0 * z, x, y),), ((0, 1),)),
            Face((Plane.through(0.2 * z, x, y),), ((1, 1),)),
            Face((so.geometry.Cylinder(np.eye(3), np.zeros(3)),), ((0, 1), (1, 1))),
        ],
    )
    c, s = np.cos(0.3), np.sin(0.3)
    tilt = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    slab = prism([(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)], 0.5)
    answer = distance(slab, disc, STILL, so.Pose(tilt, (0.0, 0.0, 1.0)))
    assert answer.distance == pytest.approx(0.5 - s, abs=1e-12)
    assert answer.status is Status.CONVERGED
