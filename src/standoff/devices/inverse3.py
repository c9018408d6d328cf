"""Haply's Inverse3 over its service on this machine."""

from __future__ import annotations

import json
import math
import threading
import time
from typing import Any, NamedTuple

import numpy as np

from standoff.bound_to_run import BoundToRun
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.devices.port import Port
from standoff.devices.tolerances import (
    ASKED_AGAIN,
    BETWEEN_LOOKS,
    CLOSED_WITHIN,
    CONNECTED_WITHIN,
    FARTHEST_CURSOR,
    FASTEST_CURSOR,
    JUMP_ALLOWED,
    LONGEST_FRAME,
)
from standoff.errors import DeviceError, StandoffTypeError, of_extra
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.twist import Twist
from standoff.simulation.device import DeviceReading, Fault

URL = "ws://localhost:10001"
"""Where the Inverse Service listens if it is not told otherwise."""

ZERO = (0.0, 0.0, 0.0)


class Inverse3(BoundToRun):
    """Haply's Inverse3, through the WebSocket of the Inverse Service (version 3.5).

    Its own thread sends a force and takes the answer, over and over, and never waits for the loop.
    An answer counts as old as the force that it answers, so that a slow service is noticed. The
    cursor has no orientation: the handle keeps that of `placement`.

    No frame is trusted: one that is broken, late, doubled, from another device, not finite or
    beyond a hand's reach sets the force to zero before the next message is sent, and it stays zero
    until the loop is engaged again. A service that is gone is not contacted again.

    Raises StandoffTypeError: an address or name that is not a string. Raises StandoffError: a
    period that is not above zero; no pose.

    Parameters
    ----------
    url : str
        Of the service.
    device_id : str, optional
        Of the device; the first Inverse3 of the service's inventory if not given.
    period : float
        Time from force to force [s].
    placement : Pose or what `Pose.of` reads, optional
        Of the device's own axes (x right, y forward, z up, origin at its base) in the world; the
        world's lengths are in metres.

    Attributes
    ----------
    problem : str
        Why it no longer gives readings, and what to do.
    frames, refused : int
        Messages received, and how many of them were faulty.
    """

    def __init__(
        self,
        url: str = URL,
        *,
        device_id: str | None = None,
        period: float = 1e-3,
        placement: PoseLike | None = None,
    ) -> None:
        texts: dict[str, Any] = {"url": url, "device_id": device_id}
        for name, given in texts.items():
            if not isinstance(given, str) and (name == "url" or given is not None):
                raise StandoffTypeError(f"{name} is {shown(given)}: give a string.", name, given)
        self._url, self._wanted = url, device_id
        self._period = positive(period, "period")
        self._placement = Pose.identity() if placement is None else Pose.of(placement)
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self.problem, self.frames, self.refused = "", 0, 0

    def attach(self, port: Port) -> None:
        """Connect, and begin to give readings to a port.

        Raises DeviceError: no service answers, or it has no such device. Raises
        ModuleNotFoundError: without the extra 'devices'.
        """
        if self._thread is not None:
            raise DeviceError("the Inverse3 moves another loop's handle; stop that loop first")
        socket = self._connected()
        try:
            device_id = self._chosen(socket)
        except BaseException:
            socket.close()
            raise
        self._stopping.clear()
        self.problem, self.frames, self.refused = "", 0, 0
        self._thread = threading.Thread(
            target=self._talk, args=(socket, device_id, port), name="inverse3", daemon=True
        )
        self._thread.start()

    def detach(self) -> None:
        """Set the force to zero and disconnect; does nothing where there is no connection."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _connected(self) -> Any:
        with of_extra("websockets", "devices"):
            from websockets.sync.client import connect
        try:
            return connect(
                self._url,
                compression=None,
                proxy=None,
                open_timeout=CONNECTED_WITHIN,
                close_timeout=CLOSED_WITHIN,
                max_size=LONGEST_FRAME,
            )
        except Exception as error:  # the library's own kinds, the system's, and invalid addresses
            raise DeviceError(
                f"no Inverse Service answers at {self._url} ({error}): start it, or give its "
                "address (url=...)."
            ) from error

    def _chosen(self, socket: Any) -> str:
        try:
            names = device_ids(socket.recv(CONNECTED_WITHIN))
        except Exception as error:
            raise DeviceError(
                f"the service at {self._url} sent no inventory ({error!r}): restart it."
            ) from error
        wanted = self._wanted
        if wanted is None and names:
            return names[0]
        if wanted is not None and wanted in names:
            return wanted
        known = ", ".join(map(shown, names)) or "none"
        raise DeviceError(
            f"the service at {self._url} has no Inverse3"
            f"{'' if wanted is None else ' ' + shown(wanted)}; it lists {known}: connect the "
            "device, or name another (device_id=...)."
        )

    def _talk(self, socket: Any, device_id: str, port: Port) -> None:
        """The device's thread: force and answer, until it is stopped or the service is gone."""
        from websockets.exceptions import ConnectionClosed

        told = _Conversation(self, socket, device_id, port)
        try:
            while not self._stopping.is_set():
                told.exchange()
            told.send(ZERO)
        except (ConnectionClosed, OSError) as error:
            self.problem = (
                f"the Inverse Service closed the connection ({error}): restart it, then the loop."
            )
        except Exception as error:
            self.problem = f"the connection to the Inverse Service failed: {error!r}"
        finally:
            port.fail(Fault.MISSING)
            socket.close()


