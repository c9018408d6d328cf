"""One frame of a world: places, pairs, answers; from the state before to the state after."""

from __future__ import annotations

import numpy as np

from standoff.errors import StandoffError
from standoff.kernels.world import arrays as W
from standoff.progress import Progress
from standoff.tracking.answers import proven
from standoff.typing import Array
from standoff.world.broad_phase import (
    PairTable,
    PlacedPieces,
    empty_placed,
    first_tree,
    place,
    repadded,
    table_of,
)
from standoff.world.carried import carried_pieces, carried_rows, carried_table
from standoff.world.model import Model
from standoff.world.moment import FrameTime
from standoff.world.narrow_phase import NarrowPhaseResult, RefusedFrame, ask
from standoff.world.poses import NO_TWISTS, GivenPoses, mend_poses, refused_pose
from standoff.world.state import NO_SOLIDS, KeptSolids, PaddedTree, WorldCounts, WorldState

Twists = tuple[Array, bool]

NO_PAIRS = PairTable(np.empty((0, W.N_INTS), dtype=np.int64), np.empty((0, W.N_KNOWN)))


def started_state(
    world: Model, given: GivenPoses, twists: Twists, progress: Progress | None = None
) -> WorldState:
    """The state of a first frame."""
    before = empty_placed(len(world.search.pieces.owners)).placed
    moment = FrameTime(0, 0.0, 0.0, *twists, False, world.minima, 1, progress)
    return _sought(world, given, before, (NO_PAIRS, NO_SOLIDS), (), moment)


def carried_state(
    world: Model,
    old: Model,
    before: WorldState,
    given: GivenPoses,
    keeps_rows: bool,
    dt: float,
    progress: Progress | None = None,
) -> WorldState:
    """The state of a world after that of another with some of its bodies: no time passes, and the
    answers of the pairs that both have hold where their bodies are not moved."""
    numbers = carried_pieces(world, old)
    placed = carried_rows(len(world.search.pieces.owners), before, numbers)
    known = carried_table(world, before, numbers, keeps_rows)
    may_rest = not before.has_twist
    frame, minima = before.frame + 1, world.minima
    moment = FrameTime(frame, before.time, dt, NO_TWISTS, False, may_rest, minima, 1, progress)
    return _sought(world, given, placed, known, before.pages, moment)


def _sought(
    world: Model,
    given: GivenPoses,
    before: Array,
    known: tuple[PairTable, KeptSolids],
    pages: tuple[Array, ...],
    moment: FrameTime,
) -> WorldState:
    """The state of a frame in which the pairs of all pieces are sought, and what is known of some
    is kept."""
    search, n = world.search, len(before)
    frame, given = _placed(world, given, no_tree(n), before)
    tree = first_tree(search, frame)
    frame.sought[:] = 1
    table = table_of(search, frame, tree, known[0])
    asked = _asked(world, given, (frame, table), (pages, known[1]), moment)
    return _state(world, given, (frame, tree, table), asked, moment)


def no_tree(n: int) -> PaddedTree:
    """Before the first frame of n pieces: none is in a box."""
    none = np.zeros(1, dtype=np.int64)
    return PaddedTree(np.zeros((n, 6)), np.empty((2, 6)), none, none, 0, 0)


def next_state(
    world: Model, before: WorldState, given: GivenPoses, twists: Twists, dt: float, workers: int
) -> WorldState:
    """The state of the next frame."""
    search = world.search
    may_rest = not twists[1] and not before.has_twist
    if may_rest and before.counts.uncertified == 0 and np.array_equal(before.poses, given.matrices):
        return _rested(before, dt)
    frame, given = _placed(world, given, before.tree, before.placed)
    tree, table = before.tree, PairTable(before.ints, before.known)
    left = int(frame.sought.sum())
    if left and not search.everything:
        tree = repadded(search, frame, tree, before.placed, left)
        table = table_of(search, frame, tree, table)
    else:
        table = PairTable(table.ints.copy(), table.known.copy())
    time = before.time + dt
    moment = FrameTime(before.frame + 1, time, dt, *twists, may_rest, world.minima, workers)
    kept = before.pages, before.solids
    asked = _asked(world, given, (frame, table), kept, moment)
    return _state(world, given, (frame, tree, table), asked, moment)


def _placed(
    world: Model, given: GivenPoses, tree: PaddedTree, before: Array
) -> tuple[PlacedPieces, GivenPoses]:
    """Where the pieces are; poses that are only rounded are repaired."""
    frame, bad, _, _ = place(world.search, given.matrices, tree, before)
    if bad >= 0:
        given = mend_poses(given, [name for name, _ in world.listed])
        frame, bad, _, _ = place(world.search, given.matrices, tree, before)
    if bad >= 0:
        raise refused_pose(world.listed[bad][0])
    return frame, given


def _asked(
    world: Model,
    given: GivenPoses,
    found: tuple[PlacedPieces, PairTable],
    kept: tuple[tuple[Array, ...], KeptSolids],
    moment: FrameTime,
) -> NarrowPhaseResult:
    """`ask`, with the names of the bodies in an error."""
    pieces, (pages, before), solids = world.search.pieces, kept, None
    if world.solids.any:
        from standoff.world.solid_rows import SolidRows

        solids = SolidRows(world, given.matrices, *found, before, moment)
    try:
        return ask(world.laws, pieces, *found, pages, moment, solids)
    except RefusedFrame as refused:
        p, q, why = refused.args
        names = tuple(world.listed[pieces.owners[k]][0] for k in (p, q))
        raise StandoffError(
            f"The pair {names}: its frame was refused, with {why} of kernels.state.arrays."
        ) from refused


def _rested(before: WorldState, dt: float) -> WorldState:
    """Where nothing has moved, all answers hold."""
    counts = before.counts
    resting = counts.tracked + counts.started + counts.resting
    parts = {name: getattr(before, name) for name in WorldState.__slots__ if name != "key"}
    parts["counts"] = counts._replace(tracked=0, started=0, resting=resting, sought=0)
    parts["time"] = before.time + dt
    return WorldState(before.key, **parts)


def _state(
    world: Model,
    given: GivenPoses,
    found: tuple[PlacedPieces, PaddedTree, PairTable],
    asked: NarrowPhaseResult,
    moment: FrameTime,
) -> WorldState:
    frame, tree, (ints, known) = found
    fates = asked.fates
    near = np.flatnonzero((fates != W.FAR) & (known[:, W.C_BOUND] <= known[:, W.C_HORIZON]))
    tally = np.bincount(fates, minlength=4)
    sound = proven(ints[near, W.I_STATUS].astype(float))
    counts = WorldCounts(
        open=int(np.count_nonzero(ints[:, W.I_ROW] >= 0)),
        tracked=int(tally[W.MOVED]),
        started=int(tally[W.NEW]),
        resting=int(tally[W.RESTING]),
        bounded=int(tally[W.FAR]),
        sought=int(frame.sought.sum()),
        uncertified=int(np.count_nonzero(~sound)),
    )
    return WorldState(
        world.key,
        time=moment.time,
        frame=moment.frame,
        has_twist=moment.has_twist,
        poses=given.matrices,
        placed=frame.placed,
        tree=tree,
        ints=ints,
        known=known,
        near=near,
        pages=asked.pages,
        solids=asked.solids,
        counts=counts,
        repaired=given.repaired,
    )
