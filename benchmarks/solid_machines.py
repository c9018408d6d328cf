"""Machines of solids: a nut that runs down its bolt, a pair of gears, and a key in its lock.

Run with ``python -m benchmarks.solid_machines --seconds N``: N seconds of each machine's own time.
Told are what a tick takes, beside a tick of a ball that meets nothing; how many pairs of leaves are
looked at in a tick, places and spots; what was not certified; the energy's balance; and how far the
machine is from its kinematics. Newton's nut on a bolt, by signed distance fields on a GPU, takes
145 µs (newton-physics/newton#3801): another machine, so no more than a scale.
"""

from __future__ import annotations

import argparse
import runpy
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.kernels.solids import contact_front as C
from standoff.kernels.solids import contact_places as P
from standoff.kernels.solids import front_rows as R
from standoff.simulation.device_loop import given_readings
from standoff.simulation.operator import Going
from standoff.simulation.system_state import SystemState, state_length
from standoff.solids import Solid
from standoff_studies.machines.keys import WITHIN, pushed
from standoff_studies.machines.prisms import extruded
from standoff_studies.machines.threads import THREAD, bolt, nut
from standoff_studies.soak import solid_parts

GEARS = Path(__file__).parents[1] / "examples" / "planar" / "gears.py"
STEEL = 7800.0
"""kg/m³."""
BOLT_TURNS, NUT_TURNS = 4, 2
PLAY = 5e-5
"""Of the nut, all round, metres."""
TEETH, MODULE, THINNING = (20, 30), 1e-3, 2e-3
"""Of both gears; millimetres a tooth, in metres; radians taken from each side of a tooth."""
SPEED = 20.0
"""Of the driving gear, radians a second."""
PIN, BORE_PLAY = 4e-3, 2e-5
"""Radius of the pin that the other gear turns on, and by how much its bore is wider, metres."""
KEY_PLAY, KEY_SPEED, KEY_STEP = 3e-5, 0.016, 5e-5
"""Of the key all round, metres; of the hand, m/s; s."""
KEY_LONGEST = 0.5
"""s, until the key is all through its lock."""
GPU = 145.0
"""µs, Newton's nut on a bolt."""


class Machine(NamedTuple):
    """A system with its step, and how far a state is from the machine's kinematics, as text."""

    name: str
    operator: sim.Operator
    off: Callable[[SystemState, float], str] | None
    hand: sim.DeviceReadings | None = None


def nut_on_bolt() -> Machine:
    """The bolt is fixed, the nut free and without friction: its weight turns it."""
    above = (BOLT_TURNS - NUT_TURNS - 1) * THREAD.pitch
    law = sim.HuntCrossley(stiffness=1e6, damping=20.0, depth=2e-5)
    bodies = [
        sim.RigidBody.fixed(bolt(THREAD, BOLT_TURNS, 0.004)),
        sim.RigidBody.free(
            nut(THREAD, NUT_TURNS, 0.015, PLAY), density=STEEL,
            pose=so.Pose(np.eye(3), [1e-6, 0, above]),
        ),
    ]  # fmt: skip

    def off(state: SystemState, turned: float) -> str:
        climb = state.pose(1).translation[2] - above
        return (
            f"turned {turned:.3f} rad, {1e6 * (climb - THREAD.climb(turned)):.1f} um off the helix"
        )

    return Machine("nut on its bolt", sim.Operator(sim.System(bodies, law), 1e-4), off)


def turning(speed: float) -> so.motion.Path:
    return so.motion.ConstantTwist(so.Pose.identity(), so.Twist([0, 0, 0], [0, 0, speed]))


def gear_pair() -> Machine:
    """One gear is driven; the other turns on a pin and lies on its head, with friction."""
    drawn = runpy.run_path(str(GEARS))
    (one, _), (other, base) = (
        drawn["involute_gear"](teeth, MODULE, thinning=THINNING) for teeth in TEETH
    )
    centres = 0.5 * MODULE * sum(TEETH)
    ratio = -TEETH[0] / TEETH[1]
    turn = drawn["in_mesh"](0.0, *TEETH, centres)[1].rotation
    law = sim.HuntCrossley(stiffness=1e6, damping=5.0, friction=0.1, slip_speed=0.05, depth=2e-5)
    pin = Solid(solid_parts.bolt(PIN, 2.0 * PIN, 6e-3, 8e-3).boundary)
    bodies = [
        sim.RigidBody.driven(extruded(one, -1e-3, 6e-3, 3e-3), turning(SPEED)),
        sim.RigidBody.free(
            extruded(other, 0.0, 5e-3, PIN + BORE_PLAY), density=STEEL,
            pose=so.Pose(turn, [centres, 1.5e-5, 1e-6]),
            twist=so.Twist([0, 0, 0], [0, 0, ratio * SPEED]),
        ),
        sim.RigidBody.fixed(pin, so.Pose(so.Pose.exp([np.pi, 0, 0]).rotation, [centres, 0, 6e-3])),
    ]  # fmt: skip

    def off(state: SystemState, turned: float) -> str:
        behind = turned - ratio * SPEED * state.time
        return f"turned {turned:.3f} rad, {1e6 * base * behind:.1f} um behind on its base circle"

    system = sim.System(bodies, law, pairs=[(0, 1), (2, 1)])
    return Machine("pair of gears", sim.Operator(system, 1e-4), off)


