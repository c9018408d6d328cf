"""An Inverse3 by a service that speaks the documented messages, and one that breaks them."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from mangled import kinds

import standoff as so
from standoff.devices import Inverse3
from standoff.devices.inverse3 import Cursor, _Conversation, cursor_of, device_ids, force_message
from standoff.errors import DeviceError, StandoffTypeError
from standoff.servo import Servo
from standoff.simulation import Fault, Wrench
from waiting import until

pytest.importorskip("websockets", reason="the extra 'devices' is not installed")

import device_soak
from fake_service import DEVICE, FakeService, hang_up


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that others use holds up a loop without a priority now and then."""
    monkeypatch.setattr("standoff.servo.loop.LONGEST_GAP", 2.0)


@pytest.fixture
def service() -> Iterator[FakeService]:
    made = FakeService()
    yield made
    made.close()


def engaged(servo: Servo, service: FakeService) -> None:
    """Engage until the service is sent a force: a late frame of a busy machine ends it."""
    until(lambda: servo.ready)

    def forced() -> bool:
        if not servo.latest().engaged:
            servo.engage()
            time.sleep(2e-3)
        return bool(service.forces and any(service.forces[-1]))

    until(forced)


def test_messages_are_those_that_are_documented() -> None:
    told = json.loads(force_message("049D", (0.0, -1.0, 1.5), first=True))
    assert told == {
        "session": {"configure": {"profile": {"name": "standoff"}}},
        "inverse3": [
            {
                "device_id": "049D",
                "commands": {"set_cursor_force": {"vector": {"x": 0.0, "y": -1.0, "z": 1.5}}},
            }
        ],
    }
    assert "session" not in json.loads(force_message("049D", (0.0, 0.0, 0.0)))
    frame = json.dumps(
        {
            "session_id": 7,
            "inverse3": [
                {
                    "device_id": "049D",
                    "state": {
                        "cursor_position": {"x": 0.0, "y": -0.12, "z": 0.15},
                        "cursor_velocity": {"x": 0.0, "y": 0.5, "z": 0},
                    },
                }
            ],
        }
    )
    assert device_ids(frame) == ["049D"]
    assert cursor_of(frame, "049D") == Cursor((0.0, -0.12, 0.15), (0.0, 0.5, 0.0))
    assert cursor_of(frame.replace("cursor_velocity", "other"), "049D") == Cursor(
        (0.0, -0.12, 0.15), None
    )
    assert cursor_of(frame, "05AB") is Fault.MISSING


def test_every_bad_frame_is_refused() -> None:
    assert device_soak.messages(3000, seed=2) == 0


def test_a_hand_s_force_comes_and_ends(service: FakeService) -> None:
    placement = so.Pose.exp([0.0, 0.0, np.pi / 2.0], [0.0, 0.0, 0.0])
    device = Inverse3(service.url, placement=placement)
    with Servo(device_soak.held_ball(2e-3), device=device, max_age=0.2) as servo:
        engaged(servo, service)
        handle = servo.latest().state.coupler.handle
        # the cursor is a centimetre off the ball, which the force pulls to
        assert handle is None or 0.005 < np.hypot(*handle.p[:2]) < 0.02
        servo.disengage()
        until(lambda: not any(service.forces[-1]))
        engaged(servo, service)
    # sent before the connection closed, and read by the service in its own time
    until(lambda: not any(service.forces[-1]))
    assert (service.wrong, service.profiles) == (0, ["standoff"])


def test_a_service_that_dies_ends_the_force(service: FakeService) -> None:
    device = Inverse3(service.url)
    with Servo(device_soak.held_ball(2e-3), device=device, max_age=0.2) as servo:
        engaged(servo, service)
        service.mangle = hang_up
        until(lambda: servo.problem)
        until(lambda: not servo.latest().engaged)
        assert servo.latest().fault in (Fault.MISSING, Fault.LATE)
        assert not servo.latest().wrench.force.any()
        servo.engage()  # the device is gone: it lets go again
        time.sleep(0.02)
        assert not servo.latest().wrench.force.any()
    assert "the Inverse Service" in servo.stop().problem


