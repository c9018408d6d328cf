"""Twists: how a body moves at an instant, and where it gets to while the twist lasts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
import scipy
from numpy.typing import ArrayLike

from standoff.checks.arrays import finite, text, unmasked
from standoff.checks.names import choice
from standoff.checks.numbers import number, positive
from standoff.checks.real_numbers import as_given, shown
from standoff.errors import StandoffError
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.vectors import written
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

Frame: TypeAlias = Literal["world", "body"]
"""The axes in which a twist's components are given."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Twist(KeepsReadOnly):
    """The velocity of a rigid body: linear part first.

    Both frames hold the same two vectors, the velocity of the body's origin and the angular
    velocity, both relative to the world; `frame` says along which axes they are resolved.

    Raises ValueError if a component is not finite, a shape is wrong, or the frame is unknown.

    Parameters
    ----------
    v : array_like, shape (3,)
        Velocity of the body's origin [length/s].
    omega : array_like, shape (3,)
        Angular velocity [rad/s].
    frame : {"world", "body"}
        Axes of both vectors.

    Attributes
    ----------
    v, omega : ndarray, shape (3,)
        Read-only, float64.
    frame : {"world", "body"}
    """

    v: Array
    omega: Array
    frame: Frame

    def __init__(self, v: ArrayLike, omega: ArrayLike, frame: Frame = "world") -> None:
        choice(frame, "frame", get_args(Frame))
        object.__setattr__(self, "v", finite(v, "v", (3,)))
        object.__setattr__(self, "omega", finite(omega, "omega", (3,)))
        object.__setattr__(self, "frame", frame)

    def __repr__(self) -> str:
        frame = "" if self.frame == "world" else f', "{self.frame}"'
        return f"Twist({written(self.v)}, {written(self.omega)}{frame})"

    @classmethod
    def of(cls, value: TwistLike) -> Twist:
        """Read a twist; bare numbers are in world axes.

        Raises ValueError if it is none of these.

        Parameters
        ----------
        value : Twist, pair (v, ω), or array_like of shape (6,)
            Linear part first.
        """
        if isinstance(value, Twist):
            return value
        unmasked(value, "twist")
        try:
            given = as_given(value)
        except (ValueError, RecursionError) as error:
            raise StandoffError(
                f"not a twist: {shown(value)}; {_ACCEPTED}", "value", value
            ) from error
        if given.shape not in ((6,), (2, 3)):
            raise StandoffError(
                f"not a twist: shape {given.shape}, value {text(given)}; {_ACCEPTED}",
                "value",
                value,
            )
        v, omega = given.reshape(2, 3)
        return cls(v, omega)

    @classmethod
    def zero(cls) -> Twist:
        """Return the twist of a body at rest."""
        return cls(np.zeros(3), np.zeros(3))

    @classmethod
    def between(cls, first: PoseLike, second: PoseLike, duration: float) -> Twist:
        """Return the body-frame twist that carries `first` to `second` in `duration`.

        It is the logarithm on SE(3): the constant twist of the screw with the least turn.

        Raises ValueError if the duration is not positive.

        Parameters
        ----------
        first, second : Pose or what `Pose.of` reads
        duration : float
            Time between them [s], above zero.
        """
        seconds = positive(duration, "duration")
        poses = Pose.of(first), Pose.of(second)
        rotations = np.array([pose.rotation for pose in poses])
        translations = np.array([pose.translation for pose in poses])
        v, omega = screws(rotations, translations, np.array([seconds]))
        return cls(v[0], omega[0], "body")

    @classmethod
    def from_checked(cls, v: Array, omega: Array, frame: Frame = "world") -> Twist:
        """Wrap float64 arrays known to be a twist, unchecked and uncopied; they become read-only.

        As `Pose.from_checked`.
        """
        twist = cls.__new__(cls)
        for name, value in (("v", v), ("omega", omega)):
            value.setflags(write=False)
            object.__setattr__(twist, name, value)
        object.__setattr__(twist, "frame", frame)
        return twist

    def in_world(self, pose: PoseLike) -> Twist:
        """Return the same twist in world axes, for a body at `pose`."""
        if self.frame == "world":
            return self
        rotation = Pose.of(pose).rotation
        return Twist(rotation @ self.v, rotation @ self.omega)

    def carry(self, pose: PoseLike, duration: float) -> Pose:
        """Return where a body gets to from `pose` while this twist lasts, constant in its own
        frame.

        In body axes the motion is a screw, ``pose @ exp(twist · duration)``. In world axes the
        origin moves straight on while the body turns.

        Parameters
        ----------
        pose : Pose or what `Pose.of` reads
            Where the body is at first.
        duration : float
            Time [s]; negative goes back.
        """
        placed = Pose.of(pose)
        seconds = number(duration, "duration")
        turn, shift = self.omega * seconds, self.v * seconds
        rotation: Array = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
        if self.frame == "world":
            return Pose.from_checked(rotation @ placed.rotation, placed.translation + shift)
        return placed @ Pose.from_checked(rotation, _shear(turn, shift))


