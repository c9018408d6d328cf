"""Many poses as two arrays: read, checked and repaired all at once."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeAlias

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from standoff.checks.arrays import finite, numbers
from standoff.checks.numbers import GREATEST
from standoff.checks.real_numbers import shape_of, shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.pose import LAST_ROW, HasMatrix, Pose, PoseLike, RotationLike, matrix_of
from standoff.motion.rotations import defect, mirrored, without_rounding
from standoff.motion.tolerances import (
    ORTHONORMALITY,
    QUATERNION_ROUNDING,
    ROUNDED,
    UNIT_QUATERNION,
)
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

SEVEN = (
    "the order of a quaternion must be named: give so.Poses.from_xyzw(rows[:, 3:], rows[:, :3]) "
    "for rows x, y, z, qx, qy, qz, qw, or so.Poses.from_wxyz(rows[:, 3:], rows[:, :3])"
)
"""What is said of rows of seven numbers."""


def has_last_row(matrices: Array) -> NDArray[np.bool_]:
    """Is the last row of each matrix (n, 4, 4) that of a homogeneous one?"""
    with np.errstate(invalid="ignore"):
        off: Array = np.abs(matrices[:, 3] - LAST_ROW).max(axis=1)
    return off <= ORTHONORMALITY


def matrices_of(rotations: Array, translations: Array) -> Array:
    """Homogeneous matrices (n, 4, 4) of rotations (n, 3, 3) and translations (n, 3) or (3,)."""
    matrices = np.zeros((len(rotations), 4, 4))
    matrices[:, :3, :3], matrices[:, :3, 3] = rotations, translations
    matrices[:, 3, 3] = 1.0
    return matrices


class Poses(KeepsReadOnly):
    """Many rigid placements: n poses as arrays, checked and repaired all at once.

    ``poses[k]`` is one `Pose`, ``len(poses)`` their number. Takes about a microsecond per pose,
    where a list of `Pose` takes fifty.

    Raises ValueError if a shape is wrong, or a pose is invalid; the first such is named.

    Parameters
    ----------
    rotations : array_like, shape (n, 3, 3), or SciPy's ``Rotation`` of n
        Each is checked, and repaired where it is rounded, as by `Pose`.
    translations : array_like, shape (n, 3) or (3,)
        The body's origins in world coordinates [length]; one is used for all rotations.

    Attributes
    ----------
    rotations : ndarray, shape (n, 3, 3)
        Read-only, float64.
    translations : ndarray, shape (n, 3)
        Read-only, float64.
    repaired : ndarray of bool, shape (n,)
        The mark `Pose.repaired` of each.
    """

    rotations: Array
    translations: Array
    repaired: NDArray[np.bool_]

    def __init__(self, rotations: RotationLike, translations: ArrayLike) -> None:
        turns = _rows(matrix_of(rotations), "rotations", (3, 3))
        shifts = _shifts(translations, len(turns))
        self._take(turns, shifts, zip(turns, shifts, strict=True))

    def _set(self, rotations: Array, translations: Array, repaired: NDArray[np.bool_]) -> None:
        for array in (rotations, translations, repaired):
            array.setflags(write=False)
        self.rotations, self.translations, self.repaired = rotations, translations, repaired

    def _take(
        self,
        rotations: Array,
        translations: Array,
        given: Iterable[PoseLike],
        wrong: NDArray[np.bool_] | None = None,
    ) -> None:
        """Take over arrays of its own, with rounded rotations repaired.

        Some may be known to be wrong; `given` are the poses that an error names.
        """
        with np.errstate(invalid="ignore", over="ignore"):  # of numbers that are refused below
            off = defect(rotations)
            bad = mirrored(rotations) | ~(off <= ROUNDED)
        bad |= ~(np.abs(translations) <= GREATEST).all(axis=1)
        if wrong is not None:
            bad |= wrong
        if bad.any():
            for index, pose in enumerate(given):
                _read(index, pose)  # says what is wrong with it
        repaired = off > ORTHONORMALITY
        rotations[repaired] = without_rounding(rotations[repaired])
        self._set(rotations, translations, repaired)

    @classmethod
    def of(cls, poses: Poses | Sequence[PoseLike] | NDArray[Any] | HasMatrix) -> Poses:
        """Read poses.

        Raises TypeError if it is none of these. Raises ValueError if a pose is invalid; the first
        such is named.

        Parameters
        ----------
        poses : Poses, sequence of poses, array (n, 4, 4), or SciPy's ``RigidTransform`` of n
            Of a sequence each is a Pose or what `Pose.of` reads.
        """
        if isinstance(poses, Poses):
            return poses
        given = matrix_of(poses)
        if hasattr(given, "__array__"):
            return cls._of_matrices(given)
        if not isinstance(given, Sequence) or isinstance(given, str):
            raise StandoffTypeError(
                f"poses is {shown(poses)}: give a list of poses, or an array of shape (n, 4, 4)",
                "poses",
                poses,
            )
        read = [_read(index, pose) for index, pose in enumerate(given)]
        made = cls.__new__(cls)
        made._set(
            np.array([pose.rotation for pose in read]).reshape(-1, 3, 3),
            np.array([pose.translation for pose in read]).reshape(-1, 3),
            np.array([pose.repaired for pose in read], dtype=bool),
        )
        return made

    @classmethod
    def _of_matrices(cls, given: Any) -> Poses:
        shape = tuple(given.shape)
        if len(shape) != 3 or shape[1:] != (4, 4):
            hint = f"; {SEVEN}" if shape[1:] == (7,) else ""
            raise StandoffError(
                f"poses has shape {shape}: give homogeneous matrices, an array of shape "
                f"(n, 4, 4), or a list of poses{hint}",
                "poses",
                given,
            )
        matrices = numbers(given, "poses", shape)
        turns, shifts = matrices[:, :3, :3].copy(), matrices[:, :3, 3].copy()
        made = cls.__new__(cls)
        made._take(turns, shifts, matrices, ~has_last_row(matrices))
        return made

    @classmethod
    def from_wxyz(cls, quaternions: ArrayLike, translations: ArrayLike) -> Poses:
        """Make poses from quaternions with the scalar first.

        Raises ValueError if a component is not finite, a shape is wrong, or a norm is off by more
        than 1e-3; the first such pose is named.

        Parameters
        ----------
        quaternions : array_like, shape (n, 4)
            Rows (w, x, y, z), each of unit norm to 1e-3; normalised, and marked by `repaired`.
        translations : array_like, shape (n, 3) or (3,)
            The body's origins in world coordinates [length]; one is used for all quaternions.
        """
        rows = _rows(quaternions, "quaternions (w, x, y, z)", (4,))
        return cls._from_quaternions(rows[:, [1, 2, 3, 0]], translations)

    @classmethod
    def from_xyzw(cls, quaternions: ArrayLike, translations: ArrayLike) -> Poses:
        """Make poses from quaternions with the scalar last; otherwise as `from_wxyz`.

        Raises ValueError if a component is not finite, a shape is wrong, or a norm is off by more
        than 1e-3; the first such pose is named.

        Parameters
        ----------
        quaternions : array_like, shape (n, 4)
            Rows (x, y, z, w), each of unit norm to 1e-3; normalised, and marked by `repaired`.
        translations : array_like, shape (n, 3) or (3,)
            The body's origins in world coordinates [length]; one is used for all quaternions.
        """
        rows = _rows(quaternions, "quaternions (x, y, z, w)", (4,))
        return cls._from_quaternions(rows, translations)

    @classmethod
    def _from_quaternions(cls, xyzw: Array, translations: ArrayLike) -> Poses:
        shifts = _shifts(translations, len(xyzw))
        with np.errstate(invalid="ignore", over="ignore"):  # of numbers that are refused below
            off = np.abs(np.linalg.norm(xyzw, axis=1) - 1.0)
        wrong = ~(off <= UNIT_QUATERNION) | ~(np.abs(shifts) <= GREATEST).all(axis=1)
        for index in np.flatnonzero(wrong).tolist():
            with _named(index, xyzw[index]):
                Pose.from_xyzw(xyzw[index], shifts[index])  # says what is wrong with it
        rotations = scipy.spatial.transform.Rotation.from_quat(xyzw.reshape(-1, 4)).as_matrix()
        made = cls.__new__(cls)
        made._set(rotations, shifts, off > QUATERNION_ROUNDING)
        return made

    @property
    def matrices(self) -> Array:
        """The homogeneous matrices, shape (n, 4, 4), a new array."""
        return matrices_of(self.rotations, self.translations)

    def __len__(self) -> int:
        return len(self.rotations)

    def __getitem__(self, index: int) -> Pose:
        """Return one pose."""
        k = operator.index(index)
        return Pose.from_checked(
            self.rotations[k], self.translations[k], repaired=bool(self.repaired[k])
        )

    def __iter__(self) -> Iterator[Pose]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        told = f", {int(self.repaired.sum())} repaired" if self.repaired.any() else ""
        return f"<Poses: {len(self)}{told}>"


PosesLike: TypeAlias = (
    ArrayLike
    | Poses
    | PoseLike
    | Sequence[PoseLike]
    | NDArray[Any]
    | HasMatrix
    | tuple[RotationLike, ArrayLike]
)
"""What stands for many poses, or for one that is used for all rows: see `standoff.distances`."""


def _rows(value: Any, name: str, shape: tuple[int, ...]) -> Array:
    """A new array of n rows of the given shape."""
    array = numbers(value, name, None)
    if array.ndim == 0 or array.shape[1:] != shape or not len(array):
        wanted = ", ".join(map(str, ("n", *shape)))
        raise StandoffError(
            f"{name} has shape {array.shape}: give an array of shape ({wanted})", name, value
        )
    return array


def _shifts(translations: ArrayLike, count: int) -> Array:
    """A new array of `count` translations, from as many or from one."""
    if shape_of(translations) == (3,):
        return np.tile(finite(translations, "translations", (3,)), (count, 1))
    shifts = _rows(translations, "translations", (3,))
    if len(shifts) != count:
        raise StandoffError(
            f"{count} rotations and {len(shifts)} translations: give the same number of both, or "
            "one translation for all",
            "translations",
            translations,
        )
    return shifts


@contextmanager
def _named(index: int, pose: Any) -> Iterator[None]:
    """Name the pose in an error that it raises."""
    try:
        yield
    except ValueError as error:
        raise StandoffError(f"pose {index}: {error}", "poses", pose) from error


def _read(index: int, pose: PoseLike) -> Pose:
    with _named(index, pose):
        return Pose.of(pose)
