"""Ready-made bodies: closed, outward, on their surfaces; exact affine images; smooth edges."""

from functools import cache

import numpy as np
import pytest

import standoff as so
from draws import draws as cases
from families import shapes, smooth_bodies
from families.starts import random_face_parameters
from oracles.membership import outside
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_jet,
    chart_normal,
    coedge_parameters,
)
from standoff.kernels.body.trimming import on_face
from standoff.kernels.entries.queries import planar_edge_normal
from standoff_studies.oracles import Affine, unit

MAKERS = {maker.__name__: maker for maker in (*shapes.SOLIDS, shapes.half_space, shapes.loop)}
DRAWS = cases(6)
"""Random bodies of each kind."""
ROUNDING = 1e-13
"""Error of a length over the body's size."""
ASIDE = 1e-6
"""How far beside a trimming curve, in (u, v) of order one, inside and outside are told apart."""


@cache
def drawn(name, seed):
    """A random twin, made once for all tests, and the state of its generator after that."""
    rng = np.random.default_rng([71, seed])
    return MAKERS[name](rng), rng.bit_generator.state


def draws(name):
    """Random twins of one kind, each with its generator."""
    for seed in range(DRAWS):
        twin, state = drawn(name, seed)
        rng = np.random.default_rng(0)
        rng.bit_generator.state = state
        yield twin, rng


def allowed(body):
    return ROUNDING * (body.size if np.isfinite(body.size) else 1.0)


def packed_charts(body):
    """(packed chart, face) of a body."""
    for face in range(body.n_faces):
        first, count = body.ints[body.ints[L.FACES] + L.FACE_STRIDE * face :][:2]
        for chart in range(first, first + count):
            yield int(chart), face


def chart_of(body, face, u, v):
    """The first chart of a face that carries (u, v), as a draw on the face has it."""
    return next(
        c for c, f in packed_charts(body) if f == face and on_face(body.ints, body.reals, c, u, v)
    )


@pytest.mark.parametrize("name", MAKERS)
def test_every_edge_is_used_twice_and_loops_close(name):
    for twin, _ in draws(name):
        body = twin.body
        if body.n_faces:
            senses = [[] for _ in range(body.n_edges)]
            for face in body.face_parts:
                for edge, sense in face.loop:
                    senses[edge].append(sense)
            assert all(sorted(used) == [-1, 1] for used in senses)
        for face in body.face_parts:
            balance = np.zeros(body.n_vertices, dtype=int)
            for edge, sense in face.loop:
                part = body.edge_parts[edge]
                if part.first is not None:
                    balance[part.first] -= sense
                    balance[part.last] += sense
            assert not balance.any()
        for part in body.edge_parts:
            ends = (part.curve.point(part.curve.first), part.curve.point(part.curve.last))
            known = (ends[1], ends[0])
            if part.first is not None:
                known = body.vertex_points[part.first], body.vertex_points[part.last]
            np.testing.assert_allclose(ends, known, atol=10 * allowed(body))
        if body.dimension == 2:
            uses = [v for part in body.edge_parts for v in (part.first, part.last)]
            assert sorted(uses) == sorted([*range(body.n_vertices)] * 2)


@pytest.mark.parametrize("name", MAKERS)
def test_faces_lie_on_the_body_and_face_outward(name):
    """The body's support along a face's normal is attained at the face's point."""
    for twin, rng in draws(name):
        body = twin.body
        for face in range(body.n_faces):
            for _ in range(20):
                u, v = random_face_parameters(body, face, rng)
                chart = chart_of(body, face, u, v)
                x = np.array(chart_jet(body.ints, body.reals, chart, u, v)[0])
                normal = np.array(chart_normal(body.ints, body.reals, chart, u, v))
                if name == "half_space":
                    np.testing.assert_array_equal((normal[2], x[2]), (1.0, 0.0))
                    continue
                assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-15)
                height = twin.shape.support(normal)[0] - body.radius
                assert normal @ x == pytest.approx(height, abs=allowed(body))


@pytest.mark.parametrize("name", MAKERS)
def test_edges_and_vertices_lie_on_the_body(name):
    for twin, rng in draws(name):
        body = twin.body
        for number, part in enumerate(body.edge_parts):
            for t in rng.uniform(part.curve.first, part.curve.last, 10):
                x = part.curve.point(t)
                if body.dimension == 2:
                    feature = body.n_faces + number
                    normal = np.array(planar_edge_normal(body.ints, body.reals, feature, t))
                    height = twin.shape.support(normal)[0]
                    assert normal @ x == pytest.approx(height, abs=allowed(body))
                else:
                    assert abs(outside(twin.shape, x) + body.radius) <= allowed(body)
        if body.dimension == 3:
            for x in body.vertex_points:
                assert abs(outside(twin.shape, x) + body.radius) <= allowed(body)


