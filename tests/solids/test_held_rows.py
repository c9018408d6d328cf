"""Frames that know, pair of pieces by pair of pieces, that two solids have stayed apart."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import bracket, peg, ring
from standoff.kernels.entries import tracked_solids as T
from standoff.kernels.solids import front_rows as F
from standoff.solids import Solid, SolidTracker
from standoff.solids.tracked.front import KeptFront, room_for
from standoff.tracking.status import Status

Array = np.ndarray
STILL = np.eye(4)
BETWEEN, MIDDLE = 7, slice(2, 3)
MET = (Status.OVERLAPPING, Status.CONTAINED, Status.TOUCHING)
# About the origin, which is then the middle of its ball.
MOVED = peg(0.15, -0.3, 0.3)


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def way_between(first: Array, last: Array) -> list[Array]:
    """Poses on the way between two: the middle goes straight, and the turn is steady."""
    turn = Rotation.from_matrix(last[:3, :3] @ first[:3, :3].T).as_rotvec()
    return [
        placed(
            Rotation.from_rotvec(s * turn).as_matrix() @ first[:3, :3],
            (1.0 - s) * first[:3, 3] + s * last[:3, 3],
        )
        for s in np.linspace(0.0, 1.0, BETWEEN)[1:-1]
    ]


def row_of_frame(tracker: SolidTracker, front: KeptFront, last: Array) -> Array:
    """What the kernel tells of a frame with B at a pose, from a front on."""
    told = room_for(1)
    flat = np.concatenate([last[:3, :3].ravel(), last[:3, 3]])
    tracker.frames(front).go(flat[None], told)
    row: Array = told[0]
    return row


def test_what_is_known_to_stay_apart_does_not_meet_on_the_way() -> None:
    """Leaps past, along, through and into a bracket and a ring, longer than the distance."""
    known, crossed, rng = 0, 0, np.random.default_rng(3)
    for a, middle in ((bracket(), np.array([0.2, 0.6, 0.35])), (ring(1.0, 0.25), np.zeros(3))):
        trackers = SolidTracker(a, MOVED), SolidTracker(a, MOVED, minima=0.5)
        for k in range(36):
            tracker = trackers[k // 2 % 2]
            turn = Rotation.random(random_state=rng).as_matrix()
            shift = middle + rng.uniform(-0.9, 0.9, 3)
            first = placed(turn, shift)
            front = tracker.start(STILL, first).front
            if front is None:
                continue
            # a little farther than to the other solid, or to the other side
            leap, by = 2.0 * (middle - shift), Rotation.from_rotvec(0.2 * rng.normal(size=3))
            if k % 2:
                leap = rng.normal(size=3)
                leap *= 1.1 * front.before[13] / np.linalg.norm(leap)
                by = Rotation.from_rotvec(0.02 * rng.normal(size=3))
            last = placed(by.as_matrix() @ turn, shift + leap)
            row = row_of_frame(tracker, front, last)
            if row[T.MOTION] < front.before[13]:
                continue
            sure = row[T.SURE] > 0.0
            way = way_between(first, last) if sure else way_between(first, last)[MIDDLE]
            met = any(so.solids.distance(a, MOVED, STILL, pose).status in MET for pose in way)
            assert not (sure and met)
            known, crossed = known + sure, crossed + met
    assert known >= 10
    assert crossed >= 10


def sliding(a: Solid, b: Solid, gap: float, frames: int) -> Array:
    """Poses of B (n, 4, 4) that goes along A, by some three gaps in each."""
    rng = np.random.default_rng(4)
    pose = placed(Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix(), np.array([3.4, 0.4, 0.9]))
    tracker, poses = SolidTracker(a, b), list[Array]()
    state = tracker.start(STILL, pose)
    drift = rng.normal(size=3)
    while len(poses) < frames:
        found = state.proximity
        nearer = np.clip(gap - found.distance, -0.02, gap) * found.normal
        along = drift - found.normal * (drift @ found.normal)
        shift = 2.5 * gap * along / np.linalg.norm(along) + nearer
        pose = placed(pose[:3, :3], pose[:3, 3] + shift)
        state, found = tracker.step(state, STILL, pose)
        drift += 0.2 * rng.normal(size=3)
        assert not found.penetrating
        if found.distance < 2.0 * gap or poses:
            poses.append(pose)
    return np.array(poses)


def test_frames_that_move_by_more_than_the_gap_know_that_the_solids_stay_apart() -> None:
    a, b, gap = bracket(), peg(0.6, -1.0, 1.0), 2e-3
    poses = sliding(a, b, gap, 150)
    tracker = SolidTracker(a, b)
    front = tracker.start(STILL, poses[0]).front
    assert front is not None
    frames, told, rows = tracker.frames(front), room_for(1), []
    for pose in poses[1:]:
        frames.go(np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]])[None], told)
        rows.append(told[0].copy())
    rows = np.array(rows)
    leaps = rows[1:, T.MOTION] > rows[:-1, T.BOUND]
    assert leaps.mean() > 0.5
    assert (rows[1:][leaps][:, T.SURE] > 0.0).mean() > 0.95


@njit
def held(front, now):
    F.hold(front, 0, now, 0.0)
    return F.held_to(front, 0)


@pytest.mark.parametrize(
    ("bound", "shut", "to"),
    [
        (0.7, -np.inf, 5.7),  # back to where it was held, and on
        (-1.0, 0.7, 5.7),  # what is shut counts as well
        (0.4, 0.3, 4.5),  # not so far back: when it was not looked at they could have met
    ],
)
def test_a_row_is_held_again_by_what_lasts_back_to_where_it_was(
    bound: float, shut: float, to: float
) -> None:
    store, keys, row = (np.zeros(n) for n in (F.STORE_REALS, F.KEY_REALS, F.ROW_REALS))
    front = F.Front(store, keys, row, 1, np.zeros(0), np.zeros(0))
    store[F.KNOWN], row[F.ROW_HELD] = 4.0, 4.5
    keys[0], keys[1] = bound + 5.0, shut + 5.0
    assert held(front, 5.0) == pytest.approx(to)
