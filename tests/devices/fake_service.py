"""A service that speaks the messages of Haply's Inverse Service 3.5, and breaks them if told to."""

from __future__ import annotations

import json
import math
import socket as tcp
import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

DEVICE = "049D"

Mangle = Callable[[int, str], list[str | bytes | float]]
"""From the number of an answer and the answer to what is sent: frames, and times to wait [s]."""


def plain(number: int, text: str) -> list[str | bytes | float]:
    """Nothing is mangled."""
    return [text]


def state_of(position: list[float], velocity: list[float]) -> dict[str, Any]:
    """A device's state, with the fields that the service documents."""
    zero = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {
        "cursor_position": dict(zip("xyz", position, strict=True)),
        "cursor_velocity": dict(zip("xyz", velocity, strict=True)),
        "angular_position": {"a0": 0.0, "a1": 0.0, "a2": 0.0},
        "body_orientation": {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0},
        "current_cursor_force": zero,
        "control_domain": "cartesian",
        "control_mode": "idle",
    }


STATUS = {
    "calibrated": True,
    "in_use": False,
    "power_supply": True,
    "ready": True,
    "started": True,
}


class FakeService:
    """One device, whose cursor goes round in a circle of a centimetre, twice a second.

    Attributes
    ----------
    forces : list of (float, ...)
        What was sent last, newest last: x, y, z; bounded.
    wrong : int
        Messages that were not as documented.
    sent_bad : bool
        A frame was mangled since `clear`; from then on `forced_after` counts forces not zero.
    """

    def __init__(self, mangle: Mangle = plain, devices: list[str] | None = None) -> None:
        self.mangle = mangle
        self.devices = [DEVICE] if devices is None else devices
        self.forces: list[tuple[float, float, float]] = []
        self.frames, self.wrong, self.bad = 0, 0, 0
        self.forced_after, self.greatest_before = 0, 0.0
        self.allowed = 0
        self.sent_bad, self.forced = False, False
        self.zeros = 0  # forces of zero that came last
        self.last_bad, self.after = "", Counter[str]()
        self.profiles: list[str] = []
        self._server = serve(self._serve, "127.0.0.1", 0, compression=None)
        self.port = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()
        self.open: ServerConnection | None = None

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}"

    def clear(self) -> None:
        """The loop is about to be engaged again."""
        self.sent_bad = False
        self.forced = False
        self.zeros = 0

    def close(self) -> None:
        if self.open is not None:
            self.open.close()
        self._server.shutdown()
        self._thread.join()

    def _frame(self) -> str:
        turn = 4.0 * math.pi * time.monotonic()
        position = [0.01 * math.cos(turn), 0.01 * math.sin(turn), 0.15]
        velocity = [-0.1257 * math.sin(turn), 0.1257 * math.cos(turn), 0.0]
        state = state_of(position, velocity)
        return json.dumps(
            {"inverse3": [{"device_id": d, "state": state, "status": STATUS} for d in self.devices]}
        )

    def _serve(self, socket: ServerConnection) -> None:
        self.open = socket
        try:
            socket.send(self._frame())
            while True:
                self._heard(json.loads(socket.recv()))
                text = self._frame()
                told = self.mangle(self.frames, text)
                self.frames += 1
                if told != [text]:
                    self.bad += 1
                    # The second of two may be taken for the answer to the next force; it is found
                    # out when that one's own answer comes.
                    self.allowed = 2 if len(told) > 1 else 0
                    self.sent_bad = True
                self._answer(socket, told)
        except ConnectionClosed:
            return
        except _HungUp:
            socket.socket.close()

    def _answer(self, socket: ServerConnection, told: list[str | bytes | float]) -> None:
        try:
            # Frames that go out one after another arrive as one, as far as that can be had: on a
            # busy machine the second of two would else come in the next period, as its answer.
            if hasattr(tcp, "TCP_CORK"):
                socket.socket.setsockopt(tcp.IPPROTO_TCP, tcp.TCP_CORK, 1)
            for each in told:
                if isinstance(each, float):
                    time.sleep(each)
                else:
                    socket.send(each)
            if hasattr(tcp, "TCP_CORK"):
                socket.socket.setsockopt(tcp.IPPROTO_TCP, tcp.TCP_CORK, 0)
        except ConnectionClosed:
            return  # by the other side: what it sent before that is still to be read

    def _heard(self, message: Any) -> None:
        profile = message.get("session", {}).get("configure", {}).get("profile", {}).get("name")
        if profile:
            self.profiles.append(profile)
        try:
            (one,) = message["inverse3"]
            vector = one["commands"]["set_cursor_force"]["vector"]
            force = (float(vector["x"]), float(vector["y"]), float(vector["z"]))
            self.wrong += one["device_id"] not in self.devices or not all(map(math.isfinite, force))
        except (KeyError, TypeError, ValueError):
            self.wrong += 1
            return
        self.forces = [*self.forces[-20:], force]
        size = math.hypot(*force)
        if self.sent_bad:
            if size > 0.0 and self.allowed == 0:
                self.forced_after += 1
                self.after[self.last_bad] += 1
            self.forced = False
            self.allowed = max(self.allowed - 1, 0)
        else:
            self.greatest_before = max(self.greatest_before, size)
            self.forced = size > 0.0
        self.zeros = 0 if size > 0.0 else self.zeros + 1


class _HungUp(Exception):
    """The service is gone without a word."""


def hang_up(number: int, text: str) -> list[str | bytes | float]:
    """The service dies."""
    raise _HungUp
