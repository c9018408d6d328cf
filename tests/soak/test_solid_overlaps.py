"""The soak of solids in overlap: what it judges, and that a planted fault is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families.solid_shapes import ball, bracket
from standoff.solids import distance
from standoff.tracking.status import Status
from standoff_studies.soak.solid_overlaps import is_inside, judged, judged_motion

STILL = np.eye(4)


def test_frames_of_a_pair_are_judged() -> None:
    verdict, lines = judged_motion(0, 3, [("bolt", "plate")], 160)
    assert lines == []
    assert verdict.frames == 160
    assert verdict.sampled == 4
    assert verdict.statuses["OVERLAPPING"] > 0
    assert verdict.sound


def at(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def pressed(rng: np.random.Generator) -> tuple[object, object, np.ndarray]:
    a, b = bracket(), ball(0.3)
    near = distance(a, b, STILL, at(5.0))
    pose = at(5.0)
    pose[:3, 3] -= near.normal * (near.distance + 2e-3)
    return a, b, pose


def test_planted_faults_are_seen(rng: np.random.Generator) -> None:
    a, b, pose = pressed(rng)
    told = distance(a, b, STILL, pose, minima=0.02)
    assert told.status is Status.OVERLAPPING
    sound, lines = judged(a, b, pose, told, 0.02, rng)
    assert (sound.wrong, sound.lost, sound.besides, lines) == (0, 0, 0, [])
    assert (sound.overlaps, sound.parted) == (1, 1)
    # a depth that is more than a shift which parts them
    deeper = replace(told, upper_bound=2.0 * told.lower_bound, lower_bound=-np.inf)
    assert judged(a, b, pose, deeper, 0.02, rng)[0].wrong == 1
    apart = replace(told, status=Status.CONVERGED)
    assert judged(a, b, pose, apart, 0.02, rng)[0].wrong == 1
    missed = replace(told, minima=())
    assert judged(a, b, pose, missed, 0.02, rng)[0].lost == len(told.minima)


@pytest.mark.parametrize("shift", [0.0, 0.01])
def test_points_prove_an_overlap(rng: np.random.Generator, shift: float) -> None:
    a, b, pose = pressed(rng)
    pose = pose @ STILL
    pose[:3, 3] += shift * distance(a, b, STILL, pose, minima=0.02).normal
    told = distance(a, b, STILL, pose, minima=0.02)
    assert is_inside(a, b, pose, told, rng) is (shift == 0.0)
