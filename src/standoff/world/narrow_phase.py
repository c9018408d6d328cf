"""The pairs that are due in a frame, asked: each goes on from its kept state, or starts cold."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from standoff.kernels.entries import world as kernels
from standoff.kernels.entries import world_answers
from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.tracking.threads import in_parts
from standoff.typing import Array, Ints
from standoff.world.broad_phase import PairTable, PlacedPieces
from standoff.world.moment import FrameTime
from standoff.world.packed import PackedLaws, PackedPieces
from standoff.world.state import IN_PAGE, NO_SOLIDS, PAGE, KeptSolids

if TYPE_CHECKING:
    from standoff.world.solid_rows import SolidRows

NUMBER = np.dtype(np.float64).itemsize


class RefusedFrame(Exception):
    """A frame of two pieces, by their numbers, that the kernel has refused, and its reason."""


class NarrowPhaseResult(NamedTuple):
    """What came of a frame.

    Attributes
    ----------
    fates : (n,) array
        FAR, RESTING, MOVED or NEW, of each pair in the table.
    pages : tuple of arrays
        All blocks that the table's rows stand in.
    solids : KeptSolids
    """

    fates: Ints
    pages: tuple[Array, ...]
    solids: KeptSolids


def ask(
    laws: PackedLaws,
    pieces: PackedPieces,
    frame: PlacedPieces,
    table: PairTable,
    pages: tuple[Array, ...],
    moment: FrameTime,
    solids: SolidRows | None = None,
) -> NarrowPhaseResult:
    """Bring a table of pairs, which is changed in place, up to a frame."""
    n = len(table.ints)
    fates = np.empty(n, dtype=np.int64)
    last = moment.frame - 1 if moment.may_rest else -1
    kernels.due(pieces[:], frame[:], table[:], moment.minima, last, fates)
    if solids is not None:
        solids.settle(fates)
    asking = np.flatnonzero(fates >= W.MOVED)
    again = np.empty(n, dtype=np.int64)
    several = int(pieces.first[-1]) > 1
    while True:
        if solids is not None:
            asking = solids.ask(asking, fates)
        pages = answered(laws, pieces, frame, table, pages, moment, asking, fates)
        if not several or not kernels.due_again(
            pieces[:], frame[:], table[:], moment.minima, fates, again
        ):
            break
        asking = np.flatnonzero(again)
        if solids is not None and solids.all_asked(asking, fates):
            break
    found = NO_SOLIDS
    if solids is not None:
        found, pages = solids.answers(fates, pages)
    kept = fates != W.FAR
    table.ints[kept, W.I_FRAME] = moment.frame
    table.known[kept, W.C_TIME] = moment.time
    return NarrowPhaseResult(fates, _without_unused(table.ints, pages), found)


def answered(
    laws: PackedLaws,
    pieces: PackedPieces,
    frame: PlacedPieces,
    table: PairTable,
    pages: tuple[Array, ...],
    moment: FrameTime,
    asking: Ints,
    fates: Ints,
) -> tuple[Array, ...]:
    """The answers of some pairs, on new pages."""
    if not len(asking):
        return pages
    ints, known = table.ints[asking], table.known[asking]
    if laws.integrates:
        # one step over the frames that were left out is none of the law: it begins anew
        late = (fates[asking] == W.MOVED) & (ints[:, W.I_FRAME] != moment.frame - 1)
        fates[asking[late]] = W.NEW
    moved = fates[asking] == W.MOVED
    keeping = moved & (ints[:, W.I_INSIDE] != 0)
    asked = np.zeros((len(asking), 5), dtype=np.int64)
    asked[:, 0] = asking
    made: list[Array] = []
    rows = np.empty(len(asking), dtype=np.int64)
    for some, width in ((~keeping, K.N_BLOCK), (keeping, K.N_KEEPING_BLOCK)):
        if some.any():
            count = int(np.count_nonzero(some))
            rows[some] = (len(pages) + len(made) << PAGE) + np.arange(count)
            made.append(np.empty((count, width)))
    pages = (*pages, *made)
    places = _places(pages)
    asked[moved, 1], asked[moved, 3] = _addresses(ints[moved, W.I_ROW], places)
    asked[:, 2], asked[:, 4] = _addresses(rows, places)
    since = moment.time - known[:, W.C_TIME]
    steps = np.where(ints[:, W.I_FRAME] == moment.frame - 1, moment.dt, since)
    done = np.empty(len(asking), dtype=np.int64)
    twists = moment.twists, int(moment.has_twist)
    read = laws[:3], pieces[:], frame[:]

    def some_of(first: int, end: int) -> None:
        part = first, end
        world_answers.answer(*read, table[:], (asked, steps), twists, part, done)

    in_parts(some_of, len(asking), moment.workers)
    if done.any():
        k = int(np.flatnonzero(done)[0])
        raise RefusedFrame(int(ints[k, W.I_A]), int(ints[k, W.I_B]), int(done[k]))
    table.ints[asking, W.I_ROW] = rows
    return pages


def _places(pages: tuple[Array, ...]) -> tuple[Ints, Ints]:
    """Where pages begin in memory, and the widths of their rows."""
    bases = np.array([page.ctypes.data for page in pages], dtype=np.int64)
    return bases, np.array([page.shape[1] for page in pages], dtype=np.int64)


def _addresses(rows: Ints, places: tuple[Ints, Ints]) -> tuple[Ints, Ints]:
    """Where the blocks of rows begin in memory, and their polytopes, 0 for none."""
    bases, widths = places
    at = rows >> PAGE
    width = widths[at]
    blocks = bases[at] + (rows & IN_PAGE) * width * NUMBER
    return blocks, np.where(width == K.N_KEEPING_BLOCK, blocks + K.N_BLOCK * NUMBER, 0)


def _without_unused(ints: Ints, pages: tuple[Array, ...]) -> tuple[Array, ...]:
    """Drop pages that no row stands in, and gather rows that fill little of theirs; the rows'
    numbers are changed in place."""
    rows = ints[:, W.I_ROW]
    some = rows >= 0
    at, within = rows[some] >> PAGE, rows[some] & IN_PAGE
    used = np.bincount(at, minlength=len(pages))
    kept: list[Array] = []
    numbers = at.copy()
    for number, page in enumerate(pages):
        if not used[number]:
            continue
        here = at == number
        if 2 * used[number] < len(page):
            page = np.ascontiguousarray(page[within[here]])
            within[here] = np.arange(len(page))
        numbers[here] = len(kept)
        kept.append(page)
    if len(kept) > MOST_PAGES:
        kept, numbers, within = _gathered(kept, numbers, within)
    ints[some, W.I_ROW] = (numbers << PAGE) + within
    return tuple(kept)


MOST_PAGES = 16
"""Where there are more, all are gathered into one of each width."""


def _gathered(pages: list[Array], numbers: Ints, within: Ints) -> tuple[list[Array], Ints, Ints]:
    """All rows on one page of each width."""
    made: list[Array] = []
    for width in sorted({page.shape[1] for page in pages}):
        parts, n = [], 0
        for number, page in enumerate(pages):
            if page.shape[1] == width:
                here = numbers == number
                parts.append(page[within[here]])
                within[here] = n + np.arange(len(parts[-1]))
                numbers[here] = -1 - len(made)
                n += len(parts[-1])
        made.append(np.concatenate(parts))
    return made, -1 - numbers, within