@pytest.mark.parametrize("name", MAKERS)
def test_samples_lie_on_the_body(name):
    for twin, _ in draws(name):
        body = twin.body
        if name == "half_space" or body.dimension == 2:
            continue
        start, count = body.ints[L.SAMPLE_REALS], body.ints[L.N_SAMPLES]
        rows = body.reals[start : start + L.SAMPLE_STRIDE * count].reshape(count, -1)
        assert count >= 1
        assert max(abs(outside(twin.shape, x) + body.radius) for x in rows[:, :3]) <= allowed(body)
        facing = rows[rows[:, 3:6].any(axis=1)]
        if len(facing):
            heights = (facing[:, :3] * facing[:, 3:6]).sum(axis=1)
            known = twin.shape.support_many(facing[:, 3:6])[0] - body.radius
            np.testing.assert_allclose(heights, known, atol=allowed(body))


@pytest.mark.parametrize("name", [n for n in MAKERS if n not in ("half_space", "loop")])
def test_trimming_curves_have_the_face_on_their_left(name):
    for twin, rng in draws(name):
        body = twin.body
        for chart, _ in packed_charts(body):
            row = body.ints[body.ints[L.CHARTS] + L.CHART_STRIDE * chart :]
            first, count = row[L.CHART_COEDGE], row[L.CHART_N_COEDGES]
            limit = body.reals[row[L.CHART_REALS] + L.LIMIT]
            for coedge in range(first, first + count):
                at = body.ints[L.COEDGES] + L.COEDGE_STRIDE * coedge
                side = body.ints[at + L.COEDGE_SIDE]
                low, high = body.reals[body.ints[at + L.COEDGE_REALS] :][:2]
                for share in rng.uniform(0.1, 0.9, 3):
                    t = low + share * (high - low)
                    u, v, du, dv, depth = coedge_parameters(body.ints, body.reals, coedge, t)
                    if depth <= 0.0 or max(abs(u), abs(v)) > min(limit, 1e3) - 1e-3:
                        continue
                    step = ASIDE * (1 + abs(u) + abs(v)) * unit(np.array([[-dv, du]]))[0] * side
                    assert on_face(body.ints, body.reals, chart, u + step[0], v + step[1])
                    assert not on_face(body.ints, body.reals, chart, u - step[0], v - step[1])


def random_linear(rng, planar):
    """A regular (3, 3) matrix, mirrored in half of the cases; it keeps z = 0 if ``planar``."""
    first, second = (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2))
    # LAPACK's orthogonal factors of a square matrix are all rotations: mirror by hand.
    stretches = np.exp(rng.uniform(-1, 1, 3)) * [1, 1, rng.choice([-1, 1])]
    linear = first @ np.diag(stretches) @ second
    if planar:
        linear[2, :2] = 0.0
        linear[2, 2] = 1.0
    return linear


@pytest.mark.parametrize("name", [n for n in MAKERS if n != "half_space"])
def test_affine_images_are_exact(name):
    for twin, rng in draws(name):
        body, planar = twin.body, twin.body.dimension == 2
        linear = random_linear(rng, planar)
        if body.radius:
            first, _, second = np.linalg.svd(linear)
            linear = 1.7 * first @ second
        shift = rng.normal(size=3) * ([1, 1, 0] if planar else [1, 1, 1])
        image = body.transformed((linear, shift))
        shape = Affine(twin.shape, linear, shift)
        limit = 10 * ROUNDING * (image.size + np.abs(shift).max())
        assert image.check().notes == ()
        assert image.radius == pytest.approx(1.7 * body.radius, rel=1e-15)
        np.testing.assert_allclose(
            image.vertex_points, body.vertex_points @ linear.T + shift, atol=limit
        )
        for ours, theirs in zip(body.edge_parts, image.edge_parts, strict=True):
            for t in rng.uniform(ours.curve.first, ours.curve.last, 3):
                known = linear @ ours.curve.point(t) + shift
                np.testing.assert_allclose(theirs.curve.point(t), known, atol=limit)
        for face in range(body.n_faces):
            u, v = random_face_parameters(body, face, rng)
            chart = chart_of(body, face, u, v)
            assert on_face(image.ints, image.reals, chart, u, v)
            x = np.array(chart_jet(body.ints, body.reals, chart, u, v)[0])
            moved = np.array(chart_jet(image.ints, image.reals, chart, u, v)[0])
            np.testing.assert_allclose(moved, linear @ x + shift, atol=limit)
            normal = np.array(chart_normal(image.ints, image.reals, chart, u, v))
            height = shape.support(normal)[0] - image.radius
            assert normal @ moved == pytest.approx(height, abs=limit)


def test_a_rigid_map_is_a_pose():
    rng = np.random.default_rng(72)
    other = so.shapes.ellipsoid(0.5, 1.0, 0.3)
    for name in ("lens", "cone", "box", "capsule", "cap"):
        body = MAKERS[name](rng).body
        for _ in range(20):
            pose = so.Pose.exp(rng.normal(size=3), 2 * rng.normal(size=3))
            place = so.Pose.exp(rng.normal(size=3), 6 * rng.normal(size=3))
            image = body.transformed((pose.rotation, pose.translation))
            found = so.distance(image, other, so.Pose.identity(), place)
            known = so.distance(body, other, pose, place)
            assert found.status is known.status
            if known.certified:
                assert found.distance == pytest.approx(known.distance, abs=1e-13 * 20)