class _Conversation:
    """One connection: what was sent last, and what came."""

    def __init__(self, device: Inverse3, socket: Any, device_id: str, port: Port) -> None:
        self._device, self._socket, self._id, self._port = device, socket, device_id, port
        self._sequence, self._first = 0, True
        self._before: tuple[float, Cursor] | None = None

    def send(self, force: tuple[float, float, float]) -> None:
        self._socket.send(force_message(self._id, force, first=self._first))
        self._first = False

    def exchange(self) -> None:
        """One force, one answer, and the rest of the period, in which nothing may come."""
        device, port = self._device, self._port
        force = device._placement.rotation.T @ port.wrench().force
        sent = time.monotonic()
        self.send((float(force[0]), float(force[1]), float(force[2])))
        owed, heard = 1, sent
        while owed and not device._stopping.is_set():
            frame = self._came(max(port.max_age, device._period))
            if frame is None:
                self._before = None
                port.fail(Fault.LATE)
                now = time.monotonic()
                if owed == 1 and sent == heard:  # no force is to be held once the service is back
                    owed, sent = 2, now
                    self.send(ZERO)
                elif now - heard > ASKED_AGAIN:  # an answer was lost
                    owed, heard, sent = 1, now, now
                    self.send(ZERO)
                continue
            owed -= 1
            if owed:
                self._refuse(Fault.LATE)
            else:
                self._take(frame, sent)
        left = sent + device._period - time.monotonic()
        if self._came(max(left, 0.0)) is not None:
            self._refuse(Fault.OUT_OF_ORDER)  # the service answers once: this one is doubled
            # Of a flood, no more than arrives in a period: the device waits for its force of zero.
            end = time.monotonic() + device._period
            while time.monotonic() < end and self._came(0.0) is not None:
                self._refuse(Fault.OUT_OF_ORDER)

    def _take(self, frame: object, sent: float) -> None:
        """Give the port what a frame says, or what is wrong with it."""
        cursor = cursor_of(frame, self._id)
        if isinstance(cursor, Fault):
            self._refuse(cursor)
        elif self._before is not None and leaped(cursor, self._before[1], sent - self._before[0]):
            self._refuse(Fault.INVALID)
        else:
            self._before = (sent, cursor)
            self._sequence += 1
            self._port.put(self._reading(cursor, sent))

    def _came(self, seconds: float) -> Any:
        end = time.monotonic() + seconds
        while True:
            try:
                # Never a timed wait: that of Python's queues can outlast its time (a negative rest
                # of it means for ever), and with it the last force.
                frame = self._socket.recv(0.0)
            except TimeoutError:
                if time.monotonic() >= end:
                    return None
                time.sleep(BETWEEN_LOOKS)
                continue
            self._device.frames += 1
            return frame

    def _refuse(self, fault: Fault) -> None:
        self._device.refused += 1
        self._before = None
        self._port.fail(fault)

    def _reading(self, cursor: Cursor, stamp: float) -> DeviceReading:
        placed = self._device._placement
        position = placed.rotation @ np.array(cursor.position) + placed.translation
        twist = None
        if cursor.velocity is not None:
            twist = Twist(placed.rotation @ np.array(cursor.velocity), [0.0, 0.0, 0.0])
        return DeviceReading(
            stamp, self._sequence, Pose.from_checked(placed.rotation, position), twist
        )


