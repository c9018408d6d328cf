"""Spindle, gore, egg, rounded polytope and hull of revolution: their parts, and refusals."""

from functools import cache

import numpy as np
import pytest

import standoff as so
from families import curved_shapes
from families.nurbs_bodies import lens_nets
from oracles.membership import outside
from standoff.geometry import BezierPatch, ConicArc, Line, NurbsCurve, RationalBezier

MAKERS = ("rounded_polytope", "egg", "spindle", "gore", "revolved_hull")
CUBE = [[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]


@cache
def drawn(maker):
    """Random twins of one kind; some take a second each to make."""
    rng = np.random.default_rng(21)
    return [getattr(curved_shapes, maker)(rng) for _ in range(5)]


@pytest.mark.parametrize("maker", MAKERS)
def test_boundary_lies_on_the_oracle(maker):
    """Samples of the packed body are points of the oracle's boundary with its normals."""
    for twin in drawn(maker):
        body = twin.body
        assert body.check().notes == ()
        for number in range(body.n_faces):
            face = body.face_parts[number]
            for edge, _ in face.loop:
                curve = body.edge_parts[edge].curve
                x = curve.point(0.3 * curve.first + 0.7 * curve.last)
                if body.radius == 0.0:
                    assert abs(outside(twin.shape, x)) <= 1e-12 * body.size
                else:
                    assert outside(twin.shape, x) < 0


@pytest.mark.parametrize("maker", MAKERS)
def test_boxes_hold_the_oracle(maker):
    for twin in drawn(maker):
        ends = twin.shape.support_many(np.vstack([np.eye(3), -np.eye(3)]))[0]
        core = np.linalg.norm(ends[:3] + ends[3:] - 2 * twin.body.radius)
        assert twin.body.size - 2 * twin.body.radius >= core * (1 - 1e-12)


def test_parts():
    spindle = so.shapes.spindle(0.4, 2.0, 5)
    assert (spindle.n_faces, spindle.n_edges, spindle.n_vertices) == (5, 5, 2)
    assert spindle.check().smooth_edges == 5
    gore = so.shapes.gore(0.4, 2.0)
    assert (gore.n_faces, gore.n_edges, gore.n_vertices) == (4, 4, 2)
    assert gore.check().smooth_edges == 0
    egg = so.shapes.egg(1.0, 3.0)
    assert (egg.n_faces, egg.check().smooth_edges, egg.n_vertices) == (3, 2, 0)
    rounded = so.shapes.rounded_polytope(CUBE, 0.25)
    assert (rounded.n_faces, rounded.n_vertices, rounded.radius) == (6, 8, 0.25)
    np.testing.assert_allclose(np.abs(rounded.vertex_points), 0.75, atol=1e-15)
    assert so.shapes.rounded_polytope(CUBE, 0).radius == 0


def test_small_faces_vanish_when_rounded():
    """A cube with a corner cut off: the cut is gone when the ball does not reach it."""
    corner = [0.9, 0.9, 0.9]
    cut = [p for p in CUBE if p != [1, 1, 1]] + [[1, 1, 0.9], [1, 0.9, 1], [0.9, 1, 1], corner]
    assert so.shapes.polytope(cut).n_faces == 7
    assert so.shapes.rounded_polytope(cut, 0.01).n_faces == 7
    # the cut's plane moves in by r, the corner of the cube's planes by sqrt(3) r
    assert so.shapes.rounded_polytope(cut, 0.2).n_faces == 6


def test_hull_of_a_ring():
    ring = so.shapes.hull_of_revolution(ConicArc((2, 0, 1), (0.5, 0, 0), (0, 0, 0.3)))
    assert (ring.n_faces, ring.n_edges, ring.check().smooth_edges) == (3, 2, 2)
    top = so.distance(ring, so.shapes.point(), None or np.eye(4), so.Pose(np.eye(3), [0, 0, 3]))
    assert top.distance == pytest.approx(3 - 1.3, abs=1e-14)
    side = so.distance(ring, so.shapes.point(), np.eye(4), so.Pose(np.eye(3), [0, 4, 1]))
    assert side.distance == pytest.approx(1.5, abs=1e-14)


def test_hull_bridges_a_hollow():
    """Two bumps: arc, cone, arc; a dumbbell of equal bumps: a cylinder between them."""
    waist = RationalBezier([(0, 0, -1), (2.5, 0, -1), (-0.9, 0, 0), (2.5, 0, 1), (0, 0, 1)])
    body = so.shapes.hull_of_revolution(waist)
    assert (body.n_faces, body.n_edges, body.n_vertices) == (3, 2, 2)
    assert body.check().smooth_edges == 2
    assert body.check().notes == ()  # the pole at the end of the profile is not a reason to turn
    kinds = {type(face.charts[0]).__name__ for face in body.face_parts}
    assert kinds == {"Revolution", "Cylinder"}
    slanted = RationalBezier([(0, 0, -1), (2.5, 0, -1), (-0.9, 0, 0), (1.5, 0, 1), (0, 0, 1)])
    assert so.shapes.hull_of_revolution(slanted).check().smooth_edges == 2


def test_loops_at_collapsed_sides_are_not_turned():
    """Faces whose loop leaves out a collapsed side, at either end of v, rebuilt as they are."""
    for body in (so.shapes.spindle(0.4, 2.0), so.shapes.gore(0.4, 2.0), _knotted_lens()):
        for matrix in (np.eye(3), -np.eye(3), np.diag([1, 2, 0.5])):
            image = body.transformed((matrix, np.ones(3)))
            assert image.check().notes == ()
            assert image.check().smooth_edges == body.check().smooth_edges


def _knotted_lens():
    """A lens of three patches, one of them cut in two across its collapsed ends."""
    patches = [BezierPatch(n[..., :3] / n[..., 3:], n[..., 3]) for n in lens_nets(1, 0.45)]
    return so.Body.from_patches([patches[0].refined(knots_v=[0.5]), *patches[1:]])


def test_hull_of_a_line_is_a_frustum_or_a_cone():
    frustum = so.shapes.hull_of_revolution(Line((1, 0, 0), (0.5, 0, 1)))
    assert (frustum.n_faces, frustum.n_edges, frustum.n_vertices) == (3, 2, 0)
    for ends in (((1, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 1))):
        cone = so.shapes.hull_of_revolution(Line(*ends))
        assert (cone.n_faces, cone.n_edges, cone.n_vertices) == (2, 1, 1)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: so.shapes.spindle(1, 2), "radius = 1.0 is not below half of the length 2.0"),
        (lambda: so.shapes.spindle(0.5, 2, 2), "patches = 2: give a whole number, at least 3"),
        (lambda: so.shapes.spindle(0.5, 2, 3.5), "patches = 3.5: give a whole number"),
        (lambda: so.shapes.gore(1.5, 2), "gore: radius = 1.5 is not below half"),
        (lambda: so.shapes.gore(-1, 2), "radius = -1.0: must be positive"),
        (lambda: so.shapes.egg(1, 2, 0.71), "egg with taper = 0.71: give -0.7 to 0.7"),
        (lambda: so.shapes.egg(1, 2, np.nan), "taper = nan: must be finite"),
        (lambda: so.shapes.rounded_polytope(CUBE, 1.0), "leaves no core: .* ball has radius 1"),
        (lambda: so.shapes.rounded_polytope(CUBE, 3), "rounding = 3.0 leaves no core"),
        (lambda: so.shapes.rounded_polytope(CUBE, -0.1), "rounding = -0.1: must be zero"),
        (lambda: so.shapes.rounded_polytope(CUBE[:4], 0.1), "span no volume"),
        (lambda: so.shapes.hull_of_revolution(Line((1, 0, 0), (2, 0, 0))), "spans no volume"),
        (lambda: so.shapes.hull_of_revolution(Line((1, 0, 0), (1, 1, 0))), "leaves the plane"),
        (
            lambda: so.shapes.hull_of_revolution(
                NurbsCurve(
                    [(2, 0, 0), (2, 0, 1), (1, 0, 1), (1, 0, -1), (2, 0, -1), (2, 0, 0)],
                    [0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1],
                )
            ),
            "closed NurbsCurve as a profile",
        ),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("slenderness", [1e-2, 1e-4, 1e-6])
