"""Haply's Inverse3 over its service on this machine."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np

from standoff.bound_to_run import BoundToRun
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.devices.inverse3_messages import (
    Cursor,
    cursor_of,
    device_ids,
    force_message,
    leaped,
)
from standoff.devices.port import Port
from standoff.devices.tolerances import (
    ASKED_AGAIN,
    BETWEEN_LOOKS,
    CLOSED_WITHIN,
    CONNECTED_WITHIN,
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
