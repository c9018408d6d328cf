"""`so.robots.MujocoContacts` and `MujocoSensor`: a simulation on exact contacts and distances."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from contact_models import ARM, model

import standoff as so
from draws import draws
from standoff.errors import StandoffError
from standoff.robots import MujocoContacts, MujocoSensor
from standoff.robots.mujoco_contacts import mixed

FALL = """
<mujoco><option integrator="implicitfast" timestep="0.001"/><worldbody>
<geom name="floor" type="plane" size="1 1 1"/>
<body pos="0 0 0.2" euler="20 10 0"><freejoint/>
<geom name="a" type="ellipsoid" size="0.1 0.2 0.15"/></body>
<body pos="0.02 0 0.6"><freejoint/><geom name="b" type="sphere" size="0.15"/></body>
</worldbody>{more}</mujoco>"""


def fallen(steps: int = 400) -> tuple[Any, Any, MujocoContacts, Any]:
    at = model(FALL.format(more=""))
    contacts = MujocoContacts(so.Robot.from_mujoco(at))
    ours, theirs = mujoco.MjData(contacts.model), mujoco.MjData(at)
    for _ in range(steps):
        contacts.step(ours)
        mujoco.mj_step(at, theirs)
    return at, theirs, contacts, ours


def test_bodies_fall_and_meet_as_in_mujoco() -> None:
    _, theirs, contacts, ours = fallen()
    assert ours.ncon == theirs.ncon == 2
    np.testing.assert_allclose(ours.qpos, theirs.qpos, atol=1e-4)
    assert [a.names for a in contacts.rows] == [("floor", "a"), ("a", "b")]


def test_a_contact_is_mujocos_own_where_that_is_exact() -> None:
    """Balls on a plane and on each other: the same numbers, by another way."""
    text = FALL.format(more="").replace('"ellipsoid" size="0.1 0.2 0.15"', '"sphere" size="0.15"')
    at = model(text)
    contacts = MujocoContacts(so.Robot.from_mujoco(at))
    theirs, ours = mujoco.MjData(at), mujoco.MjData(contacts.model)
    for data in (theirs, ours):
        data.qpos[:] = [0, 0, 0.14, 1, 0, 0, 0, 0.1, 0.05, 0.38, 1, 0, 0, 0]
    mujoco.mj_forward(at, theirs)
    mujoco.mj_kinematics(contacts.model, ours)
    assert contacts(ours) == theirs.ncon == 2
    for a, b in zip(ours.contact, theirs.contact, strict=True):
        same(a, b)


def same(a: Any, b: Any) -> None:
    assert (a.dim, a.exclude) == (b.dim, b.exclude)
    for field in ("geom", "flex", "elem", "vert"):
        np.testing.assert_array_equal(getattr(a, field), getattr(b, field))
    for field in ("dist", "pos", "frame", "solref", "solimp", "friction", "solreffriction",
                  "includemargin", "adhesion", "surfacevel"):  # fmt: skip
        np.testing.assert_allclose(getattr(a, field), getattr(b, field), atol=1e-12, err_msg=field)


def test_parameters_are_mixed_as_mujoco_does(rng: np.random.Generator) -> None:
    """Against contacts of MuJoCo's own: random parameters, priorities, and a pair of the model."""
    more = (
        '<contact><pair geom1="a" geom2="b" condim="6" friction="2 1 .1 .2 .3" margin="0.02"'
        ' gap="0.01" solreffriction="0.03 0.9"/></contact>'
    )
    for trial in range(60):
        at = model(FALL.format(more=more if trial % 3 == 0 else ""))
        at.geom_condim[:] = rng.choice([1, 3, 4, 6], at.ngeom)
        at.geom_priority[:] = rng.integers(0, 2, at.ngeom)
        at.geom_solmix[:] = rng.choice([0.0, 0.5, 2.0], at.ngeom)
        at.geom_friction[:] = rng.choice([0.0, 0.3, 1.5], (at.ngeom, 3))
        at.geom_margin[:] = rng.choice([0.0, 0.02], at.ngeom)
        at.geom_gap[:] = rng.choice([0.0, 0.01], at.ngeom)
        signs = rng.choice([1.0, -1.0], (at.ngeom, 1), p=[0.7, 0.3])
        at.geom_solref[:] = signs * rng.uniform(0.01, 0.1, (at.ngeom, 2))
        at.geom_solimp[:] = rng.uniform(0.5, 0.9, (at.ngeom, 5))
        if trial % 5 == 0:
            at.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_OVERRIDE
            at.opt.o_margin = 0.03
        data = mujoco.MjData(at)
        data.qpos[:] = [0, 0, 0.14, 1, 0, 0, 0, 0.1, 0.05, 0.42, 1, 0, 0, 0]
        mujoco.mj_forward(at, data)
        assert data.ncon
        for contact in data.contact:
            found = mixed(at, *contact.geom.tolist())
            assert found.dim == contact.dim
            for name in ("solref", "solimp", "friction", "solreffriction"):
                np.testing.assert_allclose(getattr(found, name), getattr(contact, name), atol=1e-15)
            assert found.margin == contact.includemargin
            assert contact.dist < found.margin + found.gap


