"""Derivatives of answers against closed forms and against differences with Richardson's rule."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from standoff.tracking import Smoothness

SHAPES = so.shapes
PAIRS = {
    "ellipsoids": (SHAPES.ellipsoid(0.5, 0.3, 0.2), SHAPES.ellipsoid(0.2, 0.3, 0.4)),
    "lens and box": (SHAPES.lens(1.0, 0.45), SHAPES.box(0.6, 0.8, 1.0)),
    "capsules": (SHAPES.capsule(0.2, 1.0), SHAPES.capsule(0.3, 0.8)),
    "rounded box and box": (SHAPES.box(1, 1, 1, rounding=0.1), SHAPES.box(0.5, 0.5, 0.5)),
    "cylinder and cone": (SHAPES.cylinder(0.4, 1.0), SHAPES.cone(0.5, 1.0)),
}
GAPS = (1.0, 0.05, 1e-3, 1e-6, -0.05)
STEP = 1e-3
SHARPEST = 10.0
"""Greatest entry of a Hessian: the differences' own error grows with STEP^4 times its powers."""


def moved(pose: np.ndarray, twist: np.ndarray, h: float) -> np.ndarray:
    after = np.eye(4)
    after[:3, :3] = Rotation.from_rotvec(h * twist[3:]).as_matrix() @ pose[:3, :3]
    after[:3, 3] = pose[:3, 3] + h * twist[:3]
    return after


