"""Solids that are tracked face on face, and along valleys: a frame takes no more than a query."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import standoff as so
from families.solid_shapes import bracket, peg, prism, ring
from standoff.kernels.solids import front_rows as F
from standoff.solids import Solid, SolidTracker
from standoff.solids.spatial import distance as cold_query
from standoff.solids.tracked.front import room_for

Array = np.ndarray
STILL = np.eye(4)
GAP = 0.01


def at(shift: tuple[float, float, float], turn: float = 0.0) -> Array:
    return so.Pose.exp((0, 0, turn), shift).matrix


def sliding(frames: int) -> dict[str, tuple[Solid, Solid, list[Array]]]:
    """A box and a disc on a plate, and a key that slides into a channel."""
    plate, shares = Solid(so.shapes.box((4, 4, 0.5))), np.linspace(0.0, 1.0, frames)
    channel = prism([(-1, -1), (3, -1), (3, 2), (2, 2), (2, 0), (0, 0), (0, 2), (-1, 2)], 3.0)
    box, key = (Solid(so.shapes.box(sides)) for sides in ((1, 1, 1), (2 - 2 * GAP, 1, 2)))
    over = 0.25 + GAP
    return {
        "box": (plate, box, [at((2.4 * t - 1.2, 0.3, over + 0.5), 1.3 * t) for t in shares]),
        "disc": (plate, peg(0.5, 0.0, 0.4), [at((2.4 * t - 1.2, 0.3, over), t) for t in shares]),
        "key": (channel, key, [at((1.0, 1.8 - 1.28 * t, 1.5)) for t in shares]),
    }


@pytest.mark.parametrize("name", ["box", "disc", "key"])
def test_face_on_face_frames_are_as_queries_and_take_less(name: str) -> None:
    a, b, poses = sliding(25)[name]
    tracker = SolidTracker(a, b)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, np.array(poses[1:]))
    cold = [so.solids.distance(a, b, STILL, pose) for pose in poses[1:]]
    for answer, other in zip(answers, cold, strict=True):
        assert answer.status is other.status is so.Status.CONTINUUM
        assert answer.distance == pytest.approx(GAP, abs=1e-12)
        assert answer.lower_bound <= GAP <= answer.upper_bound
        assert answer.continuum is not None
        assert other.continuum is not None
        assert answer.continuum.kind == other.continuum.kind == "surface"
    assert answers.evaluations.sum() < sum(each.counts.evaluations for each in cold)


@pytest.mark.parametrize("name", ["box", "disc"])
def test_ties_on_the_same_faces_are_joined_in_compiled_code(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only those of different parts of the boundaries are asked for in Python, a few for each."""
    a, b, poses = sliding(31)[name]
    tracker = SolidTracker(a, b, minima=0.3)
    state = tracker.start(STILL, poses[0])
    asked, sought = list[float](), cold_query._gap_between

    def gap(*of: Any) -> float:
        asked.append(sought(*of))
        return asked[-1]

    monkeypatch.setattr(cold_query, "_gap_between", gap)
    for pose in poses[1:7]:
        asked.clear()
        state, answer = tracker.step(state, STILL, pose)
        assert len(answer.minima) == 1
        assert len(asked) <= 100


@pytest.mark.parametrize("n", [1, 2, 7, 30])
def test_sets_are_those_that_are_linked(n: int, rng: np.random.Generator) -> None:
    linked = np.tril(rng.random((n, n)) < 1.5 / n, -1)
    reach = linked | linked.T | np.eye(n, dtype=bool)
    for _ in range(n):
        reach = reach @ reach
    odd = np.arange(n) % 2 == 1

    def are_one(k: int, i: int) -> bool:
        return bool(linked[k, i])

    passes = [(lambda k: odd[:k] == odd[k], are_one), (lambda k: odd[:k] | ~odd[:k], are_one)]
    wanted = [np.flatnonzero(row).tolist() for row in np.unique(reach, axis=0)]
    assert cold_query._sets(n, passes) == sorted(wanted)


def test_a_link_along_a_valley_takes_no_more_than_queries() -> None:
    """As in ``examples/c/links.c``: a link is pulled back round the tube of another one, so that
    the least distance is nearly the same all along it."""
    link = ring(1.0, 0.2)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    poses = []
    for tick in range(140, 176):
        shift = [0.8 + 0.403 * (1.0 - np.cos(2.0 * np.pi * tick / 1000)), 0.001, 0.0]
        poses.append(so.Pose(turn, shift).matrix)
    tracker = SolidTracker(link, link)
    _, answers = tracker.run(tracker.start(STILL, poses[0]), STILL, np.array(poses[1:]))
    assert answers.certified.all()
    cold = [so.distance(link, link, STILL, pose).counts.evaluations for pose in poses[1::5]]
    assert answers.evaluations.max() < 2 * max(cold)
    assert answers.evaluations.mean() < np.mean(cold)


def test_what_may_be_due_is_listed(rng: np.random.Generator) -> None:
    """No row that is left out of a frame's list holds points as near as the nearest, and no row is
    listed twice."""
    a = bracket()
    tracker = SolidTracker(a, a)
    pose = so.Pose.exp((0.3, 0.5, -0.2), (2.0, 0.4, 0.9)).matrix
    front = tracker.start(STILL, pose).front
    assert front is not None
    frames, told, left_out = tracker.frames(front), room_for(1), 0
    for _ in range(40):
        pose = so.Pose.exp(0.01 * rng.normal(size=3), 0.01 * rng.normal(size=3)).matrix @ pose
        relative = np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]])
        frames.go(relative[None], told)
        store, keys = frames.work.store, frames.work.keys.reshape(-1, F.KEY_REALS)
        due = keys[: int(store[F.N_DUE]), F.DUE].astype(int)
        assert len(due) == len(np.unique(due))
        others = np.setdiff1d(np.arange(int(store[F.N_ROWS])), due)
        bound, shut = keys[others, 0] - store[F.GONE], keys[others, 1] - store[F.GONE]
        assert ((bound >= told[0, 1]) | (shut > 0.0)).all()
        left_out += len(others)
    assert left_out > 0


def test_making_a_state_leaves_nothing_for_the_first_contact() -> None:
    a, b = Solid(so.shapes.box((1, 1, 1))), Solid(so.shapes.box((1, 1, 1)))
    SolidTracker(a, b).start(STILL, at((3.0, 0.0, 0.0)))
    for solid in (a, b):
        assert solid.vertex_fans is not None
        assert solid.vertex_normals is not None
