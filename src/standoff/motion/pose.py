"""Poses: where a body is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, TypeGuard

import numpy as np
import scipy
from numpy.typing import ArrayLike

from standoff.checks.arrays import finite, numbers, text, unmasked
from standoff.checks.real_numbers import as_given, shape_of, shown
from standoff.errors import StandoffError
from standoff.motion.rotations import as_rotation, nearest_rotation
from standoff.motion.tolerances import ORTHONORMALITY, QUATERNION_ROUNDING, UNIT_QUATERNION
from standoff.motion.vectors import written
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

LAST_ROW = (0.0, 0.0, 0.0, 1.0)
"""Of every homogeneous matrix."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Pose(KeepsReadOnly):
    """A rigid placement of a body in the world.

    A point with coordinates x in the body is at ``rotation @ x + translation`` in the world.

    Raises ValueError if a component is not finite, a shape is wrong, or the matrix is not a
    rotation (``RᵀR`` is the identity to 1e-5, with determinant +1).

    Parameters
    ----------
    rotation : array_like, shape (3, 3), or SciPy's ``Rotation``
        Rotation matrix; its columns are the body's axes in world coordinates. One that is
        orthonormal to 1e-9 is kept bit for bit; one that is off by no more than 1e-5, as in single
        precision or in text with six decimals, is replaced by the nearest rotation.
    translation : array_like, shape (3,)
        The body's origin in world coordinates [length].

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
        Read-only, float64.
    translation : ndarray, shape (3,)
        Read-only, float64.
    repaired : bool
        True if the rotation given was not one to 1e-9 and the nearest was taken: a rounded matrix,
        a normalised quaternion, or a matrix given to `nearest`. Poses computed from this one do not
        carry the mark.
    """

    rotation: Array
    translation: Array
    repaired: bool

    # Without this NumPy would take a pose for an object array in ``pose @ array``.
    __array_ufunc__ = None

    def __init__(self, rotation: RotationLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        matrix, shift = _numbers(rotation, translation)
        matrix, repaired = as_rotation(matrix)
        self._set(matrix, shift, repaired=repaired)

    def _set(self, rotation: Array, translation: Array, *, repaired: bool) -> None:
        rotation.setflags(write=False)
        translation.setflags(write=False)
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "translation", translation)
        object.__setattr__(self, "repaired", repaired)

    @classmethod
    def from_checked(cls, rotation: Array, translation: Array, *, repaired: bool = False) -> Pose:
        """Wrap float64 arrays known to be a pose, unchecked and uncopied; they become read-only.

        For results computed from poses in code that runs every frame; a caller's own numbers go
        through ``Pose(...)`` or `Pose.of`.
        """
        pose = cls.__new__(cls)
        pose._set(rotation, translation, repaired=repaired)
        return pose

    @classmethod
    def of(cls, value: PoseLike) -> Pose:
        """Read a pose.

        Raises ValueError if it is none of these; a four-vector is refused, since the order of a
        quaternion cannot be known.

        Parameters
        ----------
        value : Pose, array_like of shape (4, 4), pair (R, p), or SciPy's ``RigidTransform``
            A homogeneous matrix, or a rotation with a translation. In a pair, R is a matrix or
            SciPy's ``Rotation``. Any object whose ``as_matrix()`` returns such a matrix will do,
            such as those of jaxlie and mink. Rounded rotations are repaired as by ``Pose(R, p)``.
        """
        return value if isinstance(value, Pose) else cls(*_parts(value))

    @classmethod
    def nearest(cls, value: PoseLike) -> Pose:
        """Make a pose of the rotation nearest to a matrix that is not one.

        For matrices that are farther off than `of` repairs, such as those from text with few
        digits, in half precision, or accumulated from small turns. A scale or a shear is lost:
        those of a body belong to ``Body.transformed``.

        Raises ValueError if a component is not finite, a shape is wrong, or R is mirrored or flat
        (zero, or with one principal stretch below 1e-6 of another).

        Parameters
        ----------
        value : Pose or what `of` reads
            R may be any matrix with a determinant above 0; the nearest rotation is the one with
            the least sum of squared differences.

        Returns
        -------
        Pose
            With `repaired` set, unless R was orthonormal to 1e-9: then R is kept bit for bit.
        """
        if isinstance(value, Pose):
            return value
        matrix, shift = _numbers(*_parts(value))
        rotation, repaired = nearest_rotation(matrix)
        return cls.from_checked(rotation, shift, repaired=repaired)

    @classmethod
    def identity(cls) -> Pose:
        """Return the pose whose body axes are the world's."""
        return cls.from_checked(np.eye(3), np.zeros(3))

    @classmethod
    def from_wxyz(cls, quaternion: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a quaternion with the scalar first.

        Raises ValueError if a component is not finite, a shape is wrong, or the norm is off by more
        than 1e-3.

        Parameters
        ----------
        quaternion : array_like, shape (4,)
            (w, x, y, z), of unit norm to 1e-3; normalised, and marked by `repaired`.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].
        """
        w, x, y, z = finite(quaternion, "quaternion (w, x, y, z)", (4,))
        return cls._from_quaternion(np.array([x, y, z, w]), translation)

    @classmethod
    def from_xyzw(cls, quaternion: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a quaternion with the scalar last; otherwise as `from_wxyz`.

        Raises ValueError if a component is not finite, a shape is wrong, or the norm is off by more
        than 1e-3.

        Parameters
        ----------
        quaternion : array_like, shape (4,)
            (x, y, z, w), of unit norm to 1e-3; normalised, and marked by `repaired`.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].
        """
        xyzw = finite(quaternion, "quaternion (x, y, z, w)", (4,))
        return cls._from_quaternion(xyzw, translation)

    @classmethod
    def _from_quaternion(cls, xyzw: Array, translation: ArrayLike) -> Pose:
        norm = float(np.linalg.norm(xyzw))
        defect = abs(norm - 1.0)
        if defect > UNIT_QUATERNION:
            raise StandoffError(
                f"quaternion with norm {norm:.9g}, off 1 by more than {UNIT_QUATERNION:g}; "
                "give four components of unit norm, in the order that the name says",
                "quaternion",
                xyzw,
            )
        return cls.from_checked(
            scipy.spatial.transform.Rotation.from_quat(xyzw).as_matrix(),
            finite(translation, "translation", (3,)),
            repaired=defect > QUATERNION_ROUNDING,
        )

    @classmethod
    def exp(cls, rotation_vector: ArrayLike, translation: ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Make a pose from a rotation vector.

        Raises ValueError if a component is not finite or a shape is wrong.

        Parameters
        ----------
        rotation_vector : array_like, shape (3,)
            Axis times angle [rad]. Only the rotation is the exponential.
        translation : array_like, shape (3,)
            The body's origin in world coordinates [length].
        """
        vector = finite(rotation_vector, "rotation_vector", (3,))
        return cls.from_checked(
            # SciPy takes no read-only rotation vector.
            scipy.spatial.transform.Rotation.from_rotvec(vector.copy()).as_matrix(),
            finite(translation, "translation", (3,)),
        )

    def __repr__(self) -> str:
        """One line that makes the same pose, to six digits."""
        turn = scipy.spatial.transform.Rotation.from_matrix(self.rotation).as_rotvec()
        return f"Pose.exp({written(turn, 1.0)}, {written(self.translation)})"

    @property
    def matrix(self) -> Array:
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

    def apply(self, points: ArrayLike) -> Array:
        """Map points of the body to the world.

        Raises ValueError if the last axis does not have three components.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Body coordinates [length].

        Returns
        -------
        ndarray, shape (..., 3)
            World coordinates [length].
        """
        array = numbers(points, "points", None)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise StandoffError(
                f"points have shape {array.shape}: give an array of shape (..., 3)",
                "points",
                points,
            )
        mapped: Array = array @ self.rotation.T + self.translation
        return mapped


class HasMatrix(Protocol):
    """A rotation or a rigid motion as SciPy, jaxlie and mink have them."""

    def as_matrix(self) -> Any:
        """Return the matrix, of shape (3, 3) or (4, 4)."""
        ...


RotationLike: TypeAlias = ArrayLike | HasMatrix
"""A rotation: a matrix of shape (3, 3), or SciPy's ``Rotation``."""

PoseLike: TypeAlias = Pose | ArrayLike | HasMatrix | tuple[RotationLike, ArrayLike]
"""What `Pose.of` reads: a pose, a homogeneous 4×4 matrix or SciPy's ``RigidTransform``, or a pair
(R, p)."""

_ACCEPTED = (
    "give a Pose, a homogeneous matrix of shape (4, 4), a pair (R, p) of shapes (3, 3) and (3,), "
    "or SciPy's RigidTransform; R may be SciPy's Rotation"
)


def matrix_of(value: Any) -> Any:
    """Return the matrix of what has one; anything else as it is."""
    # Asked by name, so that SciPy's classes are read without their import.
    has_one = callable(getattr(value, "as_matrix", None)) and not isinstance(value, type)
    return value.as_matrix() if has_one else value


def _numbers(rotation: RotationLike, translation: ArrayLike) -> tuple[Array, Array]:
    if shape_of(rotation) == (4, 4):
        raise StandoffError(
            f"rotation has shape (4, 4), value {shown(rotation)}: give an array of 3 by 3 numbers, "
            "or write Pose.of(matrix) for a homogeneous matrix.",
            "rotation",
            rotation,
        )
    return (
        finite(matrix_of(rotation), "rotation", (3, 3)),
        finite(translation, "translation", (3,)),
    )


def _parts(value: PoseLike) -> tuple[RotationLike, ArrayLike]:
    """Part what should be a pose into rotation and translation, which are still to be checked."""
    if isinstance(value, Pose):
        return value.rotation, value.translation
    if _is_pair(value):
        rotation, translation = value
        if shape_of(rotation) == (4,):
            raise StandoffError(_unnamed_quaternion(rotation), "rotation", rotation)
        return rotation, translation
    given = matrix_of(value)
    unmasked(given, "pose")
    try:
        given = as_given(given)
    except (ValueError, RecursionError) as error:
        raise StandoffError(f"not a pose: {shown(value)}; {_ACCEPTED}", "value", value) from error
    if given.shape == (4,):
        raise StandoffError(_unnamed_quaternion(given), "value", value)
    if given.shape != (4, 4):
        raise StandoffError(
            f"not a pose: shape {given.shape}, value {text(given)}; {_ACCEPTED}", "value", value
        )
    matrix = finite(given, "pose", (4, 4))
    if np.abs(matrix[3] - LAST_ROW).max() > ORTHONORMALITY:
        raise StandoffError(
            f"the last row of a homogeneous matrix is (0, 0, 0, 1), not {text(matrix[3])}; if the "
            "translation is there, transpose the matrix",
            "value",
            value,
        )
    return matrix[:3, :3], matrix[:3, 3]


def _is_pair(value: object) -> TypeGuard[Sequence[ArrayLike]]:
    """Tell a pair (R, p) from a matrix given as nested sequences, which has four rows."""
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2


def _unnamed_quaternion(value: ArrayLike) -> str:
    return (
        f"four numbers {text(value)} are not a pose: the order of a quaternion must be named; "
        "use Pose.from_wxyz(q, p) or Pose.from_xyzw(q, p)"
    )
