"""Rows of a batch whose poses are invalid: which, and why, computed on request."""

from __future__ import annotations

import operator
import warnings
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.errors import RefusedRowsWarning, StandoffError
from standoff.motion import Pose
from standoff.read_only import KeepsReadOnly
from standoff.tracking.inputs import check_in_plane, flat_pose, repair
from standoff.tracking.pose_arrays import another_order
from standoff.typing import Array

HOME = flat_pose(np.eye(4))
SHOWN = 3
"""Number of errors shown in the repr."""


class RefusedPoses(NamedTuple):
    """The refused ones of the poses given for one body.

    Attributes
    ----------
    name : str
        Of the argument.
    rows : (m,) array of int
        Their numbers, increasing.
    matrices : (m, 4, 4) array
        As they were given.
    given : int
        How many poses there were in all: 1 is for all rows.
    """

    name: str
    rows: NDArray[np.int64]
    matrices: Array
    given: int

    def error(self, row: int, planar: bool) -> StandoffError | None:
        """What is wrong with the pose of a row; None if nothing is."""
        number = 0 if self.given == 1 else row
        at = int(np.searchsorted(self.rows, number))
        if at == len(self.rows) or self.rows[at] != number:
            return None
        try:
            flat = flat_pose(Pose.of(self.matrices[at]))
            if planar:
                own = self.name == "poses_a"
                check_in_plane(*((flat, HOME) if own else (HOME, flat)))
            repair(flat.copy(), self.name)
        except StandoffError as error:
            told = f"Row {number} of {self.name}: {error}"
            return StandoffError(told, self.name, error.value)
        return None


class RefusedRows(Mapping[int, StandoffError], KeepsReadOnly):
    """Errors by the number of the row; each is made when it is asked for.

    Parameters
    ----------
    refused : (n,) array of bool
        Which rows are refused.
    of_a, of_b : RefusedPoses
    planar : bool
        Must the poses stay in z = 0?
    numbers : (n,) array of int, optional
        The rows as they were given, where these are some of them.
    """

    __slots__ = ("_numbers", "_of", "_planar", "_refused")

    def __init__(
        self,
        refused: NDArray[np.bool_],
        of_a: RefusedPoses,
        of_b: RefusedPoses,
        planar: bool,
        numbers: NDArray[np.int64] | None = None,
    ) -> None:
        self._refused, self._of, self._planar = refused, (of_a, of_b), planar
        self._numbers = numbers

    def at(self, rows: NDArray[np.int64]) -> RefusedRows:
        """Those of some rows, by their places among these; what they say has the given numbers."""
        numbers = rows if self._numbers is None else self._numbers[rows]
        return RefusedRows(self._refused[rows], *self._of, self._planar, numbers)

    def __getitem__(self, row: int) -> StandoffError:
        if row not in self:
            raise KeyError(row)
        number = operator.index(row) if self._numbers is None else int(self._numbers[row])
        for poses in self._of:
            error = poses.error(number, self._planar)
            if error is not None:
                return error
        raise KeyError(row)

    def __contains__(self, row: object) -> bool:
        try:
            k = operator.index(row)  # type: ignore[arg-type]
        except TypeError:
            return False
        return 0 <= k < len(self._refused) and bool(self._refused[k])

    def __iter__(self) -> Iterator[int]:
        return iter(np.flatnonzero(self._refused).tolist())

    def __len__(self) -> int:
        return int(np.count_nonzero(self._refused))

    def __repr__(self) -> str:
        told = [f"{row}: {self[row]!r}" for row in islice(self, SHOWN)]
        return f"{{{', '.join([*told, *(['...'] if len(self) > SHOWN else [])])}}}"

    def advice(self) -> str:
        """A sentence about an order of 12 numbers that the refused poses fit; empty if none."""
        return next(filter(None, (another_order(x.matrices) for x in self._of if len(x.rows))), "")

    def warn(self, stacklevel: int) -> None:
        """Warn if most rows are refused: then the poses are likely given in a wrong form."""
        n, count = len(self._refused), len(self)
        if 2 * count <= n:
            return
        first = next(iter(self))
        told = f"{count} of {n} rows are refused, and are nan. {self[first]}".rstrip(".")
        advice = f" {self.advice()}".rstrip()
        warnings.warn(
            f"{told}.{advice} `errors` of the result says why, row by row.",
            RefusedRowsWarning,
            stacklevel=stacklevel + 1,
        )
