"""What a user gives a tracker, checked and made flat: poses, twists, pairs, places to start."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.arrays import text
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.state import arrays as K
from standoff.kernels.state.arrays import NOT_GIVEN
from standoff.kernels.tolerances import FARTHEST, PLANE_TILT
from standoff.motion import Pose, PoseLike, Twist, TwistLike
from standoff.motion.rotations import defect, mirrored, without_rounding
from standoff.motion.tolerances import ROUNDED
from standoff.tracking.rows import NO_TWIST, motion_row, poses_of, twists_of
from standoff.typing import Array

LAST_ROW = [0.0, 0.0, 0.0, 1.0]
PLAIN = (np.float64, np.float32)
# Where R (row-major) and p stand in a 4x4 matrix.
ROTATION_THEN_POSITION = np.array([0, 1, 2, 4, 5, 6, 8, 9, 10, 3, 7, 11])


ABSENT = np.array([NOT_GIVEN])
"""Stands for a twist that was not given."""


def plain(
    pose_a: Any, pose_b: Any, twist_a: Any, twist_b: Any
) -> tuple[tuple[Array, Array, Array, Array], int]:
    """Poses (4, 4) and twists for the compiled step to read and check, and the number of poses
    repaired.

    Arrays are passed on as they are.
    """
    repaired = 0
    if type(pose_a) is not np.ndarray:
        pose_a, mark = matrix_and_mark(pose_a)
        repaired += mark
    if type(pose_b) is not np.ndarray:
        pose_b, mark = matrix_and_mark(pose_b)
        repaired += mark
    if twist_a is None:
        twist_a = ABSENT
    elif type(twist_a) is not np.ndarray:
        twist_a = flat_twist(twist_a, pose_a)
    if twist_b is None:
        twist_b = ABSENT
    elif type(twist_b) is not np.ndarray:
        twist_b = flat_twist(twist_b, pose_b)
    return (pose_a, pose_b, twist_a, twist_b), repaired


def matrix_and_mark(pose: PoseLike) -> tuple[Array, bool]:
    """The matrix (4, 4) of a pose, and whether its rotation was repaired."""
    pose = Pose.of(pose)
    matrix = np.empty((4, 4))
    matrix[:3, :3] = pose.rotation
    matrix[:3, 3] = pose.translation
    matrix[3] = LAST_ROW
    return matrix, pose.repaired


def flat_pose(pose: PoseLike) -> Array:
    """12 numbers (R row-major, p) of a pose, checked and, where it is rounded, repaired by Pose."""
    return flat_and_mark(Pose.of(pose))[0]


def flat_and_mark(pose: PoseLike) -> tuple[Array, bool]:
    """12 numbers of a pose, and whether its rotation was repaired.

    A plain matrix is left to the kernel to check, which costs nothing; what the kernel refuses goes
    to `repair`.
    """
    if type(pose) is np.ndarray and pose.shape == (4, 4) and pose.dtype in PLAIN:
        if pose[3].tolist() != LAST_ROW:
            Pose.of(pose)  # says what is wrong with it
        return pose.take(ROTATION_THEN_POSITION).astype(np.float64, copy=False), False
    pose = Pose.of(pose)
    flat = np.empty(12)
    flat[:9] = pose.rotation.ravel()
    flat[9:] = pose.translation
    return flat, pose.repaired


def repair(flat: Array, name: str) -> None:
    """Make the nearest rotation of a flat pose that the kernel has refused, in place.

    Raises StandoffError if more than rounding is wrong with it.
    """
    rotation = flat[:9].reshape(3, 3)
    far = not np.abs(flat[9:]).sum() < FARTHEST
    if far or not defect(rotation) <= ROUNDED or mirrored(rotation):
        try:
            Pose(rotation, flat[9:])  # says what is wrong with it
        except StandoffError as error:
            raise StandoffError(f"{name}: {error}", name, error.value) from error
    # Also of one whose columns pass: the kernel asks of the rows.
    flat[:9] = without_rounding(rotation).ravel()


def flat_twist(twist: TwistLike | None, pose: PoseLike) -> Array:
    """6 numbers (v, omega) in world axes."""
    if twist is None:
        return NO_TWIST
    if isinstance(twist, tuple) and len(twist) == 2:
        v, omega = twist
        if _plain_vector(v) and _plain_vector(omega):
            flat = np.empty(6)
            flat[:3], flat[3:] = v, omega
            return flat
    if type(twist) is np.ndarray and twist.shape == (6,) and twist.dtype in PLAIN:
        return twist  # its numbers are the kernel's to check, as a plain pose's are
    twist = Twist.of(twist)
    if twist.frame != "world":
        twist = twist.in_world(Pose.of(pose))
    return np.concatenate([twist.v, twist.omega])


def _plain_vector(value: Any) -> bool:
    return type(value) is np.ndarray and value.shape == (3,) and value.dtype in PLAIN


def mend(why: int, motion: Array) -> int:
    """Repair what the kernels have refused of a frame's row of motion, in place, where it is a
    rounded pose; 1, the number of poses repaired.

    Raises StandoffError: it is something worse.
    """
    flat_a, flat_b = poses_of(motion)
    if why == K.BAD_TWIST:
        refuse_twists(*twists_of(motion))
    if why == K.OUT_OF_PLANE:
        check_in_plane(flat_a, flat_b)
    first = why == K.BAD_POSE_A
    repair(flat_a if first else flat_b, "pose_a" if first else "pose_b")
    return 1


def motion_of(pose_a: Any, pose_b: Any, twist_a: Any, twist_b: Any) -> tuple[Array, bool, int]:
    """A frame's row of motion from poses and twists in any form, whether there are twists, and how
    many poses were repaired."""
    (flat_a, mark_a), (flat_b, mark_b) = flat_and_mark(pose_a), flat_and_mark(pose_b)
    xi_a, xi_b = flat_twist(twist_a, pose_a), flat_twist(twist_b, pose_b)
    has_twist = twist_a is not None or twist_b is not None
    return motion_row(flat_a, flat_b, xi_a, xi_b), has_twist, mark_a + mark_b


def refuse_twists(twist_a: Array, twist_b: Array) -> NoReturn:
    """Say which of two flat twists is not finite.

    Raises StandoffError.
    """
    for name, twist in (("twist_a", twist_a), ("twist_b", twist_b)):
        if not np.isfinite(twist).all():
            raise StandoffError(
                f"{name} has a NaN or infinite number: {text(twist)}; give six finite ones.",
                name,
                twist.copy(),
            )
    raise StandoffError("The twists are too large: their sum is infinite.", "twist_a")


def same_body(a: Body, b: Body) -> bool:
    """Are two bodies equal, as after a pickle round trip?"""
    return np.array_equal(a.ints, b.ints) and np.array_equal(a.reals, b.reals)


def check_body(body: object) -> None:
    """Raise TypeError if something given is not a body."""
    if not isinstance(body, Body):
        # solids and compounds, which are above this layer, answer cold queries by themselves
        asked = hasattr(body, "cold_query")
        way = (
            "this takes convex bodies alone; so.distance and so.World ask solids and compounds, "
            "so.Tracker keeps two solids in space, and so.simulation moves them"
            if asked
            else "make one with so.shapes or Body.from_brep"
        )
        raise StandoffTypeError(f"{shown(body)} is not a Body: {way}.", "body", body)


def check_pair(a: Body, b: Body) -> None:
    """Raise ValueError if two bodies cannot be a pair."""
    check_body(a)
    check_body(b)
    if not a.bounded and not b.bounded:
        raise StandoffError("Two half-spaces have no pair of witness points: one must be bounded.")
    if a.dimension != b.dimension:
        other = b if a.dimension == 2 else a
        if not other.flat:
            raise StandoffError(
                f"A planar body needs a planar partner (or a point or segment in z = 0), not "
                f"{other!r}."
            )


def out_of_plane(flats: Array) -> NDArray[np.bool_]:
    """Which of flat poses (..., 12) take a planar body out of z = 0?"""
    level = np.abs(flats[..., [2, 5, 6, 7]]).max(axis=-1) <= PLANE_TILT
    out: NDArray[np.bool_] = ~(level & (flats[..., 11] == 0.0) & (flats[..., 8] >= 0.0))
    return out


def check_in_plane(flat_a: Array, flat_b: Array) -> None:
    """A planar pair must move within one plane z = 0 of world."""
    for name, flat in (("pose_a", flat_a), ("pose_b", flat_b)):
        if out_of_plane(flat):
            tilt = float(np.abs(flat[[2, 5, 6, 7]]).max())
            raise StandoffError(
                f"{name} takes a planar body out of z = 0 (tilt {tilt:.3g}, z = {flat[11]}): "
                "planar pairs turn about z and move in x and y.",
                name,
                flat.copy(),
            )
