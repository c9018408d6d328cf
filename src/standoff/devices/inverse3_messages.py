"""Messages of Haply's Inverse Service, version 3.5: what is sent to it, and what it says.

Documented at https://docs.haply.co/inverseSDK/service/realtime/websocket-protocol: JSON over a
WebSocket, ws://localhost:10001. At first the service sends an inventory of all devices; after that
exactly one message for each that it is sent. Positions are in metres, forces in newtons, axes
right-handed: x right, y forward, z up.
"""

from __future__ import annotations

import json
import math
from typing import Any, NamedTuple

from standoff.devices.tolerances import FARTHEST_CURSOR, FASTEST_CURSOR, JUMP_ALLOWED, LONGEST_FRAME
from standoff.simulation.device import Fault

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
