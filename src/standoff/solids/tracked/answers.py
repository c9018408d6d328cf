"""Answers of many frames of two solids, as arrays."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries import tracked_solids as T
from standoff.read_only import KeepsReadOnly
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.shown_names import hides
from standoff.solids.answer import SolidProximity
from standoff.typing import Array

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure


class WitnessPlaces(NamedTuple):
    """Where the witness points of many frames lie.

    Attributes
    ----------
    feature_a, feature_b : (n,) arrays of Feature
    parameters_a, parameters_b : (n, 3) arrays
        nan where the feature has fewer parameters.
    """

    feature_a: NDArray[np.object_]
    feature_b: NDArray[np.object_]
    parameters_a: Array
    parameters_b: Array


@hides("places")
class SolidAnswers(KeepsReadOnly):
    """Answers of n frames of two solids, in arrays of n rows; ``answers[k]`` is one
    `SolidProximity`.

    Attributes
    ----------
    distance, lower_bound, upper_bound : (n,) arrays
    point_a, point_b, normal : (n, 3) arrays
        As in `SolidProximity`, in world axes; nan where a frame has none.
    status : (n,) array of Status
    certified, unique : (n,) arrays of bool
        As in `SolidProximity`.
    motion : (n,) array
        What no point of B has moved more than since the frame before, as A sees it, length.
    evaluations : (n,) array of int
        Of points and bounds.
    restarts : (n,) array of bool
        Frames that were asked from nothing, as the solids met, or were not known to be apart.
    rebuilds : (n,) array of bool
        Frames in which the front of bounds was made anew.
    """

    def __init__(
        self,
        told: Array,
        places: tuple[Array, Array, Array],
        special: Mapping[int, SolidProximity],
        plain: tuple[NDArray[np.object_], float],
        make: Callable[[int], SolidProximity],
        minima: Callable[[], tuple[LocalMinima, tuple[MinimumEvent, ...]]],
        where: Callable[[], WitnessPlaces],
    ) -> None:
        self._make, self._special, self._tell = make, dict(special), minima
        self._where = where
        self.status, slack = plain
        self.point_a, self.point_b, self.normal = places
        self.distance = told[:, T.DISTANCE].copy()
        self.lower_bound = told[:, T.BOUND] - slack
        self.upper_bound = self.distance + slack
        self.motion = told[:, T.MOTION].copy()
        self.evaluations = told[:, T.TAKEN].astype(np.int64)
        self.rebuilds = told[:, T.ANEW] > 0.0
        self.restarts = np.zeros(len(told), dtype=bool)
        self.unique = np.ones(len(told), dtype=bool)
        for k, answer in self._special.items():
            self._put(k, answer)
        self.certified = np.array([each.certified for each in self.status], dtype=bool)
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def _put(self, k: int, answer: SolidProximity) -> None:
        self.distance[k] = answer.distance
        self.lower_bound[k], self.upper_bound[k] = answer.lower_bound, answer.upper_bound
        self.status[k] = answer.status
        self.point_a[k], self.point_b[k] = answer.point_a, answer.point_b
        self.normal[k] = answer.normal
        self.evaluations[k] = answer.counts.evaluations
        self.restarts[k] = answer.counts.restarts > 0
        self.unique[k] = answer.unique

    @cached_property
    def places(self) -> WitnessPlaces:
        """The features of the witness points of all frames, and their parameters, as arrays."""
        return self._where()

    @property
    def minima(self) -> LocalMinima:
        """All local minima of all frames, in arrays.

        Raises StandoffError: the tracker was made without ``minima=``.
        """
        return self._told[0]

    @property
    def events(self) -> tuple[MinimumEvent, ...]:
        """Which minima begin, end and go to another feature, and when another is the nearest.

        Raises StandoffError: the tracker was made without ``minima=``.
        """
        return self._told[1]

    @cached_property
    def _told(self) -> tuple[LocalMinima, tuple[MinimumEvent, ...]]:
        return self._tell()

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw how far each local minimum is apart, over the frames, where it begins and ends.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises StandoffError: the tracker was made without ``minima=``; or the file has another
        ending. Raises TypeError if `path` is neither a string nor a Path. Raises OSError if the
        file cannot be written.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from standoff.bodies.drawing.files import drawn

        def draw() -> Figure:
            from standoff.solids.tracked.plot import minima_figure

            return minima_figure(self.minima, self.distance)

        figure: Figure = drawn(path, draw)
        return figure

    def __len__(self) -> int:
        return len(self.distance)

    def __getitem__(self, k: int) -> SolidProximity:
        index = range(len(self))[operator.index(k)]
        return self._special[index] if index in self._special else self._make(index)

    def __iter__(self) -> Iterator[SolidProximity]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<SolidAnswers of {len(self)} frames>"


def world_places(told: Array, poses_a: Array) -> tuple[Array, Array, Array]:
    """Witness points and normals of frames in world axes; `poses_a` are (n, 12)."""
    turns, shifts = poses_a[:, :9].reshape(-1, 3, 3), poses_a[:, 9:]
    x, y = (
        np.einsum("nij,nj->ni", turns, told[:, o : o + 3]) + shifts for o in (T.POINT_A, T.POINT_B)
    )
    away = y - x
    length = np.linalg.norm(away, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        normal: Any = away / length
    return x, y, normal
