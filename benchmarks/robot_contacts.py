"""``python -m benchmarks.robot_contacts``: a minute on our contacts in MuJoCo, beside MuJoCo's own.

Bodies of ellipsoids and lenses on the plane and on each other, two milliseconds a step, the same
model, solver and parameters for both; the contacts alone differ (`so.robots.MujocoContacts`). A
lens is no shape of MuJoCo: it has the hull of a fine mesh of the same body. Told for each:

* drift: how far a body is from where it should be after the minute: at rest from where it was
  set down, and rolling from where the closed form has it; and when it was first a millimetre off;
* energy: the greatest kinetic energy in the last ten seconds of a body at rest; of one that rolls,
  how much of its energy is lost;
* normal: the greatest error of a contact's normal in degrees, against differences of the signed
  distance (ours or MuJoCo's contact at the same configuration).

Options: --quick (six seconds).
"""

from __future__ import annotations

import math
import sys
import time
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.robots import MujocoContacts

Array = NDArray[np.float64]
STEP = 2e-3
G = 9.81
LENS = (0.2, 0.12)
"""Radius of the three balls, and how far their centres are from the middle."""
AXES = (0.12, 0.1, 0.06)


class Case(NamedTuple):
    """One scene: its bodies in MJCF, and how it starts."""

    name: str
    bodies: str
    velocity: tuple[float, ...] = ()
    rolls: bool = False


def body(kind: str, pos: str, quat: str = "1 0 0 0", name: str = "a") -> str:
    """A free body of 1000 kg/m³, or the lens with 1 kg."""
    if kind == "lens":
        inner = (
            '<inertial pos="0 0 0" mass="1" diaginertia="0.003 0.003 0.003"/>'
            f'<geom name="{name}" type="mesh" mesh="lens"/>'
        )
    else:
        inner = f'<geom name="{name}" type="ellipsoid" size="{" ".join(map(str, AXES))}"/>'
    return f'<body pos="{pos}" quat="{quat}"><freejoint/>{inner}</body>'


CASES = (
    Case("an ellipsoid at rest", body("ellipsoid", "0 0 0.06")),
    Case("a lens at rest on a face", body("lens", "0 0 0.08", "1 0 1 0")),
    Case(
        "an ellipsoid on an ellipsoid",
        body("ellipsoid", "0 0 0.06") + body("ellipsoid", "0 0 0.18", name="b"),
    ),
    Case(
        "a lens on an ellipsoid",
        body("ellipsoid", "0 0 0.06") + body("lens", "0 0 0.2", "1 0 1 0", name="b"),
    ),
    Case("an ellipsoid that rocks", body("ellipsoid", "0 0 0.075", "1 0.25 0.1 0")),
    Case("a lens that rocks", body("lens", "0 0 0.081", "1 0.1 1 0.05")),
    Case(
        "a ball of an ellipsoid rolls",
        '<body pos="0 0 0.1"><freejoint/>'
        '<geom name="a" type="ellipsoid" size="0.1 0.1 0.1"/></body>',
        velocity=(0.5, 0.0, 0.0, 0.0, 5.0, 0.0),
        rolls=True,
    ),
)


def lens_mesh() -> str:
    """The lens as a mesh of two thousand points of its surface."""
    r, c = LENS
    n = 2000
    k = np.arange(n) + 0.5
    phi, z = math.pi * (1.0 + 5.0**0.5) * k, 1.0 - 2.0 * k / n
    way = np.stack([np.cos(phi) * np.sqrt(1 - z * z), np.sin(phi) * np.sqrt(1 - z * z), z], axis=1)
    angles = 2.0 * np.pi * np.arange(3) / 3.0
    centres = -c * np.stack([np.cos(angles), np.sin(angles), np.zeros(3)], axis=1)
    along = way @ centres.T  # a ray leaves the first of the three balls
    points = way * (along + np.sqrt(along**2 - c * c + r * r)).min(axis=1)[:, None]
    return " ".join(f"{x:.9g}" for x in points.ravel())


def model_of(case: Case) -> Any:
    mesh = f'<mesh name="lens" vertex="{lens_mesh()}"/>' if "lens" in case.bodies else ""
    return mujoco.MjModel.from_xml_string(f"""
      <mujoco><option integrator="implicitfast" timestep="{STEP}" cone="elliptic" impratio="10">
      <flag energy="enable"/></option><asset>{mesh}</asset>
      <default><geom solref="0.01 1" solimp="0.95 0.99 0.001 0.5 2" friction="0.8 0.001 0.00001"
        condim="3"/></default><worldbody>
      <geom name="floor" type="plane" size="20 20 1"/>{case.bodies}</worldbody></mujoco>""")


