"""A frame of the predictor-corrector by its parts: follow, contact, restart, and which is taken."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_frames import NOT_INTEGRATED, TOLERANCE, motion_of, options, state_at
from hand_made_pairs import Placed, X, Y, Z, ball, box, ellipsoid, unit, vector

from standoff.kernels.depth.descent import descend
from standoff.kernels.depth.penetration import begin_along
from standoff.kernels.frame.apart import apart, contact, follow, track_predicted
from standoff.kernels.pair.certified import CERTIFIED, PENETRATING, STAYED, UNCERTIFIED
from standoff.kernels.pair.events import (
    CORRECTIONS,
    EVALUATIONS,
    KEEPING,
    KEPT,
    LIMIT,
    RESTARTS,
    SEARCHES,
)
from standoff.kernels.state.arrays import (
    DEPTH_LOCAL,
    PREDICT_FEEDFORWARD,
    PREDICT_NONE,
)
from standoff.kernels.state.tracked import ANSWERED, TRY_CONTACT, TRY_RESTART
from standoff.kernels.tolerances import CUT_TURN
from standoff.kernels.values import Depth

H = 0.01
RADIUS, OTHER = 1.0, 0.7
BALLS = Placed(ball(RADIUS), ball(OTHER), (0.0, 0.0, 2.0))
FREE, LOCAL = options(), options(depth=DEPTH_LOCAL)
ALONE = options(restarts=False)


def over(angle, distance=2.0):
    """The balls, the second at an angle from z about y."""
    return BALLS.at(distance * math.sin(angle), 0.0, distance * math.cos(angle))


def nearest(case):
    n = np.array(unit(*case.p))
    return case.place(RADIUS * n, -OTHER * n)


def before_of(case, **known):
    """The state of a frame that was solved at the pair's own pose."""
    n = unit(*case.p)
    gap = float(np.linalg.norm(case.p)) - RADIUS - OTHER
    told = {"motion": motion_of(case.pose), "normal": n, "distance": gap, "lower": gap - 1e-13}
    return state_at(nearest(case), **(told | known))


def turning(case, rate):
    """B goes round A at a rate (rad/s) about y, without turning itself."""
    return motion_of(case.pose, np.cross((0.0, rate, 0.0), case.p))


def assert_answer(case, found, gap, accuracy=1e-12):
    assert found.distance == pytest.approx(gap, abs=accuracy)
    assert found.lower <= found.distance
    np.testing.assert_allclose(case.gap(found.place), gap * np.array(unit(*case.p)), atol=1e-6)


def test_one_correction_follows_a_small_step():
    """By 2 mrad: the error of one Newton step is of the third order or less."""
    work = new_work()
    case = over(0.002)
    done, stay = follow(case.pair, turning(case, 0.2), before_of(over(0.0)), FREE, H, work)
    assert stay
    assert done.found.outcome == CERTIFIED
    assert_answer(case, done.found, 0.3)
    assert work.counts[CORRECTIONS] == 1
    assert done.fresh


def test_the_feedforward_predicts_the_turn():
    """The rates of the frame before bring the place to within the second order of the turn."""
    case, start = over(0.002), before_of(over(0.0))
    work = new_work()
    held, _ = follow(case.pair, turning(case, 0.2), start, FREE, H, work)
    rates = held.rates
    told = start._replace(rates=rates, history=1, fed=True)
    errors = {}
    for predictor in (PREDICT_NONE, PREDICT_FEEDFORWARD):
        work = new_work()
        work.counts[LIMIT] = 0  # the prediction alone
        law = options(predictor)
        done, _ = follow(case.pair, turning(case, 0.2), told, law, H, work)
        x_a = case.points(done.found.place)[0]
        errors[predictor] = np.linalg.norm(x_a - RADIUS * np.array(unit(*case.p)))
    assert errors[PREDICT_NONE] == pytest.approx(0.002, rel=1e-3)
    assert errors[PREDICT_FEEDFORWARD] < 1e-5


def test_points_that_pass_each_other_are_not_followed():
    """Near contact B's point has come behind A's along the last normal."""
    close = over(0.0, 1.71)
    through = close.at(0.0, 0.0, 1.69)
    work = new_work()
    done, stay = follow(through.pair, motion_of(through.pose), before_of(close), FREE, H, work)
    assert not stay
    assert done.found.outcome == UNCERTIFIED
    assert work.counts[EVALUATIONS] == 0
    # far from contact it is not asked: points may be behind each other on other features
    far = before_of(close, distance=1.0)
    assert follow(through.pair, motion_of(through.pose), far, FREE, H, work)[1]


