"""What a run leaves: one row a frame, and the switching events."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from standoff.scene.reader import Array
from standoff.tracking import Counts, Event, Feature, Proximity, Status


@dataclass(frozen=True)
class RecordedEvent:
    """A switching event and the frame whose step met it.

    Attributes
    ----------
    frame : int
        Index of the frame.
    time : float
        Scene time [s]: that of the frame, or within the step before it where it was located.
    event : Event
        What the tracker told.
    """

    frame: int
    time: float
    event: Event


@dataclass(frozen=True, eq=False)
class Recording:
    """Answers of a run, by frame; row k of every array belongs to ``times[k]``.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Scene times [s].
    distance, lower_bound, rate, residual : ndarray, shape (n,)
        As in `Proximity`; NaN in rows not yet reached.
    point_a, point_b, normal, velocity_a, velocity_b : ndarray, shape (n, 3)
        World axes.
    parameters_a, parameters_b : ndarray, shape (n, 3)
        NaN where the feature has fewer parameters.
    counts : ndarray of int, shape (n, len(Counts._fields))
        Work of each frame.
    certified : ndarray of bool, shape (n,)
    features_a, features_b : list of Feature
    statuses : list of Status
    events : list of RecordedEvent
    """

    times: Array
    distance: Array
    lower_bound: Array
    rate: Array
    residual: Array
    point_a: Array
    point_b: Array
    normal: Array
    velocity_a: Array
    velocity_b: Array
    parameters_a: Array
    parameters_b: Array
    counts: np.ndarray[tuple[int, int], np.dtype[np.int64]]
    certified: np.ndarray[tuple[int], np.dtype[np.bool_]]
    features_a: list[Feature] = field(default_factory=list)
    features_b: list[Feature] = field(default_factory=list)
    statuses: list[Status] = field(default_factory=list)
    events: list[RecordedEvent] = field(default_factory=list)

    @classmethod
    def empty(cls, times: Array) -> Recording:
        """Return a recording with no row written yet."""

        def unwritten(*shape: int) -> Array:
            return np.full((len(times), *shape), np.nan)

        return cls(
            times=times,
            distance=unwritten(),
            lower_bound=unwritten(),
            rate=unwritten(),
            residual=unwritten(),
            point_a=unwritten(3),
            point_b=unwritten(3),
            normal=unwritten(3),
            velocity_a=unwritten(3),
            velocity_b=unwritten(3),
            parameters_a=unwritten(3),
            parameters_b=unwritten(3),
            counts=np.zeros((len(times), len(Counts._fields)), dtype=np.int64),
            certified=np.zeros(len(times), dtype=np.bool_),
        )

    def append(self, answer: Proximity) -> None:
        """Write the next row."""
        row = len(self.statuses)
        for name in ("distance", "lower_bound", "rate", "residual", "certified", "counts"):
            getattr(self, name)[row] = getattr(answer, name)
        for name in ("point_a", "point_b", "normal", "velocity_a", "velocity_b"):
            getattr(self, name)[row] = getattr(answer, name)
        self.parameters_a[row, : len(answer.parameters_a)] = answer.parameters_a
        self.parameters_b[row, : len(answer.parameters_b)] = answer.parameters_b
        self.features_a.append(answer.feature_a)
        self.features_b.append(answer.feature_b)
        self.statuses.append(answer.status)
        self.events.extend(
            RecordedEvent(row, float(self.times[row]), event) for event in answer.events
        )

    @property
    def gap(self) -> Array:
        """Distance less its lower bound [length], shape (n,)."""
        return self.distance - self.lower_bound

    def closest(self) -> int | None:
        """Return the frame of the least distance; None where no frame has a distance."""
        return None if np.isnan(self.distance).all() else int(np.nanargmin(self.distance))

    def widest_gap(self) -> int | None:
        """Return the frame of the greatest gap; None where no frame has one."""
        return None if np.isnan(self.gap).all() else int(np.nanargmax(self.gap))

    def total_counts(self) -> Counts:
        """Return the counts summed over all frames."""
        return Counts(*self.counts.sum(axis=0).tolist())

    def status_frames(self) -> Counter[Status]:
        """Return how many frames ended in each status."""
        return Counter(self.statuses)
