"""How a servo loop keeps its time: a ball that a hand slides over a lens, in and out of contact.

Run with ``python -m benchmarks.servo``: 60 s at 1 kHz and at 10 kHz, each beside an empty tick, the
same loop with its reading, publishing and log, in which bodies are left alone. The ball goes over
a face, a vertex and an edge of the lens and back, and leaves it three times a second. An hour at
1 kHz, with the memory that is held, is ``python -m benchmarks.servo --rates 1000 --seconds 3600``.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

import numpy as np

import standoff as so
from standoff import simulation as sim
from standoff.devices import Trace
from standoff.kernels.dynamics import arrays as A
from standoff.kernels.dynamics import servo_arrays as V
from standoff.kernels.state import arrays as T
from standoff.servo import Servo, ServoReport

ONE_WAY = 2.0
"""s, of the hand from the face to the edge."""


def hand(t: float) -> so.Pose:
    """Round the lens, now nearer than its surface, now farther."""
    angle, reach = 1.6 * t, 0.0475 + 0.0035 * np.cos(6.0 * np.pi * t)
    position = [reach * np.cos(angle) - 0.0035, 0.001, reach * np.sin(angle)]
    return so.Pose(np.eye(3), position)


def coupled(rate: float) -> sim.Operator:
    """The ball on its coupler, one step a tick."""
    sampling = sim.Sampling(period=1.0 / rate, device_damping=1.0)
    coupler = sim.VirtualCoupler(
        stiffness=800.0, damping=0.5, max_force=20.0, max_age=0.01, sampling=sampling
    )
    contact = sim.HuntCrossley(
        stiffness=3e5, damping=4.0, friction=0.2, slip_speed=0.05, depth=5e-4
    )
    lens = sim.RigidBody.fixed(so.shapes.lens(0.05, 0.0225))
    ball = sim.RigidBody.free(so.shapes.sphere(0.01), mass=0.2, pose=hand(0.0))
    system = sim.System([lens, ball], contact, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, 1.0 / rate)


def visited(operator: sim.Operator, trace: Trace) -> tuple[int, int]:
    """Contacts and switches of one turn, by the same readings without a clock."""
    readings = sim.DeviceReadings([None])
    readings.rows = trace.rows(operator.dt)
    run = operator.run(operator.start().engage(), len(readings.rows), device=readings)
    at = A.STATE_HEADER + 2 * A.N_BODY + T.MODE
    features = run.states[:, at : at + 4 : 2]
    switches = np.count_nonzero((np.diff(features, axis=0) != 0).any(axis=1))
    return np.count_nonzero(np.diff((run.spots[:, 0] > 0).astype(int)) == 1), switches


def memory() -> int:
    """Resident memory of the process, kB."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1])
    return 0


def serve(rate: float, seconds: float, empty: bool, real_time: bool) -> ServoReport:
    """A servo of so many seconds; tells the force and the memory once a minute."""
    trace = Trace(hand, 0.0, ONE_WAY, there_and_back=True)
    servo = Servo(coupled(rate), device=trace, seconds=seconds, real_time=real_time)
    servo._plan[V.V_EMPTY] = empty
    servo.engage()
    servo.start()
    began, told = time.monotonic(), 0
    while not servo.wait(1.0):
        minutes = int((time.monotonic() - began) / 60.0)
        if minutes > told:
            told, now = minutes, servo.latest()
            print(
                f"  {minutes} min, tick {now.tick}, {memory()} kB, missed {now.missed}, "
                f"engaged {now.engaged}, load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
    return servo.stop()


def tell(name: str, report: ServoReport) -> None:
    """The spreads of a run, in microseconds."""
    found = report.statistics
    for what in ("period", "lateness", "work"):
        values = " ".join(f"{1e6 * value:9.1f}" for value in getattr(found, what))
        print(f"{name:18s} {what:9s} {values}")
    print(
        f"{name:18s} {report.ended.name}, {found.ticks} ticks, {found.missed} deadlines missed, "
        f"{found.engaged} engaged, fault {report.fault.name}; load "
        + " ".join(f"{load:.1f}" for load in os.getloadavg()),
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rates", type=float, nargs="+", default=[1000.0, 10_000.0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--usual", action="store_true", help="without a real-time priority")
    given = parser.parse_args()
    for rate in given.rates:
        trace = Trace(hand, 0.0, ONE_WAY, there_and_back=True)
        contacts, switches = visited(coupled(rate), trace)
        print(f"{rate:g} Hz; a turn of {2 * ONE_WAY:g} s: {contacts} contacts, {switches} switches")
        print(f"{'us':28s} {'median':>9s} {'p99':>9s} {'p99.9':>9s} {'p99.99':>9s} {'worst':>9s}")
        for empty in (False, True):
            report = serve(rate, given.seconds, empty, not given.usual)
            tell(f"{rate:g} Hz{', empty' if empty else ''}", report)
        for note in report.notes:
            print(note)


if __name__ == "__main__":
    main()
