"""A recorded motion of a handle, played to a loop as if a device said it."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np

from standoff.checks.numbers import number, positive, yes_or_no
from standoff.devices.tolerances import PERIOD_ROUNDING
from standoff.errors import StandoffError
from standoff.kernels.dynamics import coupler_arrays as K
from standoff.motion.paths import Path
from standoff.motion.pose import PoseLike
from standoff.motion.pose_function import path_of
from standoff.motion.samples import PoseSamples
from standoff.motion.samples_file import read_pose_samples
from standoff.read_only import KeepsReadOnly
from standoff.simulation.arrivals import reading_row
from standoff.simulation.device import DeviceReading
from standoff.simulation.device_readings import MOST_MADE
from standoff.typing import Array


class Trace(KeepsReadOnly):
    """A handle that follows a recorded motion, whatever force is on it.

    The loop reads it tick by tick from a table, so that the same trace gives the same run on every
    machine. Between samples it moves as `PoseSamples` does. Each reading is as old as the tick that
    takes it.

    Raises StandoffTypeError: not a path. Raises StandoffError: an end that is not after the start;
    a flag that is neither true nor false.

    Parameters
    ----------
    path : Path or function of the time
        Of the handle, in the world.
    start, end : float
        The times between which it is played, on the path's own clock [s].
    there_and_back : bool
        Play it to its end, then backwards to its start, and so on; else, when it is over, there are
        no more readings, and the force is zero.
    """

    path: Path
    start: float
    end: float
    there_and_back: bool

    def __init__(
        self,
        path: Path | Callable[[float], PoseLike],
        start: float,
        end: float,
        *,
        there_and_back: bool = False,
    ) -> None:
        found: Any = path_of(path)
        self.path = found
        self.start, self.end = number(start, "start"), number(end, "end")
        if not self.end > self.start:
            raise StandoffError(
                f"end is {self.end:g}: give a time after the start, {self.start:g}.", "end", end
            )
        self.there_and_back = yes_or_no(there_and_back, "there_and_back")

    @classmethod
    def read(cls, file: str | os.PathLike[str], *, there_and_back: bool = False) -> Trace:
        """Read a recorded motion: what a servo logged, or any file of `read_pose_samples`.

        Raises StandoffError, OSError, ModuleNotFoundError as `standoff.motion.read_pose_samples`.

        Parameters
        ----------
        file : str or path
            ``.parquet`` with the columns ``time``, ``x y z`` and ``qx qy qz qw``, as a servo's log
            has them of its handle; or ``.csv``, ``.tum``.
        there_and_back : bool
            As above.
        """
        samples: PoseSamples = read_pose_samples(file)
        return cls(samples, samples.start, samples.end, there_and_back=there_and_back)

    @property
    def duration(self) -> float:
        """Time from its start to its end [s]."""
        return self.end - self.start

    def rows(self, period: float) -> Array:
        """Return its readings as the kernels read them, one per period.

        Raises StandoffError: more than a million readings, or less than two.

        Parameters
        ----------
        period : float
            [s]

        Returns
        -------
        (n, m) array
            Laid out in ``standoff.kernels.dynamics.coupler_arrays``, stamps from 0 on.
        """
        seconds = positive(period, "period")
        count = int(self.duration / seconds * (1.0 + PERIOD_ROUNDING)) + 1
        turns = 2 * (count - 1) if self.there_and_back else count
        if not count >= 2 or turns > MOST_MADE:
            raise StandoffError(
                f"period is {seconds:g}: with it a trace of {self.duration:g} s has {turns} "
                f"readings; 2 to {MOST_MADE} can be played.",
                "period",
                period,
            )
        times = self.start + seconds * np.arange(count)
        times[-1] = min(times[-1], self.end)
        forth = [
            reading_row(DeviceReading(0.0, 0, self.path.pose(t), self.path.twist(t)))
            for t in times.tolist()
        ]
        rows = np.array(forth)
        if self.there_and_back:
            back = rows[-2:0:-1].copy()
            back[:, K.G_MOTION + 12 :] *= -1.0
            rows = np.concatenate([rows, back])
        rows[:, K.G_TIME] = seconds * np.arange(len(rows))
        rows[:, K.G_SEQUENCE] = np.arange(len(rows))
        rows.flags.writeable = False
        return rows

    def __repr__(self) -> str:
        again = ", there and back" if self.there_and_back else ""
        return f"<Trace of {self.duration:g} s{again}>"
