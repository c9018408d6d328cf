"""Readings of a device as numbers, for runs that ask no device and run without Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final

import numpy as np

from standoff.checks.numbers import positive, whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.paths import Path
from standoff.motion.pose import PoseLike
from standoff.motion.pose_function import path_of
from standoff.read_only import KeepsReadOnly
from standoff.simulation.arrivals import reading_row
from standoff.simulation.device import DeviceReading
from standoff.typing import Array

MOST_MADE: Final = 1_000_000
"""Greatest number of readings made from one path: a quarter of an hour at 1 kHz, 180 MB."""


class DeviceReadings(KeepsReadOnly):
    """What a device said, reading by reading: recorded, or written by hand.

    Raises StandoffTypeError: not iterable. Raises StandoffError: no reading at all.

    Parameters
    ----------
    readings : iterable of DeviceReading or None
        None where nothing came. A faulty one is not an error here: the coupler lets go when its
        turn comes, as with a device.

    Attributes
    ----------
    rows : (n, m) array
        Laid out in ``standoff.kernels.dynamics.coupler_arrays``.
    """

    rows: Array

    def __init__(self, readings: Iterable[DeviceReading | None]) -> None:
        given: Any = readings
        try:
            listed = None if isinstance(given, str | bytes) else list(given)
        except TypeError:
            listed = None
        if listed is None:
            raise StandoffTypeError(
                f"readings is {shown(readings)}: give a list of DeviceReading, None where nothing "
                "came.",
                "readings",
                readings,
            )
        rows = [reading_row(reading) for reading in listed]
        if not rows:
            raise StandoffError(
                "readings is empty: give at least one reading.", "readings", readings
            )
        self.rows = np.array(rows)
        self.rows.flags.writeable = False

    @classmethod
    def along(
        cls, path: Path | Callable[[float], PoseLike], count: int, period: float
    ) -> DeviceReadings:
        """Return the readings of a handle that follows a path, from time 0 on.

        Raises StandoffError: a count below one or beyond a million, a period that is not above
        zero. Raises StandoffTypeError: not a path.

        Parameters
        ----------
        path : Path or function of the time
            Of the handle, in the world; its twists come with the readings.
        count : int
        period : float
            From reading to reading [s].
        """
        found: Any = path_of(path)
        seconds = positive(period, "period")
        times = [k * seconds for k in range(whole_number(count, "count", 1, MOST_MADE))]
        return cls(DeviceReading(t, k, found.pose(t), found.twist(t)) for k, t in enumerate(times))

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return f"<DeviceReadings, {len(self)} of them>"
