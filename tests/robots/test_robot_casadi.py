"""`so.robots.casadi_distance`: distances by q with exact first and second derivatives."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from contact_models import ARM, TWO, differences, model, touching

import standoff as so
from standoff.errors import StandoffError
from standoff.robots import casadi_distance
from standoff.tracking.derivatives import Smoothness


@pytest.fixture(scope="module")
def arm() -> so.Robot:
    return so.Robot.from_mujoco(model(ARM))


def smooth_pairs(robot: so.Robot) -> list[tuple[str, str]]:
    return [pair for pair in robot.pairs if "g3" in pair or "g4" in pair]


def compiled(function, nq: int):
    q = ca.MX.sym("q", nq)
    value = function(q)
    jacobian = ca.jacobian(value, q)
    hessians = [ca.hessian(value[k], q)[0] for k in range(value.numel())]
    return ca.Function("all", [q], [value, jacobian, *hessians])


def test_values_and_derivatives_are_the_robots_and_the_differences(
    arm: so.Robot, rng: np.random.Generator
) -> None:
    pairs = smooth_pairs(arm)
    every = compiled(casadi_distance(arm, pairs), 4)
    at = [list(arm.pairs).index(pair) for pair in pairs]
    for _ in range(8):
        q = rng.uniform(arm.lower, arm.upper)
        value, jacobian, *hessians = (x.full() for x in every(q))
        rows = arm.distances(q)
        np.testing.assert_allclose(value.ravel(), rows.distance[at], atol=1e-13)
        np.testing.assert_allclose(jacobian, rows.jacobian[at], atol=1e-10)
        wanted = differences(lambda x: arm.distances(x).jacobian[at], arm.kinematics, q, 1e-4)
        for k, hessian in enumerate(hessians):
            if np.isfinite(hessian).all() and rows[at[k]].smoothness is Smoothness.SMOOTH:
                np.testing.assert_allclose(hessian, wanted[k], atol=2e-6, rtol=2e-5)


def test_second_derivatives_are_exact_through_contact() -> None:
    robot = so.Robot.from_mujoco(model(TWO))
    every = compiled(casadi_distance(robot, [("a", "b")]), 4)
    start, down = np.array([0.1, 0.05, -0.2, 0.3]), np.array([0.0, 0.0, -0.6, 0.0])
    contact = touching(lambda q: robot.distances(q).distance[0], start, down)
    for q in (start, contact, contact + 0.03 * down):
        value, jacobian, hessian = (x.full() for x in every(q))
        assert value[0, 0] == pytest.approx(robot.distances(q).distance[0], abs=1e-14)
        first = differences(lambda x: robot.distances(x).distance, robot.kinematics, q)
        second = differences(lambda x: robot.distances(x).jacobian[0], robot.kinematics, q, 1e-4)
        np.testing.assert_allclose(jacobian, first, atol=1e-8)
        np.testing.assert_allclose(hessian, second, atol=1e-6)


def test_the_first_named_is_a(arm: so.Robot) -> None:
    function = casadi_distance(arm, [("g3", "post"), ("post", "g3")])
    every = compiled(function, 4)
    _, jacobian, first, second = (x.full() for x in every(np.array([0.3, 0.4, 0.2, 0.0])))
    np.testing.assert_allclose(jacobian[0], jacobian[1], atol=1e-12)
    np.testing.assert_allclose(first, second, atol=1e-9)


def test_ipopt_stops_at_the_clearance(arm: so.Robot) -> None:
    """The nearest configuration to one in overlap that keeps all of the last links 3 cm off."""
    pairs = [("floor", "g4"), ("post", "g4"), ("ball", "g4"), ("post", "g3"), ("ball", "g3")]
    wanted = np.array([0.75, 0.9, 0.0, 0.0])
    assert min(arm.distances(wanted).distance) < 0.0
    q = ca.MX.sym("q", 4)
    problem = {"x": q, "f": ca.sumsqr(q - wanted), "g": casadi_distance(arm, pairs)(q)}
    options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-9}
    found = ca.nlpsol("solve", "ipopt", problem, options)(
        x0=np.array([0.0, 0.5, 0.0, 0.0]), lbg=0.03, ubg=np.inf, lbx=arm.lower, ubx=arm.upper
    )
    x = found["x"].full().ravel()
    kept = min(a.distance for a in arm.distances(x) if a.names in pairs)
    assert kept == pytest.approx(0.03, abs=1e-6)


def test_flat_pairs_have_no_second_derivative() -> None:
    box = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0 0 1"><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
    <geom name="box" type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>"""
    robot = so.Robot.from_mujoco(model(box))
    every = compiled(casadi_distance(robot, [("floor", "box")]), 2)
    value, jacobian, hessian = (x.full() for x in every(np.zeros(2)))
    assert value[0, 0] == pytest.approx(0.9)
    np.testing.assert_array_equal(jacobian, [[1.0, np.nan]])
    assert np.isnan(hessian).any()
    asked = compiled(casadi_distance(robot, [("floor", "box")], undefined="raise"), 2)
    with pytest.raises(RuntimeError, match="has no derivative"):
        asked(np.zeros(2))


