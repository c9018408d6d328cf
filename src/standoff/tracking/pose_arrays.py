"""Poses of many frames or rows: every form in which they may be given, and all repaired at once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.checks.real_numbers import real_array, shape_of, shown
from standoff.errors import StandoffError, UnreadableNumbers
from standoff.kernels.tolerances import FARTHEST, ROTATION
from standoff.motion import Pose, Poses
from standoff.motion.pose import matrix_of
from standoff.motion.poses import SEVEN, has_last_row, matrices_of
from standoff.motion.rotations import defect, mirrored, without_rounding
from standoff.motion.tolerances import ROUNDED
from standoff.tracking.inputs import (
    LAST_ROW,
    ROTATION_THEN_POSITION,
    matrix_and_mark,
    out_of_plane,
)
from standoff.tracking.tolerances import CHECK_ROUNDOFF
from standoff.typing import Array

FORMS = (
    "an array of shape (n, 4, 4) or (n, 12), a pair (R, p) of shapes (n, 3, 3) and (n, 3), "
    "so.Poses, a list of poses, or one pose"
)

ORDERS = {
    "the position stands first": [3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2],
    "rows are 3 by 4 matrices [R p]": [0, 1, 2, 4, 5, 6, 8, 9, 10, 3, 7, 11],
}
"""Orders in which the 12 numbers R row-major, p are sometimes given instead, and where R and p are
in each."""


TOGETHER = 2048
"""Number of poses repaired together: their numbers stay in the processor's cache."""


class PoseArray(NamedTuple):
    """Poses of n frames or rows, or one for all of them.

    Attributes
    ----------
    matrices : (n, 4, 4) array
        Not checked.
    repaired : (n,) array of int
        1 where a pose was repaired when it was read.
    """

    matrices: Array
    repaired: NDArray[np.int64]


def numbers(value: Any, name: str, forms: str) -> Array:
    """An array of float64, the one given where it is one.

    Raises StandoffError.
    """
    try:
        return real_array(value, copy=False)
    except UnreadableNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{name} is {shown(value)}: give {forms}, all of them real numbers.", name, value
        ) from error


def read_poses(value: Any, name: str) -> PoseArray:
    """Poses in any of `FORMS`; their numbers are not checked.

    Raises StandoffError if it is none of these.
    """
    if isinstance(value, Poses):
        return PoseArray(value.matrices, value.repaired.astype(np.int64))
    if isinstance(value, Pose):
        return _one(value)
    given = matrix_of(value)
    if type(given) in (list, tuple) and given:
        shapes = [shape_of(matrix_of(x)) for x in given] if len(given) == 2 else [None]
        if shapes[0] == (3, 3) or shapes == [(4,), (3,)]:
            return _one(tuple(given))
        if len(shapes[0] or ()) > 1 and (shapes[-1] or ())[-1:] == (3,):
            return _unmarked(_of_pair(given, name))
        if any(isinstance(x, Pose | tuple) or matrix_of(x) is not x for x in given):
            return _of_list(given, name)
    array = numbers(given, name, FORMS)
    if array.shape == (4, 4):
        return _unmarked(array[None])
    if array.ndim == 3 and array.shape[1:] == (4, 4) and len(array):
        return _unmarked(array)
    if array.ndim == 2 and array.shape[1] == 12 and len(array):
        return _unmarked(matrices_of(array[:, :9].reshape(-1, 3, 3), array[:, 9:]))
    told = SEVEN if array.shape[-1:] == (7,) else f"give {FORMS}"
    raise StandoffError(f"{name} has the shape {array.shape}: {told}.", name, value)


def _unmarked(matrices: Array) -> PoseArray:
    return PoseArray(matrices, np.zeros(len(matrices), dtype=np.int64))


def _one(pose: Any) -> PoseArray:
    matrix, mark = matrix_and_mark(pose)
    return PoseArray(matrix[None], np.array([int(mark)]))


def _of_pair(given: Any, name: str) -> Array:
    """Matrices of a pair (R, p) of stacks."""
    turns, shifts = (numbers(matrix_of(x), name, FORMS) for x in given)
    told = f"{name} is a pair of arrays of shapes {turns.shape} and {shifts.shape}"
    if turns.shape[-1:] == (4,):
        raise StandoffError(
            f"{told}: the order of a quaternion must be named; give so.Poses.from_wxyz(q, p) or "
            "so.Poses.from_xyzw(q, p).",
            name,
            given,
        )
    count = len(turns) if turns.ndim == 3 and turns.shape[1:] == (3, 3) else 0
    if not count or shifts.shape not in ((3,), (count, 3)):
        raise StandoffError(
            f"{told}: give (R, p) of shapes (n, 3, 3) and (n, 3), or (3,) for one position.",
            name,
            given,
        )
    return matrices_of(turns, shifts)


