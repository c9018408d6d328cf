"""Distances at many poses: arrays in, arrays out, no Python object per row."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import feature_of
from standoff.checks.numbers import positive, whole_number, yes_or_no
from standoff.errors import StandoffError
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.answers import AnswerArrays, proven, statuses
from standoff.tracking.inputs import check_pair
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.pose_arrays import PoseArray, mended, read_poses
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import AddressTable, cold_table
from standoff.tracking.refused_rows import RefusedPoses, RefusedRows
from standoff.tracking.rows import motion_row
from standoff.tracking.threads import in_parts
from standoff.tracking.tracker import Tracker
from standoff.wording import counted, short_name

if TYPE_CHECKING:
    from standoff.tracking.derivatives import DerivativeArrays

Array = NDArray[np.float64]

ColdRows = Callable[[AddressTable, tuple[Array, Array], Array, int], None]
"""Answers cold rows as `cold_rows` does."""
FEATURE = np.dtype([("kind", "U6"), ("index", np.int64)])
"""A feature in an array: "face", "edge" or "vertex", and its number among those."""


class Distances(AnswerArrays):
    """Signed distances of two bodies at n pairs of poses, as arrays of n rows.

    ``found[k]`` is row k as a `Proximity`. A row whose poses are invalid is nan in all arrays, and
    ``errors`` says why.

    Attributes
    ----------
    distance, lower_bound, upper_bound : (n,) arrays
    point_a, point_b, normal : (n, 3) arrays
        As in `Proximity`, in world axes.
    repaired : (n,) array of int
        How many of a row's two poses had a rounded rotation and were replaced by the nearest.
    errors : mapping of int to StandoffError
        Of the rows that were refused; each error is made when it is asked for.
    poses : pair of (n, 4, 4) arrays
        World poses of A and B for which the rows hold, nan where they are invalid; (1, 4, 4) where
        one was given for all.
    """

    __slots__ = ("_a", "_b", "errors", "poses", "repaired", "rows")

    def __init__(
        self,
        bodies: tuple[Body, Body],
        rows: Array,
        poses: tuple[Array, Array],
        repaired: NDArray[np.int64],
        errors: RefusedRows,
    ) -> None:
        self._a, self._b = bodies
        self.rows, self.poses, self.repaired, self.errors = rows, poses, repaired, errors
        for array in (rows, repaired, *poses):
            array.flags.writeable = False

    @property
    def _numbers(self) -> Array:
        return self.rows

    @property
    def bodies(self) -> tuple[Body, Body]:
        """(A, B)."""
        return self._a, self._b

    @property
    def status(self) -> NDArray[np.object_]:
        """(n,) the status of each row, REFUSED where a pose is invalid."""
        return statuses(self.rows[:, K.STATUS])

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(n,) is the answer proven?"""
        return proven(self.rows[:, K.STATUS])

    @property
    def feature_a(self) -> NDArray[np.void]:
        """(n,) A's active feature, an array with the fields ``kind`` and ``index``."""
        return _features(self._a, self.rows[:, K.OUT_MODE])

    @property
    def feature_b(self) -> NDArray[np.void]:
        """(n,) B's."""
        return _features(self._b, self.rows[:, K.OUT_MODE + 2])

    def derivatives(self, *, workers: int = 1) -> DerivativeArrays:
        """All derivatives of all rows by the poses, with flags (docs/derivatives.md).

        Parameters
        ----------
        workers : int
            Threads that share the rows; the numbers are the same for any number.
        """
        from standoff.tracking.derivatives import derivative_arrays

        return derivative_arrays(self, whole_number(workers, "workers"))

    @property
    def gradient(self) -> Array:
        """(n, 12) derivatives of the distance by unit twists (v_A, omega_A, v_B, omega_B).

        nan where there is none, in flat contact only for some turns; computed at each call, like
        those below.
        """
        from standoff.tracking.derivatives import gradients

        return gradients(self)

    @property
    def hessian(self) -> Array:
        """(n, 12, 12) of the distance."""
        return self.derivatives().hessian

    @property
    def normal_jacobian(self) -> Array:
        """(n, 3, 12) of the normal."""
        return self.derivatives().normal_jacobian

    @property
    def point_jacobians(self) -> tuple[Array, Array]:
        """Two (n, 3, 12), of the witness points on A and on B."""
        return self.derivatives().point_jacobians

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, k: int) -> Proximity:
        index = range(len(self))[operator.index(k)]
        if index in self.errors:
            raise self.errors[index]
        block = np.zeros(K.N_BLOCK)
        block[: K.N_OUT] = self.rows[index]
        block[K.BLOCK_MOTION : K.BLOCK_TIME_STEP] = motion_row(
            *(_flat(_row(poses, index)) for poses in self.poses)
        )
        return Proximity(self._a, self._b, block, int(self.repaired[index]))

    def __repr__(self) -> str:
        names = " and ".join(short_name(body.name) for body in (self._a, self._b))
        refused = f", {len(self.errors)} refused" if self.errors else ""
        return f"<Distances at {counted(len(self), 'pair')} of poses: {names}{refused}>"


