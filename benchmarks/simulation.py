"""Simulated systems over many ticks: what is kept, and what a tick costs.

Run with ``python -m benchmarks.simulation --ticks 1000000``. First a free asymmetric body: how far
its energy, angular momentum and rotation are off at the end. Then bodies on a plane, in and out of
contact: ticks whose pair was not certified, the drift of the account of energy over what was lost,
the time of a tick in the compiled loop, and that of single ticks called from Python.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import standoff as so
from standoff import simulation as sim

FLOOR = so.shapes.halfspace()
DT = 2e-5
"""s"""
SINGLE = 20_000
"""Ticks that are called one by one."""
CONTACT = sim.HuntCrossley(stiffness=3e6, damping=0.05, friction=0.4, slip_speed=0.02, depth=5e-3)
TURN = so.Pose.exp([0.7, -0.4, 0.3]).rotation
BODIES = {
    "sphere": so.shapes.sphere(0.1),
    "ellipsoid": so.shapes.ellipsoid([0.1, 0.12, 0.15]),
    "box": so.shapes.box(0.2, 0.3, 0.1),
    "cylinder": so.shapes.cylinder(0.1, 0.3),
    "superellipsoid": so.shapes.superellipsoid([0.2, 0.15, 0.1], [0.5, 0.5]),
}


def tumble(ticks: int) -> None:
    """A free box about its middle axis, without forces."""
    twist = so.Twist([0.0, 0.0, 0.0], [0.1, 3.0, 0.2])
    body = sim.RigidBody.free(so.shapes.box(0.1, 0.2, 0.4), mass=1.0, twist=twist)
    system = sim.System([body], sim.HuntCrossley(stiffness=1.0), gravity=[0, 0, 0])
    print(f"free body, {ticks} ticks of 0.1 ms")
    for method in ("rk4", "semi-implicit", "heun"):
        operator = sim.Operator(system, 1e-4, method)
        run = operator.run(operator.start(), ticks, every=ticks // 100)
        energy, spin, R = run.energy.kinetic, run.angular_momenta(0), run.rotations(0)
        print(
            f"  {method:14s} energy {np.abs(energy / energy[0] - 1).max():.1e}, momentum "
            f"{np.abs(spin - spin[0]).max():.1e}, rotation "
            f"{np.abs(R @ R.transpose(0, 2, 1) - np.eye(3)).max():.1e}"
        )


def fall(name: str, tracker: str, ticks: int) -> None:
    """A body that is dropped on a plane."""
    floor = sim.RigidBody.fixed(FLOOR)
    twist = so.Twist([0.3, 0.0, 0.0], [1.0, 2.0, 3.0])
    pose = so.Pose(TURN, [0.0, 0.0, 0.45])
    body = sim.RigidBody.free(BODIES[name], density=800.0, pose=pose, twist=twist)
    operator = sim.Operator(sim.System([floor, body], CONTACT), DT, tracker=tracker)
    state = operator.start()
    began = time.perf_counter()
    run = operator.run(state, ticks, every=ticks // 100)
    loop = (time.perf_counter() - began) / ticks
    singles = np.empty(SINGLE)
    for k in range(SINGLE):
        began = time.perf_counter()
        state = operator.step(state)
        singles[k] = time.perf_counter() - began
    energy = run.energy
    drift = np.abs(energy.balance - energy.balance[0]).max()
    median, late, worst = 1e6 * np.quantile(singles, [0.5, 0.999, 1.0])
    print(
        f"{name:15s} {tracker:7s} {run.uncertified:6d} {drift / energy.dissipated[-1]:9.1e} "
        f"{1e6 * loop:9.2f} {median:9.1f} {late:9.1f} {worst:9.1f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ticks", type=int, default=1_000_000)
    ticks = parser.parse_args().ticks
    tumble(ticks)
    print(f"bodies on a plane, {ticks} ticks of {1e6 * DT:g} us; times in us")
    print(
        f"{'body':15s} {'tracker':7s} {'uncert':>6s} {'drift':>9s} {'in a loop':>9s} "
        f"{'one tick':>9s} {'p99.9':>9s} {'worst':>9s}"
    )
    for name in BODIES:
        for tracker in ("beside", "inside"):
            fall(name, tracker, ticks)


if __name__ == "__main__":
    main()
