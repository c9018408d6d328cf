"""What a tracked run leaves: one row a frame, and the switching events."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import Feature, feature_of
from standoff.kernels import events as N
from standoff.kernels import frame as K
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import shown
from standoff.tracking.proximity import Counts, charts_of
from standoff.tracking.status import Status
from standoff.tracking.visits import Visit
from standoff.whole_files import file_name, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from standoff.tracking.automaton import Automaton

Array = NDArray[np.float64]
# Where the fields of Counts stand in the kernels' own counts.
COUNT_COLUMNS = [
    K.OUT_COUNTS + k
    for k in (
        N.EVALUATIONS,
        N.CORRECTIONS,
        N.EVENTS,
        N.CHART_CHANGES,
        N.RESTARTS,
        N.REGULARISED,
        N.SATURATIONS,
        N.SEARCHES,
    )
]


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
        Was the instant found within the step, or is it only dated to the frame?
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
        law, predictor, integrator, gain (1/s), tolerance, dt (the longest step, s), depth,
        deadline (evaluations, or None), locate; of the paper's law also feedback (as text),
        realisation, saturation, switching and solve. Of a file of format version 2 depth and
        deadline are not known, and missing here.
    title : str
    length_unit : str
        Label of lengths; empty where none was given.
    version : str
        The Standoff that made it.
    source : mapping
        What the caller adds, such as a scene's text; plain data that JSON can hold.
    """

    bodies: tuple[str, str]
    digests: tuple[str, str]
    options: Mapping[str, Any]
    title: str = ""
    length_unit: str = ""
    version: str = ""
    source: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Recording(KeepsReadOnly):
    """Answers of a run, by frame; row k of every array belongs to ``time[k]``.

    All vectors in world axes, lengths in the bodies' unit.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s, strictly increasing.
    distance, lower_bound, upper_bound, rate, residual : ndarray, shape (n,)
        As in `Proximity`; nan while overlapping. ``upper_bound`` is nan in all frames of a file
        of format version 2, which does not hold it.
    point_a, point_b, normal, velocity_a, velocity_b : ndarray, shape (n, 3)
    feature_a, feature_b : ndarray of Feature, shape (n,)
    parameters_a, parameters_b : ndarray, shape (n, 3)
        nan where the feature has fewer parameters.
    status : ndarray of Status, shape (n,)
    counts : ndarray of int, shape (n, 8)
        Work of each frame, in the order of `Counts`.
    events : tuple of RecordedEvent
        In order of frame and time. Of each body the source of an event is the target of the one
        before.
    info : RunInfo
    pair : (Body, Body) or None
        A and B; None in a recording opened from a file, which keeps their digests only.
    """

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
    pair: tuple[Body, Body] | None = field(default=None, repr=False)

    @classmethod
    def of_answers(
        cls,
        time: Array,
        answers: Array,
        events: tuple[RecordedEvent, ...],
        pair: tuple[Body, Body],
        info: RunInfo,
    ) -> Recording:
        """Return the recording of a run's flat answers, (n, N_OUT) as ``kernels.frame`` has it."""
        a, b = pair
        statuses = {status.value: status for status in Status}
        rows = np.array(answers)

        def vectors(first: int) -> Array:
            return rows[:, first : first + 3]

        return cls(
            time=time,
            distance=rows[:, K.DISTANCE],
            lower_bound=rows[:, K.LOWER_BOUND],
            upper_bound=rows[:, K.UPPER_BOUND],
            rate=rows[:, K.OUT_RATE],
            residual=rows[:, K.RESIDUAL],
            point_a=vectors(K.POINT_A),
            point_b=vectors(K.POINT_B),
            normal=vectors(K.NORMAL),
            velocity_a=vectors(K.VELOCITY_A),
            velocity_b=vectors(K.VELOCITY_B),
            feature_a=_objects(rows[:, K.OUT_MODE], lambda n: feature_of(a, n)),
            feature_b=_objects(rows[:, K.OUT_MODE + 2], lambda n: feature_of(b, n)),
            parameters_a=_parameters(a, rows, 0),
            parameters_b=_parameters(b, rows, 2),
            status=_objects(rows[:, K.STATUS], statuses.__getitem__),
            counts=rows[:, COUNT_COLUMNS].astype(np.int64),
            events=events,
            info=info,
            pair=pair,
        )

    def __len__(self) -> int:
        return len(self.time)

    @property
    def certified(self) -> NDArray[np.bool_]:
        """Whether each frame's gap is within the tolerance, shape (n,)."""
        return np.asarray((self.status == Status.CONVERGED) | (self.status == Status.GLOBAL))

    @property
    def penetrating(self) -> NDArray[np.bool_]:
        """Whether the bodies touch or overlap in each frame, shape (n,)."""
        inside = [s in (Status.LOCAL, Status.GLOBAL, Status.OVERLAPPING) for s in self.status]
        return np.asarray(inside, dtype=bool)

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
        return Counter(self.status.tolist())

    def modes(self) -> list[Visit]:
        """Return the visited modes in order of time.

        A stay ends at the instant of the switch that ends it. Where an overlap has no depth there
        is no mode: the stay before ends at the last frame with one, the next one begins at the
        first frame that has one again. Of switches at one instant only the last mode is visited.
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
            if self.status[frame] is Status.OVERLAPPING:
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

    def automaton(self) -> Automaton:
        """Return the pair's automaton with the visited modes and the switches marked.

        Raises
        ------
        ValueError
            In a recording opened from a file, which does not hold the bodies.
        """
        from standoff.tracking.automaton import automaton  # it reads recordings itself

        if self.pair is None:
            raise ValueError(
                "A recording from a file does not hold its bodies: make the pair's with "
                "standoff.tracking.automaton.automaton(a, b) and mark it with "
                ".marked(recording.modes(), recording.events)."
            )
        return automaton(*self.pair).marked(self.modes(), self.events)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw distance and bound, gap and residual, modes and parameters over time.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ModuleNotFoundError
            If matplotlib is not installed; the message names the extra.
        TypeError
            If `path` is neither a text nor a Path.
        ValueError
            If it is empty, or the file's ending is another.
        OSError
            If the file cannot be written, or is no regular file but a folder, a FIFO or a device.
            A link stays: what it leads to is replaced.
        """
        from standoff.tracking import recording_plot

        if path is None:
            return recording_plot.draw(self)
        target = file_name(path)
        ending = target.suffix.lower().removeprefix(".")
        if ending not in recording_plot.FORMATS:
            raise ValueError(
                f"{target}: the ending '{target.suffix}' is not known here; name a file that ends "
                f"in .{', .'.join(recording_plot.FORMATS)}"
            )
        figure = recording_plot.draw(self)
        write_whole({target: lambda file: figure.savefig(file, format=ending)})
        return figure

    def save(self, path: str | Path) -> None:
        """Write a Parquet file, whole or not at all; `open_recording` reads it.

        docs/scene-format.md lists the columns; any reader of Parquet understands them.

        Raises
        ------
        ModuleNotFoundError
            If pyarrow is not installed; the message names the extra.
        TypeError
            If `path` is neither a text nor a Path.
        ValueError
            If it is empty, or ``info.source`` is nested too deeply.
        OSError
            If the file cannot be written, or is no regular file but a folder, a FIFO or a device.
            A link stays: what it leads to is replaced.
        """
        target = file_name(path)
        from standoff.tracking.recording_file import write_table

        write_whole({target: lambda file: write_table(self, file)})


