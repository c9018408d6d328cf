"""What is kept of a world's answer in a row: the least distance of all pairs, and its proof."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from standoff.motion import Pose
from standoff.motion.vectors import pose_row
from standoff.sweep.rows import NO_PAIR, Rows
from standoff.tracking.answers import PROVEN
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.world import World
from standoff.world.answer import WorldAnswer
from standoff.world.pieces import PieceUnion
from standoff.world.solid_answer import SolidPairAnswer


class NearestRow(NamedTuple):
    """One row's numbers, as `Rows` has them."""

    distance: float
    lower_bound: float
    status: int
    pair: int


def signed(answer: WorldAnswer) -> Array:
    """(k,) distances of the near pairs, of a body inside another's material less the wall."""
    pairs = answer.pairs
    return np.asarray(np.where(pairs.inside, -pairs.distance, pairs.distance))


def row_of(answer: WorldAnswer) -> NearestRow:
    """Return what is kept of a world's answer.

    The status is that of the nearest pair; where another pair that may be nearer still is not
    proven, it is that pair's. The bound holds for all pairs.
    """
    pairs, distance = answer.pairs, signed(answer)
    if not len(distance):
        return NearestRow(np.nan, answer.clearance, Status.FAR.value, NO_PAIR)
    nearest = int(np.argmin(distance))
    told = np.array([status.value for status in pairs.status])
    bounds = pairs.lower_bound
    open_ = np.flatnonzero(~PROVEN[told] & (bounds < distance[nearest]))
    which = nearest
    if PROVEN[told[nearest]] and len(open_):
        which = int(open_[np.argmin(bounds[open_])])
    i, j = pairs.bodies[nearest].tolist()
    number = i * len(answer.model.listed) + j
    return NearestRow(float(distance[nearest]), answer.clearance, int(told[which]), number)


def rows_of(answers: Iterable[WorldAnswer], first: int) -> Rows:
    """Return rows from `first` on, of an answer each."""
    found = [row_of(answer) for answer in answers]
    distance, bound, status, pair = np.array(found).reshape(-1, len(NearestRow._fields)).T
    numbers = np.arange(first, first + len(found))
    return Rows(numbers, distance, bound, status.astype(np.int64), pair.astype(np.int64))


def names_of(names: Sequence[str], number: int) -> tuple[str, str] | None:
    """Return the names of a pair by its number, of the names of all bodies."""
    if number == NO_PAIR:
        return None
    i, j = divmod(number, len(names))
    return names[i], names[j]


def nearest_of(answer: WorldAnswer) -> Any:
    """Return the answer of the pair whose distance a row has; None where none is near."""
    pairs = answer.pairs
    return pairs[int(np.argmin(signed(answer)))] if len(pairs) else None


def drawn_answer(world: World, answer: Any) -> Any:
    """Return the answer of a pair with the poses of its nearest pieces, which it is drawn with.

    That of convex bodies has these already; that of a pair with a solid has those of the bodies.
    """
    if not isinstance(answer, SolidPairAnswer):
        return answer
    poses = []
    for name, piece, pose in zip(answer.names, answer.pieces, answer.poses, strict=True):
        body = world.bodies[name]
        if isinstance(body, PieceUnion) and piece:
            within = Pose(pose[:9].reshape(3, 3), pose[9:]) @ body.pieces[piece].pose
            pose = pose_row(within.rotation, within.translation)
        poses.append(pose)
    return replace(answer, poses=(poses[0], poses[1]))
