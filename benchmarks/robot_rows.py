"""``python -m benchmarks.robot_rows``: rows of collision limits through contact, beside others.

Two ellipsoids a metre from the origin; one slides and turns. At gaps from 0.1 m to -0.1 m the row
of Pink's `SelfCollisionBarrier`, of mink's `CollisionAvoidanceLimit` and ours are set beside
differences of the signed distance. docs/images/make_robot_rows_pictures.py draws what is measured
here.
"""

from __future__ import annotations

from typing import NamedTuple

import coal
import mink
import mujoco
import numpy as np
import pink
import pinocchio as pin
from numpy.typing import NDArray

import standoff as so
from standoff.robots import MinkLimit, PinkBarrier

Array = NDArray[np.float64]
STILL, MOVING = (0.3, 0.2, 0.25), (0.15, 0.2, 0.1)
TURN = pin.rpy.rpyToMatrix(0.4, 0.3, 0.1)
START = np.array([0.05, 0.02, 0.9, 0.2])
GAPS = np.array([1e-1, 3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9])
BALLS = """<mujoco><worldbody>
<body><freejoint/><geom name="a" type="sphere" size="0.05"/></body>
<body><freejoint/><geom name="b" type="sphere" size="0.05"/></body></worldbody></mujoco>"""


class Rows(NamedTuple):
    """Rows (n, 4) by the three slides and the turn, at n gaps: theirs, ours, and differences."""

    gaps: Array
    theirs: Array
    ours: Array
    true: Array


def around_zero(gaps: Array) -> Array:
    """The gaps, zero, and the same in overlap."""
    return np.concatenate([gaps, [0.0], -gaps[::-1]])


def at_gap(robot: so.Robot, gap: float, q: Array) -> Array:
    """The configuration of that gap on the way along z, by Newton's method."""
    q = q.copy()
    for _ in range(30):
        rows = robot.distances(q)
        q[2] += (gap - rows.distance[0]) / rows.jacobian[0, 2]
    return q


def differences(robot: so.Robot, q: Array, step: float = 3e-5) -> Array:
    """(4,) of the distance, to fourth order."""
    found = np.empty(4)
    for k, unit in enumerate(np.eye(4)):
        d = [robot.distances(q + s * step * unit).distance[0] for s in (-2.0, -1.0, 1.0, 2.0)]
        found[k] = (d[0] - 8.0 * d[1] + 8.0 * d[2] - d[3]) / (12.0 * step)
    return found


def pink_models() -> tuple[pin.Model, pin.GeometryModel]:
    model, geometry = pin.Model(), pin.GeometryModel()
    joint, at = 0, pin.SE3(np.eye(3), np.ones(3))
    kinds = (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ(), pin.JointModelRX())
    for k, kind in enumerate(kinds):
        joint, at = model.addJoint(joint, kind, at, f"j{k}"), pin.SE3.Identity()
    for name, parent, pose, axes in (
        ("a", 0, pin.SE3(TURN, np.ones(3)), STILL),
        ("b", joint, pin.SE3.Identity(), MOVING),
    ):
        shape = coal.Ellipsoid(*axes)
        geometry.addGeometryObject(pin.GeometryObject(name, parent, 0, pose, shape))
    geometry.addCollisionPair(pin.CollisionPair(0, 1))
    return model, geometry


def of_pink(gaps: Array) -> Rows:
    """Rows of h(q): Pink's are those of its barrier's Jacobian."""
    model, geometry = pink_models()
    robot = so.Robot.from_pinocchio(model, geometry)
    theirs, ours = pink.barriers.SelfCollisionBarrier(1, d_min=0.0), PinkBarrier(robot, -1.0)
    found = []
    for gap in gaps:
        q = at_gap(robot, gap, START)
        state = pink.Configuration(
            model,
            model.createData(),
            q,
            collision_model=geometry,
            collision_data=geometry.createData(),
        )
        rows = (theirs.compute_jacobian(state)[0], ours.compute_jacobian(state)[0])
        found.append((*rows, differences(robot, q)))
    return Rows(gaps, *(np.array(x) for x in zip(*found, strict=True)))


