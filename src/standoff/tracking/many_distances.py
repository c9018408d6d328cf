"""Distances at many poses: arrays in, arrays out, no Python object a row."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.bodies.body import Body
from standoff.bodies.features import feature_of
from standoff.errors import StandoffError
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K
from standoff.kernels.tolerances import FARTHEST, ROTATION
from standoff.motion import Pose, PoseLike
from standoff.tracking.answers import AnswerArrays
from standoff.tracking.choices import whole_number, yes_or_no
from standoff.tracking.cold_query import ColdQuery
from standoff.tracking.inputs import check_in_plane, flat_pose
from standoff.tracking.overlap_proof import cores_overlap
from standoff.tracking.proximity import Proximity
from standoff.tracking.rows import motion_row
from standoff.tracking.runs import read_poses
from standoff.tracking.status import Status
from standoff.tracking.threads import in_parts
from standoff.tracking.tracker import Tracker
from standoff.wording import counted, short_name

if TYPE_CHECKING:
    from standoff.tracking.derivatives import DerivativeArrays

Array = NDArray[np.float64]
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
        How many of a row's two poses had a rounded rotation and were brought to the nearest.
    errors : dict of int to StandoffError
        Of the rows that were refused.
    poses : pair of (n, 4, 4) arrays
        World poses of A and B that the rows hold for; (1, 4, 4) where one was given for all.
    """

    __slots__ = ("_a", "_b", "errors", "poses", "repaired", "rows")

    def __init__(
        self,
        bodies: tuple[Body, Body],
        rows: Array,
        poses: tuple[Array, Array],
        repaired: NDArray[np.int64],
        errors: dict[int, StandoffError],
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
        """(n,) the status of each row; None where it was refused."""
        numbers = self.rows[:, K.STATUS]
        known: dict[float, Status | None] = {float(s.value): s for s in Status}
        return np.array([known.get(x) for x in numbers.tolist()], dtype=object)

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(n,) is the answer proven?"""
        proven = [float(s.value) for s in Status if s.certified]
        return np.isin(self.rows[:, K.STATUS], proven)

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

        return derivative_arrays(self, at_least_one(workers, "workers"))

    @property
    def gradient(self) -> Array:
        """(n, 12) derivatives of the distance by unit twists (v_A, omega_A, v_B, omega_B).

        nan where there is none, in flat contact by some turns only; computed at each call, as those
        below.
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
    """Features by the kernels' numbers; an empty kind and -1 where a row was refused."""
    found = np.zeros(len(numbers), dtype=FEATURE)
    found["index"] = -1
    for number in np.unique(numbers[~np.isnan(numbers)]).astype(int).tolist():
        feature = feature_of(body, number)
        here = numbers == number
        found["kind"][here], found["index"][here] = feature.kind, feature.index
    return found


def distances(
    a: Body,
    b: Body,
    poses_a: ArrayLike | PoseLike,
    poses_b: ArrayLike | PoseLike,
    *,
    warm: bool = False,
    workers: int = 1,
) -> Distances:
    """The signed minimum distances of two bodies at n pairs of poses.

    Parameters
    ----------
    a, b : Body
        Two spatial bodies, or two planar ones.
    poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), or one pose for all rows
        World poses; rows of 12 are R row-major, p.
    warm : bool
        False: every row is a cold query by itself, as ``so.distance``. True: each starts from the
        row before, as ``Tracker.run``: several times as fast where rows follow a motion.
    workers : int
        Threads that share cold rows. The answers are the same, to the last bit, for any number.

    Returns
    -------
    Distances
        Arrays of n rows. A row with invalid poses says so; the others are not affected.

    Raises
    ------
    TypeError
        Not a body.
    ValueError
        Arrays of another shape, or of different lengths; no positive number of workers; a planar
        body with a spatial one; two half-spaces.
    """
    at_least_one(workers, "workers")
    query = Tracker(a, b) if yes_or_no(warm, "warm") else ColdQuery(a, b)
    (of_a, mark_a), (of_b, mark_b) = read_poses(poses_a, "poses_a"), read_poses(poses_b, "poses_b")
    n = max(len(of_a), len(of_b))
    if {len(of_a), len(of_b)} - {1, n}:
        raise StandoffError(
            f"poses_a has {counted(len(of_a), 'pose')} and poses_b {len(of_b)}: give n of both, or "
            "one for all rows.",
            "poses_a",
        )
    errors: dict[int, StandoffError] = {}
    repaired = np.full(n, mark_a + mark_b)
    of_a, of_b = (
        _checked(poses, name, query.planar, n, errors, repaired)
        for poses, name in ((of_a, "poses_a"), (of_b, "poses_b"))
    )
    rows = np.full((n, K.N_OUT), np.nan)
    if warm:
        _warm(query, (of_a, of_b), rows, errors)
    else:
        _cold(query, (of_a, of_b), rows, workers)
    for k in np.flatnonzero(rows[:, K.STATUS] == Status.NOT_CERTIFIED.value).tolist():
        _name_overlap(query, rows[k], _row(of_a, k), _row(of_b, k))
    rows[list(errors)] = np.nan
    return Distances((a, b), rows, (of_a, of_b), repaired, errors)


def at_least_one(value: int, name: str) -> int:
    """A number of threads."""
    if whole_number(value, name) < 1:
        raise StandoffError(f"{name} = {value}: give 1 or more.", name, value)
    return int(value)


def _row(poses: Array, k: int) -> Array:
    row: Array = poses[0 if len(poses) == 1 else k]
    return row


def _flat(pose: Array) -> Array:
    """(12,) R row-major, p."""
    return np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]])


