"""Simulated systems over many ticks: what is kept, and what a tick costs.

Run with ``python -m benchmarks.simulation --ticks 1000000``. First a free asymmetric body: how far
its energy, angular momentum and rotation are off at the end. Then bodies on a plane, in and out of
contact: ticks whose pair was not certified, the drift of the account of energy over what was lost,
the time of a tick in the compiled loop, and that of single ticks called from Python. The first row
is a free body that meets nothing: the empty tick. Last a tool that a device's handle drags into
contact and out of it through a virtual coupler, by ``--coupler`` alone.
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
PERIOD = 1e-3
"""s, of a device."""
SINGLE = 20_000
"""Ticks that are called one by one."""
CONTACT = sim.HuntCrossley(stiffness=3e6, damping=0.05, friction=0.4, slip_speed=0.02, depth=5e-3)
NOTHING = "nothing"
"""A free body alone."""
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
    solid = BODIES.get(name, BODIES["sphere"])
    body = sim.RigidBody.free(solid, density=800.0, pose=pose, twist=twist)
    bodies = [body] if name == NOTHING else [floor, body]
    operator = sim.Operator(sim.System(bodies, CONTACT), DT, tracker=tracker)
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
    lost = max(energy.dissipated[-1], energy.kinetic[-1] if name == NOTHING else 0.0)
    print(
        f"{name:15s} {tracker:7s} {run.uncertified:6d} {drift / lost:9.1e} "
        f"{1e6 * loop:9.2f} {median:9.1f} {late:9.1f} {worst:9.1f}"
    )


def knocking(t: float) -> so.Pose:
    """A handle that goes in circles over the lens and knocks at it three times a second."""
    height = 0.058 + 0.012 * np.cos(6.0 * np.pi * t)
    return so.Pose(np.eye(3), [0.02 * np.sin(1.7 * t), 0.02 * np.cos(2.3 * t), height])


def coupled(ticks_a_reading: int, tracker: str) -> sim.Operator:
    """A ball over a lens, joined to the handle of a device of 1 kHz."""
    sampling = sim.Sampling(period=PERIOD, device_damping=1.0)
    coupler = sim.VirtualCoupler(
        stiffness=800.0, damping=0.5, max_force=20.0, max_age=0.01, sampling=sampling
    )
    contact = sim.HuntCrossley(
        stiffness=3e5, damping=4.0, friction=0.2, slip_speed=0.05, depth=5e-4
    )
    lens = sim.RigidBody.fixed(so.shapes.lens(0.05, 0.0225))
    ball = sim.RigidBody.free(so.shapes.sphere(0.01), mass=0.2, pose=knocking(0.0))
    system = sim.System([lens, ball], contact, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, PERIOD / ticks_a_reading, tracker=tracker)


def drag(tracker: str, ticks: int) -> None:
    """The tool in and out of contact: what is lost, and what a tick costs."""
    a_reading = 10
    count = ticks // a_reading
    given = sim.DeviceReadings.along(knocking, count, PERIOD)
    operator = coupled(a_reading, tracker)
    began = time.perf_counter()
    run = operator.run(operator.start().engage(), count * a_reading, a_reading, device=given)
    loop = (time.perf_counter() - began) / (count * a_reading)
    found, touching = run.coupler, run.spots[:, 0] > 0
    assert found is not None
    single = coupled(1, tracker)
    state, calls = single.start().engage(), np.empty((2, SINGLE))
    for k in range(SINGLE):
        reading = sim.DeviceReading(k * PERIOD, k, knocking(k * PERIOD))
        began = time.perf_counter()
        state = single.step(state, reading)
        calls[0, k] = time.perf_counter() - began
        began = time.perf_counter()
        calls[1, k] = time.perf_counter() - began
    print(
        f"{tracker:7s} {run.uncertified:6d} {found.counts.faults:6d} "
        f"{np.count_nonzero(np.diff(touching.astype(int)) == 1):8d} {found.energy.least[-1]:9.1e} "
        f"{1e6 * loop:9.2f}",
        *(f"{1e6 * q:9.2f}" for q in np.quantile(calls[0], [0.5, 0.999, 1.0])),
        *(f"{1e6 * q:9.2f}" for q in np.quantile(calls[1], [0.5, 0.999, 1.0])),
    )


def drag_all(ticks: int) -> None:
    """The tool with the tracker beside and inside."""
    print(f"a tool on a coupler, {ticks} ticks of 100 us; single ticks of 1 ms; times in us")
    print(
        "tracker uncert faults contacts    energy in a loop  one tick     p99.9     worst "
        "    empty     p99.9     worst"
    )
    for tracker in ("beside", "inside"):
        drag(tracker, ticks)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ticks", type=int, default=1_000_000)
    parser.add_argument("--coupler", action="store_true", help="the tool on a coupler alone")
    ticks = parser.parse_args().ticks
    if parser.parse_args().coupler:
        drag_all(ticks)
        return
    tumble(ticks)
    print(f"bodies on a plane, {ticks} ticks of {1e6 * DT:g} us; times in us")
    print(
        f"{'body':15s} {'tracker':7s} {'uncert':>6s} {'drift':>9s} {'in a loop':>9s} "
        f"{'one tick':>9s} {'p99.9':>9s} {'worst':>9s}"
    )
    for name in (NOTHING, *BODIES):
        for tracker in ("beside", "inside"):
            fall(name, tracker, ticks)
    drag_all(ticks)


if __name__ == "__main__":
    main()