def differences(f: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Central differences of fourth order by the 12 unit twists, in the last axis."""
    steps = STEP * np.eye(12)
    columns = [(8.0 * (f(e) - f(-e)) - (f(2.0 * e) - f(-2.0 * e))) / (12.0 * STEP) for e in steps]
    return np.stack(columns, axis=-1)


def facts(answer: so.Proximity) -> np.ndarray:
    points = answer.point_a, answer.point_b
    return np.concatenate([[answer.distance], answer.normal, *points])


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("name", PAIRS)
def test_derivatives_are_those_of_differences(
    name: str, gap: float, rng: np.random.Generator
) -> None:
    """Wherever the features stay the same within the differences' steps."""
    a, b = PAIRS[name]
    compared = 0
    for _ in range(20):
        pose_a, pose_b = (moved(np.eye(4), rng.normal(size=6), 1.0) for _ in range(2))
        pose_b[:3, 3] += 3.0 * so.distance(a, b, pose_a, pose_b).normal
        first = so.distance(a, b, pose_a, pose_b)
        pose_b[:3, 3] += (gap - first.distance) * first.normal
        here = so.distance(a, b, pose_a, pose_b)
        features = here.feature_a, here.feature_b
        pointed = "vertex" in (kinds := [f.kind for f in features]) and "face" not in kinds
        # a corner on a corner or an edge, where the cores nearly touch, turns within a step
        if not here.certified or (pointed and gap + a.radius + b.radius < 0.05):
            continue

        def at(e: np.ndarray, poses: tuple = (pose_a, pose_b)) -> so.Proximity:
            return so.distance(a, b, moved(poses[0], e[:6], 1.0), moved(poses[1], e[6:], 1.0))

        around = [at(s * e) for e in 2.0 * STEP * np.eye(12) for s in (1.0, -1.0)]
        if any((x.feature_a, x.feature_b) != features for x in around):
            continue
        found = here.derivatives()
        assert found.smoothness is Smoothness.SMOOTH, found.reason
        if np.abs(found.hessian).max() > SHARPEST:
            continue
        slopes = differences(lambda e: facts(at(e)))
        exact = np.vstack([found.gradient, found.normal_jacobian, *found.point_jacobians])
        scale = max(1.0, float(np.abs(found.hessian).max()))
        assert np.abs(slopes[0] - exact[0]).max() <= 1e-8 * scale
        assert np.abs(slopes[1:] - exact[1:]).max() <= 1e-6 * scale
        turned = differences(lambda e: at(e).gradient)
        assert np.abs(0.5 * (turned + turned.T) - found.hessian).max() <= 1e-6 * scale
        compared += 1
        if compared == 2:
            break
    assert compared


@pytest.mark.parametrize("gap", [1.0, 1e-3, 1e-6, 1e-9, -0.1])
def test_spheres(gap: float, rng: np.random.Generator) -> None:
    """d = |p_B - p_A| - r_A - r_B: Hess = (I - n n') / |p_B - p_A| with signs; turns do nothing."""
    a, b = SHAPES.sphere(0.5), SHAPES.sphere(0.3)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    pose_a, pose_b = (moved(np.eye(4), rng.normal(size=6), 1.0) for _ in range(2))
    pose_b[:3, 3] = pose_a[:3, 3] + (0.8 + gap) * n
    found = so.distance(a, b, pose_a, pose_b).derivatives()
    across = (np.eye(3) - np.outer(n, n)) / (0.8 + gap)
    zero = np.zeros((3, 3))
    block = np.block([-across, zero, across, zero])
    np.testing.assert_allclose(found.gradient, [*-n, 0, 0, 0, *n, 0, 0, 0], atol=1e-14)
    np.testing.assert_allclose(found.normal_jacobian, block, atol=1e-13)
    hessian = np.vstack([-block, np.zeros((3, 12)), block, np.zeros((3, 12))])
    np.testing.assert_allclose(found.hessian, hessian, atol=1e-13)
    own = np.block([np.eye(3), np.zeros((3, 9))])
    np.testing.assert_allclose(found.point_jacobians[0], own + 0.5 * block, atol=1e-13)


@pytest.mark.parametrize("gap", [1.0, 1e-6, -0.1])
def test_sphere_and_half_space(gap: float) -> None:
    """d = n·(p_B - p_A) - r: only turns of the half-space bend it."""
    a, b = SHAPES.halfspace(), SHAPES.sphere(0.5)
    pose_b = np.eye(4)
    pose_b[:3, 3] = 0.3, 0.2, 0.0
    start = so.distance(a, b, np.eye(4), pose_b)
    pose_b[:3, 3] += (gap - start.distance) * start.normal
    answer = so.distance(a, b, np.eye(4), pose_b)
    n, p = answer.normal, pose_b[:3, 3]
    expected = np.r_[-n, np.cross(n, p), n, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(answer.gradient, expected, atol=1e-14)
    hessian = answer.hessian
    assert np.abs(hessian[np.ix_([0, 1, 2, 6, 7, 8], [0, 1, 2, 6, 7, 8])]).max() <= 1e-14
    turns = 0.5 * (np.outer(p, n) + np.outer(n, p)) - (n @ p) * np.eye(3)
    np.testing.assert_allclose(hessian[3:6, 3:6], turns, atol=1e-13)


def test_planar_pairs_stay_in_their_plane(rng: np.random.Generator) -> None:
    """Columns of twists out of the plane are zero, the others those of differences."""
    from standoff.geometry import ConicArc

    oval = SHAPES.planar_loop([ConicArc([0.0, 0.0], [1.0, 0.0], [0.0, 0.6])])
    pose_b = np.eye(4)
    pose_b[:3, :3] = Rotation.from_rotvec([0.0, 0.0, 0.4]).as_matrix()
    pose_b[:2, 3] = 2.5, 0.7
    found = so.distance(oval, oval, np.eye(4), pose_b).derivatives()
    out = [2, 3, 4, 8, 9, 10]
    assert not found.gradient[out].any()
    assert not found.hessian[out].any()

    def slope(j: int) -> float:
        def d(h: float) -> float:
            e = h * np.eye(12)[j]
            poses = moved(np.eye(4), e[:6], 1.0), moved(pose_b, e[6:], 1.0)
            return so.distance(oval, oval, *poses).distance

        return (8 * (d(STEP) - d(-STEP)) - (d(2 * STEP) - d(-2 * STEP))) / (12 * STEP)

    for j in set(range(12)) - set(out):
        assert abs(slope(j) - found.gradient[j]) <= 1e-9


def test_equal_depths_have_a_flag() -> None:
    ball = SHAPES.sphere(0.5)
    answer = so.distance(ball, ball, np.eye(4), np.eye(4))
    same = answer.derivatives()
    assert same.smoothness is Smoothness.UNDEFINED
    assert np.isnan(same.gradient).all()
    for name in ("gradient", "hessian", "normal_jacobian", "point_jacobians"):
        with pytest.raises(so.StandoffError, match="not unique"):
            getattr(answer, name)


@pytest.mark.parametrize(("x", "flag"), [(0.5, "ONE_SIDED"), (0.499, "SMOOTH"), (0.6, "SMOOTH")])
def test_a_feature_boundary_has_a_flag(x: float, flag: str) -> None:
    """A point above a box: over its face, over its edge exactly, and beside it."""
    box, point = SHAPES.box(1.0, 1.0, 1.0), SHAPES.sphere(0.1)
    answer = so.distance(box, point, np.eye(4), so.Pose(np.eye(3), [x, 0.1, 1.0]))
    found = answer.derivatives()
    assert found.smoothness is Smoothness[flag]
    assert bool(found.reason) is (flag == "ONE_SIDED")
    if flag == "ONE_SIDED":
        np.testing.assert_allclose(found.gradient[6:9], [0.0, 0.0, 1.0], atol=1e-9)


def hill() -> so.Body:
    """x, y from 0 to 2; its roof, of degree 2 in x, is level up to 1, then falls by (x - 1)²/4."""
    knots = [0.0, 0, 0, 1, 2, 2, 2]
    net = np.array(
        [[[x, y, z] for y in (0, 2)] for x, z in ((0, 0), (0.5, 0), (1.5, 0), (2, -0.25))]
    )
    low = net * [1, 1, 0] + [0, 0, -1.0]
    flat = [0.0, 0, 1, 1]
    walls = [
        so.geometry.NurbsSurface(np.stack([net[:, k], low[:, k]], axis=1), knots, flat)
        for k in (0, 1)
    ]
    ends = [so.geometry.BezierPatch(np.stack([net[k], low[k]], axis=1)) for k in (0, -1)]
    floor = so.geometry.BezierPatch(low[[0, -1]])
    return so.Body.from_patches([so.geometry.NurbsSurface(net, knots, flat), floor, *walls, *ends])


@pytest.mark.parametrize(("x", "flag"), [(1.0, "ONE_SIDED"), (1.001, "SMOOTH"), (0.5, "SMOOTH")])
def test_a_jump_of_the_curvature_has_a_flag(x: float, flag: str) -> None:
    roof, point = hill(), SHAPES.sphere(0.1)
    found = so.distance(roof, point, np.eye(4), so.Pose(np.eye(3), [x, 0.7, 1.0])).derivatives()
    assert found.smoothness is Smoothness[flag]


@pytest.mark.parametrize(("turn", "flag"), [(0.0, "SMOOTH"), (0.5, "SMOOTH"), (1.0, "ONE_SIDED")])
def test_an_apex_has_derivatives_inside_its_normal_cone(turn: float, flag: str) -> None:
    """The cone's sides rise by 2 to 1, so their normals are at atan(2) to the axis."""
    cone, point = SHAPES.cone(0.5, 1.0), SHAPES.point()
    angle = turn * np.arctan(2.0)
    place = [np.sin(angle), 0.0, 0.5 + np.cos(angle)]
    answer = so.distance(cone, point, np.eye(4), so.Pose(np.eye(3), place))
    assert answer.feature_a.kind == "vertex"
    assert answer.derivatives().smoothness is Smoothness[flag]


def test_an_edge_of_an_atlas_has_a_flag() -> None:
    """The rim of a lens, seen along a face's own normal there."""
    lens, point = SHAPES.lens(1.0, 0.45), SHAPES.point()
    away = so.Pose(np.eye(3), [-1.5, 0.3, 0.1])
    first = so.distance(lens, point, np.eye(4), away)
    assert first.feature_a.kind == "edge"
    # the edge's faces are spheres of radius 1: their normals at x are x less their centres
    centres = [
        -0.45 * np.array([np.cos(k), np.sin(k), 0.0]) for k in 2.0 * np.pi / 3.0 * np.arange(3)
    ]
    ways = [first.point_a - c for c in centres]
    own = [way for way in ways if abs(np.linalg.norm(way) - 1.0) < 1e-12]
    assert len(own) == 2
    for way, flag in ((own[0], "ONE_SIDED"), (own[0] + 0.01 * own[1], "SMOOTH")):
        pose = so.Pose(np.eye(3), first.point_a + 0.4 * way)
        answer = so.distance(lens, point, np.eye(4), pose)
        assert np.linalg.norm(answer.point_a - first.point_a) < 1e-9
        assert answer.derivatives().smoothness is Smoothness[flag]


EQUAL = {
    "an ellipsoid about another's centre": (*PAIRS["ellipsoids"], (0.0, 0.0, 0.0), 0.0),
    "a cube, turned about its diagonal, in a cube": (
        SHAPES.box(2, 2, 2),
        SHAPES.box(1, 1, 1),
        (0, 0, 0),
        0.0,
    ),
    "as near to two sides": (
        SHAPES.box(2, 2, 2),
        SHAPES.ellipsoid(0.1, 0.1, 0.2),
        (0.5, 0.5, 0),
        0,
    ),
    "as near to two sides, turned": (
        SHAPES.box(2, 2, 2),
        SHAPES.sphere(0.2),
        (0.6, 0.1, -0.6),
        0.7,
    ),
}


@pytest.mark.parametrize("name", EQUAL)
@pytest.mark.parametrize("off", [0.0, 1e-6])
def test_equal_depths_are_found_and_others_are_not(name: str, off: float) -> None:
    a, b, place, turn = EQUAL[name]
    diagonal = 0.3 if "diagonal" in name else 0.0
    pose_a = moved(np.eye(4), np.array([0.3, 0.1, 0.2, turn, -turn, 0.5 * turn]), 1.0)
    pose_b = pose_a.copy()
    pose_b[:3, :3] = pose_a[:3, :3] @ Rotation.from_rotvec(diagonal * np.ones(3)).as_matrix()
    pose_b[:3, 3] += pose_a[:3, :3] @ (np.array(place) + off * np.array([3.0, 2.0, 1.0]))
    answer = so.distance(a, b, pose_a, pose_b)
    assert answer.distance < 0.0
    flag = answer.derivatives().smoothness
    assert flag is (Smoothness.SMOOTH if off else Smoothness.UNDEFINED)


@pytest.mark.parametrize("name", PAIRS)
def test_depths_alone_are_those_of_one_normal(name: str, rng: np.random.Generator) -> None:
    """The flag and `witness_set`, which descends from 53 directions, agree."""
    a, b = PAIRS[name]
    for _ in range(draws(12)):
        poses = [
            moved(np.eye(4), np.r_[0.2, 0.2, 0.2, 2, 2, 2] * rng.normal(size=6), 1.0) for _ in "ab"
        ]
        answer = so.distance(a, b, *poses)
        if answer.distance < 0.0 and answer.derivatives().smoothness is not Smoothness.ONE_SIDED:
            alone = answer.derivatives().smoothness is Smoothness.SMOOTH
            assert alone is answer.unique
