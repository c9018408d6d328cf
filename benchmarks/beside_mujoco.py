"""The same scenes in MuJoCo and in Standoff, beside what closed forms say.

Run with ``python -m benchmarks.beside_mujoco`` (``pip install standoff[peers]``). MuJoCo's contacts
are constraints that give way softly, ours are springs: what happens during an impact is not one
number in both, so each scene is asked for what does not hang on the model of contact, and where it
does, each is set beside its own closed form.
"""

from __future__ import annotations

import argparse
from typing import Any, NamedTuple

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff_studies.accuracy.peers.answer import require

G = 9.81
"""m/s²"""
FLOOR = so.shapes.halfspace()
HARD = 'solref="0.002 1" solimp="0.99 0.999 0.0001 0.5 2"'
"""A stiff contact of MuJoCo: two milliseconds, critically damped."""


class Row(NamedTuple):
    """One quantity, by three: `exact` is the closed form, for MuJoCo its own if it differs."""

    scene: str
    quantity: str
    exact: float
    standoff: float
    mujoco: float
    mujoco_exact: float | None = None


class Path(NamedTuple):
    """(n,) times, (n, 3) positions, (n, 3, 3) rotations, (n, 3) velocities and spins, world."""

    times: np.ndarray
    positions: np.ndarray
    rotations: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray


def numbers(values: Any) -> str:
    return " ".join(f"{x:.17g}" for x in np.ravel(values))


def in_mujoco(
    geom: str,
    pose: so.Pose,
    twist: so.Twist,
    duration: float,
    *,
    gravity: Any = (0.0, 0.0, -G),
    friction: float = 0.5,
    dt: float = 1e-4,
    every: int = 10,
    contact: str = HARD,
    inertial: str = "",
    floor: bool = True,
) -> Path:
    """One free body over the plane z = 0, by MuJoCo's Runge-Kutta method of order four."""
    mujoco = require("mujoco")
    plane = f'<geom type="plane" size="9 9 1" friction="{friction} 0 0" {contact}/>'
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, pose.rotation.ravel())
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco><option gravity="{numbers(gravity)}" timestep="{dt}" integrator="RK4"
        cone="elliptic" tolerance="1e-14" iterations="200" impratio="100"/>
      <worldbody>{plane if floor else ""}
        <body pos="{numbers(pose.translation)}" quat="{numbers(quaternion)}">
          <freejoint/>{inertial}
          <geom {geom} density="1000" condim="3" friction="{friction} 0 0" {contact}/>
        </body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    # of the joint: the linear velocity in the world, the angular one in the body's axes
    data.qvel[:3] = twist.v
    data.qvel[3:] = pose.rotation.T @ twist.omega
    rows = []
    for k in range(round(duration / dt) + 1):
        if k % every == 0:
            R = np.empty(9)
            mujoco.mju_quat2Mat(R, data.qpos[3:])
            R = R.reshape(3, 3)
            v, spin = data.qvel[:3].copy(), R @ data.qvel[3:]
            rows.append((data.time, data.qpos[:3].copy(), R, v, spin))
        mujoco.mj_step(model, data)
    return Path(*(np.array(column) for column in zip(*rows, strict=True)))


def in_standoff(
    body: so.Body,
    contact: sim.HuntCrossley,
    pose: so.Pose,
    twist: so.Twist,
    duration: float,
    *,
    gravity: Any = (0.0, 0.0, -G),
    dt: float = 2e-5,
    every: int = 50,
    method: str = "semi-implicit",
    floor: bool = True,
    **mass: Any,
) -> Path:
    """The same by the operator, the tracker beside."""
    free = sim.RigidBody.free(body, pose=pose, twist=twist, **(mass or {"density": 1000.0}))
    bodies = [sim.RigidBody.fixed(FLOOR), free] if floor else [free]
    operator = sim.Operator(sim.System(bodies, contact, gravity=gravity), dt, method)
    ticks = every * round(duration / dt / every)
    run = operator.run(operator.start(allow_overlap=True), ticks, every=every)
    k = len(bodies) - 1
    return Path(
        run.times,
        run.positions(k),
        run.rotations(k),
        run.velocities(k),
        run.angular_velocities(k),
    )