def open_recording(path: str | Path) -> Recording:
    """Read a recording that `Recording.save` or ``standoff track -o`` wrote.

    Everything is as it was, but for ``pair``: the file holds the bodies' names and digests, not
    the bodies.

    Parameters
    ----------
    path : str or Path
        A Parquet file.

    Returns
    -------
    Recording

    Raises
    ------
    TypeError
        If `path` is neither a text nor a Path.
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no Parquet file or cut off, is no recording, or is of a format that this Standoff
        does not read.
    ModuleNotFoundError
        If pyarrow is not installed; the message names the extra.
    """
    from standoff.tracking.recording_file import read_table

    given: object = path
    if not isinstance(given, str | Path):
        raise TypeError(f"path is {shown(given)}: give the name of a file, a text or a Path.")
    return read_table(Path(path))


def _objects(numbers: Array, meaning: Any) -> NDArray[np.object_]:
    """Return one object a number; equal numbers share theirs."""
    unique, inverse = np.unique(numbers.astype(np.int64), return_inverse=True)
    table = np.empty(len(unique), dtype=object)
    for k, number in enumerate(unique.tolist()):
        table[k] = meaning(number)
    return table[inverse]


def _parameters(body: Body, rows: Array, at: int) -> Array:
    """Return the parameters as `Proximity` gives them, (n, 3), filled with nan."""
    parameters = np.full((len(rows), 3), np.nan)
    numbers = rows[:, K.OUT_MODE + at].astype(np.int64)
    on_face = numbers < body.n_faces
    on_edge = ~on_face & (numbers < body.n_faces + body.n_edges)
    parameters[on_face | on_edge, 0] = rows[on_face | on_edge, K.OUT_Q + at]
    parameters[on_face, 1] = rows[on_face, K.OUT_Q + at + 1]
    for face in np.unique(numbers[on_face]).tolist():
        first, count = charts_of(body, face)
        if count > 1:
            here = numbers == face
            parameters[here, 2] = rows[here, K.OUT_MODE + at + 1] - first
    return parameters
