"""The same scenes in MuJoCo and in Standoff, beside what closed forms say.

Run with ``python -m benchmarks.beside_mujoco`` (``pip install standoff-studies[peers]``). MuJoCo's
contacts are constraints that give way softly, ours are springs: what happens during an impact is
not one number in both, so each scene is asked for what does not hang on the model of contact, and
where it does, each is set beside its own closed form.
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


AT_REST = so.Twist([0.0, 0.0, 0.0], [0.0, 0.0, 0.0])


def standing(z: float, turn: Any = (0.0, 0.0, 0.0)) -> so.Pose:
    return so.Pose.exp(list(turn), [0.0, 0.0, z])


def tumbling() -> list[Row]:
    """A free box about its middle axis: there is no contact, so both must be one motion."""
    twist = so.Twist([0.0, 0.0, 0.0], [0.1, 3.0, 0.2])
    box, none = so.shapes.box(0.1, 0.2, 0.4), sim.HuntCrossley(stiffness=1.0)
    still = {"gravity": (0.0, 0.0, 0.0), "floor": False}
    size = 'type="box" size="0.05 0.1 0.2"'
    theirs = in_mujoco(size, standing(0.0), twist, 5.0, dt=1e-3, every=1, **still)
    ours = in_standoff(box, none, standing(0.0), twist, 5.0, dt=1e-4, method="rk4", **still)
    found = [float(path.rotations[-1, 0, 0]) for path in (ours, theirs)]
    fine = in_standoff(box, none, standing(0.0), twist, 5.0, dt=1e-5, method="rk4", **still)
    return [Row("torque-free box, 5 s", "R[0, 0]", float(fine.rotations[-1, 0, 0]), *found)]


def bouncing() -> list[Row]:
    """A ball that loses nothing: it comes back to where it was dropped."""
    drop = 0.05
    pose = standing(0.1 + drop)
    lossless = sim.HuntCrossley(stiffness=1e9, depth=6e-4)
    fall = np.sqrt(2.0 * drop / G)
    ours = in_standoff(so.shapes.sphere(0.1), lossless, pose, AT_REST, 2.2 * fall, dt=5e-6)
    spring = 'solref="-1e7 0" solimp="0.99 0.99 0.001 0.5 2"'
    theirs = in_mujoco(
        'type="sphere" size="0.1"', pose, AT_REST, 2.2 * fall, contact=spring, dt=1e-5
    )
    tops = [path.positions[path.times > 1.2 * fall, 2].max() - 0.1 for path in (ours, theirs)]
    return [Row("ball that loses nothing", "height, m", drop, *map(float, tops))]


def resting() -> list[Row]:
    """A box set down: how deep it stands, each by its own law of contact."""
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=1.0, friction=0.5, slip_speed=2e-3, depth=1e-3
    )
    weight = 1000.0 * 0.2 * 0.3 * 0.1 * G
    ours = in_standoff(so.shapes.box(0.2, 0.3, 0.1), contact, standing(0.05), AT_REST, 1.0)
    theirs = in_mujoco('type="box" size="0.1 0.15 0.05"', standing(0.05), AT_REST, 1.0)
    depths = [1e6 * (0.05 - float(path.positions[-1, 2])) for path in (ours, theirs)]
    rocking = [1e6 * float(np.abs(path.spins[-1]).max()) for path in (ours, theirs)]
    # MuJoCo: d k r = (1 - d) g at rest, d at its least of 0.99 and k = d / (d_max time)²; four
    # corners share it
    d, d_max, time = 0.99, 0.999, 0.002
    wanted = 1e6 * 0.25 * (1.0 - d) * G / (d * d / (d_max * time) ** 2)
    return [
        Row("box at rest", "depth, μm", 1e6 * (weight / 4e7) ** (2.0 / 3.0), *depths, wanted),
        Row("box at rest", "turning, μrad/s", 0.0, *rocking),
    ]


def sliding() -> list[Row]:
    """A box slides to a stop."""
    mu, speed = 0.4, 0.5
    contact = sim.HuntCrossley(stiffness=1e7, damping=1.0, friction=mu, slip_speed=5e-4, depth=1e-3)
    twist = so.Twist([speed, 0.0, 0.0], [0.0, 0.0, 0.0])
    box, size = so.shapes.box(0.3, 0.3, 0.1), 'type="box" size="0.15 0.15 0.05"'
    ours = in_standoff(box, contact, standing(0.05), twist, 0.3)
    theirs = in_mujoco(size, standing(0.05), twist, 0.3, friction=mu)
    ways = [float(path.positions[-1, 0]) for path in (ours, theirs)]
    left = [1e3 * abs(float(path.velocities[-1, 0])) for path in (ours, theirs)]
    return [
        Row("box slides to a stop", "way, m", speed**2 / (2.0 * mu * G), *ways),
        Row("box slides to a stop", "speed then, mm/s", 0.0, *left),
    ]


def rolling() -> list[Row]:
    """A cylinder rolls down a slope for half a second."""
    slope, duration, lying = 0.2, 0.5, (np.pi / 2, 0.0, 0.0)
    gravity = G * np.array([np.sin(slope), 0.0, -np.cos(slope)])
    contact = sim.HuntCrossley(
        stiffness=1e8, damping=0.5, friction=0.6, slip_speed=1e-3, depth=1e-3
    )
    body, size = so.shapes.cylinder(0.1, 0.4), 'type="cylinder" size="0.1 0.2"'
    field, pose = {"gravity": gravity}, standing(0.1, lying)
    ours = in_standoff(body, contact, pose, AT_REST, duration, **field)
    theirs = in_mujoco(size, pose, AT_REST, duration, friction=0.6, **field)
    speed = 2.0 / 3.0 * G * np.sin(slope) * duration
    found = [float(path.velocities[-1, 0]) for path in (ours, theirs)]
    spins = [float(path.spins[-1, 1]) for path in (ours, theirs)]
    return [
        Row("cylinder rolls down 0.2 rad", "speed, m/s", speed, *found),
        Row("cylinder rolls down 0.2 rad", "spin, rad/s", speed / 0.1, *spins),
    ]


def period(path: Path) -> float:
    """The time between two falls of the tilt through zero."""
    tilt = path.rotations[:, 0, 2]
    at = np.flatnonzero((tilt[:-1] > 0.0) & (tilt[1:] <= 0.0))[:2]
    part = tilt[at] / (tilt[at] - tilt[at + 1])
    return float(np.diff(path.times[at] + (path.times[1] - path.times[0]) * part)[0])


def rocking() -> list[Row]:
    """A flat ellipsoid rocks on the plane, rolling."""
    a, c, tilt = 0.2, 0.1, 0.02
    mass = 1000.0 * 4.0 / 3.0 * np.pi * a * a * c
    inertia = mass * (a * a + c * c) / 5.0 + mass * c * c
    wanted = 2.0 * np.pi * np.sqrt(inertia / (mass * G * (a * a / c - c)))
    contact = sim.HuntCrossley(stiffness=3e8, friction=0.9, slip_speed=2e-3, depth=1e-4)
    low = float(np.hypot(c * np.cos(tilt), a * np.sin(tilt)))
    sunk = (mass * G / 3e8) ** (2.0 / 3.0)
    turn = (0.0, tilt, 0.0)
    body, size = so.shapes.ellipsoid([a, a, c]), f'type="ellipsoid" size="{a} {a} {c}"'
    ours = in_standoff(body, contact, standing(low - sunk, turn), AT_REST, 2.3 * wanted)
    theirs = in_mujoco(size, standing(low - 1e-6, turn), AT_REST, 2.3 * wanted, friction=0.9)
    return [Row("ellipsoid rocks", "period, s", wanted, period(ours), period(theirs))]


def settling() -> list[Row]:
    """A tilted ellipsoid falls, bounces and rocks on: how much energy it has lost by then."""
    axes, turn, height, end = (0.1, 0.12, 0.15), (0.7, -0.4, 0.3), 0.25, 4.0
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=2.0, friction=0.5, slip_speed=5e-3, depth=5e-3
    )
    body, size = so.shapes.ellipsoid(axes), f'type="ellipsoid" size="{numbers(axes)}"'
    # condim 3 has no friction of rolling or spinning, nor have we: it rocks for long
    ours = in_standoff(body, contact, standing(height, turn), AT_REST, end)
    theirs = in_mujoco(size, standing(height, turn), AT_REST, end)
    ends = [float(path.positions[-1, 2]) for path in (ours, theirs)]
    lost = [float(energy(axes, path)[0] - energy(axes, path)[-1]) for path in (ours, theirs)]
    return [
        Row("ellipsoid falls and rocks", "height at 4 s, m", np.nan, *ends),
        Row("ellipsoid falls and rocks", "energy lost, J", np.nan, *lost),
    ]


def energy(axes: tuple[float, float, float], path: Path) -> np.ndarray:
    """Kinetic and potential energy of an ellipsoid of 1000 kg/m³."""
    mass = 1000.0 * 4.0 / 3.0 * np.pi * float(np.prod(axes))
    squares = np.square(axes)
    moments = 0.2 * mass * (squares.sum() - squares)
    spin = np.einsum("nji,nj->ni", path.rotations, path.spins)
    moving = 0.5 * mass * np.sum(path.velocities**2, axis=1) + 0.5 * spin**2 @ moments
    return np.asarray(moving + mass * G * path.positions[:, 2])


def rattling() -> list[Row]:
    """A rattleback, as in examples/simulation: it is spun by -5 rad/s, and turns round."""
    axes, inertia = (0.20, 0.04, 0.02), (3e-4, 5e-3, 5.2e-3, 5e-4, 0.0, 0.0)
    contact = sim.HuntCrossley(
        stiffness=1e7, damping=0.3, friction=1.0, slip_speed=0.02, depth=5e-4
    )
    twist, pose = so.Twist([0, 0, 0], [0, 0, -5.0]), standing(0.01999, (0.0, 0.005, 0.0))
    full = [[3e-4, 5e-4, 0.0], [5e-4, 5e-3, 0.0], [0.0, 0.0, 5.2e-3]]
    mass = {"mass": 1.0, "centre": [0.0, 0.0, -0.003], "inertia": full}
    ours = in_standoff(so.shapes.ellipsoid(axes), contact, pose, twist, 4.0, **mass)
    inertial = f'<inertial pos="0 0 -0.003" mass="1" fullinertia="{numbers(inertia)}"/>'
    size = f'type="ellipsoid" size="{numbers(axes)}"'
    theirs = in_mujoco(size, pose, twist, 4.0, friction=1.0, inertial=inertial)
    most = [float(path.spins[:, 2].max()) for path in (ours, theirs)]
    when = [float(path.times[np.argmax(path.spins[:, 2] > 0.0)]) for path in (ours, theirs)]
    return [
        Row("rattleback", "greatest spin back, rad/s", np.nan, *most),
        Row("rattleback", "turns round at, s", np.nan, *when),
    ]


SCENES = (tumbling, bouncing, resting, sliding, rolling, rocking, settling, rattling)


def written(value: float | None) -> str:
    return "–" if value is None or np.isnan(value) else f"{value:.6g}"


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("| scene | quantity | closed form | Standoff | MuJoCo |")
    print("|---|---|---|---|---|")
    for scene in SCENES:
        for row in scene():
            exact = written(row.exact)
            if row.mujoco_exact is not None:
                exact += f"; MuJoCo's {written(row.mujoco_exact)}"
            found = f"{written(row.standoff)} | {written(row.mujoco)}"
            print(f"| {row.scene} | {row.quantity} | {exact} | {found} |")


if __name__ == "__main__":
    main()
