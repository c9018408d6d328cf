"""Bodies of several pieces: the nearest, all local minima, gradients by the body's motion."""

from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest
from scattered import SHAPES, poses_of

import standoff as so
from draws import draws

BALL = so.shapes.sphere(0.5)
TWO = so.compound({"left": BALL, "right": (BALL, (np.eye(3), [2.0, 0.0, 0.0]))})


def at(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def test_the_nearest_piece_is_told_with_the_bounds_of_all() -> None:
    answer = so.World({"two": TWO, "ball": BALL}).distances([at(0.0), at(4.5)])["two", "ball"]
    assert answer.distance == pytest.approx(1.5)
    assert answer.pieces == ("right", "")
    assert answer.lower_bound <= 1.5


def test_every_local_minimum_below_a_distance() -> None:
    world = so.World({"two": TWO, "ball": BALL}, minima=3.0)
    answer = world.distances([at(0.0), at(0.9, 1.5)])
    found = answer.minima(("two", "ball"))
    left, right = np.hypot(0.9, 1.5) - 1.0, np.hypot(1.1, 1.5) - 1.0
    assert [x.distance for x in found] == pytest.approx([left, right])
    assert [x.pieces[0] for x in found] == ["left", "right"]
    assert len(answer.minima(("ball", "two"), below=0.8)) == 1
    assert answer.minima(("ball", "two"))[0].pieces == ("", "left")
    # the nearest alone without
    alone = so.World({"two": TWO, "ball": BALL}).distances([at(0.0), at(0.2, 1.5)])
    assert len(alone.minima(("two", "ball"))) == 1


def test_depth_is_that_of_the_deepest_pair_of_pieces() -> None:
    world = so.World({"two": TWO, "ball": BALL})
    answer = world.distances([at(0.0), at(1.0, 0.0)])["two", "ball"]
    assert answer.distance == pytest.approx(0.0, abs=1e-9)
    answer = world.distances([at(0.0), at(1.3, 0.0)])["two", "ball"]
    assert answer.depth == pytest.approx(0.3)
    assert answer.pieces[0] == "right"
    assert answer.lower_bound <= -0.3 <= answer.upper_bound + 1e-12


def test_gradients_are_by_the_motion_of_the_bodies(rng: np.random.Generator) -> None:
    turned = poses_of(rng, 1, 0.7)[0]
    hand = so.compound({"palm": SHAPES[0], "thumb": (SHAPES[5], turned)})
    world = so.World({"hand": hand, "tool": SHAPES[0]})
    for _ in range(6):
        poses = poses_of(rng, 2, 1.6)
        found = world.distances(poses)["hand", "tool"]
        if found.distance < 0.05:
            continue
        step, numeric = 1e-6, np.zeros(12)
        for k in range(12):
            ends = []
            for sign in (1.0, -1.0):
                moved = poses.copy()
                twist = np.zeros(6)
                twist[k % 6] = sign * step
                side = k // 6
                moved[side, :3, 3] += twist[:3]
                moved[side, :3, :3] = so.Pose.exp(twist[3:]).rotation @ moved[side, :3, :3]
                ends.append(world.distances(moved)["hand", "tool"].distance)
            numeric[k] = (ends[0] - ends[1]) / (2.0 * step)
        assert found.gradient == pytest.approx(numeric, abs=1e-6)


def test_rates_are_those_of_the_bodies(rng: np.random.Generator) -> None:
    world = so.World({"two": TWO, "tool": SHAPES[0]})
    poses, twists = poses_of(rng, 2, 2.5), rng.normal(size=(2, 6))
    found = world.answer(world.start(poses, twists))["two", "tool"]
    if found.distance > 0.0:
        assert found.rate == pytest.approx(float(found.gradient @ twists.ravel()), abs=1e-8)


def off(pose: np.ndarray, defect: float) -> np.ndarray:
    """A pose whose axes are too long, so that R'R is off the identity by the defect."""
    pose = pose.copy()
    pose[:3, :3] *= np.sqrt(1.0 + defect)
    return pose


@pytest.mark.parametrize("placed", [1e-9, 0.999e-9, 0.0])
@pytest.mark.parametrize("given", [1e-9 - 1e-15, 0.999e-9, 1e-9 - 3e-15])
def test_composed_rotations_are_never_refused(
    rng: np.random.Generator, placed: float, given: float
) -> None:
    """Each of the two is let pass by itself, off orthonormal by so much."""
    for _ in range(5):
        turned = off(poses_of(rng, 1, 0.7)[0], 0.999999 * placed)
        hand = so.compound({"palm": SHAPES[0], "thumb": (SHAPES[5], turned)})
        poses = poses_of(rng, 2, 1.0)
        poses[0] = off(poses[0], given)
        world = so.World({"hand": hand, "tool": SHAPES[0]}, within=5.0)
        state = world.start(poses)
        for _ in range(3):
            poses[0, :3, 3] += 0.01
            state, answer = world.step(state, poses)
        thumb = hand.pieces["thumb"].pose
        local = np.eye(4)
        local[:3, :3], local[:3, 3] = thumb.rotation, thumb.translation
        true = min(
            so.distance(SHAPES[0], SHAPES[0], *poses).distance,
            so.distance(SHAPES[5], SHAPES[0], so.Pose.nearest(poses[0] @ local), poses[1]).distance,
        )
        assert answer["hand", "tool"].distance == pytest.approx(true, abs=1e-7)


def test_a_pose_that_is_only_just_let_pass_is_repaired(rng: np.random.Generator) -> None:
    """Composed with a placement it would be off by roundoff more, and be refused."""
    hand = so.compound({"palm": SHAPES[0], "thumb": (SHAPES[5], poses_of(rng, 1, 0.7)[0])})
    world = so.World({"hand": hand, "tool": SHAPES[0]}, within=50.0)
    repaired = 0
    for _ in range(draws(300)):
        poses = poses_of(rng, 2, 1.0)
        poses[0] = off(poses[0], 1e-9 - rng.uniform(0.0, 4e-16))
        repaired += world.start(poses).repaired
    assert 10 < repaired < draws(300)


def test_a_placement_is_a_rotation_to_roundoff(rng: np.random.Generator) -> None:
    turned = off(poses_of(rng, 1)[0], 0.9e-9)
    piece = so.compound({"a": (BALL, turned)}).pieces["a"]
    assert np.abs(piece.pose.rotation.T @ piece.pose.rotation - np.eye(3)).max() < 1e-15
    assert np.abs(piece.pose.rotation - turned[:3, :3]).max() < 1e-9
    quarter = so.Pose([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [1.0, 2.0, 3.0])
    kept = so.compound({"a": (BALL, quarter)}).pieces["a"].pose
    assert np.array_equal(kept.rotation, quarter.rotation)


DISC = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (0.5, 0), (0, 0.5))])