class Run(NamedTuple):
    """What a minute gave."""

    drift: float
    moved: float
    energy: float
    normal: float
    step: float


def run(case: Case, model: Any, contacts: MujocoContacts | None, duration: float) -> Run:
    """A simulation with our contacts, or with MuJoCo's own."""
    used = model if contacts is None else contacts.model
    data = mujoco.MjData(used)
    data.qvel[: len(case.velocity)] = case.velocity
    kinetic, worst, spent, moved = [], 0.0, 0.0, math.inf
    mujoco.mj_forward(used, data)
    start, energy = data.qpos.copy(), data.energy.sum()
    judge = so.Robot.from_mujoco(model, meshes=exact_lenses(model))
    steps = round(duration / STEP)
    for k in range(steps):
        begun = time.perf_counter()
        if contacts is None:
            mujoco.mj_step(used, data)
        else:
            contacts.step(data)
        spent += time.perf_counter() - begun
        kinetic.append(float(data.energy[1]))
        if moved == math.inf and drift_of(case, data, start) > 1e-3:
            moved = float(data.time)
        if k % (steps // 60) == 1:
            worst = max(worst, normal_error(judge, used, data, contacts))
    last = kinetic[-max(1, steps // 6) :]
    lost = float((energy - data.energy.sum()) / data.energy[1]) if case.rolls else max(last)
    return Run(drift_of(case, data, start), moved, lost, worst, spent / steps)


def drift_of(case: Case, data: Any, start: Array) -> float:
    """How far the farthest body is from where it should be, length."""
    wanted = start.reshape(-1, 7)[:, :3]
    if case.rolls:
        wanted = wanted + data.time * np.array(case.velocity[:3])
    return float(np.linalg.norm(data.qpos.reshape(-1, 7)[:, :3] - wanted, axis=1).max())


def exact_lenses(model: Any) -> dict[str, Any]:
    """The lens for each geom of its mesh."""
    mesh = int(mujoco.mjtGeom.mjGEOM_MESH)
    lens = so.shapes.lens(*LENS)
    return {model.geom(k).name: lens for k in range(model.ngeom) if model.geom_type[k] == mesh}


def normal_error(judge: so.Robot, model: Any, data: Any, contacts: MujocoContacts | None) -> float:
    """The greatest error of a normal, degrees: against differences of the distance."""
    scratch = mujoco.MjData(model)
    scratch.qpos[:] = data.qpos
    mujoco.mj_kinematics(model, scratch)
    mujoco.mj_collision(model, scratch)
    if contacts is not None:
        contacts(scratch)
    names = judge.geoms.names
    worst = 0.0
    for contact in scratch.contact:
        pair = sorted(names.index(model.geom(int(g)).name) for g in contact.geom)
        swapped = names.index(model.geom(int(contact.geom[0])).name) != pair[0]
        wanted = (
            -differences(judge, data.qpos, pair) if swapped else differences(judge, data.qpos, pair)
        )
        turn = np.linalg.norm(np.cross(contact.frame[:3], wanted))
        worst = max(worst, math.degrees(math.asin(min(1.0, float(turn)))))
    return worst


def differences(judge: so.Robot, q: Array, pair: list[int]) -> Array:
    """(3,) of the distance by the place of the second body: the normal, by differences alone."""
    body_b = int(judge.geoms.joints[pair[1]])
    first = int(judge.joints.v_at[body_b])
    names = (judge.geoms.names[pair[0]], judge.geoms.names[pair[1]])
    found = np.empty(3)
    h = 1e-5
    for k in range(3):
        v = np.zeros(judge.nv)
        v[first + k] = h
        far, near, back, behind = (
            judge.distances(judge.kinematics.integrate(q, s * v)).answer[names].distance
            for s in (2.0, 1.0, -1.0, -2.0)
        )
        found[k] = (behind - 8.0 * back + 8.0 * near - far) / (12.0 * h)
    return found


def main() -> None:
    """Print the table."""
    duration = 6.0 if "--quick" in sys.argv else 60.0
    print(f"{duration:g} s at {1e3 * STEP:g} ms; drift mm, energy J (of what rolls: part lost)")
    print("| scene | | drift, mm | a millimetre at, s | energy | normal, degrees | step, µs |")
    print("|---|---|---|---|---|---|---|")
    for case in CASES:
        model = model_of(case)
        robot = so.Robot.from_mujoco(model, meshes=exact_lenses(model))
        for name, contacts in (("ours", MujocoContacts(robot)), ("MuJoCo's", None)):
            found = run(case, model, contacts, duration)
            print(
                f"| {case.name} | {name} | {1e3 * found.drift:.4g} | {found.moved:.3g} | "
                f"{found.energy:.2e} | {found.normal:.1e} | {1e6 * found.step:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
