"""``python -m benchmarks.many_bodies``: ticks of systems of 2 to 500 bodies on a plane.

Pebbles of one shape fall on a half-space and on each other, a quarter of them on top of others,
with a horizon of half a pebble. In turn, in one process: the tick that visits all pairs, and the
one that finds its near pairs by the tree of padded boxes. Both moved the bodies alike, to the bit.

Options: --most N (bodies, 500 if not given), --servo S (only this: for S seconds each, a ball on a
coupler at 1 kHz among 49 other bodies, fixed ones and free ones, one step a tick and ten).
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import time
from typing import NamedTuple

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.devices import Trace
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.state import arrays as T
from standoff.servo import Servo
from standoff.simulation import near_pairs

PEBBLE = so.shapes.ellipsoid(0.05, 0.05, 0.04)
WITHIN = 0.05
"""m, half a pebble."""
DT = 1e-3
"""s"""
CONTACT = sim.HuntCrossley(stiffness=1e4, damping=0.5, friction=0.3, slip_speed=0.5)
LAW = so.PredictorCorrector(depth="local", within=WITHIN)
SIZES = (2, 10, 50, 200, 500)
SETTLING = 300
"""Ticks before those that are timed."""
ROUNDS = 5
VISITED = 2e6
"""Visits of pairs that one timing is worth."""


class Way(NamedTuple):
    """An operator, and how many ticks of it are timed at once."""

    name: str
    operator: sim.Operator
    ticks: int


def pebbles(n: int) -> list[sim.RigidBody]:
    """n bodies: the plane and the others above it."""
    rng = np.random.default_rng(n)
    side = max(1, round((0.8 * n) ** 0.5))
    found = [sim.RigidBody.fixed(so.shapes.halfspace())]
    for k in range(n - 1):
        layer, place = divmod(k, side * side)
        at = [0.12 * (place % side), 0.12 * (place // side), 0.06 + 0.11 * layer]
        spin = so.Twist(np.zeros(3), 2.0 * rng.normal(size=3))
        found.append(sim.RigidBody.free(PEBBLE, mass=0.3, pose=(np.eye(3), at), twist=spin))
    return found


def operators(bodies: list[sim.RigidBody]) -> tuple[sim.Operator, sim.Operator]:
    """One that visits all pairs, and one that searches."""
    system, least = sim.System(bodies, CONTACT), near_pairs.LEAST_PAIRS
    made = []
    for few in (1 << 60, 1):
        near_pairs.LEAST_PAIRS = few
        made.append(sim.Operator(system, DT, law=LAW))
    near_pairs.LEAST_PAIRS = least
    return made[0], made[1]


def timed(way: Way, state: sim.SystemState) -> float:
    """Seconds of a tick."""
    begun = time.perf_counter()
    way.operator.run(state, way.ticks, way.ticks)
    return (time.perf_counter() - begun) / way.ticks


def plane(n: int) -> None:
    everything, searching = operators(pebbles(n))
    start = everything.start(allow_overlap=True)
    ends = [made.run(start, SETTLING, SETTLING).final for made in (everything, searching)]
    assert ends[0].data.tobytes() == ends[1].data.tobytes()
    state = ends[0]
    pairs = len(state.system.pairs)
    ticks = int(max(100, VISITED / pairs))
    ways = (Way("all", everything, ticks), Way("tree", searching, max(2000, ticks)))
    times: list[list[float]] = [[], []]
    for _ in range(ROUNDS):
        for kept, way in zip(times, ways, strict=True):
            kept.append(timed(way, state))
    near = np.count_nonzero(
        [state.data[K.STATE_HEADER + K.N_BODY * n + K.N_PAIR * k + T.N_STATE + T.STATUS] != T.FAR
         for k in range(pairs)]
    )  # fmt: skip
    held = state.data.nbytes / 1e6
    room = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    cells = [f"{1e3 * statistics.median(kept):10.4f}" for kept in times]
    spread = [f"{1e3 * max(kept):10.4f}" for kept in times]
    print(
        f"{n:6d} {pairs:8d} {near:6d} {cells[0]} {spread[0]} {cells[1]} {spread[1]} "
        f"{held:9.2f} {room:9.0f}",
        flush=True,
    )


def hand(t: float) -> so.Pose:
    """In circles through the bodies."""
    return so.Pose(np.eye(3), [0.42 + 0.3 * np.cos(1.7 * t), 0.42 + 0.3 * np.sin(2.3 * t), 0.1])


def among(others: str, steps: int, tree: bool) -> sim.Operator:
    """A ball on a coupler, and 49 bodies, fixed or free; a plane under these."""
    coupler = sim.VirtualCoupler(
        stiffness=800.0,
        damping=5.0,
        max_force=20.0,
        max_age=0.01,
        sampling=sim.Sampling(period=DT, device_damping=1.0),
    )
    soft = sim.HuntCrossley(stiffness=5e3, damping=0.5, friction=0.2, slip_speed=0.5, depth=2e-3)
    bodies = [sim.RigidBody.free(so.shapes.sphere(0.01), mass=0.2, pose=hand(0.0))]
    for k in range(49):
        at = (np.eye(3), [0.14 * (k % 7), 0.14 * (k // 7), 0.045])
        free = others == "free"
        bodies.append(
            sim.RigidBody.free(PEBBLE, mass=0.3, pose=at)
            if free
            else sim.RigidBody.fixed(PEBBLE, at)
        )
    bodies.append(sim.RigidBody.fixed(so.shapes.halfspace()))
    system = sim.System(bodies, soft, coupler=coupler, tool=0)
    kept = near_pairs.LEAST_PAIRS
    near_pairs.LEAST_PAIRS = 1 if tree else 1 << 60
    operator = sim.Operator(system, DT / steps, law=LAW)
    near_pairs.LEAST_PAIRS = kept
    return operator


def servo(seconds: float) -> None:
    """What a tick of the loop takes: median, p99, p99.9, p99.99 and worst, us."""
    print(f"{'us of work':24s} {'median':>9s} {'p99':>9s} {'p99.9':>9s} {'p99.99':>9s} worst")
    for others in ("fixed", "free"):
        for steps in (1, 10):
            for tree in (False, True):
                operator = among(others, steps, tree)
                trace = Trace(hand, 0.0, 10.0, there_and_back=True)
                running = Servo(operator, device=trace, seconds=seconds, real_time=True)
                running.engage()
                running.start()
                running.wait()
                report = running.stop()
                found = report.statistics
                name = f"{others}, {steps} steps{', tree' if tree else ''}"
                print(
                    f"{name:24s}",
                    *(f"{1e6 * value:9.1f}" for value in found.work),
                    f"  {report.ended.name}, {found.missed} of {found.ticks} deadlines missed, "
                    f"{found.engaged} engaged, load {os.getloadavg()[0]:.1f}",
                    flush=True,
                )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=SIZES[-1])
    parser.add_argument("--servo", type=float, default=0.0)
    given = parser.parse_args()
    if given.servo > 0.0:
        servo(given.servo)
        return
    print(
        f"{'bodies':>6s} {'pairs':>8s} {'near':>6s} {'all, ms':>10s} {'worst':>10s} "
        f"{'tree, ms':>10s} {'worst':>10s} {'state, MB':>9s} {'peak, MB':>9s}"
    )
    for n in SIZES:
        if n <= given.most:
            plane(n)


if __name__ == "__main__":
    main()
