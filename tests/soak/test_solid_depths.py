"""Bounds of the depth of solids that overlap: some poses of pairs of the soak, and its judge."""

from dataclasses import replace

import numpy as np
import pytest

from shares import only
from standoff.solids import SolidProximity, distance
from standoff.tracking.status import Status
from standoff_studies.soak import solid_depths as D

BLOCKS = range(len(D.PAIRS))


@pytest.mark.parametrize("number", only((0, 3, 5, 8, 11, 14, 18, 20), BLOCKS))
def test_the_bounds_of_a_depth_are_sound(number: int) -> None:
    slow = {"most", "one"} & set(getattr(D.PAIRS[number], "keywords", {}))
    poses = 1 if slow else 6
    verdict, lines = D.judge_block(number, 2, poses)
    assert not lines
    assert verdict.poses == poses
    if verdict.shares:
        assert np.median(verdict.shares) > 0.6
        assert np.median(verdict.ways) < 1.1


def deeper(told: SolidProximity) -> SolidProximity:
    assert told.overlap is not None
    return replace(told, overlap=told.overlap._replace(depth=1.001 * told.overlap.most))


def nearer(told: SolidProximity) -> SolidProximity:
    assert told.overlap is not None
    assert told.overlap.parting is not None
    way = told.overlap.parting
    return replace(told, overlap=told.overlap._replace(parting=0.99 * way))


BREAKS = {
    "parts": (2, deeper),
    "none shorter": (2, nearer),
    "shorter than": (8, deeper),
    "does not part": (8, nearer),
    "of solids that overlap": (2, lambda told: replace(told, status=Status.WITHIN)),
    "bounds": (2, lambda told: replace(told, lower_bound=-np.inf)),
    "off its bounds": (2, lambda told: replace(told, distance=0.5 * told.upper_bound)),
}


@pytest.mark.parametrize("fault", BREAKS)
def test_the_judge_notices_a_wrong_bound(fault: str) -> None:
    number, change = BREAKS[fault]
    rng = np.random.default_rng([3, number])
    drawn, inner = D.PAIRS[number](rng), np.eye(4)
    inner[:3, :3], inner[:3, 3] = drawn.turn, drawn.shift
    told = distance(drawn.a, drawn.b, np.eye(4), inner)
    assert not D.judged(drawn, told, rng, np.eye(4))
    assert fault in "; ".join(D.judged(drawn, change(told), rng, np.eye(4)))


def test_the_least_way_out_of_boxes_is_that_of_their_sum() -> None:
    one, two = np.array([[[0.0, 0, 0], [10, 10, 10]]]), np.array([[[0.0, 0, 0], [4, 4, 4]]])
    for shift, least in (((3, 3, 0), 4.0), ((3, 3, -2), 2.0), ((2, 3, 3), 6.0), ((11, 0, 0), 0.0)):
        assert D.least_of_boxes(one, two + np.array(shift, dtype=float)) == least
