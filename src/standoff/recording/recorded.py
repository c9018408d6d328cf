"""The data that a tracked run leaves: one row per frame, and the switching events."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from standoff.automaton.visits import Visit
from standoff.bodies.features import Feature
from standoff.errors import StandoffError
from standoff.motion import PoseLike
from standoff.read_only import KeepsReadOnly
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.tracking.law_options import Law
from standoff.tracking.laws import every_option, law_of_facts
from standoff.tracking.rows import Counts
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.wording import counted, short_name


class Placing(Protocol):
    """What a recording asks of a path."""

    def pose(self, t: float, /) -> PoseLike:
        """The world pose at a time [s]."""


Paths: TypeAlias = tuple[Placing, Placing]
"""Of A and of B."""


class RecordedEvent(NamedTuple):
    """A switch of one body's feature in a recording.

    Attributes
    ----------
    frame : int
        Index of the frame whose step met it.
    time : float
        s, on the recording's clock. Where `located`, the first instant known to be in the target
        feature; else that of the frame.
    body : "A" or "B"
    source, target : Feature
        The features before and after.
    value : float
        The switching function at `time`: slope of the distance (dimensionless) along the
        direction that leads from the lower of the two features into the higher. Zero at a
        located instant, to roundoff; nan where it is not known.
    slope : float
        Rate of the switching function at `time`, 1/s: positive where the higher feature is
        left, negative where it is entered; nan where it is not known.
    located : bool
        Was the instant found within the step, or is it only the time of the frame?
    """

    frame: int
    time: float
    body: str
    source: Feature
    target: Feature
    value: float
    slope: float
    located: bool


@dataclass(frozen=True)
class RunInfo:
    """What a recording is of, and how it was made.

    Attributes
    ----------
    bodies : (str, str)
        Names of A and B.
    digests : (str, str)
        ``Body.digest`` of A and B.
    options : mapping
        ``law``, the law's name; every option of that law, resolved, as plain data with a scene's
        keys; dt (the longest step, s); locate. A file of a format before 4 may lack some. Of solids
        there is no law: tolerance, deadline, minima, dt and locate.
    title : str
    length_unit : str
        Label of lengths; empty where none was given.
    version : str
        The Standoff that made it.
    source : mapping
        What the caller adds, such as a scene's text; plain data that JSON can hold.
    repaired : int
        How many of the poses that the paths gave, two per frame, had a rounded rotation and were
        replaced by the nearest one. A path counts the poses that it was made of itself.
    """

    bodies: tuple[str, str]
    digests: tuple[str, str]
    options: Mapping[str, Any]
    title: str = ""
    length_unit: str = ""
    version: str = ""
    source: Mapping[str, Any] = field(default_factory=dict)
    repaired: int = 0

    @property
    def of_solids(self) -> bool:
        """Is one of the two a solid that need not be convex?"""
        return "law" not in self.options

    @property
    def law(self) -> Law:
        """The law, made again from `options`.

        Raises ValueError: its feedback is a program's own, or the file keeps only its text; or the
        run was of solids, which follow no law.
        """
        if self.of_solids:
            raise StandoffError(
                "This is a run of solids, which follow no law: `options` has what was asked."
            )
        known = ("law", *every_option())
        return law_of_facts({name: self.options[name] for name in known if name in self.options})


@dataclass(frozen=True, eq=False, repr=False)
class RecordedFrames(KeepsReadOnly):
    """The arrays of a run; `Recording` describes them and draws, stores and marks them."""

    time: Array
    distance: Array
    lower_bound: Array
    upper_bound: Array
    rate: Array
    residual: Array
    point_a: Array
    point_b: Array
    normal: Array
    velocity_a: Array
    velocity_b: Array
    feature_a: NDArray[np.object_]
    feature_b: NDArray[np.object_]
    parameters_a: Array
    parameters_b: Array
    status: NDArray[np.object_]
    counts: NDArray[np.int64]
    events: tuple[RecordedEvent, ...]
    info: RunInfo
    pair: tuple[Any, Any] | None = field(default=None, repr=False)
    paths: Paths | None = field(default=None, repr=False)
    minima: LocalMinima | None = field(default=None, repr=False)
    minima_events: tuple[MinimumEvent, ...] = field(default=(), repr=False)

    def __getstate__(self) -> Any:
        # A path may be a function, which cannot be stored.
        state, locked = super().__getstate__()
        return {**state, "paths": None}, locked

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        names = " and ".join(map(short_name, self.info.bodies))
        start, end = self.time[[0, -1]] + 0.0
        return f"<Recording of {counted(len(self), 'frame')}: {names}, {start:g} to {end:g} s>"

    @property
    def certified(self) -> NDArray[np.bool_]:
        """Whether each frame's gap is within the tolerance, shape (n,)."""
        return np.asarray([s.certified for s in self.status], dtype=bool)

    @property
    def penetrating(self) -> NDArray[np.bool_]:
        """Whether the bodies touch or overlap in each frame, shape (n,)."""
        return np.asarray([s.penetrating for s in self.status], dtype=bool)

    @property
    def gap(self) -> Array:
        """Distance less its lower bound [length], shape (n,); nan beyond the horizon."""
        known: Array = np.where(np.isinf(self.distance), np.nan, self.distance)
        return known - self.lower_bound

    def closest(self) -> int | None:
        """Return the frame of the least distance; None where no frame has a distance."""
        some = np.isfinite(self.distance).any()
        return int(np.nanargmin(self.distance)) if some else None

    def widest_gap(self) -> int | None:
        """Return the frame of the greatest gap; None where no frame has one."""
        return None if np.isnan(self.gap).all() else int(np.nanargmax(self.gap))

    def total_counts(self) -> Counts:
        """Return the counts summed over all frames."""
        return Counts(*self.counts.sum(axis=0).tolist())

    def status_frames(self) -> Counter[Status]:
        """Return how many frames ended in each status."""
        return Counter(self.status.tolist())

    def modes(self) -> list[Visit]:
        """Return the visited modes in order of time.

        A stay ends at the instant of the switch that ends it. Where an overlap has no depth, and
        beyond the horizon, there is no mode: the stay before ends at the last frame with one, the
        next one begins at the first frame that has one again. Of several switches at one instant,
        only the last mode is visited.
        """
        visits: list[Visit] = []
        events = list(self.events)
        mode: list[Feature] = []
        start, at = 0.0, 0

        def leave(end: float) -> None:
            if mode and end > start:
                visits.append(Visit(mode[0], mode[1], start, end))

        for frame, time in enumerate(self.time.tolist()):
            here = at
            while at < len(events) and events[at].frame == frame:
                at += 1
            if self.status[frame] in (Status.OVERLAPPING, Status.FAR):
                leave(float(self.time[frame - 1]) if frame else time)
                mode = []
            elif not mode:
                mode, start = [self.feature_a[frame], self.feature_b[frame]], time
            else:
                for event in events[here:at]:
                    leave(event.time)
                    start = max(start, event.time)
                    mode["AB".index(event.body)] = event.target
        leave(float(self.time[-1]))
        return visits
