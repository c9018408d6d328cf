"""Bodies sewn from patches answer like the quadrics that they are."""

import re
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from families import patch_shells as shells
from standoff.geometry import (
    ConicArc,
    Cylinder,
    FormulaSurface,
    ellipsoid_octants,
    ellipsoid_patches,
)
from standoff.geometry.swept import Extrusion, Revolution
from standoff.geometry.torus import Torus
from standoff.kernels.body import layout as L

AXES = (0.7, 1.1, 0.5)
PARTNERS = (
    so.shapes.point(),
    so.shapes.ellipsoid(0.5, 0.9, 0.3),
    so.shapes.box(0.6, 0.9, 0.4),
    so.shapes.lens(0.8, 0.3),
)
POSES = draws(60)
"""Random poses a body; each partner in turn."""


def assert_same_answers(sewn, known, poses=POSES, seed=None):
    """Both bodies are as far from random others, at the same points."""
    rng = np.random.default_rng(seed)
    home, certified = so.Pose.identity(), 0
    for k in range(poses):
        turn = Rotation.random(random_state=rng).as_matrix()
        pose = so.Pose(turn, known.size * rng.normal(size=3))
        other = PARTNERS[k % len(PARTNERS)]
        p, q = so.distance(sewn, other, home, pose), so.distance(known, other, home, pose)
        if q.distance <= 0.0:  # of depths that nearly tie either may be found
            certified += q.certified
            assert p.distance == pytest.approx(q.distance, abs=1e-3 * q.depth + 1e-12), pose
            continue
        assert p.status is q.status, pose
        if q.certified:
            certified += 1
            assert p.distance == pytest.approx(q.distance, abs=1e-12), pose
            np.testing.assert_allclose(p.normal, q.normal, atol=1e-9 / min(q.distance, 1.0))
            if other.name != "box" and known.name == "ellipsoid":  # else not always unique
                np.testing.assert_allclose(p.point_a, q.point_a, atol=1e-9)
                np.testing.assert_allclose(p.point_b, q.point_b, atol=1e-9)
    assert certified > poses // 2


def assert_closed(body, faces=None):
    """Euler's number of a sphere, and nothing for the certificate to subtract."""
    report = body.check()
    assert report.vertices - report.edges + report.faces == 2
    assert faces is None or report.faces == faces
    assert report.closed
    assert report.outward
    assert report.sewing_residual <= 1e-14 * report.size
    assert report.slack == 0.0
    assert all(patch.convex and patch.hemisphere for patch in report.patches)


ELLIPSOID = so.shapes.ellipsoid(*AXES)


@pytest.mark.parametrize("pieces", [1, 2, 3])
def test_gnomonic_charts_make_an_ellipsoid(pieces):
    body = so.Body.from_patches(shells.cube_sphere(pieces, AXES), name="tiles")
    assert_closed(body, 6 * pieces**2)
    assert body.check().smooth_edges == body.n_edges
    assert body.check().notes == ()
    assert body.name == "tiles"
    assert_same_answers(body, ELLIPSOID)


@pytest.mark.parametrize(
    ("make", "faces", "edges", "vertices"),
    [(ellipsoid_patches, 6, 12, 8), (ellipsoid_octants, 8, 12, 6)],
)
def test_rational_patches_make_an_ellipsoid(make, faces, edges, vertices):
    body = so.Body.from_patches(make(*AXES))
    report = body.check()
    assert (report.faces, report.edges, report.vertices) == (faces, edges, vertices)
    assert report.smooth_edges == edges
    assert_closed(body)
    assert {patch.method for patch in report.patches} == {"bernstein"}
    apexes = [len(face.apexes) for face in body.face_parts]
    assert apexes == [0] * 6 if faces == 6 else [1] * 8
    assert_same_answers(body, ELLIPSOID)


def test_six_rectangles_make_a_box():
    body = so.Body.from_patches(shells.box((1.0, 1.4, 0.8)))
    assert_closed(body, 6)
    report = body.check()
    assert report.smooth_edges == 0
    assert report.sharpest.angle == pytest.approx(np.pi / 2, abs=1e-15)
    assert report.flattest.angle == pytest.approx(np.pi / 2, abs=1e-15)
    assert_same_answers(body, so.shapes.box(1.0, 1.4, 0.8))