def tilted(angle: float, tilt: float, x: float, y: float) -> np.ndarray:
    """A planar pose off its plane by a tilt that is let pass."""
    pose = at(x, y)
    pose[:3, :3] = so.Pose.exp((0.0, 0.0, angle)).rotation
    pose[0, 2], pose[1, 2], pose[2, 0], pose[2, 1] = tilt, -tilt, tilt, tilt
    return pose


def test_planar_tilts_that_are_let_pass_are_so_where_they_are_composed() -> None:
    two = so.compound({"near": DISC, "off": (DISC, tilted(0.7, 1e-12, 2.0, 3.0))})
    world = so.World({"two": two, "disc": DISC}, within=9.0)
    state = world.start([tilted(-0.4, -1e-12, 0.0, 0.0), tilted(0.2, 1e-12, 5.0, 3.0)])
    for angle in np.linspace(-0.4, 3.0, 20):
        poses = [tilted(angle, 1e-12, 0.0, 0.0), tilted(0.2, 1e-12, 5.0, 3.0)]
        state, answer = world.step(state, poses)
        offs = np.array(
            [np.cos(angle) * 2 - np.sin(angle) * 3, np.sin(angle) * 2 + np.cos(angle) * 3]
        )
        true = min(np.hypot(5.0, 3.0), np.hypot(*(np.array([5.0, 3.0]) - offs))) - 1.0
        assert answer["two", "disc"].distance == pytest.approx(true, abs=1e-9)


def test_planar_placements_are_in_the_plane() -> None:
    with pytest.raises(ValueError, match=r"'up'.*out of the plane z = 0.*z = 0\.1"):
        so.compound({"a": DISC, "up": (DISC, at(1.0, 0.0, 0.1))})
    with pytest.raises(ValueError, match=r"'over'.*turned over"):
        so.compound({"over": (DISC, np.diag([1.0, -1.0, -1.0, 1.0]))})
    # points are spatial, but lie in a planar world's plane
    mast = so.compound({"foot": so.shapes.point(), "top": (so.shapes.point(), at(0.0, 0.0, 1.0))})
    with pytest.raises(ValueError, match=r"'mast\.top'.*out of the plane"):
        so.World({"mast": mast, "disc": DISC})
    so.World({"mast": mast, "ball": BALL})


def test_bad_compounds() -> None:
    with pytest.raises(TypeError, match="mapping of names"):
        so.compound({})
    with pytest.raises(TypeError, match="'a' is 3"):
        so.compound({"a": 3})
    with pytest.raises(TypeError, match="not a string"):
        so.compound({7: BALL})
    with pytest.raises(ValueError, match="'a'"):
        so.compound({"a": (BALL, np.full((4, 4), np.nan))})