@pytest.mark.parametrize("solver", ["mjSOL_NEWTON", "mjSOL_PGS"])
@pytest.mark.parametrize("integrator", ["mjINT_EULER", "mjINT_IMPLICITFAST"])
def test_a_step_is_mujocos_where_all_contacts_are_its_own(solver: str, integrator: str) -> None:
    """With none of ours the order of the stages is what is left: the same to the last bit."""
    text = FALL.format(more="").replace('"ellipsoid"', '"box"')
    text = text.replace('"sphere" size="0.15"', '"box" size="0.1 0.1 0.1"')
    at = model(text)
    at.opt.solver = getattr(mujoco.mjtSolver, solver)
    at.opt.integrator = getattr(mujoco.mjtIntegrator, integrator)
    at.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    contacts = MujocoContacts(so.Robot.from_mujoco(at))
    ours, theirs = mujoco.MjData(contacts.model), mujoco.MjData(at)
    for _ in range(300):
        contacts.step(ours)
        mujoco.mj_step(at, theirs)
    assert ours.ncon >= 4
    np.testing.assert_array_equal(ours.qpos, theirs.qpos)
    np.testing.assert_array_equal(ours.energy, theirs.energy)


def test_mujocos_contacts_of_other_pairs_stay() -> None:
    at = model(FALL.format(more=""))
    contacts = MujocoContacts(so.Robot.from_mujoco(at), pairs=[("b", "a")])
    data = mujoco.MjData(contacts.model)
    for _ in range(400):
        contacts.step(data)
    assert data.ncon == 2
    mujoco.mj_collision(contacts.model, data)
    both = {tuple(c.geom.tolist()): c.dist for c in data.contact}
    assert set(both) == {(0, 1), (2, 1)}  # MuJoCo's: the ball, of the simpler type, first
    contacts(data)
    now = {tuple(c.geom.tolist()): c.dist for c in data.contact}
    assert set(now) == {(0, 1), (1, 2)}
    assert now[0, 1] == both[0, 1]


def test_a_lens_rests_on_its_own_surface() -> None:
    """A body that MuJoCo does not have, for a mesh: it stands as deep as its weight asks."""
    lens = so.shapes.lens(0.3, 0.15)
    # far from symmetric: MuJoCo turns and moves the frame of a mesh to its centre of mass
    corners = [[0.1, 0, 0], [0, 0.12, 0], [0, 0, 0.05], [-0.1, -0.2, 0.01], [0.02, 0.1, -0.2]]
    points = " ".join(map(str, np.ravel(corners)))
    at = model(
        f"""<mujoco><option integrator="implicitfast" timestep="0.001"/>
        <asset><mesh name="rough" vertex="{points}"/></asset><worldbody>
        <geom name="floor" type="plane" size="1 1 1"/>
        <body pos="0 0 0.2" quat="1 0 1 0"><freejoint/>
        <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
        <geom name="lens" type="mesh" mesh="rough"/></body></worldbody></mujoco>"""
    )
    contacts = MujocoContacts(so.Robot.from_mujoco(at, meshes={"lens": lens}))
    data = mujoco.MjData(contacts.model)
    for _ in range(2000):
        contacts.step(data)
    assert data.ncon == 1
    force = np.zeros(6)
    mujoco.mj_contactForce(contacts.model, data, 0, force)
    assert force[0] == pytest.approx(9.81, rel=1e-3)
    assert -1e-3 < contacts.rows[0].distance < 0.0


