"""Overlaps that are as thin along several normals: by symmetry, and made unequal by a shift."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff.geometry import ConicArc
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
