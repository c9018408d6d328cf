"""Where a recording is being played: its frame, its clock, its speed."""

from __future__ import annotations

from typing import Any, Generic, Protocol, TypeVar

import numpy as np

SPEEDS = {"×0.1": 0.1, "×0.25": 0.25, "×0.5": 0.5, "×1": 1.0, "×2": 2.0, "×5": 5.0}
"""How much faster than its own time a recording is played, by the words of the page."""


class Playable(Protocol):
    """Frames that can be played: a recording of a pair, the course of a world, or a simulation."""

    @property
    def time(self) -> Any:
        """(n,) array [s]."""


R = TypeVar("R", bound=Playable)


class Player(Generic[R]):
    """A recording and the time at which it stands.

    Parameters
    ----------
    recording : Playable

    Attributes
    ----------
    time : float
        On the recording's clock [s].
    playing : bool
    speed : float
        No unit.
    """

    def __init__(self, recording: R) -> None:
        self.recording = recording
        self.time = self.first
        self.playing = False
        self.speed = 1.0

    @property
    def first(self) -> float:
        """Time of the first frame [s]."""
        return float(self.recording.time[0])

    @property
    def last(self) -> float:
        """Time of the last frame [s]."""
        return float(self.recording.time[-1])

    @property
    def frame(self) -> int:
        """Number of the frame that is shown: the last one that is not after `time`."""
        found = int(np.searchsorted(self.recording.time, self.time, side="right")) - 1
        return max(found, 0)

    def seek(self, time: float) -> None:
        """Stand at a time [s], or at the nearest that the recording has."""
        self.time = min(max(time, self.first), self.last)

    def advance(self, elapsed: float) -> None:
        """Let a time pass [s]; after the last frame the first one follows."""
        if not self.playing:
            return
        self.time += self.speed * elapsed
        if self.time > self.last:
            self.time = self.first

    def behind(self, span: float, most: int) -> slice:
        """Return the frames of the last `span` seconds, thinned to `most` of them or fewer."""
        end = self.frame
        begin = int(np.searchsorted(self.recording.time, self.time - span))
        step = max(1, -(-(end + 1 - begin) // most))
        return slice(begin + (end - begin) % step, end + 1, step)