def exact_centre(rotation: np.ndarray, shift: np.ndarray, point: list[Fraction]) -> list[Fraction]:
    """R x + p without roundoff."""
    r, p = [[Fraction(float(x)) for x in row] for row in rotation], map(Fraction, shift.tolist())
    return [
        sum(a * x for a, x in zip(row, point, strict=True)) + s for row, s in zip(r, p, strict=True)
    ]


def test_bounds_hold_what_composing_poses_has_lost(rng: np.random.Generator) -> None:
    """Balls on arms so long that the roundoff of their places is above that of their distance."""
    lost = 0
    for _ in range(draws(60)):
        arm = 10.0 ** rng.uniform(2, 6)
        turned = poses_of(rng, 1, 1.0)[0]
        turned[:3, 3] = arm * turned[:3, 0]
        body = so.compound({"ball": (BALL, turned)})
        poses = poses_of(rng, 2, 1.0)
        poses[0, :3, 3] -= poses[0, :3, :3] @ turned[:3, 3]
        poses[1, :3, 3] += [2.0, 0.0, 0.0]
        piece = body.pieces["ball"].pose
        at_piece = exact_centre(
            poses[0, :3, :3], poses[0, :3, 3], list(map(Fraction, piece.translation.tolist()))
        )
        between = [x - Fraction(float(y)) for x, y in zip(at_piece, poses[1, :3, 3], strict=True)]
        with localcontext() as context:
            context.prec = 60
            squares = sum(x * x for x in between)
            root = (Decimal(squares.numerator) / Decimal(squares.denominator)).sqrt()
            true = root - 1
            found = so.World({"body": body, "ball": BALL}).distances(poses)["body", "ball"]
            if found.distance > 0.0:
                assert Decimal(found.lower_bound) <= true <= Decimal(found.upper_bound)
                lost += abs(Decimal(found.distance) - true) > Decimal("1e-13")
    assert lost > 10


def test_derivatives_are_those_of_the_nearest_pieces_by_the_bodies_motions() -> None:
    """Against differences of the gradient in the chart R <- exp(omega) R, p <- p + v."""
    egg, lens = so.shapes.ellipsoid(0.3, 0.2, 0.25), so.shapes.ellipsoid(0.2, 0.1, 0.15)
    dumbbell = so.compound(
        {
            "near": (egg, so.Pose.exp([0.2, 0.1, 0.4], [0.5, 0.2, -0.1])),
            "far": (egg, so.Pose(np.eye(3), [-0.5, 0.0, 0.0])),
        }
    )
    other = so.compound({"only": (lens, so.Pose.exp([0.5, 0.2, 0.1], [-0.3, 0.1, 0.2]))})
    world = so.World({"a": dumbbell, "b": other})
    poses = [so.Pose.exp([0.1, 0.3, -0.2], [0.1, 0.0, 0.0])]
    poses.append(so.Pose.exp([-0.3, 0.1, 0.4], [1.6, 0.4, 0.1]))

    def moved(k: int, way: float) -> list[so.Pose]:
        turn, shift = np.zeros(3), np.zeros(3)
        (shift if k % 6 < 3 else turn)[k % 3] = way
        found = list(poses)
        old = poses[k // 6]
        found[k // 6] = so.Pose(
            so.Pose.exp(turn).rotation @ old.rotation, np.asarray(old.translation) + shift
        )
        return found

    def gap(at: list[so.Pose]) -> so.world.PairAnswer:
        return world.distances(at)["a", "b"]

    found, h = gap(poses).derivatives(), 1e-4
    assert found.smoothness is so.tracking.Smoothness.SMOOTH
    hessian, normal, points = np.empty((12, 12)), np.empty((3, 12)), np.empty((2, 3, 12))
    for k in range(12):
        sides = [gap(moved(k, s * h)) for s in (1, -1)]
        assert found.gradient[k] == pytest.approx(
            (sides[0].distance - sides[1].distance) / (2 * h), abs=1e-7
        )
        normal[:, k] = (sides[0].normal - sides[1].normal) / (2 * h)
        points[0, :, k] = (sides[0].point_a - sides[1].point_a) / (2 * h)
        points[1, :, k] = (sides[0].point_b - sides[1].point_b) / (2 * h)
        hessian[k, k] = (sides[0].distance - 2 * gap(poses).distance + sides[1].distance) / h**2
    np.testing.assert_allclose(found.normal_jacobian, normal, atol=1e-6)
    np.testing.assert_allclose(found.point_jacobians, points, atol=1e-6)
    np.testing.assert_allclose(np.diag(found.hessian), np.diag(hessian), atol=1e-6)
    np.testing.assert_allclose(found.hessian, found.hessian.T, atol=1e-12)
    np.testing.assert_array_equal(gap(poses).hessian, found.hessian)