def test_a_certified_step_is_the_answer():
    case = over(0.002)
    then, tracked = apart(case.pair, turning(case, 0.2), before_of(over(0.0)), FREE, H, new_work())
    assert then == ANSWERED
    assert tracked.shown.found.outcome == CERTIFIED
    assert (tracked.shown.inside, tracked.shown.fresh) == (False, True)
    assert_answer(case, tracked.shown.found, 0.3)
    np.testing.assert_allclose(
        tracked.shown.jets[0][0], case.points(tracked.shown.found.place)[0], atol=1e-15
    )


def test_very_near_contact_the_answer_is_polished():
    """1e-9 apart the direction between the points is lost; the polish gives it back."""
    spent = {}
    for gap in (1e-9, 1e-2):
        case = over(1e-6, 1.7 + gap)
        work = new_work()
        before = before_of(over(0.0, 1.7 + gap))
        then, tracked = apart(case.pair, turning(case, 1e-4), before, FREE, H, work)
        assert then == ANSWERED
        spent[gap] = int(work.counts[EVALUATIONS])
        if gap > 1e-3:
            break
        found = tracked.shown.found
    assert spent[1e-2] == 1
    assert spent[1e-9] > 1
    case = over(1e-6, 1.7 + 1e-9)
    assert found.distance == pytest.approx(1e-9, abs=2e-15)
    assert found.normal == pytest.approx(unit(*case.p), abs=1e-12)


def test_what_is_not_certified_is_tried_in_contact_near_it_and_by_a_restart_elsewhere():
    """Both points on the far sides of the balls: stationary, no minimum."""
    case = over(0.0)
    far = case.place((0.0, 0.0, -RADIUS), (0.0, 0.0, OTHER))
    for distance, expected in ((1.0, TRY_RESTART), (1e-3, TRY_CONTACT)):
        before = before_of(case)._replace(place=far, distance=distance)
        then, tracked = apart(case.pair, motion_of(case.pose), before, FREE, H, new_work())
        assert then == expected
        assert tracked.shown.found.outcome == UNCERTIFIED
    overlapping = over(0.0, 1.5)
    before = before_of(over(0.0, 1.71))
    then, _ = apart(overlapping.pair, motion_of(overlapping.pose), before, FREE, H, new_work())
    assert then == TRY_CONTACT


def test_a_frame_cut_off_apart_answers_with_what_it_has():
    case = over(0.1)
    work = new_work()
    work.counts[LIMIT] = 0
    law = options(PREDICT_NONE)
    then, tracked = apart(case.pair, turning(case, 0.2), before_of(over(0.0)), law, H, work)
    assert then == ANSWERED
    found = tracked.shown.found
    assert found.outcome == UNCERTIFIED
    assert not tracked.shown.inside
    assert found.lower <= 0.3 < found.distance
    assert found.place == nearest(over(0.0))


BOXES = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (0.9, 0.5, -0.3))
"""0.4 deep along x, 0.8 along -z."""


def minimum(case, n):
    start = Depth(False, math.nan, n, begin_along(*case.both, n))
    found = descend(*case.both, start, TOLERANCE, new_work())
    assert found.found
    return found


def inside_of(case, n, **known):
    """The state of a frame that was solved in contact."""
    at = minimum(case, n)
    told = {"motion": motion_of(case.pose), "normal": at.normal, "distance": at.distance}
    return state_at(at.place, **(told | {"inside": True} | known))


def test_in_contact_the_least_depth_is_followed_and_proven():
    case = BOXES.at(0.901, 0.501, -0.3)
    work = new_work()
    then, tracked = contact(*case.both, inside_of(BOXES, X), FREE, work)
    assert then == ANSWERED
    found = tracked.shown.found
    assert tracked.shown.inside
    assert found.outcome == PENETRATING
    assert found.distance == pytest.approx(-0.399, abs=1e-12)
    assert found.upper == pytest.approx(-0.399, abs=1e-12)
    assert (work.counts[KEEPING], work.counts[KEPT], work.counts[SEARCHES]) == (1, 1, 1)


