"""Distances at many poses: arrays in, arrays out, no Python object per row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.numbers import positive, whole_number, yes_or_no
from standoff.errors import StandoffError
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.pose_arrays import PoseArray, mended, read_poses
from standoff.tracking.reached import AddressTables, cold_tables
from standoff.tracking.refused_rows import RefusedPoses, RefusedRows
from standoff.tracking.row_pairs import RowPairs, is_planar, row_pairs
from standoff.tracking.threads import in_parts
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff.wording import counted

ColdRows = Callable[[AddressTables, tuple[Array, Array], Array, int], None]
"""Answers cold rows as `cold_rows` does."""


def distances(
    a: Body | Sequence[Body],
    b: Body | Sequence[Body],
    poses_a: PosesLike,
    poses_b: PosesLike,
    *,
    warm: bool = False,
    workers: int = 1,
    within: float | None = None,
) -> Distances:
    """The signed minimum distances of two bodies, or of n pairs of bodies, at n pairs of poses.

    Raises TypeError: not a body. Raises ValueError: arrays of another shape, or of different
    lengths; lists of bodies of another length; a number of workers that is not positive; a planar
    body with a spatial one; two half-spaces.

    Parameters
    ----------
    a, b : Body, or list of n bodies
        All spatial, or all planar. A list has one body for each row; the same body may stand in it
        many times.
    poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all rows
        World poses; rows of 12 are R row-major, p. Also a pair (R, p) of stacks (n, 3, 3) and (n,
        3), a list of poses, SciPy's ``RigidTransform`` of n, and `Poses`, for quaternions:
        ``so.Poses.from_xyzw(q, p)`` or ``from_wxyz``.
    warm : bool
        False: every row is a cold query by itself, as ``so.distance``. True: each starts from the
        row before, of lists from the last row of the same two bodies, as in ``Tracker.run``:
        several times as fast if the rows follow a motion.
    workers : int
        Threads that share cold rows. The answers are the same, to the last bit, for any number.
    within : float, optional
        Horizon, length: of rows farther apart only that is proven, with the status FAR.

    Returns
    -------
    Distances
        Arrays of n rows. A row with invalid poses says so; the others are not affected.

    Warns
    -----
    RefusedRowsWarning
        More than half of the rows have invalid poses.
    """
    found = answered_rows(a, b, poses_a, poses_b, warm=warm, workers=workers, within=within)
    if found.errors:
        found.errors.warn(stacklevel=2)
    return found


def answered_rows(
    a: Body | Sequence[Body],
    b: Body | Sequence[Body],
    poses_a: Any,
    poses_b: Any,
    *,
    warm: bool = False,
    workers: int = 1,
    within: float | None = None,
    cold: ColdRows | None = None,
) -> Distances:
    """`distances`, without a warning. `cold` is what answers cold rows, if not the processor."""
    whole_number(workers, "workers")
    of = row_pairs(a, b)
    horizon = None if within is None else positive(within, "within")
    yes_or_no(warm, "warm")
    given_a, given_b = read_poses(poses_a, "poses_a"), read_poses(poses_b, "poses_b")
    n = _count(of, len(given_a.matrices), len(given_b.matrices))
    (of_a, marks_a, refused_a), (of_b, marks_b, refused_b) = (
        _checked(given, name, of.planar)
        for given, name in ((given_a, "poses_a"), (given_b, "poses_b"))
    )
    refused = np.zeros(n, dtype=bool)
    for poses in (refused_a, refused_b):
        refused[slice(None) if poses.given == 1 and len(poses.rows) else poses.rows] = True
    rows = np.full((n, K.N_OUT), np.nan)
    if warm:
        _warm(of, horizon, (of_a, of_b), rows, refused)
    else:
        (cold or cold_rows)(cold_tables(of, horizon), (of_a, of_b), rows, workers)
    errors = RefusedRows(refused, refused_a, refused_b, of.planar)
    repaired = np.broadcast_to(marks_a, n) + np.broadcast_to(marks_b, n)
    return Distances(of, rows, (of_a, of_b), repaired, errors)


def _count(of: RowPairs, poses_a: int, poses_b: int) -> int:
    """How many rows there are."""
    n = max(poses_a, poses_b, len(of.which))
    if {poses_a, poses_b} - {1, n}:
        raise StandoffError(
            f"poses_a has {counted(poses_a, 'pose')} and poses_b {poses_b}: give "
            f"{'n' if len(of.which) < n else n} of both, or one for all rows.",
            "poses_a",
        )
    if len(of.which) not in (1, n):
        raise StandoffError(
            f"There are {counted(len(of.which), 'pair')} of bodies and {n} of poses: give one body "
            "for each row, or one for all.",
            "a",
        )
    return n


def rows_at_made_poses(a: Body, b: Body, poses: tuple[Array, Array], within: float | None) -> Array:
    """The rows of `distances`, (n, N_OUT), of two spatial bodies at poses that are not looked at.

    Parameters
    ----------
    a, b : Body
        Checked to be a pair.
    poses : two (n, 4, 4) arrays, or (1, 4, 4)
        Contiguous, and known to be such that `distances` would repair and refuse none.
    within : float or None
    """
    rows = np.full((max(map(len, poses)), K.N_OUT), np.nan)
    cold_rows(cold_tables(row_pairs(a, b), within), poses, rows)
    return rows


def fit_poses(a: Body, b: Body, poses: tuple[Array, Array]) -> tuple[Array, Array]:
    """Poses as `distances` asks of them, for `rows_at_made_poses`: rounded rotations are repaired,
    and invalid poses nan, of which the rows are nan as well.

    Parameters
    ----------
    a, b : Body
    poses : two (n, 4, 4) arrays, or (1, 4, 4)
    """
    planar = is_planar((a, b))
    of_a, of_b = (
        _checked(read_poses(given, name), name, planar)[0]
        for given, name in zip(poses, ("poses_a", "poses_b"), strict=True)
    )
    return of_a, of_b


def _tracker(a: Body, b: Body, within: float | None) -> Tracker:
    if within is None:
        return Tracker(a, b)
    return Tracker(a, b, law=PredictorCorrector(within=within))


def _row(poses: Array, k: int) -> Array:
    row: Array = poses[0 if len(poses) == 1 else k]
    return row


def _checked(
    given: PoseArray, name: str, planar: bool
) -> tuple[Array, NDArray[np.int64], RefusedPoses]:
    """Poses for the kernels, which refuse nan: rounded ones repaired, invalid ones nan; how many
    of each were repaired; the invalid ones."""
    matrices, repaired, refused = mended(given.matrices, planar)
    rows = np.flatnonzero(refused)
    told = RefusedPoses(name, rows, given.matrices[rows], len(matrices))
    matrices[rows] = np.nan
    return matrices, np.where(refused, 0, given.repaired + repaired), told


def cold_rows(
    tables: AddressTables, poses: tuple[Array, Array], rows: Array, workers: int = 1
) -> None:
    """Answer every row by itself."""
    done = np.zeros(len(rows), dtype=np.int64)

    def part(first: int, end: int) -> None:
        batch.starts(tables.numbers, tables.which, *poses, first, end, rows, done)

    in_parts(part, len(rows), workers)


def _warm(
    of: RowPairs,
    within: float | None,
    poses: tuple[Array, Array],
    rows: Array,
    refused: NDArray[np.bool_],
) -> None:
    """Answer each row from the one before, of the same bodies; the first, and one behind a refused
    row, cold."""
    if not of.several:
        _follow(_tracker(*of.pairs[0], within), poses, rows, refused)
        return
    for j, at in of.groups():
        own = np.full((len(at), K.N_OUT), np.nan)
        there = tuple(x if len(x) == 1 else x[at] for x in poses)
        _follow(_tracker(*of.pairs[j], within), (there[0], there[1]), own, refused[at])
        rows[at] = own


def _follow(
    tracker: Tracker, poses: tuple[Array, Array], rows: Array, refused: NDArray[np.bool_]
) -> None:
    good = np.flatnonzero(~refused)
    for stretch in np.split(good, np.flatnonzero(np.diff(good) > 1) + 1) if len(good) else ():
        first, end = int(stretch[0]), int(stretch[-1]) + 1
        state = tracker.start(_row(poses[0], first), _row(poses[1], first))
        rows[first] = state.proximity.row
        if end - first == 1:
            continue
        parts = [x if len(x) == 1 else x[first + 1 : end] for x in poses]
        if all(len(x) == 1 for x in parts):
            parts[0] = np.repeat(parts[0], end - first - 1, axis=0)
        _, answers = tracker.run(state, *parts)
        rows[first + 1 : end] = answers.blocks[:, : K.N_OUT]