TwistLike: TypeAlias = Twist | ArrayLike | tuple[ArrayLike, ArrayLike]
"""What `Twist.of` reads: a twist, a pair (v, ω), or six numbers (v, ω)."""

_ACCEPTED = "give a Twist, a pair (v, ω) of three numbers each, or six numbers with v first"


# The two maps below are V and V⁻¹ of the exponential on SE(3),
# exp(v, φ) = (exp φ, V v), as in Lynch and Park, Modern Robotics, 2017, Eq. (3.88). On the plane
# across the axis n = φ/|φ| they multiply by the complex numbers (e^{iθ} − 1)/(iθ) and its inverse;
# along the axis they are the identity. Written with n, no term loses digits at small angles.


def _shear(turn: Array, shift: Array) -> Array:
    angle = math.hypot(*turn)
    if angle == 0.0:
        return shift
    axis = turn / angle
    real = math.sin(angle) / angle
    imaginary = 2.0 * math.sin(0.5 * angle) ** 2 / angle
    sheared: Array = (
        real * shift + imaginary * np.cross(axis, shift) + (1.0 - real) * (axis @ shift) * axis
    )
    return sheared


def _unshear(turns: Array, translations: Array) -> Array:
    """V⁻¹ of stacks (n, 3)."""
    # The library of C, by element: NumPy's own vary by a rounding with the processor.
    angles = np.array(list(map(math.hypot, *turns.T.tolist())))
    still = angles == 0.0
    angles[still] = 1.0
    axes = turns / angles[:, None]
    real = 0.5 * angles / np.array(list(map(math.tan, (0.5 * angles).tolist())))
    along = (1.0 - real) * (axes[:, None, :] @ translations[:, :, None])[:, 0, 0]
    unsheared: Array = (
        real[:, None] * translations - 0.5 * np.cross(turns, translations) + along[:, None] * axes
    )
    unsheared[still] = translations[still]
    return unsheared


def screws(rotations: Array, translations: Array, durations: Array) -> tuple[Array, Array]:
    """Return the twists (v, ω), body axes, of the screws from each of n poses to the next.

    Parameters
    ----------
    rotations, translations : ndarray, shape (n, 3, 3) and (n, 3)
    durations : ndarray, shape (n - 1,)
        From each pose to the next [s], above zero.

    Returns
    -------
    v, omega : ndarray, shape (n - 1, 3)
    """
    back = np.swapaxes(rotations[:-1], 1, 2).copy()
    origins = -(back @ translations[:-1, :, None])[:, :, 0]
    ways = (translations[1:, None, :] @ np.swapaxes(back, 1, 2))[:, 0] + origins
    turns = scipy.spatial.transform.Rotation.from_matrix(back @ rotations[1:]).as_rotvec()
    with np.errstate(over="ignore"):  # a velocity beyond float64 is refused as infinite
        return _unshear(turns, ways) / durations[:, None], turns / durations[:, None]
