"""The first time at which any pair of a world meets, against closed forms."""

import itertools

import numpy as np
import pytest
from scattered import SHAPES
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from families.solid_shapes import ring
from standoff.impact import ImpactStatus
from standoff.motion import ConstantTwist, Offset, PoseSamples, Screw
from standoff.motion.moving import moving
from standoff.tracking.support import sample_points
from standoff.world.impact import Follower
from standoff.world.packed import pieces_of

BALL = so.shapes.sphere(0.5)


def at(x: float, y: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, 0.0
    return pose


def test_the_first_of_several_impacts_with_its_pieces() -> None:
    two = so.compound({"left": BALL, "right": (BALL, at(2.0))})
    world = so.World(
        {"two": two, "near": BALL, "far": BALL, "wall": so.shapes.box((1.0, 1.0, 1.0))},
        fixed={"wall": at(20.0)},
    )
    paths = {
        "two": ConstantTwist(at(0.0), ([1.0, 0, 0], [0, 0, 0])),
        "near": at(8.0),
        "far": at(12),
    }
    found = world.time_of_impact(paths, 20.0)
    assert found.status is ImpactStatus.IMPACT
    assert found.names == ("two", "near")
    assert found.pieces == ("right", "")
    assert found.time <= 5.0
    assert found.time == pytest.approx(5.0, abs=1e-8)
    # the others come near each other later, or never
    assert found.searched == 1
    early = world.time_of_impact(paths, 20.0, clearance=1.0)
    assert early.time == pytest.approx(4.0, abs=1e-8)


def test_among_solids_that_are_not_convex() -> None:
    """One ball goes through a ring, whose hull it meets; the next one comes to the ring itself."""
    ball, hoop = so.shapes.sphere(0.1), ring(0.3, 0.05)
    world = so.World(
        {"ring": hoop, "through": ball, "wide": ball},
        fixed={"ring": at(0.0)},
        parents={"wide": "through"},
    )

    def up(x: float, z: float) -> ConstantTwist:
        pose = at(x)
        pose[2, 3] = z
        return ConstantTwist(pose, ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]))

    paths = {"through": up(0.0, -1.0), "wide": up(0.2, -3.0)}
    found = world.time_of_impact(paths, 6.0)
    # 0.1 from the circle in its plane, and 0.15 in all
    true = 3.0 - np.sqrt(0.15**2 - 0.1**2)
    assert found.status is ImpactStatus.IMPACT
    assert set(found.names) == {"ring", "wide"}
    assert found.time <= true
    assert found.time == pytest.approx(true, abs=1e-8)
    assert world.time_of_impact(paths, 2.5).status is ImpactStatus.NO_IMPACT


def test_no_impact_and_bad_paths() -> None:
    world = so.World({"a": BALL, "b": BALL})
    paths = {"a": at(0.0), "b": ConstantTwist(at(0.0, 3.0), ([1.0, 0, 0], [0, 0, 0]))}
    found = world.time_of_impact(paths, 5.0)
    assert found.status is ImpactStatus.NO_IMPACT
    assert found.time == 5.0
    assert found.names is None
    with pytest.raises(ValueError, match="none of 'b'"):
        world.time_of_impact({"a": at(0.0)}, 5.0)
    for duration in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="duration"):
            world.time_of_impact(paths, duration)
    with pytest.raises(TypeError, match=r"'clearence'.*'clearance'"):
        world.time_of_impact(paths, 5.0, clearence=0.1)
    for alone in (world, so.World({"a": BALL, "b": BALL}, ignore=[("a", "b")])):  # without a pair
        for wrong in (
            {"clearance": -1.0},
            {"tolerance": 0.0},
            {"max_evaluations": 1},
            {"start": np.nan},
            {"duration": 0.0},
        ):
            with pytest.raises(ValueError, match=next(iter(wrong))):
                alone.time_of_impact(paths, **{"duration": 5.0, **wrong})
        with pytest.raises(TypeError, match=r"'b'.*how fast"):
            alone.time_of_impact({"a": at(0.0), "b": lambda t: at(3.0 - t)}, 1.0)
        short = PoseSamples([0.0, 1.0], np.stack([at(5.0), at(6.0)]))
        with pytest.raises(ValueError, match=r"'b'.*ends at 1\.0"):
            alone.time_of_impact({"a": at(0.0), "b": short}, 5.0)


def test_a_pair_keeps_the_greater_of_clearance_and_margin() -> None:
    bodies = {"ball": BALL, "near": BALL, "far": BALL, "wall": BALL}
    world = so.World(
        bodies,
        fixed={"wall": at(0.0, 9.0)},
        groups={"others": ["near", "far"]},
        ignore=[("near", "far")],
        margins={("ball", "far"): 3.0, ("ball", "others"): 0.5},
    )
    paths = {
        "ball": ConstantTwist(at(0.0), ([1.0, 0, 0], [0, 0, 0])),
        "near": at(5.0),
        "far": at(7.0),
    }
    # near: 5 - 1 - 0.5, far: 7 - 1 - 3
    assert world.time_of_impact(paths, 9.0).names == ("ball", "far")
    assert world.time_of_impact(paths, 9.0).time == pytest.approx(3.0, abs=1e-8)
    assert world.time_of_impact(paths, 9.0, clearance=2.0).time == pytest.approx(2.0, abs=1e-8)
    assert world.time_of_impact(paths, 9.0, clearance=2.0).names == ("ball", "near")
    found = world.time_of_impact(paths | {"far": at(3.9)}, 9.0)
    assert found.status is ImpactStatus.AT_START
    assert found.time == 0.0