SMOOTH = {
    "capsule": lambda: (smooth_bodies.capsule(0.4, 1.2), so.shapes.capsule(0.4, 1.2)),
    "rounded box": lambda: (
        smooth_bodies.rounded_box(1.0, 1.4, 0.8, 0.2),
        so.shapes.box(1.0, 1.4, 0.8, rounding=0.2),
    ),
}
"""Bodies in patches that meet smoothly, and the same as swept cores."""
PARTNERS = {
    "lens": so.shapes.lens(1.0, 0.45),
    "point": so.shapes.point(),
    "ellipsoid": so.shapes.ellipsoid(0.5, 1.0, 0.3),
    "box": so.shapes.box(1.0, 1.0, 1.0),
}
SMOOTH_POSES = 1000
TRACKED = 1e-9
"""Error of a tracked distance (length) and normal: the tracker's gap is up to 1e-10 of the size."""


def assert_same(found, known, error=1e-12):
    if known.distance <= 0.0:  # of depths that nearly tie either may be found
        assert found.distance == pytest.approx(known.distance, abs=1e-3 * known.depth + 1e-12)
    elif known.certified:
        assert found.status is known.status
        assert found.distance == pytest.approx(known.distance, abs=error)
        turn = np.linalg.norm(found.normal - known.normal)
        assert turn <= error / min(known.distance, 1.0)


@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_patches_answer_like_swept_cores(name, rng):
    patches, swept = SMOOTH[name]()
    report = patches.check()
    assert report.smooth_edges == report.edges
    seed = int(rng.integers(1 << 31))
    rng = np.random.default_rng(seed)
    for number in range(SMOOTH_POSES):
        other = tuple(PARTNERS.values())[number % len(PARTNERS)]
        pose = so.Pose.exp(rng.normal(size=3), rng.normal(size=3))
        place = so.Pose.exp(2 * rng.normal(size=3), pose.translation + 1.5 * rng.normal(size=3))
        assert_same(
            so.distance(patches, other, pose, place), so.distance(swept, other, pose, place)
        )


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("dt", [1e-3, 33e-3])
def test_smooth_patches_are_tracked_like_swept_cores(name, dt):
    """A lens around a tumbling body: every smooth edge in its way is passed without a restart."""
    trackers = [so.Tracker(body, PARTNERS["lens"], dt=dt) for body in SMOOTH[name]()]
    spin = np.array([0.9, -0.7, 1.3])

    def frame(t):
        place = 2.2 * np.array([np.cos(t), np.sin(t), 0.4 * np.sin(2 * t)])
        velocity = 2.2 * np.array([-np.sin(t), np.cos(t), 0.8 * np.cos(2 * t)])
        poses = so.Pose.exp(spin * t), so.Pose.exp((0, 0.5 * t, 0), place)
        return *poses, (np.zeros(3), spin), (velocity, np.array([0, 0.5, 0]))

    states = [tracker.start(*frame(0.0)) for tracker in trackers]
    restarts, faces = 0, set()
    for k in range(1, round(2 * np.pi / dt) if dt > 0.01 else 1500):
        answers = []
        for index, tracker in enumerate(trackers):
            states[index], answer = tracker.step(states[index], *frame(k * dt))
            answers.append(answer)
        assert answers[0].certified
        assert_same(*answers, error=TRACKED)
        restarts += answers[0].counts.restarts
        faces.add(answers[0].feature_a)
    assert restarts == 0
    assert len(faces) >= 3


def test_a_panel_over_its_charts_seam_is_trimmed_alike():
    swept = so.shapes.box(1.0, 1.4, 0.8, rounding=0.2)
    rng, home, point = np.random.default_rng(74), so.Pose.identity(), so.shapes.point()
    for turn in (2.3, np.pi, -1.9):
        patches = smooth_bodies.rounded_box(1.0, 1.4, 0.8, 0.2, turn=turn)
        for _ in range(100):
            place = so.Pose(np.eye(3), rng.normal(size=3))
            assert_same(
                so.distance(patches, point, home, place), so.distance(swept, point, home, place)
            )


@pytest.mark.parametrize("wrong", [(0,), (3,), tuple(range(12))])
def test_inward_loops_of_smooth_faces_are_turned_and_reported(wrong):
    good = smooth_bodies.capsule(0.4, 1.2)
    faces = [
        so.bodies.Face(face.charts, tuple((edge, -sense) for edge, sense in face.loop))
        if number in wrong
        else face
        for number, face in enumerate(good.face_parts)
    ]
    body = so.Body.from_brep(good.vertex_points, good.edge_parts, faces)
    assert len(body.check().notes) == len(wrong)
    rng, home = np.random.default_rng(73), so.Pose.identity()
    for _ in range(100):
        place = so.Pose(np.eye(3), 1.5 * rng.normal(size=3))
        point = so.shapes.point()
        assert_same(so.distance(body, point, home, place), so.distance(good, point, home, place))
