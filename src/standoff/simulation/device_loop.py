"""A run of a system whose tool is coupled to a device: what is read, and what is written back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import DeviceError, StandoffError, StandoffTypeError
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.simulation.arrivals import reading_row
from standoff.simulation.device import Device
from standoff.simulation.device_readings import DeviceReadings
from standoff.simulation.wrench import Wrench
from standoff.typing import Array

NOTHING_READ = np.zeros(K.N_READING)
"""What is read where there is no device."""

NOTHING_READ[K.G_FAULT] = K.MISSING
NOTHING_READ.flags.writeable = False


def check_device(device: Any, coupled: bool) -> None:
    """Refuse what is not a device, and a device where there is no coupler."""
    if device is None:
        return
    if not isinstance(device, Device | DeviceReadings):
        raise StandoffTypeError(
            f"device is {shown(device)}: give a Device, DeviceReadings, or None.", "device", device
        )
    if not coupled:
        raise StandoffError(
            "A device moves the tool of a coupler, and the system has none: give one with "
            "System(..., coupler=..., tool=...).",
            "device",
            device,
        )


def check_count(device: Any, needed: int) -> None:
    """Refuse fewer readings than a run has."""
    if isinstance(device, DeviceReadings) and len(device) < needed:
        raise StandoffError(
            f"device has {len(device)} readings, and the run takes {needed}: give more of them, or "
            "run fewer ticks.",
            "device",
            device,
        )


def given_readings(device: Any, first: int, count: int) -> Array:
    """Return the readings `first` to `first + count` as one row of numbers."""
    if device is None:
        return NOTHING_READ.copy()
    found: Array = device.rows[first : first + count].flatten()
    return found


def read(device: Device) -> Array:
    """Return what a device says now; nothing if it is gone."""
    try:
        return reading_row(device.read())
    except DeviceError:
        return NOTHING_READ.copy()


def write(device: Device, coupler: Array) -> None:
    """Hold the wrench of a coupler's state on the handle; a device that is gone holds none."""
    wrench = Wrench.from_checked(tuple(coupler[K.C_ON_DEVICE : K.C_ON_TOOL].tolist()))
    try:
        device.write(wrench)
    except DeviceError:
        return


def blocks(count: int, each: int) -> Iterator[tuple[int, int]]:
    """Yield (first, last) of the blocks of `each` that make up `count`."""
    for first in range(0, count, each):
        yield first, min(first + each, count)
