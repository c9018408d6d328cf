"""The soak of bodies in hollow corners: what it judges, and that a planted fault is seen."""

from __future__ import annotations

import numpy as np
import pytest

from standoff.motion import Pose
from standoff.simulation import ContactSpot, SolidContact
from standoff_studies.soak import solid_corners
from standoff_studies.soak.solid_corners import BLOCK, CASES, DEPTH, STRETCH, judged_press, samples


@pytest.mark.parametrize("block", range(len(CASES)))
def test_a_press_is_judged(block: int) -> None:
    verdict, lines = judged_press(block, 1, 240)
    assert lines == []
    assert verdict.sound
    assert verdict.ticks == 240
    assert verdict.sampled == 240 // STRETCH
    assert verdict.overlaps > 0
    assert "0 wrong" in str(verdict)


@pytest.mark.soak
@pytest.mark.parametrize("block", [2, 7, 13, 25])
def test_presses_that_once_fell_through(block: int) -> None:
    """A drum in its hole, a tube on its shaft, drums in a channel: rims past hollow rims, and bores
    round what is in them, whose normals rested."""
    verdict, lines = judged_press(block, 1, BLOCK)
    assert lines == []
    assert verdict.ticks == BLOCK


def spot(depth: float) -> ContactSpot:
    return ContactSpot(np.zeros(3), np.array([0.0, 0.0, 1.0]), depth, 1.0)


def test_planted_faults_are_seen() -> None:
    pushed = SolidContact((), (spot(DEPTH),), True)
    assert solid_corners.faults_of(pushed, DEPTH) == []
    assert len(solid_corners.faults_of(pushed, 3.0 * DEPTH)) == 1
    assert len(solid_corners.faults_of(pushed._replace(spots=()), DEPTH)) == 1
    assert solid_corners.faults_of(pushed._replace(spots=(), complete=False), DEPTH) == []
    assert (
        len(solid_corners.faults_of(SolidContact((), (spot(9.0 * DEPTH),), True), 9.0 * DEPTH)) == 1
    )


def test_how_deep_is_seen(rng: np.random.Generator) -> None:
    """Moved into the corner by some, a body has a point as deep, by closed forms alone."""
    for make in CASES:
        case = make(rng)
        spots = samples(case.fixed.truth), samples(case.pressed.truth)
        still = Pose(np.eye(3), np.zeros(3))
        for out in (0.01, -0.003):
            moved = Pose(case.fits.rotation, case.fits.translation + out * case.out)
            deep = solid_corners.deepest(case, spots, still, moved)
            if out > 0.0:
                assert deep < 1e-9
            else:
                assert 1e-3 < deep < 4e-3
