"""A million frames from a service that lies: ``python tests/devices/device_soak.py``.

A servo runs with an `Inverse3` against a service that speaks the documented messages and mangles
some of its frames. After each bad one every force that the service gets must be zero, until the
servo is engaged again; nothing may crash, and in between the force must come back.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

from fake_service import DEVICE, STATUS, FakeService, state_of
from mangled import Frames, kinds

import standoff as so
from standoff import simulation as sim
from standoff.devices import Inverse3
from standoff.devices.inverse3 import Cursor, cursor_of, leaped
from standoff.servo import Servo

MAX_AGE = 0.01
"""s, of a reading."""

PERIOD = 5e-4
"""s, of loop and device."""


def held_ball(period: float) -> sim.Operator:
    """A ball near the device's home, far from the floor: every offset of the cursor is felt."""
    coupler = sim.VirtualCoupler(
        stiffness=200.0, damping=0.5, max_force=5.0, max_age=MAX_AGE, engage_time=0.0
    )
    floor = sim.RigidBody.fixed(so.shapes.halfspace())
    home = so.Pose(np.eye(3), [0.0, 0.0, 0.15])
    ball = sim.RigidBody.free(so.shapes.sphere(0.01), mass=0.5, pose=home)
    rubber = sim.HuntCrossley(stiffness=1e5, damping=1.0, depth=1e-3)
    system = sim.System([floor, ball], rubber, gravity=[0, 0, 0], coupler=coupler, tool=1)
    return sim.Operator(system, period)


class Soak:
    """What a soak did.

    Attributes
    ----------
    forced_after : int
        Forces that were not zero after a bad frame: there must be none.
    engaged : int
        How often the servo was engaged.
    ends : list of str
        Why servos ended in between, by messages: another one was made.
    """

    def __init__(self, frames: int, seed: int, share: float = 0.2) -> None:
        self.frames, self.share = frames, share
        self.names: Counter[str] = Counter()
        self.engaged, self.refused = 0, 0
        self.ends: list[str] = []
        self._rng = np.random.default_rng(seed)
        self._kinds = list(kinds(2.0 * MAX_AGE).items())
        self.service = FakeService(self.mangle)

    def mangle(self, number: int, text: str) -> Frames:
        """Break some of the frames that come while a force is rendered."""
        if not self.service.forced or self._rng.random() >= self.share:
            return [text]
        chosen = int(self._rng.integers(0, len(self._kinds)))
        name, make = self._kinds[chosen]
        self.names[name] += 1
        self.service.last_bad = name
        return make(text, self._rng)

    def run(self, tell: bool = False) -> Soak:
        """Serve so many frames."""
        began, told = time.monotonic(), 0
        try:
            while self.service.frames < self.frames:
                device = Inverse3(self.service.url, period=PERIOD)
                servo = Servo(held_ball(PERIOD), device=device, log_ticks=100, real_time=tell)
                asked_at = -3
                with servo:
                    while servo.running and self.service.frames < self.frames:
                        assert not servo.problem, servo.problem
                        seen = servo.latest()
                        # neither a request nor a force is under way
                        calm = seen.tick >= asked_at + 3 and self.service.zeros >= 3
                        if not seen.engaged and calm:
                            self.service.clear()
                            servo.engage()
                            self.engaged += 1
                            asked_at = servo.latest().tick
                        time.sleep(1e-3)
                        if tell and time.monotonic() - began > 30.0 * (told + 1):
                            told += 1
                            print(self, flush=True)
                self.refused += device.refused
                self.ends.append(servo.stop().message)
        finally:
            self.service.close()
        return self

    def __repr__(self) -> str:
        found = self.service
        return (
            f"{found.frames} frames, {found.bad} bad, engaged {self.engaged} times, forces to "
            f"{found.greatest_before:.2f} N, {found.forced_after} of them after a bad frame, "
            f"{found.wrong} messages not as documented {dict(found.after)}"
        )


def messages(count: int, seed: int) -> int:
    """Bad frames one by one, without a socket; those that were not refused."""
    rng = np.random.default_rng(seed)
    good = json.dumps(
        {
            "inverse3": [
                {
                    "device_id": DEVICE,
                    "state": state_of([0.01, 0.02, 0.15], [0.1, 0.0, 0.0]),
                    "status": STATUS,
                }
            ]
        }
    )
    before = cursor_of(good, DEVICE)
    assert isinstance(before, Cursor)
    makers = [make for name, make in kinds(0.0).items() if name not in ("doubled", "late")]
    taken = 0
    for _ in range(count):
        (frame,) = makers[int(rng.integers(0, len(makers)))](good, rng)
        found = cursor_of(frame, DEVICE)
        taken += isinstance(found, Cursor) and not leaped(found, before, PERIOD)
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    taken = messages(given.frames, given.seed)
    print(f"{given.frames} bad frames one by one: {taken} were not refused", flush=True)
    soak = Soak(given.frames, given.seed).run(tell=True)
    print(soak, dict(soak.names), dict(Counter(soak.ends)), sep="\n")
    raise SystemExit(bool(taken or soak.service.forced_after or soak.service.wrong))


if __name__ == "__main__":
    main()
