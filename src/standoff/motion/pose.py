"""Poses: where a body is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, TypeGuard

import numpy as np
import scipy
from numpy.typing import ArrayLike

from standoff.motion import inputs
from standoff.motion.inputs import FloatArray, text
from standoff.motion.tolerances import ORTHONORMALITY, QUATERNION_ROUNDING, UNIT_QUATERNION
from standoff.read_only import KeepsReadOnly
from standoff.real_numbers import shape_of, shown


@dataclass(frozen=True, init=False, eq=False)
class Pose(KeepsReadOnly):
    """A rigid placement of a body in the world.

    A point with coordinates x in the body is at ``rotation @ x + translation`` in the world.

    Parameters
    ----------
    rotation : array_like, shape (3, 3)
        Rotation matrix; its columns are the body's axes in world coordinates.
    translation : array_like, shape (3,)
        The body's origin in world coordinates [length].

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
        Read-only, float64.
    translation : ndarray, shape (3,)
        Read-only, float64.
    normalised : bool
        True where this pose was made from a quaternion that was not of unit norm and was
        normalised. Poses computed from it do not carry the mark.

    Raises
    ------
    ValueError
        If a component is not finite, a shape is wrong, or the matrix is no rotation
        (orthonormal to 1e-9 with determinant +1).
    """

    rotation: FloatArray
    translation: FloatArray
    normalised: bool

    # Without this NumPy would take a pose for an object array in ``pose @ array``.
    __array_ufunc__ = None

    def __init__(self, rotation: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        matrix = inputs.array(rotation, "rotation", (3, 3))
        _check_rotation(matrix)
        self._set(matrix, inputs.array(translation, "translation", (3,)), normalised=False)

    def _set(self, rotation: FloatArray, translation: FloatArray, *, normalised: bool) -> None:
        rotation.setflags(write=False)
        translation.setflags(write=False)
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "translation", translation)
        object.__setattr__(self, "normalised", normalised)

    @classmethod
    def from_checked(
        cls, rotation: FloatArray, translation: FloatArray, *, normalised: bool = False
    ) -> Pose:
        """Wrap float64 arrays known to be a pose, unchecked and uncopied; they become read-only.

        For results computed from poses in code that runs every frame; a caller's own numbers go
        through ``Pose(...)`` or `Pose.of`.
        """
        pose = cls.__new__(cls)
        pose._set(rotation, translation, normalised=normalised)
        return pose

    @classmethod
    def of(cls, value: PoseLike) -> Pose:
        """Read a pose.

        Parameters
        ----------
        value : Pose, array_like of shape (4, 4), or pair (R, p)
            A homogeneous matrix, or a rotation matrix with a translation.

        Raises
        ------
        ValueError
            If it is none of these; a four-vector is refused, since nothing tells the order of a
            quaternion.
        """
        if isinstance(value, Pose):
            return value
        if _is_pair(value):
            rotation, translation = value
            if shape_of(rotation) == (4,):
                raise ValueError(_unnamed_quaternion(rotation))
            return cls(rotation, translation)
        inputs.unmasked(value, "pose")
        try:
            given = np.asarray(value)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"no pose: {shown(value)}; {_ACCEPTED}") from error
        if given.shape == (4,):
            raise ValueError(_unnamed_quaternion(given))
        if given.shape != (4, 4):
            raise ValueError(f"no pose: shape {given.shape}, value {text(given)}; {_ACCEPTED}")
        matrix = inputs.array(given, "pose", (4, 4))
        if np.abs(matrix[3] - (0.0, 0.0, 0.0, 1.0)).max() > ORTHONORMALITY:
            raise ValueError(
                f"the last row of a homogeneous matrix is (0, 0, 0, 1), not {text(matrix[3])}; "
                "if the translation stands there, transpose the matrix"
            )
        return cls(matrix[:3, :3], matrix[:3, 3])

    @classmethod
    def identity(cls) -> Pose:
        """Return the pose whose body axes are the world's."""
        return cls.from_checked(np.eye(3), np.zeros(3))

    @classmethod
    def from_wxyz(cls, quaternion: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a quaternion with the scalar first.

        Parameters
        ----------
        quaternion : array_like, shape (4,)
            (w, x, y, z), of unit norm to 1e-3; normalised, which `normalised` tells.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].

        Raises
        ------
        ValueError
            If a component is not finite, a shape is wrong, or the norm is off by more than 1e-3.
        """
        w, x, y, z = inputs.array(quaternion, "quaternion (w, x, y, z)", (4,))
        return cls._from_quaternion(np.array([x, y, z, w]), translation)

    @classmethod
    def from_xyzw(cls, quaternion: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a quaternion with the scalar last; otherwise as `from_wxyz`.

        Parameters
        ----------
        quaternion : array_like, shape (4,)
            (x, y, z, w), of unit norm to 1e-3; normalised, which `normalised` tells.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].

        Raises
        ------
        ValueError
            If a component is not finite, a shape is wrong, or the norm is off by more than 1e-3.
        """
        xyzw = inputs.array(quaternion, "quaternion (x, y, z, w)", (4,))
        return cls._from_quaternion(xyzw, translation)

    @classmethod
    def _from_quaternion(cls, xyzw: FloatArray, translation: ArrayLike) -> Pose:
        norm = float(np.linalg.norm(xyzw))
        defect = abs(norm - 1.0)
        if defect > UNIT_QUATERNION:
            raise ValueError(
                f"quaternion with norm {norm:.9g}, off 1 by more than {UNIT_QUATERNION:g}; "
                "give four components of unit norm, in the order that the name says"
            )
        return cls.from_checked(
            scipy.spatial.transform.Rotation.from_quat(xyzw).as_matrix(),
            inputs.array(translation, "translation", (3,)),
            normalised=defect > QUATERNION_ROUNDING,
        )

    @classmethod
    def exp(cls, rotation_vector: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a rotation vector.

        Parameters
        ----------
        rotation_vector : array_like, shape (3,)
            Axis times angle [rad]. Only the rotation is the exponential.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].

        Raises
        ------
        ValueError
            If a component is not finite or a shape is wrong.
        """
        vector = inputs.array(rotation_vector, "rotation_vector", (3,))
        return cls.from_checked(
            # SciPy takes no read-only rotation vector.
            scipy.spatial.transform.Rotation.from_rotvec(vector.copy()).as_matrix(),
            inputs.array(translation, "translation", (3,)),
        )

    @property
    def matrix(self) -> FloatArray:
        """The homogeneous matrix, shape (4, 4), a new array."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    def inverse(self) -> Pose:
        """Return the pose of the world in the body."""
        rotation = self.rotation.T.copy()
        return Pose.from_checked(rotation, -(rotation @ self.translation))

    def __matmul__(self, other: Pose) -> Pose:
        """Compose: with b given in a's frame, ``a @ b`` is b in the world."""
        if not isinstance(other, Pose):
            return NotImplemented
        return Pose.from_checked(self.rotation @ other.rotation, self.apply(other.translation))

    def apply(self, points: ArrayLike) -> FloatArray:
        """Map points of the body to the world.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Body coordinates [length].

        Returns
        -------
        ndarray, shape (..., 3)
            World coordinates [length].

        Raises
        ------
        ValueError
            If the last axis has not three components.
        """
        inputs.unmasked(points, "points")
        array = np.asarray(points, dtype=np.float64)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"points have shape {array.shape}: give an array of shape (..., 3)")
        mapped: FloatArray = array @ self.rotation.T + self.translation
        return mapped