def test_slender_spindles_keep_their_girth(slenderness):
    """The rounding of so large an arc's centre would be lost from the bulge."""
    body = so.shapes.spindle(slenderness, 2.0)
    for edge in body.edge_parts:
        curve = edge.curve
        for t in np.linspace(curve.first, curve.last, 9)[1:-1]:
            x, y, z = curve.point(t)
            # intersecting chords: (bulge - r)(R + c + r) = z², R + c = 2 R - bulge
            bulge = slenderness
            drop = z * z / (1.0 / bulge + np.hypot(x, y))
            assert np.hypot(x, y) == pytest.approx(bulge - drop, rel=1e-12)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_hulls_of_revolution_of_any_size(size):
    """A disc's plane has parameters in length units, and no rim as a gnomonic chart has."""
    arc = RationalBezier([(size, 0, 0), (0.5 * size, 0, 0.7 * size), (0, 0, 0.7 * size)])
    body = so.shapes.hull_of_revolution(arc)
    pose = (np.eye(3), (0, 0, 2.7 * size))
    answer = so.distance(body, so.shapes.point(), np.eye(4), pose)
    assert answer.certified
    assert answer.distance == pytest.approx(2.0 * size, rel=1e-12)


@pytest.mark.parametrize(
    "body",
    [
        so.shapes.cylinder(0.5, 2.0),
        so.shapes.cone(0.5, 2.0),
        so.shapes.box(1.0, 2.0, 0.5),
        so.shapes.lens(1.0, 0.45),
    ],
)
def test_flattened_along_any_direction(body):
    """The trimming curves are the body's own: none is found by a nearly singular inverse."""
    direction = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    for thin in (1e-2, 1e-4, 1e-6):
        image = body.transformed(np.eye(3) - (1.0 - thin) * np.outer(direction, direction))
        assert image.check().sewing_residual <= 1e-15 * body.size
        assert image.check().slack == 0.0