def mink_model() -> mujoco.MjModel:
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, TURN.ravel())

    def text(numbers: object) -> str:
        return " ".join(map(repr, np.asarray(numbers, dtype=float).tolist()))

    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    return mujoco.MjModel.from_xml_string(f"""<mujoco><worldbody>
      <geom name="a" type="ellipsoid" size="{text(STILL)}" pos="1 1 1" quat="{text(quat)}"/>
      <body name="frame"><body name="carrier" pos="1 1 1">{slides}
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="moving"><joint type="hinge" axis="1 0 0"/>
      <geom name="b" type="ellipsoid" size="{text(MOVING)}"/></body></body></body>
      </worldbody></mujoco>""")


def of_mink(gaps: Array) -> Rows:
    """Rows of the distance: mink's with the sign turned, as it has -∂d/∂q in G."""
    model = mink_model()
    robot = so.Robot.from_mujoco(model)
    options = {"collision_detection_distance": 2.0, "minimum_distance_from_collisions": -1.0}
    theirs = mink.CollisionAvoidanceLimit(model, [(["a"], ["b"])], **options)
    ours = MinkLimit(robot, -1.0)
    found = []
    for gap in gaps:
        q = at_gap(robot, gap, START)
        state = mink.Configuration(model, q=q)
        rows = (-limit.compute_qp_inequalities(state, 1e-2).G[0] for limit in (theirs, ours))
        found.append((*rows, differences(robot, q)))
    return Rows(gaps, *(np.array(x) for x in zip(*found, strict=True)))


def of_balls(gaps: Array) -> Rows:
    """Two balls above each other: mink's row by the second one's way, (n, 3)."""
    model = mujoco.MjModel.from_xml_string(BALLS)
    robot = so.Robot.from_mujoco(model)
    options = {"collision_detection_distance": 2.0, "minimum_distance_from_collisions": -1.0}
    limits = (
        mink.CollisionAvoidanceLimit(model, [(["a"], ["b"])], **options),
        MinkLimit(robot, -1.0),
    )
    found = []
    for gap in gaps:
        q = np.array([0, 0, 0, 1, 0, 0, 0, 0, 0, 0.1 + gap, 1, 0, 0, 0])
        state = mink.Configuration(model, q=q)
        rows = [-limit.compute_qp_inequalities(state, 1e-2).G[0, 6:9] for limit in limits]
        found.append((*rows, np.array([0.0, 0.0, 1.0])))
    return Rows(gaps, *(np.array(x) for x in zip(*found, strict=True)))


def angles(rows: Array, true: Array) -> Array:
    """Degrees between the rows' parts by the three slides; 90 for a row of zeros."""
    a, b = rows[:, :3], true[:, :3]
    sine = np.linalg.norm(np.cross(a, b), axis=1)
    cosine = np.einsum("ni,ni->n", a, b)
    found = np.degrees(np.arctan2(sine, cosine))
    return np.where(np.linalg.norm(a, axis=1) == 0.0, 90.0, found)


def main() -> None:
    """Print the tables."""
    for name, rows in (("Pink", of_pink), ("mink", of_mink), ("mink, two balls", of_balls)):
        # of balls 0.1 m in overlap the centres are one point
        found = rows(around_zero(GAPS[1:] if rows is of_balls else GAPS))
        print(f"{name}\n| gap, m | row theirs | ours | degrees off, theirs | ours |")
        print("|---|---|---|---|---|")
        off = angles(found.theirs, found.true), angles(found.ours, found.true)
        for k, gap in enumerate(found.gaps):
            written = [" ".join(f"{x:6.3f}" for x in r[k]) for r in (found.theirs, found.ours)]
            print(
                f"| {gap:.0e} | {written[0]} | {written[1]} | {off[0][k]:.1e} | {off[1][k]:.1e} |"
            )
        print(f"ours at most {np.abs(found.ours - found.true).max():.1e} from the differences\n")


if __name__ == "__main__":
    main()