@pytest.mark.parametrize("name", kinds(0.0))
def test_a_bad_frame_ends_the_force(
    service: FakeService, name: str, rng: np.random.Generator
) -> None:
    make = kinds(0.3)[name]
    device = Inverse3(service.url)
    with Servo(device_soak.held_ball(2e-3), device=device, max_age=0.1) as servo:
        engaged(servo, service)
        service.clear()
        broken = []

        def once(number: int, text: str) -> list[str | bytes | float]:
            if broken:
                return [text]
            broken.append(text)
            return make(text, rng)

        service.mangle = once
        until(lambda: not servo.latest().engaged)
        until(lambda: not any(service.forces[-1]))
        time.sleep(0.02)
        assert service.forced_after == 0
        assert not any(service.forces[-1])
        service.clear()
        engaged(servo, service)


@pytest.mark.parametrize("answered", [True, False])
def test_a_flood_ends_the_force_and_holds_no_stop_up(service: FakeService, answered: bool) -> None:
    device = Inverse3(service.url)
    with Servo(device_soak.held_ball(2e-3), device=device, max_age=0.2) as servo:
        engaged(servo, service)
        flood = Flood(service, answered=answered)
        service.mangle = flood
        until(lambda: flood.sent > 1000)
        until(lambda: not servo.latest().engaged)
        if answered:  # and the device is told so while the flood goes on
            until(lambda: service.zeros > 10)
        started = time.monotonic()
        servo.stop()
        seconds = time.monotonic() - started
        flood.over.set()
    assert seconds < 5.0  # an unanswered flood lasts for 20 s
    # of what it does not hear it knows nothing
    if answered:
        until(lambda: not any(service.forces[-1]))


def test_of_a_flood_no_more_is_read_than_comes_in_a_period() -> None:
    class Endless:
        """A connection that has another frame at any time, for a minute."""

        def __init__(self) -> None:
            self.end, self.forces = time.monotonic() + 60.0, 0

        def send(self, message: str) -> None:
            self.forces += 1

        def recv(self, seconds: float) -> str:
            if time.monotonic() > self.end:
                raise ConnectionError("of a flood all was read")
            return "{}"

    class Quiet:
        """A port that tells of no force."""

        max_age = 0.01

        def wrench(self) -> Wrench:
            return Wrench.zero()

        def fail(self, fault: Fault) -> None:
            pass

    socket, device = Endless(), Inverse3()
    told = _Conversation(device, socket, DEVICE, Quiet())  # type: ignore[arg-type]
    started = time.monotonic()
    for _ in range(5):
        told.exchange()
    assert time.monotonic() - started < 30.0
    assert socket.forces == 5
    assert device.refused > 5


class Flood:
    """Answers without end; between them the service hears the forces, or it does not."""

    def __init__(self, service: FakeService, *, answered: bool) -> None:
        self._service, self._answered = service, answered
        self.sent, self.over = 0, threading.Event()

    def __call__(self, number: int, text: str) -> list[str | bytes | float]:
        end = time.monotonic() + (0.02 if self._answered else 20.0)
        while time.monotonic() < end and self.sent < 10_000_000 and not self.over.is_set():
            assert self._service.open is not None
            self._service.open.send(text)
            self.sent += 1
        return [text]


def test_a_short_soak() -> None:
    found = device_soak.Soak(1500, seed=3).run()
    assert found.service.bad > 10
    assert found.service.greatest_before > 0.0
    assert found.service.forced_after == 0, found.service.after
    assert found.service.wrong == 0


def test_what_is_not_there_is_told() -> None:
    with pytest.raises(DeviceError, match=r"no Inverse Service answers at ws://127\.0\.0\.1:1"):
        Servo(device_soak.held_ball(2e-3), device=Inverse3("ws://127.0.0.1:1")).start()
    with pytest.raises(StandoffTypeError, match="url is 3: give a string"):
        Inverse3(3)  # type: ignore[arg-type]
    service = FakeService(devices=["A", "B"])
    try:
        with pytest.raises(DeviceError, match=r"no Inverse3 'C'; it lists 'A', 'B'"):
            Servo(device_soak.held_ball(2e-3), device=Inverse3(service.url, device_id="C")).start()
    finally:
        service.close()
    assert DEVICE == "049D"
