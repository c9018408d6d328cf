"""Poses and twists of many bodies: an array, a list, or a mapping by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.names import did_you_mean
from standoff.checks.real_numbers import real_array, shown
from standoff.errors import StandoffError, StandoffTypeError, UnreadableNumbers
from standoff.kernels.tolerances import FARTHEST, ROTATION
from standoff.motion import Pose, Twist
from standoff.motion.rotations import defect, without_rounding
from standoff.tracking.inputs import flat_twist, matrix_and_mark, out_of_plane
from standoff.tracking.pose_arrays import flat_poses, mended, numbers, read_poses
from standoff.typing import Array, Ints
from standoff.world.tolerances import COMPOSED_ROUNDOFF


class GivenPoses(NamedTuple):
    """Of all bodies.

    Attributes
    ----------
    matrices : (n, 4, 4) array
    repaired : int
        How many had a rounded rotation and were replaced by the nearest one.
    """

    matrices: Array
    repaired: int


def read_poses_of(poses: Any, names: Sequence[str], planar: bool) -> GivenPoses:
    """Poses of the named bodies, in this order; their numbers are left for the kernel to check.

    Raises StandoffError: another number of poses, a name that is missing or unknown, a planar body
    out of z = 0.
    """
    if isinstance(poses, Mapping):
        check_names(poses, names, "poses")
        matrices = np.empty((len(names), 4, 4))
        repaired = 0
        for k, name in enumerate(names):
            try:
                matrices[k], mark = matrix_and_mark(poses[name])
            except StandoffError as error:
                raise type(error)(f"poses[{name!r}]: {error}", "poses", poses[name]) from error
            repaired += mark
    elif not names and (poses is None or len(poses) == 0):
        return GivenPoses(np.empty((0, 4, 4)), 0)
    else:
        read = read_poses(poses, "poses")
        matrices, repaired = read.matrices, int(read.repaired.sum())
    if len(matrices) != len(names):
        raise StandoffError(
            f"poses are {len(matrices)}, but the world has {len(names)} bodies that move: give one "
            "of each, in the order of world.moving, or a mapping of names.",
            "poses",
        )
    if planar:
        check_level(names, matrices, "poses")
    return GivenPoses(np.ascontiguousarray(matrices), repaired)


def check_level(names: Sequence[str], matrices: Any, argument: str) -> None:
    """Refuse poses (n, 4, 4) that take a planar body out of z = 0; the name of the first is told.
    What is no number is left for others to refuse.

    Raises StandoffError.
    """
    flat = flat_poses(np.ascontiguousarray(matrices))
    out = out_of_plane(flat) & np.isfinite(flat).all(axis=1)
    for k in np.flatnonzero(out)[:1]:
        tilt = float(np.abs(flat[k, [2, 5, 6, 7]]).max())
        over = ", turned over" if flat[k, 8] < 0.0 else ""
        raise StandoffError(
            f"The pose of {names[k]!r} is out of the plane z = 0 (tilt {tilt:.3g}, z = "
            f"{flat[k, 11]:.6g}{over}): planar bodies turn about z and move in x and y.",
            argument,
            matrices[k],
        )


def mend_poses(given: GivenPoses, names: Sequence[str]) -> GivenPoses:
    """Poses that the kernel has refused, repaired where they are only rounded, or so far off that
    one that is composed with a placement is off by more than is let pass.

    Raises StandoffError: more than rounding is wrong with one; its name is told.
    """
    found = mended(given.matrices)
    for k in np.flatnonzero(found.refused)[:1]:
        try:
            Pose.of(given.matrices[k])
        except StandoffError as error:
            told = f"The pose of {names[k]!r} is not one: {error}"
            raise StandoffError(told, "poses", given.matrices[k]) from error
        raise refused_pose(names[k])
    turns = found.matrices[:, :3, :3]
    doubtful = defect(turns.transpose(0, 2, 1)) > ROTATION - COMPOSED_ROUNDOFF
    turns[doubtful] = without_rounding(turns[doubtful])
    repaired = found.repaired | doubtful
    return GivenPoses(found.matrices, given.repaired + int(repaired.sum()))


def refused_pose(name: str) -> StandoffError:
    """What to raise of a pose that only the kernel refuses."""
    return StandoffError(
        f"The pose of {name!r} puts it, or one of its pieces, farther out than {FARTHEST:g}.",
        "poses",
    )


def check_names(given: Mapping[str, Any], names: Sequence[str], argument: str) -> None:
    """Refuse a mapping that does not have each of the names and no other.

    Raises StandoffError.
    """
    for name in names:
        if name not in given:
            raise StandoffError(
                f"{argument} has none of {name!r}: give one of each body that moves.", argument
            )
    known = set(names) if len(given) != len(names) else given
    for name in given:
        if name not in known:
            raise StandoffError(
                f"{argument} has {shown(name)}, which is no body of the world that moves."
                f"{did_you_mean(str(name), names)}",
                argument,
                name,
            )


def read_twists_of(
    twists: Any, names: Sequence[str], poses: Array, rows: Ints
) -> tuple[Array, bool]:
    """(twist and origin of each body (n, 9), are there any?); fixed bodies are at rest.

    Raises StandoffError: another number of twists, a name that is missing or unknown, a number that
    is not finite.
    """
    if twists is None:
        return NO_TWISTS, False
    found = np.zeros((len(poses), 9))
    found[:, 6:] = poses[:, :3, 3]
    if isinstance(twists, Mapping):
        check_names(twists, names, "twists")
        for row, name in zip(rows, names, strict=True):
            found[row, :6] = flat_twist(twists[name], Pose.of(poses[row]))
    elif isinstance(twists, list | tuple) and any(isinstance(x, Twist | tuple) for x in twists):
        _check_count(len(twists), names)
        for row, twist in zip(rows, twists, strict=True):
            found[row, :6] = flat_twist(twist, Pose.of(poses[row]))
    else:
        try:
            array = real_array(twists, copy=False)
        except UnreadableNumbers as error:
            raise StandoffError(f"twists {error}: {shown(twists)}", "twists", twists) from error
        except (TypeError, ValueError) as error:
            raise StandoffTypeError(
                f"twists = {shown(twists)}: give (n, 6), or a mapping of names.", "twists", twists
            ) from error
        if array.ndim != 2 or array.shape[1] != 6:
            raise StandoffError(
                f"twists have the shape {array.shape}: give (n, 6), or a mapping of names.",
                "twists",
                twists,
            )
        _check_count(len(array), names)
        found[rows, :6] = array
    # the twist of a piece is that of its body and its turn times the piece's arm: below this the
    # sum is finite
    sound = np.abs(found[rows, :6]) < FARTHEST
    for k in np.flatnonzero(~sound.all(axis=1))[:1]:
        raise StandoffError(
            f"The twist of {names[k]!r} has a number that is NaN, infinite or too large: "
            f"{found[rows[k], :6]}.",
            "twists",
            found[rows[k], :6],
        )
    return found, True


def frames_of(given: Any, name: str) -> Any:
    """Frames in an array of another library, read where it is; anything else as it is given.

    Raises StandoffError: an array that is on a device, or not of numbers.
    """
    if isinstance(given, np.ndarray) or not hasattr(given, "__dlpack_device__"):
        return given
    return numbers(given, name, "an array of n frames")


def check_frames(poses: Any, twists: Any) -> None:
    """Refuse twists of another number of frames, where both are known.

    Raises StandoffError.
    """
    if isinstance(poses, Sized) and isinstance(twists, Sized) and len(twists) != len(poses):
        raise StandoffError(
            f"twists are of {len(twists)} frames and poses of {len(poses)}: give as many.",
            "twists",
            twists,
        )


def _check_count(count: int, names: Sequence[str]) -> None:
    if count != len(names):
        raise StandoffError(
            f"twists are {count}, but the world has {len(names)} bodies that move: give one of "
            "each, in the order of world.moving.",
            "twists",
        )


NO_TWISTS = np.zeros((1, 9))
NO_TWISTS.flags.writeable = False
