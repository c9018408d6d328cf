"""Pairs of pieces of a world at many frames, each asked by itself: one call for all.

The pieces of every frame stand behind each other, as if one world had them all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.tracking.answers import proven
from standoff.typing import Array, Ints
from standoff.world.broad_phase import PairTable, PlacedPieces, empty_placed, place
from standoff.world.frame import no_tree
from standoff.world.model import Model
from standoff.world.moment import FrameTime
from standoff.world.narrow_phase import answered
from standoff.world.packed import PackedLaws, PackedPieces
from standoff.world.poses import NO_TWISTS, GivenPoses, mend_poses
from standoff.world.state import IN_PAGE, PAGE


class PieceAnswers(NamedTuple):
    """What is known of k pairs of pieces; points and normals are nan where there are none.

    Attributes
    ----------
    distance, lower, upper : (k,) arrays
        Signed distances and their bounds, length; bounds that are not proven are -inf and inf.
    point_a, point_b, normal : (k, 3) arrays
        World axes.
    """

    distance: Array
    lower: Array
    upper: Array
    point_a: Array
    point_b: Array
    normal: Array


def pieces_placed(world: Model, poses: Array) -> Array:
    """(n pieces, N_PLACED): where the pieces are, at poses of all bodies (n, 4, 4).

    Raises StandoffError: a pose is none.
    """
    nothing = empty_placed(len(world.search.pieces.owners)).placed
    tree = no_tree(len(nothing))
    frame, bad, _, _ = place(world.search, poses, tree, nothing)
    if bad >= 0:
        mended = mend_poses(GivenPoses(poses, 0), [name for name, _ in world.listed])
        frame, _, _, _ = place(world.search, mended.matrices, tree, nothing)
    return frame.placed


def answers_at(
    world: Model,
    placed: Sequence[Array],
    frames: Ints,
    pieces: tuple[Ints, Ints],
    workers: int = 1,
) -> PieceAnswers:
    """The distances of pairs of pieces, each in one of several frames.

    Parameters
    ----------
    world : Model
    placed : sequence of (n, N_PLACED) arrays
        Of `pieces_placed`, of each frame.
    frames : (k,) array of int
        The frame of each pair.
    pieces : two (k,) arrays of int
        Numbers of the pieces A and B.
    workers : int
        Threads that share the pairs.
    """
    solid = are_solids(world, pieces)
    if not solid.any():
        return _convex_answers_at(world, placed, frames, pieces, workers)
    from standoff.world.placed_solids import solid_answers_at

    found = PieceAnswers(*np.empty((3, len(frames))), *np.empty((3, len(frames), 3)))
    for which, asked in ((solid, solid_answers_at), (~solid, _convex_answers_at)):
        some = asked(world, placed, frames[which], (pieces[0][which], pieces[1][which]), workers)
        for whole, part in zip(found, some, strict=True):
            whole[which] = part
    return found


def are_solids(world: Model, pieces: tuple[Ints, Ints]) -> NDArray[np.bool_]:
    """(k,): which of some pairs of pieces are asked as solids."""
    of_pieces = world.solids.bodies[world.search.pieces.owners]
    found: NDArray[np.bool_] = of_pieces[pieces[0]] | of_pieces[pieces[1]]
    return found


def _convex_answers_at(
    world: Model, placed: Sequence[Array], frames: Ints, pieces: tuple[Ints, Ints], workers: int
) -> PieceAnswers:
    n, k = len(world.search.pieces.owners), len(frames)
    if not k:
        return PieceAnswers(*np.zeros((3, 0)), *np.zeros((3, 0, 3)))
    laws, many = _repeated(world, len(placed))
    rows = np.concatenate(placed)
    frame = PlacedPieces(rows, *np.zeros((2, len(rows)), dtype=np.int64))
    table = _table(frames * n + pieces[0], frames * n + pieces[1])
    moment = FrameTime(0, 0.0, 0.0, NO_TWISTS, False, False, -np.inf, workers)
    every, fates = np.arange(k), np.full(k, W.NEW)
    pages = answered(laws, many, frame, table, (), moment, every, fates)
    at = table.ints[:, W.I_ROW]
    blocks = np.empty((k, K.N_OUT))
    for number, page in enumerate(pages):
        here = at >> PAGE == number
        blocks[here] = page[at[here] & IN_PAGE, : K.N_OUT]
    sound = proven(table.ints[:, W.I_STATUS].astype(float))
    return PieceAnswers(
        blocks[:, K.DISTANCE],
        np.where(sound, blocks[:, K.LOWER_BOUND], -np.inf),
        np.where(sound, blocks[:, K.UPPER_BOUND], np.inf),
        blocks[:, K.POINT_A : K.POINT_A + 3],
        blocks[:, K.POINT_B : K.POINT_B + 3],
        blocks[:, K.NORMAL : K.NORMAL + 3],
    )


def _repeated(world: Model, frames: int) -> tuple[PackedLaws, PackedPieces]:
    """A world's pieces, once for each frame."""
    laws, pieces = world.laws, world.search.pieces
    owners = np.tile(pieces.owners, frames)
    addresses, classes = np.tile(laws.addresses, (frames, 1)), np.tile(laws.classes, frames)
    facts, planes = np.tile(pieces.facts, (frames, 1)), np.tile(pieces.planes, frames)
    many = PackedPieces(owners, pieces.first, planes, facts)
    for array in (addresses, classes, *many):
        array.flags.writeable = False
    return laws._replace(addresses=addresses, classes=classes), many


def _table(a: Ints, b: Ints) -> PairTable:
    """Pairs of which nothing is known yet."""
    ints = np.full((len(a), W.N_INTS), -1, dtype=np.int64)
    known = np.zeros((len(a), W.N_KNOWN))
    ints[:, W.I_KEY] = np.arange(len(a))
    ints[:, W.I_A], ints[:, W.I_B], ints[:, W.I_INSIDE] = a, b, 0
    known[:, W.C_BOUND], known[:, W.C_UPPER], known[:, W.C_HORIZON] = -np.inf, np.inf, np.inf
    return PairTable(ints, known)
