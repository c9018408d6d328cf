"""Distances and gradients of robots: against Coal, MuJoCo, and differences of our own."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest
from robot_models import EXACT, MJCF, drawn, exact_robot, urdf

import standoff as so
from draws import draws
from standoff.robots.robot_model import Horizons

mujoco = pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")

COAL = 2e-6
"""How far Coal's distances are from the true ones while apart, m: its GJK's tolerance is 1e-6."""
MUJOCO = 2e-6
"""MuJoCo's, m: its own tolerance is 1e-6."""
H = 1e-5
"""Step of central differences, rad or m."""
DIFFERENCES = 1e-7
"""By how much gradients may differ from them, relative to 1."""


@pytest.fixture(scope="module")
def every_joint() -> so.Robot:
    return so.Robot.from_mujoco(mujoco.MjModel.from_xml_string(MJCF))


@pytest.mark.parametrize("name", ["panda", "laikago", "a1", "romeo", "allegro right"])
def test_distances_are_coal_s(name: str) -> None:
    import coal

    robot, rng = exact_robot(name), np.random.default_rng(10)
    path = str(urdf(name))
    model = pin.buildModelFromUrdf(path, mimic=True)
    geometry = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    data, places = model.createData(), geometry.createData()
    numbers = {x.name: k for k, x in enumerate(geometry.geometryObjects)}
    for _ in range(draws(4)):
        q = drawn(robot, rng)
        rows = robot.distances(q)
        assert len(rows) == len(robot.pairs)
        assert rows.certified.all()
        pin.updateGeometryPlacements(model, data, geometry, places, q)
        for (a, b), distance in zip(rows.names, rows.distance, strict=True):
            if distance <= 0.0:
                continue
            i, j = numbers[a], numbers[b]
            theirs = coal.distance(
                *(
                    x
                    for k in (i, j)
                    for x in (
                        geometry.geometryObjects[k].geometry,
                        coal.Transform3s(places.oMg[k].rotation, places.oMg[k].translation),
                    )
                ),
                coal.DistanceRequest(),
                coal.DistanceResult(),
            )
            assert abs(theirs - distance) <= COAL, (a, b)


def test_distances_are_mujoco_s(every_joint: so.Robot) -> None:
    robot, rng = every_joint, np.random.default_rng(11)
    model = robot.kinematics.model
    data, names = mujoco.MjData(model), {}
    reports = robot.report().geoms
    for k in range(model.ngeom):
        names[reports[k].name] = k
    for _ in range(draws(10)):
        q = drawn(robot, rng)
        rows = robot.distances(q)
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        for (a, b), distance in zip(rows.names, rows.distance, strict=True):
            if distance > 0.0 and "floor" not in (a, b):
                theirs = mujoco.mj_geomDistance(model, data, names[a], names[b], 10.0, None)
                assert abs(theirs - distance) <= MUJOCO, (a, b)


def check_gradients(robot: so.Robot, rng: np.random.Generator, within: float) -> int:
    """Rows against central differences of our own distances; how many were compared."""
    q = drawn(robot, rng)
    rows = robot.distances(q, within=within)
    smooth = np.flatnonzero(rows.smooth & rows.certified)
    moved = []
    for dof in range(robot.nv):
        way = H * np.eye(robot.nv)[dof]
        moved.append([robot.distances(robot.kinematics.integrate(q, s * way)) for s in (1, -1)])
    checked = 0
    for k in smooth.tolist():
        if rows[k].smoothness is not so.tracking.Smoothness.SMOOTH:
            continue
        pair, gradient = rows.names[k], rows.jacobian[k]
        for dof, (ahead, behind) in enumerate(moved):
            far, near = (side.answer[pair] for side in (ahead, behind))
            if {far.feature_a, near.feature_a} != {rows[k].pair.feature_a}:
                continue
            if {far.feature_b, near.feature_b} != {rows[k].pair.feature_b}:
                continue
            if far.normal @ near.normal < 0.9:
                continue
            rate = (far.distance - near.distance) / (2.0 * H)
            assert abs(rate - gradient[dof]) <= DIFFERENCES * max(1.0, abs(rate)), (pair, dof)
            checked += 1
    return checked


@pytest.mark.parametrize("name", ["panda", "romeo", "every joint"])
def test_rows_are_differences_of_distances(name: str, every_joint: so.Robot) -> None:
    robot = every_joint if name == "every joint" else exact_robot(name)
    rng = np.random.default_rng(12)
    checked = sum(check_gradients(robot, rng, 0.3) for _ in range(draws(2)))
    assert checked >= 50


def test_rows_are_the_pairs_own_gradients(every_joint: so.Robot) -> None:
    """By the chain rule of twists, in overlap too."""
    robot, rng = every_joint, np.random.default_rng(13)
    overlapping = 0
    for _ in range(draws(20)):
        q = np.array(drawn(robot, rng))
        q[:3] = rng.normal(scale=0.2, size=3)  # among the floor and the post
        rows = robot.distances(q)
        jacobians = np.zeros((len(robot.geoms.names), 6, robot.nv))
        jacobians[robot.geoms.moving] = robot.kinematics.jacobians(q)
        for answer, (i, j) in zip(rows, rows.bodies, strict=True):
            if not answer.smooth or np.isnan(answer.pair.gradient).any():
                continue
            expected = answer.pair.gradient @ np.concatenate([jacobians[i], jacobians[j]])
            assert np.abs(answer.gradient - expected).max() <= 1e-9
            overlapping += answer.distance < 0.0
    assert overlapping >= 10


