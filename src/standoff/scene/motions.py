"""From a ``[motions.NAME]`` table to a path in time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath
from typing import NamedTuple, cast, get_args

import numpy as np

from standoff.motion import (
    Carried,
    ConstantTwist,
    Fixed,
    Frame,
    Helix,
    Offset,
    Orientation,
    Path,
    Pose,
    PoseSamples,
    Screw,
    Spiral,
    Twist,
    read_pose_samples,
)
from standoff.scene.degrees import ENDING, in_radians, with_degrees
from standoff.scene.files import existing_file
from standoff.scene.placements import in_space, read_pose
from standoff.scene.reader import SceneTable
from standoff.typing import Array

FILE_START = "file"
"""Value of ``start`` that keeps the time stamps as the file gives them."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A body's path and where it came from.

    Attributes
    ----------
    path : Path
        Where the body is in scene time.
    kind : str
        As the scene names it.
    sample_times : ndarray, shape (n,)
        Scene times [s] of the pose samples; empty for a path given by a formula.
    file : Path or None
        The file of the pose samples.
    repaired : int
        How many of its poses had a rounded quaternion or matrix, and were replaced by the nearest
        rotation.
    """

    path: Path
    kind: str
    sample_times: Array = field(repr=False)
    file: FilePath | None = None
    repaired: int = 0


class MotionKind(NamedTuple):
    """One kind of motion: its keys, whether it starts from a placement, and what reads it."""

    keys: tuple[str, ...]
    placed: bool
    read: Callable[[SceneTable, Pose], Motion]


def at_rest(placement: Pose) -> Motion:
    """Return the motion of a body that stays where it is placed."""
    return _formula("fixed", Fixed(placement))


def _formula(kind: str, path: Path) -> Motion:
    return Motion(path, kind, np.empty(0))


def _twist(table: SceneTable, placement: Pose) -> Motion:
    if "linear" not in table and "angular" not in table:
        raise table.error("a twist needs 'linear' or 'angular'; add linear = [0.1, 0.0, 0.0]")
    linear = in_space(table, "linear") if "linear" in table else np.zeros(3)
    angular = table.vector("angular", 3) if "angular" in table else np.zeros(3)
    frame = cast(Frame, table.choice("frame", get_args(Frame), "world"))
    twist = table.build(lambda: Twist(linear, angular, frame))
    return _formula("twist", ConstantTwist(placement, twist))


def _screw(table: SceneTable, placement: Pose) -> Motion:
    axis = table.vector("axis", 3)
    point = in_space(table, "point") if "point" in table else np.zeros(3)
    rate, pitch = table.number("angular_rate"), table.number("pitch", 0.0)
    return _formula("screw", table.build(lambda: Screw(placement, axis, point, rate, pitch)))


def _helix(table: SceneTable, _: Pose) -> Motion:
    radius, pitch = table.positive("radius"), table.number("pitch")
    rate, phase = table.number("rate"), table.number("phase", 0.0)
    centre = in_space(table, "centre") if "centre" in table else np.zeros(3)
    axis = table.vector("axis", 3) if "axis" in table else np.array([0.0, 0.0, 1.0])
    orientation = _orientation(table)
    path = table.build(lambda: Helix(radius, pitch, rate, centre, axis, phase, orientation))
    return _formula("helix", path)


def _spiral(table: SceneTable, _: Pose) -> Motion:
    radius, growth = table.not_negative("radius"), table.number("growth")
    rate, phase = table.number("rate"), table.number("phase", 0.0)
    centre = table.vector("centre", 2) if "centre" in table else np.zeros(2)
    orientation = _orientation(table)
    path = table.build(lambda: Spiral(radius, growth, rate, centre, phase, orientation))
    return _formula("spiral", path)


def _samples(table: SceneTable, _: Pose) -> Motion:
    file = existing_file(table, "file", 'file = "hand.tum"')
    samples: PoseSamples = table.build(lambda: read_pose_samples(file), "file")
    start = table.number_or_word("start", FILE_START, 0.0)
    if start is None:
        return Motion(samples, "samples", samples.times, file, samples.repaired)
    # A shift to a far start can round two close stamps to one, which the samples refuse.
    shifted = table.build(lambda: samples.starting_at(start), "start")
    return Motion(shifted, "samples", shifted.times, file, samples.repaired)


def _orientation(table: SceneTable) -> Orientation:
    return cast(Orientation, table.choice("orientation", get_args(Orientation), "fixed"))


ANGLES = ("angular_rate", "rate", "phase")
ANGLE_VECTORS = ("angular", "spin")
"""Keys in rad or rad/s, which may be given in degrees under another."""

_WINDING = ("centre", "rate", "phase", "orientation")

MOTIONS: Mapping[str, MotionKind] = {
    "twist": MotionKind(("linear", "angular", "frame"), True, _twist),
    "screw": MotionKind(("axis", "point", "angular_rate", "pitch"), True, _screw),
    "helix": MotionKind(("radius", "pitch", "axis", *_WINDING), False, _helix),
    "spiral": MotionKind(("radius", "growth", *_WINDING), False, _spiral),
    "samples": MotionKind(("file", "start"), False, _samples),
}
"""Every kind of motion that a scene may name."""


def read_motion(table: SceneTable, placement: Pose | None) -> Motion:
    """Return the motion that a ``[motions.NAME]`` table describes.

    Raises SceneError: at an unknown kind or key, a value that the motion refuses, a file that is
    missing or cannot be read, or a placement together with a motion that gives the whole pose
    itself.

    Parameters
    ----------
    table : SceneTable
        With ``kind``, the kind's own keys, and optionally ``offset`` and ``spin``.
    placement : Pose or None
        The body's own placement, if the scene gives one.
    """
    kind = MOTIONS[table.choice("kind", list(MOTIONS))]
    own = [key + ENDING for key in kind.keys if key in (*ANGLES, *ANGLE_VECTORS)]
    table = in_radians(table, ANGLES, ANGLE_VECTORS)
    table.expect("kind", "offset", *with_degrees(["spin"]), *kind.keys, *own)
    if placement is not None and not kind.placed:
        raise table.error(
            "this kind of motion gives the whole pose, and the body has a placement too; "
            "remove the placement, or write it as this motion's 'offset'",
            "kind",
        )
    motion = kind.read(table, placement or Pose.identity())
    if "offset" in table:
        offset = read_pose(table.table("offset"))
        repaired = motion.repaired + offset.repaired
        motion = replace(motion, path=Offset(motion.path, offset), repaired=repaired)
    if "spin" in table:
        spin = table.vector("spin", 3)
        turning = table.build(lambda: Twist(np.zeros(3), spin, "body"), "spin")
        spinning = ConstantTwist(Pose.identity(), turning)
        motion = replace(motion, path=Carried(motion.path, spinning))
    return motion