def test_normals_in_overlap_are_exact_and_mujocos_are_not() -> None:
    """A sphere in an ellipsoid along its axes' symmetry, and a general pose against differences."""
    at = model(FALL.format(more=""))
    worst = {"ours": 0.0, "mujoco": 0.0}
    rng = np.random.default_rng(1)
    robot = so.Robot.from_mujoco(at)
    for _ in range(20):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        turn = rng.normal(size=4)
        turn /= np.linalg.norm(turn)
        q = np.concatenate([[0, 0, 2.0], [1, 0, 0, 0], [0, 0, 2.0] + 0.25 * axis, turn])
        if not -0.08 < robot.distances(q).distance[-1] < -1e-3:
            continue
        row = next(a for a in robot.distances(q) if a.names == ("a", "b"))
        step = 1e-6
        wanted = np.empty(3)
        for k in range(3):
            v = np.zeros(12)
            v[6 + k] = step
            pair = [
                next(a for a in robot.distances(robot.kinematics.integrate(q, s * v))
                     if a.names == ("a", "b")).distance
                for s in (1.0, -1.0)
            ]  # fmt: skip
            wanted[k] = (pair[0] - pair[1]) / (2.0 * step)
        worst["ours"] = max(worst["ours"], float(np.abs(row.normal - wanted).max()))
        data = mujoco.MjData(at)
        data.qpos[:] = q
        mujoco.mj_forward(at, data)
        (contact,) = data.contact
        sign = -1.0 if contact.geom[0] == 2 else 1.0
        off = np.linalg.norm(sign * contact.frame[:3] - wanted)
        worst["mujoco"] = max(worst["mujoco"], float(off))
    assert worst["ours"] < 1e-8
    assert worst["mujoco"] > 100.0 * worst["ours"]


def test_distances_of_meshes_are_within_proven_bounds(rng: np.random.Generator) -> None:
    """As in mujoco#3383: random convex meshes apart, judged by a bound that needs no engine."""
    for _ in range(3):
        meshes = [rng.normal(size=(12, 3)) * 0.05 for _ in "ab"]
        assets = "".join(
            f'<mesh name="{name}" vertex="{" ".join(map(str, points.ravel()))}"/>'
            for name, points in zip("ab", meshes, strict=True)
        )
        bodies = "".join(
            f'<body><freejoint/><geom name="{n}" type="mesh" mesh="{n}"/></body>' for n in "ab"
        )
        at = model(f"<mujoco><asset>{assets}</asset><worldbody>{bodies}</worldbody></mujoco>")
        robot, data = so.Robot.from_mujoco(at, meshes="hull"), mujoco.MjData(at)
        for _ in range(draws(20)):
            turns = rng.normal(size=(2, 4))
            turns /= np.linalg.norm(turns, axis=1)[:, None]
            way = rng.normal(size=3)
            place = way / np.linalg.norm(way) * rng.uniform(0.3, 0.7)
            data.qpos[:] = np.concatenate([np.zeros(3), turns[0], place, turns[1]])
            (row,) = robot.distances(data.qpos)
            mujoco.mj_kinematics(at, data)
            theirs = mujoco.mj_geomDistance(at, data, 0, 1, 9.0, None)
            assert row.distance > 0.01
            assert row.lower_bound - 1e-6 < theirs < row.upper_bound + 1e-6


def test_what_does_not_fit_is_refused() -> None:
    at = model(FALL.format(more=""))
    robot = so.Robot.from_mujoco(at)
    with pytest.raises(StandoffError, match="write them into the model"):
        MujocoContacts(robot.with_obstacles({"wall": so.shapes.box((1.0, 1.0, 0.1))}))
    with pytest.raises(StandoffError, match="does not watch"):
        MujocoContacts(robot, pairs=[("floor", "nobody")])
    contacts = MujocoContacts(robot)
    contacts.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(StandoffError, match="implicitfast"):
        contacts.step(mujoco.MjData(contacts.model))
    assert (at.geom_contype == 1).all()


SENSORS = """<sensor>
<user name="post" dim="2" needstage="pos"/><user name="least" dim="1" needstage="pos"/>
</sensor>"""


def test_sensors_are_filled_by_mujoco() -> None:
    at = model(ARM.replace("</worldbody>", "</worldbody>" + SENSORS))
    robot = so.Robot.from_mujoco(at)
    data = mujoco.MjData(at)
    data.qpos[:] = [0.3, 0.6, 0.2, 0.05]
    for within in (None, 0.02):
        sensor = MujocoSensor(robot, {"post": ("g4", "post"), "least": None}, within=within)
        mujoco.set_mjcb_sensor(sensor)
        try:
            mujoco.mj_forward(at, data)
        finally:
            mujoco.set_mjcb_sensor(None)
        rows = robot.distances(data.qpos)
        row = next(a for a in rows if a.names == ("post", "g4"))
        if within is None:
            assert data.sensordata.tolist() == pytest.approx(
                [row.distance, row.lower_bound, rows.distance.min()], abs=1e-14
            )
        else:
            assert row.distance > within
            assert data.sensordata[:2].tolist() == [within, within]
    with pytest.raises(StandoffError, match="user sensor"):
        MujocoSensor(robot, {"nobody": None})
