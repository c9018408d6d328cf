"""A recorded run: drawn, stored, and marked in the pair's automaton."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import charts_of, feature_of
from standoff.checks.numbers import whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.recording.recorded import Paths, RecordedFrames
from standoff.recording.recorded import RecordedEvent as RecordedEvent
from standoff.recording.recorded import RunInfo as RunInfo
from standoff.tracking.pair_plot import view_angles
from standoff.tracking.rows import AnswerRows
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.whole_files import file_name, write_whole

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.figure import Figure

    from standoff.automaton.graph import Automaton
    from standoff.automaton.parallel import SolidAutomaton


@dataclass(frozen=True, eq=False, repr=False)
class Recording(RecordedFrames):
    """Answers of a run, by frame; row k of every array belongs to ``time[k]``.

    All vectors in world axes, lengths in the bodies' unit.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s, strictly increasing.
    distance, lower_bound, upper_bound, rate, residual : ndarray, shape (n,)
        As in `Proximity`; nan while overlapping. ``upper_bound`` is nan in all frames of a file
        of format version 2, which does not hold it. Of solids as in `SolidProximity`; ``rate`` is
        nan where the witness points are not unique, ``residual`` always.
    point_a, point_b, normal, velocity_a, velocity_b : ndarray, shape (n, 3)
        The velocities are nan of solids.
    feature_a, feature_b : ndarray of Feature, shape (n,)
    parameters_a, parameters_b : ndarray, shape (n, 3)
        nan where the feature has fewer parameters.
    status : ndarray of Status, shape (n,)
    counts : ndarray of int, shape (n, 11)
        Work of each frame, in the order of `Counts`; of solids the evaluations, switches and
        restarts, all else is 0.
    events : tuple of RecordedEvent
        In order of frame and time. Of each body the source of an event is the target of the one
        before.
    info : RunInfo
    pair : (Body, Body) or None
        A and B, bodies or solids; None in a recording opened from a file, which keeps only their
        digests.
    paths : (path, path) or None
        Those of A and B, which `animate` asks for poses; None in a recording opened from a file,
        and in a copy or a pickle, because a path may be a function.
    minima : LocalMinima or None
        Of solids whose tracker was given ``minima=``: all local minima of all frames.
    minima_events : tuple of MinimumEvent
        Which of them begin, end and go to another feature, and when another is the nearest.
    """

    @classmethod
    def of_answers(
        cls,
        time: Array,
        answers: Array,
        events: tuple[RecordedEvent, ...],
        pair: tuple[Body, Body],
        info: RunInfo,
        paths: Paths | None = None,
    ) -> Recording:
        """Return the recording of a run's flat answers, (n, N_OUT) as in
        ``kernels.state.arrays``."""
        a, b = pair
        statuses = {status.value: status for status in Status}
        rows = AnswerRows(np.array(answers))
        return cls(
            time=time,
            distance=rows.distance,
            lower_bound=rows.lower_bound,
            upper_bound=rows.upper_bound,
            rate=rows.rate,
            residual=rows.residual,
            point_a=rows.point_a,
            point_b=rows.point_b,
            normal=rows.normal,
            velocity_a=rows.velocity_a,
            velocity_b=rows.velocity_b,
            feature_a=_objects(rows.mode[:, 0], lambda n: feature_of(a, n)),
            feature_b=_objects(rows.mode[:, 2], lambda n: feature_of(b, n)),
            parameters_a=_parameters(a, rows.mode[:, :2], rows.q[:, :2]),
            parameters_b=_parameters(b, rows.mode[:, 2:], rows.q[:, 2:]),
            status=_objects(rows.status, statuses.__getitem__),
            counts=rows.counts,
            events=events,
            info=info,
            pair=pair,
            paths=paths,
        )

    def automaton(self) -> Automaton | SolidAutomaton:
        """Return the pair's automaton with the visited modes and the switches marked.

        Raises ValueError: in a recording of convex bodies opened from a file, which does not hold
        the bodies; or of solids that were tracked without ``minima=``.

        Returns
        -------
        Automaton or SolidAutomaton
            The latter of solids: one automaton per local minimum. In a recording opened from a
            file, which does not hold the solids, it has what was visited and taken, not what else
            they allow.
        """
        if self.info.of_solids:
            from standoff.automaton.parallel import solid_automaton
            from standoff.recording.branch_modes import branch_automaton

            solids = None if self.pair is None else [getattr(x, "given", x) for x in self.pair]
            return branch_automaton(self, None if solids is None else solid_automaton(*solids))
        from standoff.automaton.graph import automaton

        if self.pair is None:
            raise StandoffError(
                "A recording from a file does not hold its bodies: make the pair's with "
                "standoff.automaton.graph.automaton(a, b) and mark it with "
                ".marked(recording.modes(), recording.events)."
            )
        return automaton(*self.pair).marked(self.modes(), self.events)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw distance and bound, gap and residual, modes and parameters over time.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises TypeError if `path` is neither a string nor a Path. Raises ValueError if it is empty,
        or the file has another ending. Raises OSError if the file cannot be written, or is a
        folder, a FIFO or a device. A link stays: what it leads to is replaced.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from standoff.recording import plot as recording_plot

        if path is None:
            return recording_plot.draw(self)
        target = file_name(path)
        ending = target.suffix.lower().removeprefix(".")
        if ending not in recording_plot.FORMATS:
            raise StandoffError(
                f"{target}: the ending '{target.suffix}' is not known here; name a file that ends "
                f"in .{', .'.join(recording_plot.FORMATS)}",
                "path",
                path,
            )
        figure = recording_plot.draw(self)
        write_whole({target: lambda file: figure.savefig(file, format=ending)})
        return figure

    def animate(
        self, pictures: int = 60, *, view: tuple[float, float] | None = None
    ) -> FuncAnimation:
        """Return an animation of both bodies, their active features and the witness line.

        Show it, or save it: ``recording.animate().save("run.gif", writer="pillow")``.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises ValueError: in a recording opened from a file or copied, which does not hold bodies
        or paths; one of solids; fewer than one picture; a view that is not two finite numbers.

        Parameters
        ----------
        pictures : int
            Greatest number of frames to draw, evenly chosen from the first to the last.
        view : (float, float), optional
            Elevation and azimuth of the viewer, degrees. If not given, the view is across the
            normal of the closest frame.

        Returns
        -------
        matplotlib.animation.FuncAnimation
        """
        if self.pair is None or self.paths is None:
            raise StandoffError(
                "A recording that was opened from a file, copied or unpickled does not hold what "
                "moved: animate the one that so.track returned."
            )
        count = whole_number(pictures, "pictures")
        angles = view_angles(view)
        from standoff.recording.animation import animation

        return animation(self, self.pair, self.paths, count, angles)

    def to_arrow(self) -> Any:
        """Return a table of PyArrow: what `save` writes, with the same columns and metadata.

        Raises ModuleNotFoundError if pyarrow is not installed; the message names the extra. Raises
        ValueError if ``info.source`` is nested too deeply.

        Returns
        -------
        pyarrow.Table
        """
        from standoff.recording.file import table_of

        return table_of(self)

    def to_pandas(self) -> Any:
        """Return a data frame of pandas: one row per frame, columns of plain numbers and words.

        The columns are those of the Parquet file, except that each parameter has its own column,
        ``parameters_a_0`` to ``parameters_b_2``, NaN where a feature has fewer, and that the events
        are left out: ``pandas.DataFrame(recording.events)`` is a table of them. The facts of
        ``info`` are in ``attrs["standoff"]``.

        Raises ModuleNotFoundError if pandas is not installed; the message names the extra.

        Returns
        -------
        pandas.DataFrame
        """
        from standoff.recording.data_frame import data_frame

        return data_frame(self)

    def save(self, path: str | Path) -> None:
        """Write a Parquet file, whole or not at all; `open_recording` reads it.

        docs/scene-format.md lists the columns; any reader of Parquet understands them.

        Raises ModuleNotFoundError if pyarrow is not installed; the message names the extra. Raises
        TypeError if `path` is neither a string nor a Path. Raises ValueError if it is empty, or
        ``info.source`` is nested too deeply. Raises OSError if the file cannot be written, or is a
        folder, a FIFO or a device. A link stays: what it leads to is replaced.
        """
        target = file_name(path)
        from standoff.recording.file import write_table

        write_whole({target: lambda file: write_table(self, file)})


def open_recording(path: str | Path) -> Recording:
    """Read a recording that `Recording.save` or ``standoff track -o`` wrote.

    Everything is as it was, except ``pair``: the file holds the bodies' names and digests, not the
    bodies.

    Raises TypeError if `path` is neither a string nor a Path. Raises FileNotFoundError if there is
    no such file. Raises ValueError if it is not a Parquet file or is truncated, is not a recording,
    or is of a format that this Standoff does not read. Raises ModuleNotFoundError if pyarrow is not
    installed; the message names the extra.

    Parameters
    ----------
    path : str or Path
        A Parquet file.

    Returns
    -------
    Recording
    """
    from standoff.recording.file import read_table

    given: object = path
    if not isinstance(given, str | Path):
        raise StandoffTypeError(
            f"path is {shown(given)}: give a file name, as a string or a Path.", "path", path
        )
    return Recording(**read_table(Path(path)))


def _objects(numbers: Array, meaning: Callable[[int], object]) -> NDArray[np.object_]:
    """Return one object a number; equal numbers share theirs."""
    unique, inverse = np.unique(numbers.astype(np.int64), return_inverse=True)
    table = np.empty(len(unique), dtype=object)
    for k, number in enumerate(unique.tolist()):
        table[k] = meaning(number)
    return table[inverse]


def _parameters(body: Body, modes: Array, q: Array) -> Array:
    """The parameters as `Proximity` gives them, (n, 3), filled with nan.

    modes are the numbers of features and charts, (n, 2), q what they have of u and v, (n, 2).
    """
    parameters = np.full((len(q), 3), np.nan)
    numbers = modes[:, 0].astype(np.int64)
    on_face = (numbers >= 0) & (numbers < body.n_faces)
    on_edge = (numbers >= body.n_faces) & (numbers < body.n_faces + body.n_edges)
    parameters[on_face | on_edge, 0] = q[on_face | on_edge, 0]
    parameters[on_face, 1] = q[on_face, 1]
    for face in np.unique(numbers[on_face]).tolist():
        first, count = charts_of(body, face)
        if count > 1:
            here = numbers == face
            parameters[here, 2] = modes[here, 1] - first
    return parameters