def test_the_local_depth_stays_and_keeps_no_polytope():
    down = (0.0, 0.0, -1.0)
    before = inside_of(BOXES, down)
    for law, n, keeping in ((LOCAL, down, 0), (FREE, X, 1)):
        work = new_work()
        _, tracked = contact(*BOXES.both, before, law, work)
        assert tracked.shown.found.normal == pytest.approx(n, abs=1e-12)
        assert work.counts[KEEPING] == keeping
    work = new_work()
    contact(*BOXES.both, before._replace(inside=False), FREE, work)
    assert work.counts[KEEPING] == 0


@pytest.mark.parametrize("cut", [0, CUT_TURN, 2 * CUT_TURN])
def test_frames_that_are_cut_off_take_turns_between_both_methods(cut):
    """From a near start Newton's method takes fewer evaluations than the descent."""
    case = Placed(ellipsoid(1.0, 0.8, 0.6), ball(0.5), (0.3, 0.2, 0.9))
    before = inside_of(case.at(0.35, 0.15, 0.9), Z, cut=cut)
    work = new_work()
    _, tracked = contact(*case.both, before, LOCAL, work)
    assert case.rises_around(tracked.shown.found.normal)
    spent = int(work.counts[EVALUATIONS])
    newton = new_work()
    contact(*case.both, before._replace(cut=0), LOCAL, newton)
    same = spent == newton.counts[EVALUATIONS]
    assert same == (cut != CUT_TURN)


def test_a_pair_that_has_come_apart_leaves_contact():
    gap = 1e-3
    case = BOXES.at(1.3 + gap, 0.5, -0.3)
    before = inside_of(BOXES.at(1.29, 0.5, -0.3), X)
    then, tracked = contact(*case.both, before, FREE, new_work())
    assert then == ANSWERED
    assert not tracked.shown.inside
    assert tracked.shown.found.outcome == CERTIFIED
    assert tracked.shown.found.distance == pytest.approx(gap, abs=1e-12)


def track(case, before, law=FREE, work=None, motion=None):
    work = work or new_work()
    motion = motion or motion_of(case.pose)
    tracked = track_predicted(case.pair, motion, before, law, H, work)
    assert tracked.integrated == NOT_INTEGRATED
    return tracked.shown, work


def test_apart_the_law_answers_without_a_restart():
    case = over(0.002)
    shown, work = track(case, before_of(over(0.0)), motion=turning(case, 0.2))
    assert_answer(case, shown.found, 0.3)
    assert (work.counts[RESTARTS], shown.inside) == (0, False)


def test_a_frame_that_was_lost_starts_anew():
    case = over(0.002)
    shown, work = track(case, before_of(over(0.0), lost=True))
    assert_answer(case, shown.found, 0.3)
    assert work.counts[RESTARTS] >= 1
    assert not shown.fresh
    # so does one whose points are on far sides, and one whose bodies have jumped
    far = case.place((0.0, 0.0, -RADIUS), (0.0, 0.0, OTHER))
    for before in (before_of(over(0.0))._replace(place=far), before_of(over(3.0))):
        shown, work = track(case, before)
        assert_answer(case, shown.found, 0.3)


def test_into_contact_and_out_of_it_there_is_no_restart():
    """A drop by 0.02 over z: the points pass each other, the depth is 0.01; then back."""
    close, deep = over(0.0, 1.71), over(0.0, 1.69)
    shown, work = track(deep, before_of(close))
    assert shown.inside
    assert shown.found.outcome == PENETRATING
    assert shown.found.distance == pytest.approx(-0.01, abs=1e-12)
    assert work.counts[RESTARTS] == 0
    shown, work = track(close, inside_of(deep, Z))
    assert not shown.inside
    assert shown.found.outcome == CERTIFIED
    assert shown.found.distance == pytest.approx(0.01, abs=1e-12)
    assert work.counts[RESTARTS] == 0


def test_frames_cut_off_for_long_start_anew_by_turns():
    """With 10 evaluations a frame a start is due after every fifth that was cut off."""
    case = over(0.5)
    for cut, started in ((4, 0), (5, 1), (6, 0), (10, 1)):
        work = new_work()
        work.counts[LIMIT] = 10
        shown, _ = track(case, before_of(case, cut=cut), work=work)
        assert_answer(case, shown.found, 0.3)
        assert (work.counts[RESTARTS] > 0) == bool(started)