def test_what_does_not_fit_is_refused(arm: so.Robot) -> None:
    with pytest.raises(StandoffError, match="pairs of names"):
        casadi_distance(arm, [("g1", "nobody")])
    with pytest.raises(StandoffError, match="single underscores"):
        casadi_distance(arm, arm.pairs, name="not a name")


FLYING = """<mujoco><worldbody>
<geom name="post" type="ellipsoid" size="0.3 0.2 0.4" pos="1.5 0.2 0.1"/>
<body pos="0.1 0 0"><freejoint/><geom name="base" type="ellipsoid" size="0.1 0.2 0.3"/>
 <body pos="0.3 0.1 0"><joint type="ball" pos="0.05 0 0.1"/>
  <geom name="arm" type="capsule" size="0.05 0.2" pos="0.3 0 0.2" euler="0 60 20"/>
  <body pos="0.5 0 0.3"><joint type="hinge" axis="0.3 1 0.2"/>
   <geom name="tip" type="ellipsoid" size="0.05 0.1 0.07" pos="0.2 0 0"/></body></body></body>
</worldbody></mujoco>"""


def planar_and_continuous() -> so.Robot:
    """A base in the plane, and a turn that reads (cos, sin), with its scalar last."""
    pin = pytest.importorskip("pinocchio")
    coal = pytest.importorskip("coal")
    robot, shapes = pin.Model(), pin.GeometryModel()
    joint = robot.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "base")
    placed = pin.SE3(pin.rpy.rpyToMatrix(0.2, 0.4, 0.1), np.array([0.4, 0.0, 0.3]))
    second = robot.addJoint(joint, pin.JointModelRUBY(), placed, "turn")
    last = robot.addJoint(second, pin.JointModelSpherical(), placed, "ball")
    numbers = [
        shapes.addGeometryObject(pin.GeometryObject(name, on, at, coal.Ellipsoid(*size)))
        for name, on, at, size in (
            ("post", 0, pin.SE3(np.eye(3), np.array([2.0, 0.3, 0.5])), (0.3, 0.2, 0.4)),
            ("tip", last, placed, (0.1, 0.15, 0.07)),
        )
    ]
    shapes.addCollisionPair(pin.CollisionPair(*numbers))
    return so.Robot.from_pinocchio(robot, shapes)


def with_compounds() -> so.Robot:
    """An arm; its tip and the obstacle are of pieces off their origins."""
    arm = """<mujoco><asset><mesh name="m" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .1"/></asset>
    <worldbody><body><joint type="hinge" axis="0 0 1"/>
    <joint type="slide" axis="1 0 0"/><joint type="hinge" axis="0 1 0.2"/>
    <geom name="tip" type="mesh" mesh="m" pos="0.2 0.1 0"/></body></worldbody></mujoco>"""
    egg, ball = so.shapes.ellipsoid(0.3, 0.2, 0.4), so.shapes.sphere(0.1)
    place = so.Pose.exp([0.4, 0.1, 0.2], [0.3, 0.2, 0.1])
    away = so.Pose.exp([0, 0, 0], [0, 3.0, 0])
    post = so.compound({"egg": (egg, place), "ball": (ball, away)})
    small = so.shapes.ellipsoid(0.1, 0.05, 0.07)
    tip = so.compound({"egg": (small, place), "other": (small, so.Pose.exp([0, 0, 0], [0, -1, 0]))})
    stand = so.Pose.exp([0.2, 0.1, 0.0], [1.5, 0.2, 0.1])
    robot = so.Robot.from_mujoco(model(arm), meshes={"tip": tip})
    return robot.with_obstacles({"post": (post, stand)})