# Messages of Haply's Inverse Service, version 3.5: what is sent to it, and what it says.
#
# Documented at https://docs.haply.co/inverseSDK/service/realtime/websocket-protocol: JSON over a
# WebSocket, ws://localhost:10001. At first the service sends an inventory of all devices; after
# that exactly one message for each that it is sent. Positions are in metres, forces in newtons,
# axes right-handed: x right, y forward, z up.

Vector = tuple[float, float, float]

PROFILE = "standoff"
"""By what name the service lists a session of this library."""

MUST_BE = {"power_supply": True, "ready": True, "started": True}
"""What the status of a usable device says, if it says anything."""


class Cursor(NamedTuple):
    """What a frame says of one device, in its own axes.

    Attributes
    ----------
    position : three floats
        [m]
    velocity : three floats or None
        [m/s]; None where the frame has none.
    """

    position: Vector
    velocity: Vector | None


def force_message(device_id: str, force: Vector, *, first: bool = False) -> str:
    """Return the message that holds a force on a cursor until the next; the first names us too."""
    vector = dict(zip("xyz", force, strict=True))
    told: dict[str, Any] = {}
    if first:
        told["session"] = {"configure": {"profile": {"name": PROFILE}}}
    told["inverse3"] = [
        {"device_id": device_id, "commands": {"set_cursor_force": {"vector": vector}}}
    ]
    return json.dumps(told)


def device_ids(frame: object) -> list[str]:
    """Return the names of all Inverse3 that a frame lists; none where it is broken."""
    listed = _devices(frame)
    if isinstance(listed, Fault):
        return []
    return [one["device_id"] for one in listed if isinstance(one.get("device_id"), str)]


def cursor_of(frame: object, device_id: str) -> Cursor | Fault:
    """Return what a frame says of a device, or what is wrong with it; never raises.

    Parameters
    ----------
    frame : object
        As it came from the socket.
    device_id : str
    """
    listed = _devices(frame)
    if isinstance(listed, Fault):
        return listed
    found = [one for one in listed if one.get("device_id") == device_id]
    if len(found) != 1:
        return Fault.MISSING if not found else Fault.MALFORMED
    status = found[0].get("status", {})
    if not isinstance(status, dict):
        return Fault.MALFORMED
    for name, wanted in MUST_BE.items():
        if status.get(name, wanted) is not wanted:
            return Fault.INVALID
    state = found[0].get("state")
    if not isinstance(state, dict):
        return Fault.MALFORMED
    position = _vector(state.get("cursor_position"))
    velocity = _vector(state["cursor_velocity"]) if "cursor_velocity" in state else None
    for given in (position, velocity):
        if isinstance(given, Fault):
            return given
    if isinstance(position, Fault) or isinstance(velocity, Fault):
        return Fault.MALFORMED
    if math.hypot(*position) > FARTHEST_CURSOR:
        return Fault.INVALID
    if velocity is not None and math.hypot(*velocity) > FASTEST_CURSOR:
        return Fault.INVALID
    return Cursor(position, velocity)


def leaped(cursor: Cursor, before: Cursor, elapsed: float) -> bool:
    """Is a cursor farther from where it was than a hand can have moved it?"""
    return math.dist(cursor.position, before.position) > JUMP_ALLOWED + FASTEST_CURSOR * elapsed


def _devices(frame: object) -> list[dict[str, Any]] | Fault:
    if not isinstance(frame, str | bytes) or len(frame) > LONGEST_FRAME:
        return Fault.MALFORMED
    try:
        told = json.loads(frame, parse_constant=_refuse)
    except (ValueError, RecursionError):  # also what is not UTF-8
        return Fault.MALFORMED
    listed = told.get("inverse3") if isinstance(told, dict) else None
    if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
        return Fault.MALFORMED
    return listed


def _refuse(name: str) -> None:
    raise ValueError(name)


def _vector(given: object) -> Vector | Fault:
    """Three finite numbers under the names of the axes."""
    if not isinstance(given, dict):
        return Fault.MALFORMED
    found = [given.get(axis) for axis in "xyz"]
    numbers = []
    for each in found:
        if isinstance(each, bool) or not isinstance(each, int | float):
            return Fault.MALFORMED
        try:
            numbers.append(float(each))
        except OverflowError:  # a whole number beyond all floats
            return Fault.NON_FINITE
    if not all(map(math.isfinite, numbers)):  # 1e999 is read as infinite
        return Fault.NON_FINITE
    return (numbers[0], numbers[1], numbers[2])
