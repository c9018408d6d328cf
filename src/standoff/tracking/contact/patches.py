"""A few pairs of points that span where two bodies are hardly farther apart than they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import patches as kernels
from standoff.kernels.patches.choice import MOST_CORNERS, PATCH_REALS
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.reached import packed
from standoff.tracking.rows import Answer
from standoff.typing import Array

N_POSES = K.TWIST_A - K.POSE_A
"""Numbers of both poses in a row of a motion."""


@dataclass(frozen=True, eq=False)
class Patch(KeepsReadOnly):
    """Up to four pairs of points that span where the gap is hardly wider than the distance.

    It is read like a tuple of pairs (point of A, point of B), as the patches of solids are.

    Attributes
    ----------
    points_a, points_b : (n, 3) arrays
        On A and on B, pair by pair, world axes, counterclockwise about the normal.
    poses : pair of (12,) arrays
        World poses of A and B for which it holds: R row-major, p.
    """

    points_a: Array
    points_b: Array
    poses: tuple[Array, Array]

    def __len__(self) -> int:
        return len(self.points_a)

    def __getitem__(self, k: int) -> tuple[Array, Array]:
        return self.points_a[k], self.points_b[k]

    def __iter__(self) -> Iterator[tuple[Array, Array]]:
        return zip(self.points_a, self.points_b, strict=True)


class Patches(KeepsReadOnly):
    """Patches of n frames, in arrays of n rows; ``patches[k]`` is one `Patch`.

    Attributes
    ----------
    count : (n,) array of int
        How many pairs each has: 0 where there is no distance.
    points_a, points_b : (n, 4, 3) arrays
        As in `Patch`; nan beyond the count.
    """

    __slots__ = ("_poses", "_rows")

    def __init__(self, rows: Array, poses: Array) -> None:
        rows.flags.writeable = poses.flags.writeable = False
        self._rows, self._poses = rows, poses

    @property
    def count(self) -> NDArray[np.int64]:
        return self._rows[:, 0].astype(np.int64)

    @property
    def _pairs(self) -> Array:
        return self._rows[:, 1:].reshape(-1, MOST_CORNERS, 2, 3)

    @property
    def points_a(self) -> Array:
        return self._pairs[:, :, 0]

    @property
    def points_b(self) -> Array:
        return self._pairs[:, :, 1]

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, k: int) -> Patch:
        n, pairs = int(self._rows[k, 0]), self._pairs[k]
        poses = self._poses[k, :12], self._poses[k, 12:]
        return Patch(pairs[:n, 0], pairs[:n, 1], poses)

    def __iter__(self) -> Iterator[Patch]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<Patches of {len(self)} frames>"


def patch_of(answer: Answer, gap: float, after: Patch | None) -> Patch:
    """See ``Proximity.patch``."""
    kept = answer.poses
    if kept is None or not np.isfinite(answer.distance):
        why = "keeps no poses" if kept is None else f"has no distance ({answer.status.name})"
        raise StandoffError(f"The answer {why}, so it has no patch.", "answer", answer)
    poses = np.concatenate(kept)[None]
    return patches_of(answer.bodies, answer.row[None], poses, gap, after=after)[0]


def patches_of(
    bodies: tuple[Body, Body],
    rows: Array,
    poses: Array,
    gap: float,
    *,
    keeping: bool = False,
    after: Patch | None = None,
) -> Patches:
    """Patches of rows of answers at poses (n, 24), each frame `keeping` the corners of the one
    before."""
    gap = positive(gap, "gap")
    outs = np.empty((len(rows), PATCH_REALS))
    pair = packed(*bodies)
    room = np.empty(kernels.patch_room(pair[0], pair[2]))
    kernels.patches(
        pair, np.ascontiguousarray(rows), np.ascontiguousarray(poses), gap, int(keeping),
        _kept(after), room, outs,
    )  # fmt: skip
    return Patches(outs, poses)


def _kept(patch: Any) -> Array:
    """A patch as the kernels go on with it: its points as each body sees its own."""
    numbers = np.zeros(PATCH_REALS)
    if patch is None:
        return numbers
    if not isinstance(patch, Patch):
        raise StandoffTypeError(
            f"after = {shown(patch)}: give the patch of the frame before.", "after", patch
        )
    numbers[0] = len(patch)
    pairs = numbers[1:].reshape(MOST_CORNERS, 2, 3)
    for side, points in enumerate((patch.points_a, patch.points_b)):
        pose = patch.poses[side]
        pairs[: len(patch), side] = (points - pose[9:]) @ np.reshape(pose[:9], (3, 3))
    return numbers