def test_the_clearance_is_the_least_of_all_pairs() -> None:
    robot, rng = exact_robot("panda"), np.random.default_rng(14)
    obstacles = {
        f"ball {k}": (so.shapes.sphere(0.05), so.Pose(np.eye(3), rng.normal(size=3)))
        for k in range(5)
    }
    robot = robot.with_obstacles(obstacles)
    configurations = np.array([drawn(robot, rng) for _ in range(draws(5))])
    answers = robot.clearances(configurations, workers=2)
    for k, q in enumerate(configurations):
        one, rows = robot.clearance(q), robot.distances(q)
        assert one.distance == rows.distance.min() == answers.distance[k]
        assert one.names == answers.names[k]
        assert one.clearance <= rows.lower_bound.min() + 1e-15
        assert one.clearance >= one.distance - 1e-6
        assert np.array_equal(one.gradient, answers.gradient[k])
        assert np.isfinite(answers.gradient[k]).all()
    assert answers.gradient.shape == (len(configurations), robot.nv)


def test_a_horizon_leaves_out_only_what_is_beyond_it() -> None:
    robot, rng = exact_robot("laikago"), np.random.default_rng(15)
    q = drawn(robot, rng)
    every, near = robot.distances(q), robot.distances(q, within=0.1)
    kept = every.distance <= 0.1
    assert 0 < kept.sum() < len(every)
    assert near.names == [name for name, keep in zip(every.names, kept, strict=True) if keep]
    assert np.array_equal(near.distance, every.distance[kept])
    assert near.clearance <= 0.1


def test_steps_are_warm_and_give_the_same(every_joint: so.Robot) -> None:
    robot, rng = every_joint, np.random.default_rng(16)
    q, v = drawn(robot, rng), 1e-3 * rng.normal(size=robot.nv)
    state = first = robot.start(q)
    assert np.array_equal(robot.rows(state).distance, robot.distances(q).distance)
    for _ in range(20):
        q = robot.kinematics.integrate(q, v)
        state, rows = robot.step(state, q)
        cold = robot.distances(q)
        assert rows.names == cold.names
        assert np.abs(rows.distance - cold.distance).max() <= 1e-7
    again, _ = robot.step(first, q)
    assert np.array_equal(again.q, robot.kinematics.check(q))


def test_flat_contact_is_flagged_and_has_numbers(tmp_path: Path) -> None:
    path = tmp_path / "slider.urdf"
    path.write_text("""
<robot name="slider">
  <link name="base"/>
  <link name="foot"><collision><geometry><box size=".2 .2 .1"/></geometry></collision></link>
  <joint name="rise" type="prismatic"><parent link="base"/><child link="shin"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="shin"/>
  <joint name="tilt" type="revolute"><parent link="shin"/><child link="foot"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>""")
    robot = so.Robot.from_urdf(path, obstacles={"floor": so.shapes.halfspace()})
    flat = robot.clearance([0.06, 0.0])
    assert flat.smoothness is so.tracking.Smoothness.PARTIAL
    assert not flat.smooth
    assert flat.reason
    assert np.isfinite(flat.gradient).all()
    assert abs(abs(flat.gradient[0]) - 1.0) <= 1e-12
    edge = robot.clearance([0.06, 0.1])
    assert edge.smoothness is so.tracking.Smoothness.PARTIAL
    assert edge.smooth  # no joint turns it about the edge's other axis
    rate = (
        robot.clearance([0.06, 0.1 + H]).distance - robot.clearance([0.06, 0.1 - H]).distance
    ) / (2.0 * H)
    assert abs(edge.gradient[1] - rate) <= 1e-9


@pytest.mark.parametrize("name", EXACT)
def test_every_robot_answers(name: str) -> None:
    robot = exact_robot(name)
    answer = robot.clearance(drawn(robot, np.random.default_rng(17)))
    assert answer.certified
    assert answer.gradient.shape == (robot.nv,)
    assert {row.became for row in robot.report().geoms} == {"exact"}


def test_a_robot_is_the_same_after_a_copy(every_joint: so.Robot) -> None:
    for robot in (every_joint, exact_robot("laikago")):
        q = drawn(robot, np.random.default_rng(18))
        state = robot.start(q)
        again, kept = pickle.loads(pickle.dumps((robot, state)))
        assert np.array_equal(again.distances(q).jacobian, robot.distances(q).jacobian)
        assert np.array_equal(again.step(kept, q)[1].distance, robot.rows(state).distance)


def test_a_robot_with_joints_that_mimic_is_not_stored() -> None:
    """Pinocchio 4.1 stores such models without what it needs, and crashes with what it reads; of a
    file it reads all joints, and what they follow is ours."""
    path = str(urdf("panda"))
    model = pin.buildModelFromUrdf(path, mimic=True)
    geometry = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    with pytest.raises(so.StandoffError, match="mimic"):
        pickle.dumps(so.Robot.from_pinocchio(model, geometry))
    robot = exact_robot("panda")
    again, q = pickle.loads(pickle.dumps(robot)), drawn(robot, np.random.default_rng(19))
    assert np.array_equal(again.poses(q), robot.poses(q))


def test_threads_that_ask_for_a_horizon_at_once_get_one_world(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Both find none and make one: the state of the one must fit the world of the other."""
    robot = exact_robot("panda")
    both, made = Barrier(2, timeout=60.0), Horizons._made
    monkeypatch.setattr(
        Horizons, "_made", lambda self, within: (both.wait(), made(self, within))[1]
    )
    with ThreadPoolExecutor(2) as threads:
        found = list(threads.map(robot._horizons.world, [0.123, 0.123]))
    assert found[0] is found[1]