def alone() -> Machine:
    """A ball that meets nothing: what a tick takes beside its contacts."""
    ball = sim.RigidBody.free(Solid(so.shapes.sphere(0.01)), density=STEEL)
    far = sim.RigidBody.fixed(Solid(so.shapes.sphere(0.01)), so.Pose(np.eye(3), [0, 0, 1e3]))
    system = sim.System([far, ball], sim.HuntCrossley(stiffness=1e5, depth=1e-5), gravity=[0, 0, 0])
    return Machine("a ball alone", sim.Operator(system, 1e-4), None)


def key_in_lock() -> Machine:
    """A hand pushes a key down and against two walls of its keyway, with friction."""
    operator, hand = pushed(KEY_PLAY, KEY_SPEED, round(KEY_LONGEST / KEY_STEP), KEY_STEP)

    def off(state: SystemState, turned: float) -> str:
        x, y, z = state.pose(1).translation
        behind = z + WITHIN + KEY_SPEED * state.time
        return (
            f"{1e3 * (-z - WITHIN):.2f} mm further in, {1e6 * behind:.1f} um behind the hand, "
            f"{1e6 * np.hypot(x, y):.1f} um beside its axis"
        )

    return Machine("key in its lock", operator, off, hand)


MACHINES = {"nut": nut_on_bolt, "gears": gear_pair, "key": key_in_lock}


class Ticks(NamedTuple):
    """Of each tick: what it took, s, and what of that its thread had a core; how many pairs of
    leaves do not rest, places and spots, of all pairs of solids. And the record of the run."""

    took: np.ndarray
    worked: np.ndarray
    counts: np.ndarray
    run: sim.SystemRun


def ticked(machine: Machine, ticks: int) -> Ticks:
    """So many ticks, one by one: of each the compiled loop alone is timed."""
    operator, hand = machine.operator, machine.hand
    start = operator.start() if hand is None else operator.start().engage()
    going = Going(operator.room_for(start), start.time, 1)
    states = np.empty((ticks + 1, state_length(operator.system)))
    accounts = np.empty((ticks + 1, operator.run(start, 1, device=hand).accounts.shape[1]))
    took, worked, counts = np.empty(ticks), np.empty(ticks), np.empty((ticks, 3))
    for k in range(ticks):
        readings = given_readings(hand, k, 1)
        rows = slice(k, k + 2)
        began, own = time.perf_counter(), time.thread_time()
        operator._advance(going, k, readings, (states[rows], accounts[rows]))
        took[k], worked[k] = time.perf_counter() - began, time.thread_time() - own
        counts[k] = counted(operator.system, going.data)
    final = SystemState(operator.system, going.data)
    return Ticks(took, worked, counts, sim.SystemRun(operator.system, states, accounts, final))


def counted(system: sim.System, data: np.ndarray) -> np.ndarray:
    """Pairs of leaves that do not rest, places and spots of a state."""
    found = np.zeros(3)
    for at, met in zip(system.kept_starts(), system.of_solids, strict=False):
        if not met:
            continue
        kept = data[state_length(system) + at :]
        store = kept[P.F_STORE :]
        rows = kept[P.F_ROWS :][: C.CONTACT_REALS * int(store[R.N_ROWS])].reshape(
            -1, C.CONTACT_REALS
        )
        of_leaves = rows[:, C.C_A] >= 0.0
        found[0] += np.count_nonzero(of_leaves & (rows[:, C.C_REST] <= store[R.GONE]))
        found[1:] += kept[P.F_PLACES], kept[P.F_SPOTS]
    return found


def turned(run: sim.SystemRun) -> np.ndarray:
    """(n,) radians by which body 1 has turned about the z-axis."""
    turns = run.rotations(1)
    angles = np.unwrap(np.arctan2(turns[:, 1, 0], turns[:, 0, 0]))
    return angles - angles[0]


def told_times(took: np.ndarray) -> str:
    parts = [np.median(took), *np.quantile(took, (0.99, 0.999)), took.max()]
    return " ".join(f"{1e6 * part:9.1f}" for part in parts)


def tell(machine: Machine, seconds: float) -> None:
    found = ticked(machine, max(10, round(seconds / machine.operator.dt)))
    run = found.run
    print(f"{machine.name:18s} {told_times(found.took[1:])}")
    print(f"{'    on its core':18s} {told_times(found.worked[1:])}", flush=True)
    if not machine.off:
        return
    leaves, places, spots = np.median(found.counts, axis=0)
    energy = run.energy
    moved = np.ptp(energy.kinetic) + np.ptp(energy.potential) + np.ptp(energy.supplied)
    print(
        f"    {leaves:.0f} pairs of leaves, {places:.0f} places, {spots:.0f} spots; the first tick "
        f"{1e3 * found.took[0]:.0f} ms; median {1e6 * np.median(found.worked) / GPU:.0f} times the "
        f"GPU's {GPU:.0f} us\n"
        f"    {run.uncertified} not certified, {run.jumps} ended deep; deepest "
        f"{1e6 * run.deepest:.1f} um\n    energy off by {np.ptp(energy.balance):.1e} of "
        f"{moved:.1e} J, {energy.shared[-1]:.1e} J more by sharing springs\n"
        f"    {machine.off(run.final, turned(run)[-1])}",
        flush=True,
    )


def main() -> None:
    read = argparse.ArgumentParser(description="Machines of solids, tick by tick.")
    read.add_argument("--seconds", type=float, default=0.5)
    read.add_argument("--machine", choices=sorted(MACHINES), nargs="*", default=list(MACHINES))
    given = read.parse_args()
    print(f"{'us':18s} {'median':>9s} {'99 %':>9s} {'99.9 %':>9s} {'worst':>9s}")
    tell(alone(), given.seconds)
    for name in given.machine:
        tell(MACHINES[name](), given.seconds)


if __name__ == "__main__":
    main()
