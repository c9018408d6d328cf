"""The bounds of motion, against points of the bodies at random configurations in a box.

The oracle's kinematics are those of `robots.trees`, written joint by joint.
"""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from robots.trees import TreeRobot, drawn_body, drawn_pose, drawn_q, drawn_robot, robot_of
from shares import only
from standoff.robots.joints import JointKind
from standoff.robots.motion_bounds import bends, least_way_along, seen_from
from standoff.robots.motions import motions_of
from standoff.robots.sight import Middle, Separations, Sight, closing, gains

KINDS = (
    JointKind.HINGE,
    JointKind.HINGE,
    JointKind.SLIDE,
    JointKind.BALL,
    JointKind.FREE,
    JointKind.CONTINUOUS,
)

Links = list[np.ndarray]

ROUNDING = 1e-13
"""Of the oracle itself [length]."""


def corners_in(frame: np.ndarray, box: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """(8, 3): corners of a core's box, given in the world, in a frame."""
    centre, sides = box
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    return (centre + signs @ sides.T - frame[:3, 3]) @ frame[:3, :3]


def core(robot: TreeRobot, links: Links, piece: int) -> tuple[np.ndarray, np.ndarray]:
    """Centre and half sides (as columns) of a core's box in the world, by the oracle."""
    body = robot.world.model.search.pieces.owners[piece]
    joint = int(robot.geoms.joints[body])
    pose = robot.geoms.placements[body]
    if joint >= 0:
        pose = links[joint] @ pose
    facts = robot.world.model.search.pieces.facts[piece]
    centre, half = facts[13:16], facts[16:19]
    return pose[:3, :3] @ centre + pose[:3, 3], pose[:3, :3] * half


def frame_of(
    robot: TreeRobot, sight: Sight, motion: int, links: Links, q: np.ndarray
) -> np.ndarray:
    """The oracle's pose of the frame that a motion carries, or the world's."""
    if motion < 0:
        return np.eye(4)
    joint = int(sight.watched.motions.joints[motion])
    if int(sight.watched.motions.links[joint]) == motion:
        return links[joint]
    parent = int(robot.joints.parents[joint])  # a free joint's shift, before its turn
    before = np.eye(4) if parent < 0 else links[parent]
    at = int(robot.joints.q_at[joint])
    shift = np.eye(4)
    shift[:3, 3] = q[at : at + 3]
    return before @ robot.joints.placements[joint] @ shift


def in_box(rng: np.random.Generator, robot: TreeRobot, q: np.ndarray, h: np.ndarray) -> np.ndarray:
    """A configuration whose motions are within h of q; often at the bounds."""
    part = rng.uniform(-1.0, 1.0, robot.nv)
    if rng.random() < 0.5:
        part = np.sign(part)
    v = np.zeros(robot.nv)
    for k in range(len(h)):
        at, n = int(motions_of(robot.joints).v_at[k]), int(motions_of(robot.joints).v_count[k])
        direction = part[at : at + n] / max(1.0, np.linalg.norm(part[at : at + n]))
        v[at : at + n] = direction * h[k]
    return robot.kinematics.integrate(q, v)


@pytest.mark.parametrize("seed", only(range(12), range(20)))
def test_no_point_goes_farther_than_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = drawn_robot(rng, int(rng.integers(1, 7)), KINDS)
    sight = Sight(robot)
    n = sight.watched.motions.size
    q, h = drawn_q(rng, robot), rng.uniform(0.0, 1.0, n) * 10.0 ** rng.uniform(-3.0, 0.3)
    pairs = np.arange(sight.pairs)
    frames = sight.frames(q[None])
    ways = np.tile(np.append(h, 0.0), (len(pairs), 1))
    at = np.zeros(len(pairs), dtype=int)
    middle = sight.middle(pairs, frames, at, ways)
    reaches, watched = middle.reaches, sight.watched
    chords = np.where(
        reaches.turns > 0, 2.0 * np.sin(np.minimum(reaches.h, np.pi) / 2.0), reaches.h
    )
    cut = seen_from(_sums(chords * reaches.r_a, chords * reaches.r_b), reaches)
    assert np.array_equal(cut.bound, middle.way)
    normals = rng.normal(size=(len(pairs), 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    along = least_way_along(reaches, normals, middle.seen, middle.half)
    greatest = np.zeros(len(pairs))
    for _ in range(30):
        other = in_box(rng, robot, q, h)
        both = [(robot.kinematics.links(x), x) for x in (q, other)]
        for k in pairs.tolist():
            sides = watched.a[k], watched.b[k]
            if watched.cores.planes[list(sides)].any():
                continue
            chain = watched.chains.frames[watched.chain[k]]
            way = 0.0
            for piece in sides:
                link = int(chain[cut.place[k]])
                ends = [
                    corners_in(frame_of(robot, sight, link, *x), core(robot, x[0], piece))
                    for x in both
                ]
                way += np.linalg.norm(ends[1] - ends[0], axis=1).max()
            greatest[k] = max(greatest[k], way)
            assert way <= middle.way[k] + ROUNDING
            # along a direction that is fixed in its cut's frame
            link = int(chain[along.place[k]])
            before, after = (frame_of(robot, sight, link, *x) for x in both)
            fixed = before[:3, :3].T @ normals[k]
            moved = [
                (corners_in(after, core(robot, both[1][0], p)) @ fixed)
                - (corners_in(before, core(robot, both[0][0], p)) @ fixed)
                for p in sides
            ]
            assert np.max(moved[0]) - np.min(moved[1]) <= along.bound[k] + ROUNDING
    # it is no idle bound either: the best of a few tries comes to a good part of some
    moving = middle.way > 0.0
    if moving.any() and not watched.cores.planes.all():
        assert (greatest[moving] / middle.way[moving]).max() > 0.2


def _sums(on_a: np.ndarray, on_b: np.ndarray) -> np.ndarray:
    none = np.zeros((len(on_a), 1))
    before = np.concatenate([none, np.cumsum(on_b, axis=1)], axis=1)
    behind = np.concatenate([np.cumsum(on_a[:, ::-1], axis=1)[:, ::-1], none], axis=1)
    return before + behind


@pytest.mark.parametrize("seed", range(10))
def test_no_point_is_accelerated_more_than_the_bound(seed: int) -> None:
    """Second differences of points on random straight paths, seen from every link of the chain."""
    rng = np.random.default_rng(100 + seed)
    robot = drawn_robot(rng, int(rng.integers(1, 7)), KINDS[:5])
    sight = Sight(robot)
    motions = sight.watched.motions
    q, v = drawn_q(rng, robot), rng.uniform(-1.0, 1.0, robot.nv)
    step, span = 1e-4, 0.2
    rates = motions.rates(v[None])
    swerves = motions.swerves(rates)
    pairs = np.arange(sight.pairs)
    at = np.zeros(len(pairs), dtype=int)
    ways = np.tile(rates * span, (len(pairs), 1))
    middle = sight.middle(pairs, sight.frames(q[None]), at, ways)
    watched, reaches = sight.watched, middle.reaches
    on_chain = np.take_along_axis(np.tile(rates, (len(pairs), 1)), reaches.chain, axis=1)
    gains = np.take_along_axis(np.tile(swerves, (len(pairs), 1)), reaches.chain, axis=1)
    found = bends(reaches, on_chain, gains)
    for _ in range(5):
        t = rng.uniform(-span + step, span - step)
        three = [robot.kinematics.integrate(q, v * (t + s * step)) for s in (-1, 0, 1)]
        moved = [(robot.kinematics.links(x), x) for x in three]
        for k in pairs.tolist():
            chain = watched.chains.frames[watched.chain[k]]
            sides = watched.a[k], watched.b[k]
            if watched.cores.planes[list(sides)].any():
                continue
            length = int((reaches.chain[k] >= 0).sum())
            for place in range(length + 1):
                total = 0.0
                for piece in sides:
                    x = [
                        corners_in(
                            frame_of(robot, sight, int(chain[place]), *each),
                            core(robot, each[0], piece),
                        )
                        for each in moved
                    ]
                    bend = (x[0] - 2.0 * x[1] + x[2]) / step**2
                    total += np.linalg.norm(bend, axis=1).max()
                assert total <= found[k, place] + 1e-6  # the differences' own roundoff


def test_the_bound_is_exact_of_one_hinge() -> None:
    """A point on a circle: the way is the arc, and the acceleration its own."""
    ball = so.shapes.sphere(0.1)
    arm = np.eye(4)
    arm[0, 3] = 2.0
    robot = robot_of(
        [1], [-1], [np.eye(4)], [[0, 0, 1.0]], [(0, ball, arm)], fixed={"f": (ball, np.eye(4))}
    )
    sight = Sight(robot)
    ways = np.array([[0.1, 0.0]])
    middle = sight.middle(np.array([0]), sight.frames(np.zeros((1, 1))), np.array([0]), ways)
    assert middle.way[0] <= 1e-8  # seen from the arm the fixed ball, on the axis, stands still
    found = bends(middle.reaches, np.array([[3.0]]), np.zeros((1, 1)))
    assert found[0] == pytest.approx([18.0, 0.0], abs=1e-7)


def on_hinges(
    axes: np.ndarray, ends: np.ndarray, normal: np.ndarray, h: np.ndarray
) -> tuple[Middle, Separations]:
    """A point on a chain of hinges that start at ``ends`` and end in the last of them,
    away from a half-space with an inward normal."""
    places = [np.eye(4) for _ in axes]
    for place, step in zip(places, np.diff(ends, axis=0, prepend=np.zeros((1, 3))), strict=False):
        place[:3, 3] = step
    tip = np.eye(4)
    tip[:3, 3] = ends[-1] - ends[-2]
    ball, plane = so.shapes.sphere(0.1), so.shapes.halfspace(-normal, -9.0)
    n = len(axes)
    parents = [*range(-1, n - 1)]
    fixed = {"wall": (plane, np.eye(4))}
    robot = robot_of([1] * n, parents, places, axes, [(n - 1, ball, tip)], fixed=fixed)
    sight = Sight(robot)
    at, ways = np.array([0]), np.append(h, 0.0)[None]
    middle = sight.middle(at, sight.frames(np.zeros((1, n))), at, ways)
    wall_is_b = bool(middle.reaches.only_a[0])
    normals = normal[None] if wall_is_b else -normal[None]
    unknown = np.zeros(1)
    return middle, Separations(unknown, unknown, unknown, normals, np.array([True]))


def turned_by(axis: np.ndarray, angles: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Points (..., 3) turned about an axis by each of their angles, by Rodrigues' formula."""
    cos, sin = np.cos(angles)[..., None], np.sin(angles)[..., None]
    return x * cos + np.cross(axis, x) * sin + axis * (x @ axis)[..., None] * (1.0 - cos)


@pytest.mark.parametrize("seed", only(range(24), range(48)))
def test_along_a_normal_the_bound_holds_on_a_dense_grid(seed: int) -> None:
    """Chains of up to three hinges, each asked at all corners and far inside of its box."""
    rng = np.random.default_rng(300 + seed)
    n = 1 + seed % 3
    axes = rng.normal(size=(n, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    ends = rng.normal(size=(n + 1, 3))
    normal = rng.normal(size=3)
    if seed % 4 > 1:
        normal = np.cross(axes[0], normal)  # the first hinge turns it as far as can be
    normal /= np.linalg.norm(normal)
    h = rng.uniform(0.1, 1.0, n) * 10.0 ** rng.uniform(-2.0, 0.7)
    parts = np.linspace(-1.0, 1.0, (10001, 101, 31)[n - 1])
    grids = np.meshgrid(*[parts * each for each in h], indexing="ij")
    x = np.broadcast_to(ends[-1], (*grids[0].shape, 3))
    for k in range(n - 1, -1, -1):
        x = ends[k] + turned_by(axes[k], grids[k], x - ends[k])
    true = float(((x - ends[-1]) @ normal).max())
    found = float(closing(*on_hinges(axes, ends, normal, h))[0])
    assert true <= found
    if n == 1:  # of one hinge it is exact, but for the grid
        assert true >= found * (1.0 - 2e-3) - 1e-6
    if h.max() < 0.1:
        assert true >= 0.5 * found


def test_a_turn_about_the_normal_takes_nothing() -> None:
    up, ends = np.array([0.0, 0.0, 1.0]), np.array([[0.0, 0, 0], [0, 0, 0.5], [1.0, 0, 0.5]])
    both = on_hinges(np.array([up, [0.0, 1.0, 0.0]]), ends, -up, np.array([3.0, 0.2]))
    assert closing(*both)[0] == pytest.approx(np.sin(0.2), rel=1e-6)
    # so halving it gives nothing back, and halving the other half of it; the way is another matter
    back = gains(*both, both[0].reaches.chain, 2)[0]
    assert back == pytest.approx([0.0, np.sin(0.2) - np.sin(0.1)], abs=1e-6)
    assert gains(both[0], None, both[0].reaches.chain, 2)[0, 0] > 0.3
    still = both[0].reaches._replace(h=np.array([[9.0, 0.0]]))  # more than a turn: nothing to halve
    own = gains(both[0]._replace(reaches=still), None, both[0].reaches.chain, 2)[0]
    assert own[0] > 0.0
    assert own[1] == 0.0


def test_a_joint_that_mimics_another_moves_by_its_ratio() -> None:
    rng = np.random.default_rng(5)
    body = drawn_body(rng)
    robot = robot_of(
        [1, 1],
        [-1, 0],
        [np.eye(4), drawn_pose(rng, 0.3)],
        np.eye(3)[:2],
        [(1, body, np.eye(4))],
        fixed={"f": (body, drawn_pose(rng, 1.0))},
        ratios=[1.0, -2.0],
    )
    assert Sight(robot).watched.motions.rates(np.array([[0.5, 0.25]])).tolist() == [[0.5, 0.5, 0.0]]


def test_a_folded_arm_is_accelerated_more_where_it_unfolds() -> None:
    """At rest its tip is on the first axis; within the box it leaves it."""
    ball, out, back = so.shapes.sphere(0.1), np.eye(4), np.eye(4)
    out[0, 3], back[0, 3] = 1.0, -1.0
    away = np.eye(4)
    away[0, 3] = 9.0
    robot = robot_of(
        [1, 1],
        [-1, 0],
        [np.eye(4), out],
        [[0, 0, 1.0]] * 2,
        [(1, ball, back)],
        fixed={"f": (ball, away)},
    )
    sight = Sight(robot)
    ways = np.array([[1.0, 1.0, 0.0]])
    middle = sight.middle(np.array([0]), sight.frames(np.zeros((1, 2))), np.array([0]), ways)
    rates = np.array([[1.0, 1.0]])
    found = bends(middle.reaches, rates, np.zeros((1, 2)))[0, 0]
    true = abs(-1.0 + 4.0 * np.exp(1j))  # of exp(i t) (1 - exp(i t)) at t = 1
    assert true == pytest.approx(3.56, abs=0.01)
    assert true <= found
    assert middle.way[0] == pytest.approx(2.0 * np.sin(0.5), abs=1e-8)  # the chord of a radian


def test_a_free_joint_of_pinocchio_swerves_no_more_than_the_bound() -> None:
    pin = pytest.importorskip("pinocchio")
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    body = so.shapes.sphere(0.1)
    robot = robot_of([4], [-1], [np.eye(4)], [[0, 0, 0.0]], [(0, body, np.eye(4))])
    motions = motions_of(robot.joints)
    v = np.array([0.7, 0.0, 0.0, 0.0, 0.0, 2.0])
    swerve = motions.swerves(motions.rates(v[None]))[0]
    step = 1e-4
    x = [pin.integrate(model, pin.neutral(model), v * (0.3 + s * step))[:3] for s in (-1, 0, 1)]
    own = np.linalg.norm(x[0] - 2.0 * x[1] + x[2]) / step**2
    assert own == pytest.approx(1.4, rel=1e-5)
    assert swerve.tolist() == pytest.approx([1.4, 0.0, 0.0])