@pytest.mark.parametrize("limit", [0, 1, 2])
def test_a_deadline_is_kept_in_every_kind_of_frame(limit):
    frames = [
        (over(0.4), before_of(over(0.0))),
        (BOXES, inside_of(BOXES, Y)),
        (over(0.4), before_of(over(0.0), lost=True)),
        (over(0.4, 1.5), before_of(over(0.0, 1.71))),
    ]
    for case, before in frames:
        work = new_work()
        work.counts[LIMIT] = limit
        shown, _ = track(case, before, work=work)
        assert work.counts[EVALUATIONS] <= limit + 1
        true = -case.least_depth()
        assert shown.found.lower <= true + 1e-12
        assert shown.found.upper >= true - 1e-12


def test_a_least_depth_from_the_wrong_side_is_found_by_the_global_depth():
    before = inside_of(BOXES, Y)
    assert before.distance == pytest.approx(-0.7, abs=1e-12)
    shown, _ = track(BOXES, before)
    assert shown.found.normal == pytest.approx(X, abs=1e-12)
    shown, _ = track(BOXES, before, LOCAL)
    assert vector(shown.found.normal) == pytest.approx(Y, abs=1e-12)


def test_alone_a_lesser_depth_is_told_and_not_gone_to():
    """0.7 deep along y where it is followed, 0.4 along x."""
    before, work = inside_of(BOXES, Y), new_work()
    shown, _ = track(BOXES, before, ALONE, work)
    found = shown.found
    assert found.outcome == STAYED
    assert found.normal == pytest.approx(Y, abs=1e-12)
    assert (found.distance, found.upper) == pytest.approx((-0.7, -0.4), abs=1e-12)
    assert found.lower <= -0.7
    assert (shown.inside, work.counts[RESTARTS], work.counts[KEPT]) == (True, 0, 1)
    # the least is proven; of another no proof is asked
    assert track(BOXES, inside_of(BOXES, X), ALONE)[0].found.outcome == PENETRATING
    unasked = options(depth=DEPTH_LOCAL, restarts=False)
    shown, _ = track(BOXES, before, unasked)
    assert shown.found.outcome == PENETRATING
    assert shown.found.distance == pytest.approx(-0.7, abs=1e-12)


def test_alone_a_depth_without_overlap_is_no_penetration():
    """B has gone through A: still a local minimum along y, and 0.1 apart along -y."""
    case = BOXES.at(0.5, -1.3, -0.3)
    for law in (ALONE, options(depth=DEPTH_LOCAL, restarts=False)):
        found = track(case, inside_of(BOXES, Y), law)[0].found
        assert found.outcome == STAYED
        assert found.normal == pytest.approx(Y, abs=1e-12)
        assert found.lower <= -2.5 + 1e-12
        assert found.upper >= 0.1
    # where its own local minimum leads out of contact, it is followed there
    case = BOXES.at(1.4, 0.5, -0.3)
    found = track(case, inside_of(BOXES, Y), ALONE)[0].found
    assert found.outcome == CERTIFIED
    assert found.distance == pytest.approx(0.1, abs=1e-12)


def test_alone_the_law_and_its_way_into_contact_are_as_ever():
    close, deep = over(0.0, 1.71), over(0.0, 1.69)
    ways = [
        (over(0.002), before_of(over(0.0))),
        (deep, before_of(close)),
        (close, inside_of(deep, Z)),
        (BOXES.at(0.901, 0.501, -0.3), inside_of(BOXES, X)),
    ]
    for case, before in ways:
        (shown, work), (other, due) = track(case, before, ALONE), track(case, before)
        assert shown.found == other.found
        assert work.counts[EVALUATIONS] == due.counts[EVALUATIONS]


def test_alone_no_frame_starts_anew():
    """Lost, on far sides, after a jump: the last place alone leads on, or it is told."""
    case = over(0.002)
    far = case.place((0.0, 0.0, -RADIUS), (0.0, 0.0, OTHER))
    starts = [
        before_of(over(0.0), lost=True),
        before_of(over(0.0))._replace(place=far),
        before_of(over(3.0)),
        before_of(over(0.0), cut=5),
    ]
    for before in starts:
        work = new_work()
        found = track(case, before, ALONE, work)[0].found
        assert work.counts[RESTARTS] == 0
        assert found.lower <= 0.3 + 1e-12
        assert found.outcome in (CERTIFIED, STAYED)
        assert found.upper >= 0.3 - 1e-12