def _features(body: Body, numbers: Array) -> NDArray[np.void]:
    """Features by the kernels' numbers; an empty kind and -1 where a row was refused or is FAR."""
    found = np.zeros(len(numbers), dtype=FEATURE)
    found["index"] = -1
    for number in np.unique(numbers[numbers >= 0.0]).astype(int).tolist():
        feature = feature_of(body, number)
        here = numbers == number
        found["kind"][here], found["index"][here] = feature.kind, feature.index
    return found


def distances(
    a: Body,
    b: Body,
    poses_a: PosesLike,
    poses_b: PosesLike,
    *,
    warm: bool = False,
    workers: int = 1,
    within: float | None = None,
) -> Distances:
    """The signed minimum distances of two bodies at n pairs of poses.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all rows
        World poses; rows of 12 are R row-major, p. Also a pair (R, p) of stacks (n, 3, 3) and (n,
        3), a list of poses, SciPy's ``RigidTransform`` of n, and `Poses`, for quaternions:
        ``so.Poses.from_xyzw(q, p)`` or ``from_wxyz``.
    warm : bool
        False: every row is a cold query by itself, as ``so.distance``. True: each starts from the
        row before, as in ``Tracker.run``: several times as fast if the rows follow a motion.
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

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        Arrays of another shape, or of different lengths; a number of workers that is not positive;
        a planar body with a spatial one; two half-spaces.
    """
    found = answered_rows(a, b, poses_a, poses_b, warm=warm, workers=workers, within=within)
    if found.errors:
        found.errors.warn(stacklevel=2)
    return found


def answered_rows(
    a: Body,
    b: Body,
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
    check_pair(a, b)
    horizon = None if within is None else positive(within, "within")
    tracker = _tracker(a, b, horizon) if yes_or_no(warm, "warm") else None
    planar = a.dimension == 2 or b.dimension == 2
    given_a, given_b = read_poses(poses_a, "poses_a"), read_poses(poses_b, "poses_b")
    counts = len(given_a.matrices), len(given_b.matrices)
    n = max(counts)
    if {*counts} - {1, n}:
        raise StandoffError(
            f"poses_a has {counted(counts[0], 'pose')} and poses_b {counts[1]}: give n of both, or "
            "one for all rows.",
            "poses_a",
        )
    (of_a, marks_a, refused_a), (of_b, marks_b, refused_b) = (
        _checked(given, name, planar)
        for given, name in ((given_a, "poses_a"), (given_b, "poses_b"))
    )
    refused = np.zeros(n, dtype=bool)
    for poses in (refused_a, refused_b):
        refused[slice(None) if poses.given == 1 and len(poses.rows) else poses.rows] = True
    rows = np.full((n, K.N_OUT), np.nan)
    if tracker is None:
        (cold or cold_rows)(cold_table(a, b, horizon), (of_a, of_b), rows, workers)
    else:
        _warm(tracker, (of_a, of_b), rows, refused)
    errors = RefusedRows(refused, refused_a, refused_b, planar)
    repaired = np.broadcast_to(marks_a, n) + np.broadcast_to(marks_b, n)
    return Distances((a, b), rows, (of_a, of_b), repaired, errors)


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
    cold_rows(cold_table(a, b, within), poses, rows)
    return rows


def fit_poses(a: Body, b: Body, poses: tuple[Array, Array]) -> tuple[Array, Array]:
    """Poses as `distances` asks of them, for `rows_at_made_poses`: rounded rotations are repaired,
    and invalid poses nan, of which the rows are nan as well.

    Parameters
    ----------
    a, b : Body
    poses : two (n, 4, 4) arrays, or (1, 4, 4)
    """
    planar = a.dimension == 2 or b.dimension == 2
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


def _flat(pose: Array) -> Array:
    """(12,) R row-major, p."""
    return np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]])


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
    table: AddressTable, poses: tuple[Array, Array], rows: Array, workers: int = 1
) -> None:
    """Answer every row by itself."""
    done = np.zeros(len(rows), dtype=np.int64)

    def part(first: int, end: int) -> None:
        batch.starts(table.address, *poses, first, end, rows, done)

    in_parts(part, len(rows), workers)


def _warm(
    tracker: Tracker, poses: tuple[Array, Array], rows: Array, refused: NDArray[np.bool_]
) -> None:
    """Answer each row from the one before; the first, and one behind a refused row, cold."""
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
