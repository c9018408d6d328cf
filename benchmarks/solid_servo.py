"""How a servo loop keeps its time with solids: a peg that a hand moves about in its hole.

Run with ``python -m benchmarks.solid_servo``: a minute at 1 kHz, beside an empty tick, in which
bodies are left alone. The peg of 20 mm has 10 µm of play. The hand slides it in and out, and
presses and tilts it against the wall all round. Told are what a tick's work takes, the least
energy that was ever seen to have gone into the coupler (`PortEnergy.least`: nothing below zero
where it is passive), how deep the peg was, and places of contact that ended deep. Ten minutes:
``--seconds 600``.
"""

from __future__ import annotations

import argparse

import numpy as np

import standoff as so
from benchmarks.servo import tell
from standoff import simulation as sim
from standoff.devices import Trace
from standoff.kernels.dynamics import servo_arrays as V
from standoff.servo import Servo, ServoReport
from standoff.simulation import SystemState
from standoff.solids import Solid
from standoff_studies.soak import solid_parts

RADIUS, PLAY, LENGTH, DEEP = 0.01, 1e-5, 0.06, 0.04
"""Of the peg and its hole, metres; how deep the hole is."""
ONE_WAY = 20.0
"""s, of the hand, and back."""
ASIDE, TILT = 2e-3, 0.02
"""How far the hand is beside the hole's axis, metres, and tilted, radians."""


def hand(t: float) -> so.Pose:
    """In and out, and pressed against the wall on all sides."""
    begun = min(t, 1.0)
    tilt = TILT * begun * np.array([np.sin(1.7 * t), np.cos(2.3 * t), 0.0])
    aside = ASIDE * begun * np.array([np.cos(2.5 * t), np.sin(2.5 * t)])
    height = 0.015 - 0.012 * np.cos(0.5 * np.pi * t)
    return so.Pose(so.Pose.exp(tilt).rotation, [*aside, height])


def coupled(rate: float) -> sim.Operator:
    """The peg on its coupler, one step a tick."""
    hole = Solid(solid_parts.plate(4.0 * RADIUS, DEEP, RADIUS + PLAY).boundary)
    peg = Solid(solid_parts.drum(RADIUS, LENGTH).boundary)
    sampling = sim.Sampling(period=1.0 / rate, device_damping=1.0, device_rotational_damping=0.01)
    coupler = sim.VirtualCoupler(
        stiffness=800.0, damping=0.5, rotational_stiffness=2.0, rotational_damping=2e-3,
        max_force=20.0, max_torque=1.0, max_age=0.01, sampling=sampling,
    )  # fmt: skip
    contact = sim.HuntCrossley(
        stiffness=1e5, damping=5.0, friction=0.1, slip_speed=0.05, depth=2e-4
    )
    bodies = [sim.RigidBody.fixed(hole), sim.RigidBody.free(peg, mass=0.3, pose=hand(0.0))]
    system = sim.System(bodies, contact, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, 1.0 / rate)


def served(rate: float, seconds: float, empty: bool) -> tuple[ServoReport, SystemState]:
    """A servo of so many seconds, and its state within the last one of them: at its end the coupler
    is at rest."""
    trace = Trace(hand, 0.0, ONE_WAY, there_and_back=True)
    servo = Servo(coupled(rate), device=trace, seconds=seconds, real_time=True)
    servo._plan[V.V_EMPTY] = empty
    servo.engage()
    servo.start()
    seen = servo.latest().state
    while not servo.wait(0.5):
        seen = servo.latest().state
    return servo.stop(), seen


def main() -> None:
    read = argparse.ArgumentParser(description="A servo with a peg in its hole.")
    read.add_argument("--rate", type=float, default=1000.0)
    read.add_argument("--seconds", type=float, default=60.0)
    given = read.parse_args()
    print(f"{'us':28s} {'median':>9s} {'p99':>9s} {'p99.9':>9s} {'p99.99':>9s} {'worst':>9s}")
    for empty in (False, True):
        report, state = served(given.rate, given.seconds, empty)
        tell(f"{given.rate:g} Hz{', empty' if empty else ''}", report)
        if not empty:
            counts, energy = state.coupler.counts, state.coupler.energy
            print(
                f"coupler: least {energy.least:.3g} J, observed {energy.observed:.3g} J, force at "
                f"its limit in {counts.force_limits} ticks; deepest {1e6 * state.deepest:.0f} um, "
                f"{state.uncertified} not certified, {state.jumps} ended deep",
                flush=True,
            )
    for note in report.notes:
        print(note)


if __name__ == "__main__":
    main()
