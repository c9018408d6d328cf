"""The answers of many rows, as arrays: what `standoff.distances` returns."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import feature_of
from standoff.checks.numbers import whole_number
from standoff.errors import StandoffError
from standoff.kernels.state import arrays as K
from standoff.motion.vectors import pose_row
from standoff.tracking.answers import AnswerArrays, proven, statuses
from standoff.tracking.proximity import Proximity
from standoff.tracking.refused_rows import RefusedRows
from standoff.tracking.row_pairs import RowPairs
from standoff.tracking.rows import motion_row
from standoff.typing import Array, Ints
from standoff.wording import counted

if TYPE_CHECKING:
    from standoff.tracking.derivatives import DerivativeArrays


FEATURE = np.dtype([("kind", "U6"), ("index", np.int64)])
"""A feature in an array: "face", "edge" or "vertex", and its number among those."""


class Distances(AnswerArrays):
    """Signed distances of bodies at n pairs of poses, as arrays of n rows.

    ``found[k]`` is row k as a `Proximity`. A row whose poses are invalid is nan in all arrays, and
    ``errors`` says why.

    Attributes
    ----------
    distance, lower_bound, upper_bound : (n,) arrays
    point_a, point_b, normal : (n, 3) arrays
        As in `Proximity`, in world axes.
    repaired : (n,) array of int
        How many of a row's two poses had a rounded rotation and were replaced by the nearest.
    errors : mapping of int to StandoffError
        Of the rows that were refused; each error is made when it is asked for.
    poses : pair of (n, 4, 4) arrays
        World poses of A and B for which the rows hold, nan where they are invalid; (1, 4, 4) where
        one was given for all.
    pairs : tuple of (Body, Body)
        The pairs of bodies that the rows are of, each once; of two bodies the only one.
    """

    __slots__ = ("_of", "errors", "poses", "repaired", "rows")

    def __init__(
        self,
        of: RowPairs,
        rows: Array,
        poses: tuple[Array, Array],
        repaired: NDArray[np.int64],
        errors: RefusedRows,
    ) -> None:
        self._of = of
        self.rows, self.poses, self.repaired, self.errors = rows, poses, repaired, errors
        for array in (rows, repaired, *poses):
            array.flags.writeable = False

    @property
    def _numbers(self) -> Array:
        return self.rows

    @property
    def bodies(self) -> tuple[Body, Body]:
        """(A, B), where all rows are of the same two.

        Raises ValueError: they are not.
        """
        if self._of.several:
            raise StandoffError(
                f"The rows are of {len(self.pairs)} pairs of bodies: found.pairs[found.pair[k]] "
                "are those of row k, found.of_pair(j) the rows of one of them."
            )
        return self.pairs[0]

    @property
    def pairs(self) -> tuple[tuple[Body, Body], ...]:
        return self._of.pairs

    @property
    def pair(self) -> Ints:
        """(n,) the number among ``pairs`` of each row's bodies."""
        return np.broadcast_to(self._of.which, len(self))

    def of_pair(self, number: int) -> Distances:
        """The rows of one of ``pairs``, in their order."""
        j = range(len(self.pairs))[operator.index(number)]
        return self._part(j, np.flatnonzero(self.pair == j))

    def _part(self, j: int, at: Ints) -> Distances:
        one = RowPairs((self.pairs[j],), np.zeros(1, dtype=np.int64))
        poses_a, poses_b = (x if len(x) == 1 else x[at] for x in self.poses)
        return Distances(
            one, self.rows[at], (poses_a, poses_b), self.repaired[at], self.errors.at(at)
        )

    @property
    def parts(self) -> list[tuple[Distances, Ints]]:
        """The rows of each pair, and which they are."""
        if not self._of.several:
            return [(self, np.arange(len(self)))]
        return [(self._part(j, at), at) for j, at in self._of.groups()]

    @property
    def status(self) -> NDArray[np.object_]:
        """(n,) the status of each row, REFUSED where a pose is invalid."""
        return statuses(self.rows[:, K.STATUS])

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(n,) is the answer proven?"""
        return proven(self.rows[:, K.STATUS])

    @property
    def feature_a(self) -> NDArray[np.void]:
        """(n,) A's active feature, an array with the fields ``kind`` and ``index``."""
        return self._features(0)

    @property
    def feature_b(self) -> NDArray[np.void]:
        """(n,) B's."""
        return self._features(1)

    def derivatives(self, *, workers: int = 1) -> DerivativeArrays:
        """All derivatives of all rows by the poses, with flags (docs/derivatives.md).

        Parameters
        ----------
        workers : int
            Threads that share the rows; the numbers are the same for any number.
        """
        from standoff.tracking.derivatives import derivative_arrays

        return derivative_arrays(self, whole_number(workers, "workers"))

    @property
    def gradient(self) -> Array:
        """(n, 12) derivatives of the distance by unit twists (v_A, omega_A, v_B, omega_B).

        nan where there is none, in flat contact only for some turns; computed at each call, like
        those below.
        """
        from standoff.tracking.derivatives import gradients

        return gradients(self)

    @property
    def hessian(self) -> Array:
        """(n, 12, 12) of the distance."""
        return self.derivatives().hessian

    @property
    def normal_jacobian(self) -> Array:
        """(n, 3, 12) of the normal."""
        return self.derivatives().normal_jacobian

    @property
    def point_jacobians(self) -> tuple[Array, Array]:
        """Two (n, 3, 12), of the witness points on A and on B."""
        return self.derivatives().point_jacobians

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, k: int) -> Proximity:
        index = range(len(self))[operator.index(k)]
        if index in self.errors:
            raise self.errors[index]
        block = np.zeros(K.N_BLOCK)
        block[: K.N_OUT] = self.rows[index]
        poses = [poses[0 if len(poses) == 1 else index] for poses in self.poses]
        block[K.BLOCK_MOTION : K.BLOCK_TIME_STEP] = motion_row(
            *(pose_row(pose[:3, :3], pose[:3, 3]) for pose in poses)
        )
        return Proximity(*self._of.of(index), block, int(self.repaired[index]))

    def _features(self, side: int) -> NDArray[np.void]:
        numbers = self.rows[:, K.OUT_MODE + 2 * side]
        if not self._of.several:
            return _features(self.pairs[0][side], numbers)
        found = np.empty(len(self), dtype=FEATURE)
        for j, at in self._of.groups():
            found[at] = _features(self.pairs[j][side], numbers[at])
        return found

    def __repr__(self) -> str:
        names = self._of.shown
        refused = f", {len(self.errors)} refused" if self.errors else ""
        return f"<Distances at {counted(len(self), 'pair')} of poses: {names}{refused}>"


def _features(body: Body, numbers: Array) -> NDArray[np.void]:
    """Features by the kernels' numbers; an empty kind and -1 where a row was refused or is FAR."""
    found = np.zeros(len(numbers), dtype=FEATURE)
    found["index"] = -1
    for number in np.unique(numbers[numbers >= 0.0]).astype(int).tolist():
        feature = feature_of(body, number)
        here = numbers == number
        found["kind"][here], found["index"][here] = feature.kind, feature.index
    return found
