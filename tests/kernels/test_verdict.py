"""The status of an answer, on bounds made by hand."""

import numpy as np
import pytest
from hand_made_frames import flat, inputs

import standoff as so
from standoff.kernels.frame.answer import judge, write_answer
from standoff.kernels.pair.certified import (
    CERTIFIED,
    OVERLAP,
    PENETRATING,
    TOUCHING_OR_OVERLAPPING,
    UNCERTIFIED,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.state.arrays import (
    DISTANCE,
    LOWER_BOUND,
    N_OUT,
    NOT_CERTIFIED,
    OVERLAPPING,
    STATUS,
    UPPER_BOUND,
)
from standoff.kernels.state.tracked import Shown
from standoff.kernels.values import NO_RATES, ORIGIN, Found, Pair, Place, Pose, resting
from standoff.tracking import Status

BOX, BALL = so.shapes.box(1.0, 1.0, 1.0), so.shapes.sphere(0.5)
SHIFT = (3.0, 0.0, 0.0)
PLACE = Place(*[np.int64(0)] * 4, 0.0, 0.0, 0.0, 0.0)
TOLERANCE = 1e-10


def status(
    outcome: int,
    distance: float,
    lower: float,
    upper: float,
    *,
    other: so.Body = BOX,
    lenient: bool = False,
    tolerance: float = TOLERANCE,
    cut: bool = False,
) -> Status:
    """The verdict on lengths of the cores: those of BALL's is a point, 0.5 inside its surface."""
    pair = Pair(BOX.ints, BOX.reals, other.ints, other.reals)
    found = Found(outcome, PLACE, distance, lower, upper, (1.0, 0.0, 0.0))
    return Status(judge(pair, SHIFT, found, lenient, tolerance, cut))


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ((CERTIFIED, 2.0, 2.0 - 1e-12, 2.0), Status.CONVERGED),
        # a gap of 1e-6 is none of 1e-10 spans
        ((UNCERTIFIED, 2.0, 2.0 - 1e-6, 2.0), Status.NOT_CERTIFIED),
        ((UNCERTIFIED, 2.0, -1.0, 2.0), Status.NOT_CERTIFIED),
        # the least depth is 0.3 when no point shows less; else only the local one
        ((PENETRATING, -0.3, -0.3, -0.3), Status.GLOBAL),
        ((PENETRATING, -0.3, -0.3, -0.1), Status.LOCAL),
        ((TOUCHING_OR_OVERLAPPING, 0.0, -1e-15, 0.0), Status.GLOBAL),
        ((TOUCHING_OR_OVERLAPPING, 0.0, -1.0, 0.0), Status.NOT_CERTIFIED),
        ((OVERLAP, 0.3, -1.0, 0.3), Status.OVERLAPPING),
        ((OVERLAP, -0.3, -0.4, 0.3), Status.OVERLAPPING),
        # a depth within the tolerance says more
        ((OVERLAP, -0.3, -0.3, -0.3), Status.GLOBAL),
    ],
)
def test_the_status_follows_the_bounds(given, expected):
    assert status(*given) is expected


def test_a_swept_radius_makes_an_overlap_of_a_positive_distance_of_cores():
    close = (CERTIFIED, 0.4, 0.4 - 1e-12, 0.4)
    assert status(*close) is Status.CONVERGED
    assert status(*close, other=BALL) is Status.GLOBAL
    assert status(CERTIFIED, 0.6, 0.6 - 1e-12, 0.6, other=BALL) is Status.CONVERGED


def test_a_law_that_still_converges_is_tracking():
    wide = (UNCERTIFIED, 2.0, 1.0, 2.0)
    assert status(*wide) is Status.NOT_CERTIFIED
    assert status(*wide, lenient=True) is Status.TRACKING
    assert status(*wide, tolerance=np.inf) is Status.TRACKING
    assert status(OVERLAP, 2.0, -1.0, 2.0, lenient=True) is Status.TRACKING


def test_a_deadline_is_told_only_where_the_answer_is_not_certified():
    assert status(UNCERTIFIED, 2.0, 1.0, 2.0, cut=True) is Status.DEADLINE
    assert status(CERTIFIED, 2.0, 2.0 - 1e-12, 2.0, cut=True) is Status.CONVERGED
    assert status(TOUCHING_OR_OVERLAPPING, 0.0, -1.0, 0.0, cut=True) is Status.DEADLINE
    assert status(TOUCHING_OR_OVERLAPPING, 0.0, -1e-15, 0.0, cut=True) is Status.GLOBAL
    # proven before the evaluations ran out
    assert status(OVERLAP, 0.3, -1.0, 0.3, cut=True) is Status.OVERLAPPING


@pytest.mark.parametrize(("distance", "upper"), [(0.3, 0.3), (-0.2, 0.1), (-0.2, -0.1)])
@pytest.mark.parametrize("named", [OVERLAPPING, NOT_CERTIFIED])
def test_of_an_overlap_no_bound_is_above_0(distance, upper, named):
    """What the points found are apart by, which overlap all the same, is no distance."""
    pair = Pair(BOX.ints, BOX.reals, BOX.ints, BOX.reals)
    home = flat(np.eye(3).ravel(), ORIGIN)
    given = inputs(home, home, np.zeros(6), np.zeros(6), False)
    pose = Pose(tuple(home[:9]), ORIGIN)
    found = Found(OVERLAP, PLACE, distance, -0.5, upper, (1.0, 0.0, 0.0))
    shown = Shown(found, pair_jets(pair, pose, PLACE), False, False, NO_RATES)
    out = np.full(N_OUT, np.nan)
    write_answer(pair, given, resting(pose), shown, ORIGIN, named, out)
    most = 0.0 if named == OVERLAPPING else np.inf
    assert out[DISTANCE] == min(distance, most)
    assert out[UPPER_BOUND] == min(upper, most)
    assert (out[LOWER_BOUND], out[STATUS]) == (-0.5, named)
