"""Many poses as two arrays: read, checked and repaired all at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import inputs
from standoff.motion.inputs import FloatArray
from standoff.motion.pose import LAST_ROW, Pose, PoseLike, matrix_of
from standoff.motion.rotations import defect, mirrored, without_rounding
from standoff.motion.tolerances import ORTHONORMALITY, ROUNDED
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import shown


class PoseStack(KeepsReadOnly):
    """Poses in a row.

    Parameters
    ----------
    rotations : ndarray, shape (n, 3, 3)
    translations : ndarray, shape (n, 3)
        Both become read-only.
    repaired : ndarray of bool, shape (n,)
        The mark of each pose.
    """

    def __init__(
        self, rotations: FloatArray, translations: FloatArray, repaired: NDArray[np.bool_]
    ) -> None:
        self.rotations, self.translations, self.repaired = rotations, translations, repaired
        rotations.setflags(write=False)
        translations.setflags(write=False)

    @classmethod
    def of(cls, poses: Any) -> PoseStack:
        """Read poses: a sequence of them, an array (n, 4, 4), or what has one by ``as_matrix``.

        Raises
        ------
        TypeError
            If it is none of these.
        ValueError
            If a pose is none; the first such is named.
        """
        given = matrix_of(poses)
        if isinstance(given, np.ndarray):
            return cls._of_matrices(given)
        if not isinstance(given, Sequence):
            raise StandoffTypeError(
                f"poses is {shown(poses)}: give a list of poses, or an array of shape (n, 4, 4)",
                "poses",
                poses,
            )
        read = [_read(index, pose) for index, pose in enumerate(given)]
        return cls(
            np.array([pose.rotation for pose in read]).reshape(-1, 3, 3),
            np.array([pose.translation for pose in read]).reshape(-1, 3),
            np.array([pose.repaired for pose in read], dtype=bool),
        )

    @classmethod
    def _of_matrices(cls, given: NDArray[Any]) -> PoseStack:
        if given.ndim != 3 or given.shape[1:] != (4, 4):
            raise StandoffError(
                f"poses has shape {given.shape}: give homogeneous matrices, an array of shape "
                "(n, 4, 4), or a list of poses",
                "poses",
                given,
            )
        matrices = inputs.numbers(given, "poses", given.shape)
        rotations, translations = matrices[:, :3, :3].copy(), matrices[:, :3, 3].copy()
        with np.errstate(invalid="ignore", over="ignore"):  # of numbers that are refused below
            off = defect(rotations)
            wrong = mirrored(rotations) | ~(off <= ROUNDED)
        wrong |= ~(np.abs(translations) <= inputs.GREATEST).all(axis=1)
        wrong |= ~(np.abs(matrices[:, 3] - LAST_ROW) <= ORTHONORMALITY).all(axis=1)
        for index in np.flatnonzero(wrong).tolist():
            _read(index, matrices[index])  # says what is wrong with it
        repaired = off > ORTHONORMALITY
        rotations[repaired] = without_rounding(rotations[repaired])
        return cls(rotations, translations, repaired)

    def pose(self, index: int) -> Pose:
        """Return one pose."""
        return Pose.from_checked(
            self.rotations[index], self.translations[index], repaired=bool(self.repaired[index])
        )


def _read(index: int, pose: PoseLike) -> Pose:
    try:
        return Pose.of(pose)
    except ValueError as error:
        raise StandoffError(f"pose {index}: {error}", "poses", pose) from error