def _of_list(given: Any, name: str) -> PoseArray:
    """Of a list whose items are poses in different forms."""
    if all(type(x) is Pose for x in given):
        turns, shifts = [x.rotation for x in given], [x.translation for x in given]
        marks = np.array([x.repaired for x in given], dtype=np.int64)
        return PoseArray(matrices_of(np.array(turns), np.array(shifts)), marks)
    items = []
    for k, item in enumerate(given):
        try:
            items.append(_one(item) if isinstance(item, Pose) else _item(matrix_of(item), name))
        except StandoffError as error:
            raise StandoffError(f"Row {k} of {name}: {error}", name, item) from error
    return PoseArray(*(np.concatenate(part) for part in zip(*items, strict=True)))


def _item(given: Any, name: str) -> PoseArray:
    """One pose of a list, a matrix or a pair; its numbers are not looked at."""
    if isinstance(given, list | tuple) and len(given) == 2:
        turn, shift = (numbers(matrix_of(x), name, FORMS) for x in given)
        if turn.shape == (3, 3) and shift.shape == (3,):
            return _unmarked(matrices_of(turn[None], shift))
    elif shape_of(given) == (4, 4):
        return _unmarked(numbers(given, name, FORMS)[None])
    Pose.of(given)  # says that it is none
    raise StandoffError(f"{shown(given)} is not a pose: give {FORMS}.", name, given)


class Mended(NamedTuple):
    """Poses with rounding repaired, as ``Tracker.step`` does one by one.

    Attributes
    ----------
    matrices : (n, 4, 4) array
        In C order, and not the caller's array.
    repaired : (n,) array of bool
        Which were rounded.
    refused : (n,) array of bool
        Which are not poses; their matrices are as they were given.
    """

    matrices: Array
    repaired: NDArray[np.bool_]
    refused: NDArray[np.bool_]


def mended(poses: Array, planar: bool = False) -> Mended:
    """Check and repair poses (n, 4, 4), all of them at once."""
    found = Mended(np.array(poses, order="C"), *np.zeros((2, len(poses)), dtype=bool))
    for first in range(0, len(poses), TOGETHER):
        part = slice(first, first + TOGETHER)
        _mend(found.matrices[part], found.repaired[part], found.refused[part], planar)
    return found


def _mend(
    matrices: Array, repaired: NDArray[np.bool_], refused: NDArray[np.bool_], planar: bool
) -> None:
    """Fill in a part of `Mended`."""
    turns, shifts = matrices[:, :3, :3], matrices[:, :3, 3]
    with np.errstate(invalid="ignore", over="ignore"):  # of numbers that are refused
        # the kernel asks of the rows, a repair of the columns
        rounded = ~(defect(turns.transpose(0, 2, 1)) <= ROTATION - CHECK_ROUNDOFF)
        far = ~(np.abs(shifts[:, 0]) + np.abs(shifts[:, 1]) + np.abs(shifts[:, 2]) < FARTHEST)
        refused |= mirrored(turns) | far | ~has_last_row(matrices)
        if rounded.any():
            those = _rows(rounded)
            refused[those] |= ~(defect(turns[those]) <= ROUNDED)
    sound = rounded & ~refused
    if sound.any():
        those = _rows(sound)
        matrices[those, :3, :3] = without_rounding(turns[those])
    if planar:
        refused |= out_of_plane(flat_poses(matrices))
    matrices[_rows(~refused), 3] = LAST_ROW
    repaired |= rounded & ~refused


def _rows(chosen: NDArray[np.bool_]) -> NDArray[np.bool_] | slice:
    """What picks rows: all of them, as of float32, without a copy."""
    return slice(None) if chosen.all() else chosen


def flat_poses(matrices: Array) -> Array:
    """Poses (n, 12), R row-major and p, of matrices (n, 4, 4)."""
    flat: Array = matrices.reshape(-1, 16)[:, ROTATION_THEN_POSITION]
    return flat


def another_order(matrices: Array) -> str:
    """A sentence about refused poses (n, 4, 4) whose numbers are poses in another order; or ""."""
    twelve = flat_poses(np.ascontiguousarray(matrices))
    for what, places in ORDERS.items():
        turns = twelve[:, places[:9]].reshape(-1, 3, 3)
        with np.errstate(invalid="ignore", over="ignore"):
            fitting = (defect(turns) <= ROUNDED) & ~mirrored(turns)
        if fitting.all():
            return (
                f"The numbers fit poses if {what}: rows of 12 are R row-major, then p; give "
                f"rows[:, {places}]."
            )
    return ""