PoseLike: TypeAlias = Pose | ArrayLike | tuple[ArrayLike, ArrayLike]
"""What `Pose.of` reads: a pose, a homogeneous 4×4 matrix, or a pair (R, p)."""

_ACCEPTED = (
    "give a Pose, a homogeneous matrix of shape (4, 4), or a pair (R, p) of shapes (3, 3) and (3,)"
)


def _is_pair(value: object) -> TypeGuard[Sequence[ArrayLike]]:
    """Tell a pair (R, p) from a matrix given as nested sequences, which has four rows."""
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2


def _unnamed_quaternion(value: ArrayLike) -> str:
    return (
        f"four numbers {text(value)} are no pose: the order of a quaternion must be named; "
        "use Pose.from_wxyz(q, p) or Pose.from_xyzw(q, p)"
    )


def _check_rotation(matrix: FloatArray) -> None:
    defect = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    if defect > ORTHONORMALITY:
        raise ValueError(
            f"rotation {text(matrix)} is not orthonormal: RᵀR differs from the identity by "
            f"{defect:.3g}, allowed is {ORTHONORMALITY:g}; a scale or shear belongs to the body "
            "(Body.transformed), and rounded matrices need orthonormalising"
        )
    if np.linalg.det(matrix) < 0.0:
        raise ValueError(
            f"rotation {text(matrix)} is mirrored: its determinant is −1; "
            "mirror the body instead (Body.transformed), or flip one axis"
        )