KINDS = {
    "free, ball and hinge": (
        lambda: so.Robot.from_mujoco(model(FLYING)),
        (slice(3, 7), slice(7, 11)),
    ),
    "planar, continuous and ball": (
        planar_and_continuous,
        (slice(2, 4), slice(4, 6), slice(6, 10)),
    ),
    "bodies of pieces": (with_compounds, ()),
}


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_by_all_numbers_of_q_are_the_differences(
    kind: str, rng: np.random.Generator
) -> None:
    make, turns = KINDS[kind]
    robot, pair = make(), ("post", "tip")
    every = compiled(casadi_distance(robot, [pair]), robot.nq)
    (row,) = [k for k, names in enumerate(robot.pairs) if set(names) == set(pair)]

    def made_unit(q: np.ndarray) -> np.ndarray:
        q = q.copy()
        for part in turns:
            q[part] /= np.linalg.norm(q[part])
        return q

    def distance(q: np.ndarray) -> float:
        return float(robot.distances(made_unit(q)).distance[row])

    for k in range(3):
        q = made_unit(0.5 * rng.normal(size=robot.nq))
        for part in turns:
            q[part] *= 1.0 + 0.2 * k  # as a solver's iterates are
        value, jacobian, hessian = (x.full() for x in every(q))
        assert value[0, 0] == pytest.approx(distance(q), abs=1e-13)
        assert distance(q) > 0.0
        step, unit = 1e-4, np.eye(robot.nq)
        first = [(distance(q + step * e) - distance(q - step * e)) / (2.0 * step) for e in unit]
        np.testing.assert_allclose(jacobian[0], first, atol=1e-6)
        signs = [(a, b) for a in (step, -step) for b in (step, -step)]
        second = [
            [
                sum(a * b * distance(q + a * unit[i] + b * unit[j]) for a, b in signs)
                / (4.0 * step**4)
                for j in range(robot.nq)
            ]
            for i in range(robot.nq)
        ]
        np.testing.assert_allclose(hessian, second, atol=2e-5)


def test_two_pieces_equally_near_have_no_derivative_on_which_they_differ() -> None:
    balls = """<mujoco><asset><mesh name="m" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .1"/></asset>
    <worldbody><geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0 0 1"><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
    <geom name="tip" type="mesh" mesh="m"/></body></worldbody></mujoco>"""
    ball = so.shapes.sphere(0.1)
    two = so.compound({s: (ball, (np.eye(3), [x, 0.0, 0.0])) for s, x in (("l", -0.3), ("r", 0.3))})
    robot = so.Robot.from_mujoco(model(balls), meshes={"tip": two})
    every = compiled(casadi_distance(robot, [("floor", "tip")]), 2)
    value, jacobian, hessian = (x.full() for x in every(np.zeros(2)))
    assert value[0, 0] == pytest.approx(0.9)
    np.testing.assert_allclose(jacobian, [[1.0, np.nan]], atol=1e-12)
    _, jacobian, hessian = (x.full() for x in every(np.array([0.0, 1e-3])))
    np.testing.assert_allclose(jacobian, [[1.0, -0.3 * np.cos(1e-3)]], atol=1e-12)
    np.testing.assert_allclose(hessian, [[0.0, 0.0], [0.0, 0.3 * np.sin(1e-3)]], atol=1e-12)
    asked = compiled(casadi_distance(robot, [("floor", "tip")], undefined="raise"), 2)
    with pytest.raises(RuntimeError, match="two pairs of pieces"):
        asked(np.zeros(2))
