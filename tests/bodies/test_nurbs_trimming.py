"""Faces trimmed by NURBS pcurves: the circle of a cap written as NURBS is the same body."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry import NurbsPcurve, Plane, Sphere, SurfaceCurve

RADIUS, HEIGHT = 1.0, 0.5
ROOT = np.sqrt(0.5)
SQUARE = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]])
WEIGHTS = np.array([1, ROOT, 1, ROOT, 1, ROOT, 1, ROOT, 1])
KNOTS = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], dtype=float)


def circle(radius: float, first: int, last: int) -> NurbsPcurve:
    """Quarters first .. last - 1 of a circle about the origin, by a quadratic; knots count them."""
    rows = slice(2 * first, 2 * last + 1)
    inside = KNOTS[(first < KNOTS) & (last > KNOTS)]
    knots = np.concatenate([[first] * 3, inside, [last] * 3])
    return NurbsPcurve(radius * SQUARE[rows], knots, WEIGHTS[rows])


def nurbs_cap(cuts: tuple[int, ...]) -> so.Body:
    """The cap of so.shapes.cap(1, 0.5), its rim cut into NURBS arcs at the quarters `cuts`."""
    rim = np.sqrt(RADIUS**2 - HEIGHT**2)
    disc = Plane.through([0, 0, HEIGHT], [1, 0, 0], [0, 1, 0])
    ball = Sphere(RADIUS * np.eye(3), np.zeros(3))
    vertices, edges, on_ball = [], [], []
    for k, (first, last) in enumerate(pairwise(cuts)):
        curve = SurfaceCurve(disc, circle(rim, first, last), first, last)
        edges.append(so.bodies.Edge(curve, k, (k + 1) % (len(cuts) - 1)))
        vertices.append(curve.point(first))
        # a gnomonic chart's parameters are x/z and y/z
        on_ball.append(circle(rim / HEIGHT, first, last))
    loop = tuple((k, 1) for k in range(len(edges)))
    back = tuple((k, -1) for k in range(len(edges)))
    faces = [so.bodies.Face((ball,), loop, pcurves=tuple(on_ball)), so.bodies.Face((disc,), back)]
    return so.Body.from_brep(vertices, edges, faces)


@pytest.mark.parametrize("cuts", [(0, 2, 4), (0, 1, 4), (0, 1, 2, 3, 4)], ids=str)
@pytest.mark.parametrize(
    "partner",
    [so.shapes.point(), so.shapes.ellipsoid(1, 0.2, 0.4), so.shapes.box(1, 0.5, 0.2)],
    ids=lambda body: body.name,
)
def test_a_nurbs_rim_changes_no_answer(
    cuts: tuple[int, ...], partner: so.Body, rng: np.random.Generator
) -> None:
    nurbs, whole = nurbs_cap(cuts), so.shapes.cap(RADIUS, HEIGHT)
    certified = 0
    for k in range(300):
        turn = np.eye(3) if k % 4 == 0 else Rotation.random(random_state=rng).as_matrix()
        pose, at = so.Pose(turn), so.Pose(np.eye(3), 1.5 * rng.normal(size=3))
        p, q = so.distance(nurbs, partner, pose, at), so.distance(whole, partner, pose, at)
        assert p.status is q.status, (turn, at.translation, p, q)
        if p.certified:
            certified += 1
            assert abs(p.distance - q.distance) <= 1e-12
            assert p.lower_bound <= q.distance + 1e-14
    assert certified >= 100


WAVE = NurbsPcurve(
    [[0, 0], [1, 2], [2, -2], [3, 2], [4, 0], [5, 3], [3, 5], [0, 4]],
    [0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5],
    [1, 0.5, 2, 1, 3, 1, 0.7, 1],
)
"""A cubic with inflections and a turn of more than 180 degrees."""


def test_pieces_make_up_the_pcurve_and_turn_little() -> None:
    pieces = WAVE.pieces(0.0, 5.0)
    assert pieces[0][1] == 0.0
    assert pieces[-1][2] == 5.0
    for (piece, first, last), (_, then, _) in zip(pieces, [*pieces[1:], pieces[-1]], strict=True):
        assert last == then or piece is pieces[-1][0]
        ts = np.linspace(first, last, 200)
        points = np.array([piece.point(t)[:2] for t in ts])
        np.testing.assert_allclose(points, [WAVE.point(t)[:2] for t in ts], atol=1e-13)
        ways = np.diff(points, axis=0)
        bends = ways[:-1, 0] * ways[1:, 1] - ways[:-1, 1] * ways[1:, 0]
        assert (bends >= -1e-9 * np.abs(bends).max()).all() or (
            bends <= 1e-9 * np.abs(bends).max()
        ).all()
        angles = np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))
        assert np.ptp(angles) < np.pi


@pytest.mark.parametrize(
    ("points", "knots", "weights", "words"),
    [
        ([[0, 0], [1, 1]], [0, 1, 0, 1], None, "knots"),
        ([[0, 0], [1, 1]], [0, 0, 1], None, "degree 0"),
        ([[0, 0], [1, 1]], [0, 0, 1, 1], [1, -1], "positive"),
        ([[0, 0], [np.nan, 1]], [0, 0, 1, 1], None, "control_points"),
        ([[0, 0, 0], [1, 1, 1]], [0, 0, 1, 1], None, "control_points"),
    ],
)
def test_bad_pcurves_are_refused(points, knots, weights, words) -> None:
    with pytest.raises(ValueError, match=words):
        NurbsPcurve(points, knots, weights)