def test_quadrics_and_rational_patches_meet():
    """Gnomonic charts and rational tiles share sides with different parameters."""
    ours, theirs = shells.cube_sphere(1, AXES), ellipsoid_patches(*AXES)
    patches = [*ours[:2], ours[5]]
    centres = [patch.jet(0.0, 0.0)[0] for patch in patches]
    for patch in theirs:
        u0, u1, v0, v1 = patch.domain
        middle = patch.jet(0.5 * (u0 + u1), 0.5 * (v0 + v1))[0]
        if min(np.linalg.norm(middle - c) for c in centres) > 0.1:
            patches.append(patch)
    body = so.Body.from_patches(patches)
    assert_closed(body, 6)
    kinds = {c for row in body.face_parts for p in row.pcurves for c in [p.kind]}
    assert L.BEZIER in kinds  # a spline where the parameters differ
    assert_same_answers(body, ELLIPSOID)


@pytest.mark.parametrize("skew", [0.3, -0.4])
def test_a_neighbour_with_other_parameters_is_joined_by_splines(skew):
    patches = list(ellipsoid_patches(*AXES))
    patches[2] = shells.reparametrised(patches[2], skew)
    body = so.Body.from_patches(patches)
    report = body.check()
    assert report.sewing_residual <= 2e-12 * report.size
    kinds = [p.kind for p in body.face_parts[2].pcurves]
    assert kinds.count(L.BEZIER) >= 2  # edges that begin on patch 0 or 1
    assert_same_answers(body, ELLIPSOID)


@pytest.mark.parametrize("ratio", [0.4, 3.0])
def test_a_projective_change_of_parameters_keeps_straight_pcurves(ratio):
    patches = list(ellipsoid_patches(*AXES))
    patches[4] = shells.projectively_reparametrised(patches[4], ratio)
    body = so.Body.from_patches(patches)
    assert_closed(body, 6)
    assert {p.kind for face in body.face_parts for p in face.pcurves} == {L.LINE}
    assert_same_answers(body, ELLIPSOID)


@pytest.mark.parametrize(("first", "second"), [(2, 1), (3, 2)])
def test_sides_are_cut_where_others_end(first, second):
    """T-junctions: one tile in first² pieces, its neighbours in second² pieces."""
    fine, coarse = (shells.cube_sphere(n, AXES) for n in (first, second))
    body = so.Body.from_patches(fine[: first**2] + coarse[second**2 :])
    report = body.check()
    assert report.faces == first**2 + 5 * second**2
    assert_closed(body)
    assert_same_answers(body, ELLIPSOID)


def test_a_rational_cylinder_is_cut_at_knots_and_seams():
    body = so.Body.from_patches(shells.cylinder(0.6, 1.4))
    assert_closed(body, 12)
    assert body.check().notes[0].startswith("patch 0: split at u = [0.25, 0.5, 0.75]")
    assert_same_answers(body, so.shapes.cylinder(0.6, 1.4))


def test_closed_quadrics_are_halved_at_their_seams(rng):
    body = so.Body.from_patches(shells.spindle(0.6, 1.2))
    assert_closed(body)
    notes = body.check().notes
    assert any(n.startswith("patch 0: halved") and "closes on itself along u" in n for n in notes)
    home, point = so.Pose.identity(), so.shapes.point()
    for _ in range(60):
        at = 2.0 * rng.normal(size=3)
        r, z = np.hypot(at[0], at[1]), abs(at[2])
        known = distance_from_chain([(0.6, 0.0), (0.6, 0.6), (0.0, 1.2)], np.array([r, z]))
        if r > 0.6 or z > 1.2 - r:
            found = so.distance(body, point, home, so.Pose(np.eye(3), at))
            assert found.certified
            assert found.distance == pytest.approx(known, abs=1e-12)


