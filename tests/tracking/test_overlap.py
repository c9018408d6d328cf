"""Overlapping pairs: the depth is achieved, and proven the least, however deep or shallow."""

import numpy as np
import pytest

import standoff as so
from draws import draws
from families.overlaps import PAIRS, draw_overlapping
from oracles.bounds import separation

POSES = draws(300)
SHARE = 6
"""Each kind of pair gets a sixth of the poses; planar loops, whose oracle is slow, half of that."""
SHOWN = 5
"""Failures printed of each kind."""


@pytest.mark.parametrize("kind", PAIRS)
def test_an_overlapping_pair_has_a_proven_depth(kind, rng):
    seed = int(rng.integers(1 << 31))
    count = POSES // (2 * SHARE if "planar" in kind else SHARE)
    failures, asked = [], 0
    for pair in draw_overlapping(kind, count, np.random.default_rng(seed)):
        poses = [(placed.rotation, placed.position) for placed in (pair.placed_a, pair.placed_b)]
        found = so.distance(pair.a.body, pair.b.body, *poses)
        if found.certified and separation(pair.placed_a, pair.placed_b, found.normal) > 0:
            continue  # the oracle took a very thin pair for overlapping: its supports disprove it
        asked += 1
        size = pair.a.body.size + pair.b.body.size
        achieved = separation(pair.placed_a, pair.placed_b, found.normal)
        if (
            found.status is not so.Status.GLOBAL
            or abs(achieved - found.distance) > 1e-9 * size
            or found.distance > 1e-12 * size
        ):
            failures.append(f"{pair.a.body}, {pair.b.body}, {pair.label}, {poses}: {found!r}")
    first = "\n".join(failures[:SHOWN])
    assert not failures, f"seed {seed}: {len(failures)} of {asked} without a proven depth:\n{first}"
    assert asked >= 0.95 * count


@pytest.mark.parametrize("share", [1.0, 0.3, 0.0, -0.3])
def test_from_apart_into_overlap_and_out_again(share):
    """A tracker follows the cold answers through contact, and out again."""
    a, b = so.shapes.lens(1.0, 0.45), so.shapes.ellipsoid(0.3, 0.5, 0.2)
    tracker = so.Tracker(a, b)
    home = so.Pose.identity()
    state = tracker.start(home, so.Pose(np.eye(3), (2.0, 0.1, share)))
    assert state.proximity.certified
    seen = []
    for x in np.linspace(2.0, -2.0, 81):
        pose = so.Pose(np.eye(3), (x, 0.1, share))
        state, answer = tracker.step(state, home, pose)
        cold = so.distance(a, b, home, pose)
        assert answer.status is cold.status
        seen.append(answer.status)
        assert answer.distance == pytest.approx(cold.distance, abs=1e-10)
    assert so.Status.GLOBAL in seen
    assert seen[-1] is so.Status.CONVERGED