def test_over_a_floor_at_rest() -> None:
    """One ball falls on it, one flies along it: that one is left out."""
    turned = so.Pose.exp((0.3, -0.2, 0.0)).rotation
    floor = so.Pose(turned, [0.0, 0.0, -2.0])
    normal = floor.rotation[:, 2]
    above = floor.translation + 3.5 * normal
    world = so.World(
        {"falls": BALL, "flies": BALL, "floor": so.shapes.halfspace()}, fixed={"floor": floor}
    )
    paths = {
        "falls": ConstantTwist((np.eye(3), above), (-0.5 * normal, [0, 0, 0])),
        "flies": ConstantTwist((np.eye(3), above + 12.0 * normal), (turned[:, 1], [0, 0, 0])),
    }
    found = world.time_of_impact(paths, 20.0)
    assert found.names == ("falls", "floor")
    assert found.time == pytest.approx(6.0, abs=1e-8)
    assert found.searched == 1
    moved = so.World(dict(world.bodies)).time_of_impact({**paths, "floor": floor}, 20.0)
    assert moved.time == found.time


def drawn_paths(rng: np.random.Generator, n: int) -> list[object]:
    """Screws, twists in both frames, samples with breaks, rest; through one place or another."""
    found: list[object] = []
    for k in range(n):
        pose = at(0.0)
        pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        pose[:3, 3] = rng.uniform(-4, 4, 3)
        twist = so.Twist(rng.normal(size=3), rng.normal(size=3), ("world", "body")[k % 2])
        if k % 5 == 0:
            found.append(Screw(pose, rng.normal(size=3), rng.normal(size=3), rng.normal(), 0.5))
        elif k % 5 == 1:
            times = np.sort(np.concatenate([[-1.0, 9.0], rng.uniform(0, 8, 6)]))
            stops = np.tile(pose, (8, 1, 1))
            stops[:, :3, 3] += np.cumsum(rng.normal(size=(8, 3)), axis=0)
            found.append(PoseSamples(times, stops))
        elif k % 5 == 2:
            found.append(pose)
        else:
            found.append(ConstantTwist(pose, twist))
    return found


def test_swept_boxes_hold_their_pieces(rng: np.random.Generator) -> None:
    for _ in range(draws(20)):
        for path in drawn_paths(rng, 5):
            path = moving(path, "path")
            body = SHAPES[rng.integers(len(SHAPES))]
            follower = Follower(body, path, 0.0, 8.0)
            times = np.linspace(0.0, 8.0, int(rng.integers(2, 9)))
            boxes = follower.boxes(times)
            for box, a, b in zip(boxes, times[:-1], times[1:], strict=True):
                for t in [a, b, *rng.uniform(a, b, 4)]:
                    points = path.pose(float(t)).apply(sample_points(body))
                    assert (box[:3] <= points - body.radius).all()
                    assert (points + body.radius <= box[3:]).all()


def test_no_pair_that_meets_is_left_out(rng: np.random.Generator) -> None:
    """Against searches of all pairs."""
    left_out = 0
    for draw in range(draws(4)):
        names = [f"b{k}" for k in range(9)]
        bodies = {name: SHAPES[k % 6] for k, name in enumerate(names)}
        bodies["two"] = so.compound({"a": BALL, "b": (SHAPES[1], at(1.0))})
        bodies["floor"] = so.shapes.halfspace()
        floor = at(0.0)
        floor[:3, :3] = so.Pose.exp((0.2, -0.1, 0.0)).rotation
        floor[2, 3] = -5.5
        margins = {("b0", "b2"): 0.4, ("b3", "floor"): 1.0}
        world = so.World(bodies, fixed={"floor": floor}, ignore=[("b1", "b4")], margins=margins)
        paths = dict(zip(world.moving, drawn_paths(rng, 10), strict=True))
        clearance = (0.0, 0.3)[draw % 2]
        found = world.time_of_impact(paths, 8.0, clearance=clearance)
        given, every = paths | {"floor": floor}, []
        for a, b in world.pairs():
            required = max(clearance, world.margin(a, b))
            parts = [
                [
                    (piece.body, Offset(moving(given[name], name), piece.pose))
                    for piece in pieces_of(bodies[name])
                ]
                for name in (a, b)
            ]
            for (x, path_x), (y, path_y) in itertools.product(*parts):
                hit = so.time_of_impact(x, y, path_x, path_y, 8.0, clearance=required)
                every.append((hit.time, (a, b)))
        first = min(every)
        assert found.time == pytest.approx(first[0], abs=1e-7)
        if found.status is not ImpactStatus.NO_IMPACT and found.time > 0.0:
            assert found.names == first[1]
        left_out += len(every) - found.searched
    assert left_out > 40