def distance_from_chain(corners, x):
    """The least distance of a point of the plane from a chain of segments."""
    distances = []
    for a, b in pairwise(np.asarray(corners)):
        share = np.clip((x - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        distances.append(np.linalg.norm(a + share * (b - a) - x))
    return min(distances)


def half_turn(centre, first, second):
    """A quarter of an ellipse about y, turned once round z."""
    return Revolution(ConicArc(centre, first, second, 0.0, 0.5 * np.pi))


def formula_tile(number, axes):
    """A gnomonic tile by formulas, its first parameter stretched."""
    names = "xyz"[number % 3 :] + "xyz"[: number % 3]
    root = "sqrt(1 + sinh(u)**2 + v**2)"
    texts = {names[0]: "sinh(u)", names[1]: "v", names[2]: "1" if number < 3 else "-1"}
    a, b, c = (f"{r!r}*({texts[k]})/{root}" for r, k in zip(axes, "xyz", strict=True))
    reach = float(np.arcsinh(1.0))
    return FormulaSurface(a, b, c, (-reach, reach, -1.0, 1.0))


QUARTERS = [0.5 * np.pi * k for k in range(4)]
KINDS = {
    "a sphere of revolution, pole to pole": (
        lambda: [Revolution(ConicArc((0, 0, 0), (0, 0, -1), (1, 0, 0), 0.0, np.pi))],
        lambda: so.shapes.ellipsoid(1, 1, 1),
        "do not fit an open hemisphere",
    ),
    "two caps and a tube": (
        lambda: [
            half_turn((0, 0, -0.5), (0, 0, -0.4), (0.4, 0, 0)),
            half_turn((0, 0, 0.5), (0.4, 0, 0), (0, 0, 0.4)),
            Cylinder(np.diag([0.4, 0.4, 1.0]), np.zeros(3)).restricted(0, 2 * np.pi, -0.5, 0.5),
        ],
        lambda: so.shapes.capsule(0.4, 1.0),
        "closes on itself along u",
    ),
    "an extruded circle between discs": (
        lambda: [
            Extrusion(ConicArc((0, 0, -0.5), (0.6, 0, 0), (0, 0.6, 0)), (0, 0, 1)),
            shells.turned(((0.6, 0.5), (0.0, 0.5))),
            shells.turned(((0.0, -0.5), (0.6, -0.5))),
        ],
        lambda: so.shapes.cylinder(0.6, 1.0),
        "where it is not C2",
    ),
    "a dome on a square's map of the disc": (
        lambda: [shells.square_disc(), half_turn((0, 0, 0), (1, 0, 0), (0, 0, 1))],
        lambda: so.shapes.cap(1.0, 0.0),
        "closes on itself",
    ),
    "a formula among charts": (
        lambda: [formula_tile(0, AXES), formula_tile(3, AXES), *side_charts()],
        lambda: ELLIPSOID,
        "turned outward",
    ),
}


def side_charts():
    return [p for p in shells.cube_sphere(1, AXES) if abs(p.jet(0.0, 0.0)[0][2]) < 1e-12]


@pytest.mark.parametrize("name", KINDS)
def test_all_kinds_of_surfaces_are_sewn(name):
    make, known, note = KINDS[name]
    body = so.Body.from_patches(make())
    report = body.check()
    assert report.vertices - report.edges + report.faces == 2
    assert report.sewing_residual <= 1e-12
    assert report.slack <= 2e-12
    assert re.search(note, "; ".join(report.notes))
    assert_same_answers(body, known())


def test_a_rounded_puck_is_smooth_all_over(rng):
    """A torus between two discs: points about it are as far as from its disc swept by a ball."""
    tori = [
        Torus(1.0, 0.3, a, a + 0.5 * np.pi, *half)
        for a in QUARTERS
        for half in ((-0.5 * np.pi, 0.0), (0.0, 0.5 * np.pi))
    ]
    lids = [shells.turned(((1.0, 0.3), (0.0, 0.3))), shells.turned(((0.0, -0.3), (1.0, -0.3)))]
    body = so.Body.from_patches([*tori, *lids])
    assert body.check().smooth_edges == body.n_edges
    home = so.Pose.identity()
    for _ in range(100):
        x = 1.5 * rng.normal(size=3)
        known = np.hypot(max(np.hypot(x[0], x[1]) - 1.0, 0.0), x[2]) - 0.3
        if known > 0.0:
            found = so.distance(body, so.shapes.point(), home, so.Pose(np.eye(3), x))
            assert found.certified
            assert found.distance == pytest.approx(known, abs=1e-12)


@pytest.mark.parametrize("wrong", [(1,), (0, 2, 5), tuple(range(6))])
def test_flipped_patches_are_turned_and_reported(wrong):
    patches = list(ellipsoid_patches(*AXES))
    for k in wrong:
        patches[k] = shells.flipped(patches[k])
    body = so.Body.from_patches(patches)
    turned = tuple(f"patch {k}: its x_u cross x_v points inward, turned outward" for k in wrong)
    assert body.check().notes == turned
    assert_closed(body, 6)
    assert_same_answers(body, ELLIPSOID)


def test_order_and_place_of_patches_do_not_matter(rng):
    for k in range(draws(6)):
        turn = Rotation.random(random_state=rng).as_matrix()
        linear = 10.0 ** rng.uniform(-2, 2) * turn @ np.diag(rng.uniform(0.4, 1.5, 3))
        shift = rng.normal(size=3)
        tiles = [*shells.cube_sphere(2), *ellipsoid_octants(1, 1, 1)]
        chosen = tiles[:24] if k % 2 else tiles[24:]
        patches = [chosen[k].transformed(linear, shift) for k in rng.permutation(len(chosen))]
        body = so.Body.from_patches(patches)
        report = body.check()
        assert report.vertices - report.edges + report.faces == 2
        # the roundoff of coordinates, which the shift makes large
        assert report.sewing_residual <= 1e-14 * (report.size + np.linalg.norm(shift))
        moved = so.shapes.ellipsoid(1, 1, 1).transformed((linear, shift))
        other, home = so.shapes.point(), so.Pose.identity()
        for _ in range(10):
            at = so.Pose(np.eye(3), shift + report.size * rng.normal(size=3))
            p, q = so.distance(body, other, home, at), so.distance(moved, other, home, at)
            assert p.status is q.status
            if q.certified:
                scale = report.size + np.linalg.norm(at.translation)
                assert p.distance == pytest.approx(q.distance, abs=1e-13 * scale)


def test_the_affine_image_of_a_sewn_body_is_sewn():
    patches = list(ellipsoid_patches(1, 1, 1))
    patches[2] = shells.reparametrised(patches[2], 0.3)
    body = so.Body.from_patches(patches).transformed(np.diag(AXES))
    assert body.check().sewing_residual <= 1e-12
    assert_same_answers(body, ELLIPSOID)
    mirrored = so.Body.from_patches(shells.box((1, 2, 3))).transformed(np.diag([-1.0, 1, 1]))
    assert_same_answers(mirrored, so.shapes.box(1, 2, 3), poses=20)


def test_a_swept_body_of_patches_is_a_rounded_box():
    body = so.Body.from_patches(shells.box((1.0, 1.4, 0.8)), rounding=0.2)
    assert_same_answers(body, so.shapes.box(1.4, 1.8, 1.2, rounding=0.2))


def test_a_tracker_crosses_the_seams():
    patches = list(ellipsoid_patches(*AXES))
    patches[2] = shells.reparametrised(patches[2], 0.3)
    body = so.Body.from_patches(patches)
    other = so.shapes.ellipsoid(0.4, 0.3, 0.6)
    trackers = [so.Tracker(b, other, dt=5e-3) for b in (body, ELLIPSOID)]

    def frame(t):
        at = 2.0 * np.array([np.cos(t), np.sin(t) * np.cos(0.7 * t), np.sin(0.7 * t) * np.sin(t)])
        return so.Pose.identity(), so.Pose.exp((0, 0.5 * t, 0.2 * t), at)

    states = [tracker.start(*frame(0.0)) for tracker in trackers]
    faces = set()
    for k in range(1, 1200):
        answers = []
        for i, tracker in enumerate(trackers):
            states[i], answer = tracker.step(states[i], *frame(5e-3 * k))
            answers.append(answer)
        assert answers[0].certified
        assert answers[0].distance == pytest.approx(answers[1].distance, abs=1e-9)
        faces.add(answers[0].feature_a)
    assert len(faces) >= 4


def test_many_patches():
    body = so.Body.from_patches(shells.cube_sphere(4, AXES))
    assert_closed(body, 96)
    assert_same_answers(body, ELLIPSOID, poses=12)