def _checked(
    poses: Array,
    name: str,
    planar: bool,
    n: int,
    errors: dict[int, StandoffError],
    repaired: NDArray[np.int64],
) -> Array:
    """Poses for the kernels: rounded ones repaired, invalid ones replaced and noted."""
    turns = poses[:, :3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        sound = (off <= ROTATION) & (np.linalg.det(turns) > 0.0)
        sound &= (poses[:, 3] == (0.0, 0.0, 0.0, 1.0)).all(axis=1)
        sound &= np.abs(poses[:, :3, 3]).sum(axis=1) < FARTHEST
    suspects = range(len(poses)) if planar else np.flatnonzero(~sound).tolist()
    mended = np.array(poses, order="C")  # kept by the answers: the caller may change his own
    for k in suspects:
        places = range(n) if len(poses) == 1 else (k,)
        try:
            pose = Pose.of(poses[k])
            flat = flat_pose(pose)
            if planar:
                check_in_plane(flat, flat)
            mended[k] = pose.matrix
            repaired[list(places)] += bool(pose.repaired)
        except StandoffError as error:
            mended[k] = np.eye(4)
            told = StandoffError(f"Row {k} of {name}: {error}", name, error.value)
            errors.update(dict.fromkeys(places, told))
    return mended


def _cold(query: Tracker, poses: tuple[Array, Array], rows: Array, workers: int) -> None:
    """Answer every row by itself."""
    done = np.zeros(len(rows), dtype=np.int64)

    def part(first: int, end: int) -> None:
        batch.starts(query.packed, *poses, first, end, query.options, rows, done)

    in_parts(part, len(rows), workers)


def _warm(
    query: Tracker, poses: tuple[Array, Array], rows: Array, errors: dict[int, StandoffError]
) -> None:
    """Answer each row from the one before; the first, and one behind a refused row, cold."""
    good = [k for k in range(len(rows)) if k not in errors]
    if not good:
        return
    cuts = np.flatnonzero(np.diff(good) > 1) + 1
    for stretch in np.split(np.array(good), cuts):
        first, end = int(stretch[0]), int(stretch[-1]) + 1
        state = query.start(_row(poses[0], first), _row(poses[1], first))
        rows[first] = state.proximity.row
        if end - first > 1:
            parts = [x if len(x) == 1 else x[first + 1 : end] for x in poses]
            if all(len(x) == 1 for x in parts):
                parts[0] = np.repeat(parts[0], end - first - 1, axis=0)
            _, answers = query.run(state, *parts)
            rows[first + 1 : end] = answers.blocks[:, : K.N_OUT]


def _name_overlap(query: Tracker, row: Array, pose_a: Array, pose_b: Array) -> None:
    """Give an uncertified row without a positive bound the status OVERLAPPING, if proven."""
    if row[K.DISTANCE] <= 0.0 or row[K.LOWER_BOUND] > 0.0:
        return
    if cores_overlap(query.a, query.b, _flat(pose_a), _flat(pose_b)):
        row[K.DISTANCE] = row[K.UPPER_BOUND] = 0.0
        row[K.STATUS] = float(Status.OVERLAPPING.value)
