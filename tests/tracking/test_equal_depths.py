"""Overlaps that are as thin along several normals: by symmetry, and made unequal by a shift."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from draws import draws
from standoff.geometry import ConicArc
from standoff.kernels.pair.polytope_layout import N_VERTICES
from standoff.kernels.state import arrays as K
from standoff.tracking.block import FrameBlock
from standoff.tracking.derivatives import Smoothness
from tracking.made_answers import random_pose

s = so.shapes
EYE = np.eye(3)
BOTH = [EYE[0], -EYE[0]]
ALL = [*EYE, *-EYE]
ALONG = 1e-7
"""Radians that a normal may be off; those of faces are exact."""

# a, b, where b is in a, the normals, and a shift of b by which one of them becomes the only one
CASES = {
    "ellipsoid in ellipsoid": (
        s.ellipsoid(1, 2, 3),
        s.ellipsoid(0.5, 0.6, 0.7),
        (0, 0, 0),
        BOTH,
        (1e-6, 0, 0),
    ),
    "cube in cube": (s.box(2, 2, 2), s.box(1, 1, 1), (0, 0, 0), ALL, (1e-6, 2e-7, 0)),
    "two faces": (
        s.box(2, 2, 2),
        s.box(2, 2, 2),
        (1.9, 1.9, 0),
        [EYE[0], EYE[1]],
        (1e-6, 0, 0),
    ),
    "capsule in slab": (
        s.box(1, 4, 4),
        s.capsule(0.1, 0.5),
        (0, 0, 0),
        BOTH,
        (-1e-6, 0, 0),
    ),
    "superellipsoid in itself": (
        s.superellipsoid(0.5, 1, 1, 0.7, 0.7),
        s.superellipsoid(0.5, 1, 1, 0.7, 0.7),
        (0, 0, 0),
        BOTH,
        (1e-6, 0, 0),
    ),
    "ball beside the middle": (
        s.ellipsoid(1, 2, 3),
        s.sphere(0.4),
        (0.1, 0, 0),
        [EYE[0]],
        (0, 0, 0),
    ),
}


def ask(case, shift, rng):
    a, b, place, _, _ = CASES[case]
    world = random_pose(rng, 2.0)
    at = world @ so.Pose.exp([0, 0, 0], np.add(place, shift))
    answer = so.distance(a, b, world, at)
    assert answer.status is so.Status.GLOBAL
    return answer, so.witness_set(answer).normals @ world.rotation


@pytest.mark.parametrize("case", CASES)
def test_all_normals_are_found(case, rng):
    answer, found = ask(case, (0, 0, 0), rng)
    expected = CASES[case][3]
    assert len(found) == len(expected)
    for n in expected:
        assert np.linalg.norm(found - n, axis=1).min() <= ALONG
    assert np.array_equal(answer.witness_set().normal, answer.normal)
    assert answer.unique == (len(expected) == 1 and answer.witness_set().dimension == 0)


@pytest.mark.parametrize("case", CASES)
def test_a_shift_leaves_one(case, rng):
    _, found = ask(case, CASES[case][4], rng)
    assert len(found) == 1


def test_planar():
    oval = s.planar_loop([ConicArc((0, 0), (0.5, 0), (0, 0.9))])
    turned = so.Pose.exp([0, 0, 0.4], [0.3, -0.2, 0])
    found = so.distance(oval, oval, turned, turned).witness_set()
    across = turned.rotation[:, 0]
    assert len(found.normals) == 2
    for n in (across, -across):
        assert np.linalg.norm(found.normals - n, axis=1).min() <= ALONG


def test_apart_there_is_one():
    answer = so.distance(
        s.box(2, 2, 2), s.sphere(1), so.Pose.identity(), so.Pose.exp([0, 0, 0], [3, 0, 0])
    )
    assert answer.unique
    assert np.array_equal(answer.witness_set().normals, [answer.normal])


TIES = {
    "slabs": (s.box(1, 1, 0.2), s.box(1, 1, 0.2), 1),
    "slab in cube": (s.box(1, 1, 1), s.box(1, 1, 0.2), 1),
    "ball in cube": (s.box(1, 1, 1), s.ellipsoid(0.4, 0.4, 0.4), 0),
    "eggs": (s.ellipsoid(1, 2, 3), s.ellipsoid(0.5, 0.6, 0.7), 0),
}


def derived_after_a_frame(tie, shift, rng):
    """Of the last of some frames with a tie at their end, and of the same without a polytope."""
    a, b, axis = TIES[tie]
    world = random_pose(rng, 2.0)
    step = rng.uniform(-1e-3, 1e-3, size=(2, 3))
    tracker = so.Tracker(a, b, 1e-3)
    ways = [so.Pose.exp(*(k * step)) @ so.Pose.exp([0, 0, 0], shift * EYE[axis]) for k in range(4)]
    state = tracker.start(world, world @ ways[-1])
    for way in ways[-2::-1]:
        state, answer = tracker.step(state, world, world @ way)
    block = FrameBlock(answer._out)
    assert block.polytope[N_VERTICES] > 0.0
    bare = block.data[: int(block.data[K.BLOCK_POLYTOPE])].copy()
    bare[K.BLOCK_POLYTOPE] = 0.0
    return answer.derivatives(), so.Proximity(a, b, bare).derivatives()


@pytest.mark.parametrize("tie", TIES)
def test_derivatives_tell_ties_with_the_polytope_of_their_frame_and_without(tie, rng):
    for shift in (0.0, 1e-13, 1e-12, 1e-8, 1e-6, 1e-4):
        for _ in range(draws(3)):
            by_kept, anew = derived_after_a_frame(tie, shift, rng)
            assert by_kept.smoothness is anew.smoothness
            np.testing.assert_array_equal(by_kept.gradient, anew.gradient)
            if shift <= 1e-12:
                assert by_kept.smoothness is Smoothness.UNDEFINED
