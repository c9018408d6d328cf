"""What a frame keeps and predicts: exact for linear motion, none where a feature has changed."""

import numpy as np
import pytest
from hand_made import BOX, EDGE, TOP, beside, new_work, on_edge, on_top, place_of
from hand_made_frames import motion_of, state_at
from hand_made_pairs import Placed, ball, box, on_atlas, packed, unit

import standoff as so
from standoff.kernels.body.features import feature_jet
from standoff.kernels.frame.prediction import (
    apply_step,
    carry_over,
    feeds,
    in_chart,
    kept_state,
    next_state,
    predict,
    secant,
)
from standoff.kernels.pair.certified import CERTIFIED
from standoff.kernels.pair.events import CHART_CHANGES, EVENTS
from standoff.kernels.state.arrays import (
    CONVERGED,
    DEADLINE,
    GLOBAL,
    NOT_CERTIFIED,
    NOT_RESTARTED,
    OVERLAPPING,
    PREDICT_FEEDFORWARD,
    PREDICT_FEEDFORWARD_2,
    PREDICT_NONE,
    PREDICT_SECANT,
)
from standoff.kernels.state.state import Integrated
from standoff.kernels.state.tracked import Shown, Tracked, begun, errors_at, without_rates
from standoff.kernels.values import NO_RATES, Found, Side, moved

RATES, LAST = (1.0, -2.0, 3.0, 0.5), (0.5, 1.0, -1.0, 0.0)
ABOVE = (0.3, -0.2, 3.0)
PAIR, POSE = beside(ABOVE)
PLACE = place_of(on_top(0.3, -0.2))


def test_without_a_history_or_a_predictor_nothing_is_predicted():
    known = state_at(PLACE, rates=RATES)
    assert predict(known, PREDICT_FEEDFORWARD, 0.1) == NO_RATES
    assert predict(known._replace(history=2), PREDICT_NONE, 0.1) == NO_RATES


@pytest.mark.parametrize("predictor", [PREDICT_SECANT, PREDICT_FEEDFORWARD])
@pytest.mark.parametrize("history", [1, 2])
def test_a_prediction_is_the_rates_times_the_time(predictor, history):
    known = state_at(PLACE, rates=RATES, last_rates=LAST, last_step=0.2, history=history)
    expected = tuple(0.1 * w for w in RATES)
    assert predict(known, predictor, 0.1) == pytest.approx(expected, abs=1e-16)


def test_two_rates_predict_what_changes_linearly():
    """q(t) = q0 + w t + c t² / 2, with frames at -0.2, 0 and 0.1: rates w - 0.2 c and w."""
    c = np.array([2.0, -1.0, 0.5, 4.0])
    now, before = np.array(RATES), np.array(RATES) - 0.2 * c
    known = state_at(
        PLACE, rates=RATES, last_rates=tuple(before.tolist()), last_step=0.2, history=2
    )
    exact = 0.1 * now + 0.5 * 0.1 * 0.1 * c
    assert predict(known, PREDICT_FEEDFORWARD_2, 0.1) == pytest.approx(exact, abs=1e-15)
    one = predict(known._replace(history=1), PREDICT_FEEDFORWARD_2, 0.1)
    assert one == pytest.approx(0.1 * now, abs=1e-15)


def test_a_step_within_a_face_is_taken_whole():
    work = new_work()
    place = apply_step(PAIR, PLACE, (0.1, 0.2, 0.0, 0.0), work)
    assert place == moved(PLACE, 1.0, (0.1, 0.2, 0.0, 0.0))
    assert work.counts[EVENTS] == 0


def test_a_step_over_a_boundary_holds_it():
    """From x = 0.3 to 1.7 along x: on the edge at y = -0.2, after half of the step."""
    work = new_work()
    place = apply_step(PAIR, PLACE, (0.0, 1.4, 0.0, 0.0), work)
    assert (place.feature_a, place.chart_a) == (EDGE, -1)
    jet = feature_jet(*packed(BOX), place.feature_a, place.chart_a, place.u, place.v)
    assert jet[0] == pytest.approx((1.0, -0.2, 1.0), abs=1e-15)
    assert work.counts[EVENTS] == 1


def test_a_step_that_one_body_stops_is_cut_for_both():
    """A's point goes half of its way, to the edge, and so does that of the ball above it."""
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (0.3, -0.2, 2.0))
    place = case.place((0.3, -0.2, 1.0), (0.0, 0.0, -0.5))
    across = case.points(moved(place, 1.0, (0.0, 0.1, 0.0, 0.0)))[0] - case.points(place)[0]
    assert across == pytest.approx((0.1, 0.0, 0.0), abs=1e-15)
    after = apply_step(case.pair, place, (0.0, 1.4, 0.2, -0.4), new_work())
    assert case.points(after)[0] == pytest.approx((1.0, -0.2, 1.0), abs=1e-15)
    assert (after.r, after.s) == pytest.approx((place.r + 0.1, place.s - 0.2), abs=1e-15)


BALL = so.shapes.ellipsoid(1.0, 0.8, 0.6)
SOLIDS = Placed(ball(1.0), ball(0.7), (0.0, 0.0, 2.0))


def test_a_step_to_a_chart_s_rim_changes_charts():
    side = on_atlas(BALL, (1.0, 0.0, 0.0))
    place = SOLIDS.place((1.0, 0.0, 0.0), (0.0, 0.0, -0.7))
    work = new_work()
    after = apply_step(SOLIDS.pair, place, (1.25, 0.0, 0.0, 0.0), work)
    assert work.counts[CHART_CHANGES] == 1
    assert after.chart_a != side.chart
    assert max(abs(after.u), abs(after.v)) < 1.0
    x = SOLIDS.points(after)[0]
    before = SOLIDS.points(moved(place, 1.0, (1.25, 0.0, 0.0, 0.0)))[0]
    np.testing.assert_allclose(x, before, atol=1e-15)


def velocity(side, rates):
    jet = feature_jet(*packed(BALL), side.feature, side.chart, side.p, side.q)
    return np.array(jet[0]), rates[0] * np.array(jet[1]) + rates[1] * np.array(jet[2])


def test_in_another_chart_it_is_the_same_point_with_the_same_velocity():
    x = tuple(float(y) for y in np.array([1.0, 0.8, 0.6]) * unit(1.0, 0.9, 0.3))
    old, rates = on_atlas(BALL, x), (0.4, -0.7)
    assert in_chart(*packed(BALL), old, rates, old.chart) == (True, old, rates)
    other = on_atlas(BALL, (0.0, 0.8, 0.0)).chart
    assert other != old.chart
    seen, side, w = in_chart(*packed(BALL), old, rates, other)
    assert seen
    assert side.chart == other
    for mine, theirs in zip(velocity(old, rates), velocity(side, w), strict=True):
        np.testing.assert_allclose(theirs, mine, atol=1e-14)
    opposite = on_atlas(BALL, (-1.0, 0.0, 0.0)).chart
    assert in_chart(*packed(BALL), old, rates, opposite) == (False, old, rates)


def test_a_history_is_carried_to_the_charts_of_this_frame_and_not_to_other_features():
    x = np.array(unit(1.0, 0.9, 0.3))
    old = SOLIDS.place(x, (0.0, 0.0, -0.7))
    other = on_atlas(SOLIDS.a.body, (0.0, 1.0, 0.0))
    new = old._replace(chart_a=other.chart, u=other.p, v=other.q)
    same, place, rates = carry_over(SOLIDS.pair, state_at(old, rates=RATES), new)
    assert same
    expected = in_chart(
        *SOLIDS.pair[:2], Side(old.feature_a, old.chart_a, old.u, old.v), RATES[:2], other.chart
    )
    assert (place.chart_a, place.u, place.v) == (other.chart, expected[1].p, expected[1].q)
    assert rates == (*expected[2], *RATES[2:])
    assert (place.r, place.s) == (old.r, old.s)

    known = state_at(PLACE, rates=RATES)
    edge = place_of(on_edge(0.5))
    assert carry_over(PAIR, known, edge) == (False, PLACE, RATES)
    swapped = Placed(SOLIDS.a, box(1.0, 1.0, 1.0), (0.0, 0.0, 3.0))
    first = swapped.place((1.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    second = swapped.place((1.0, 0.0, 0.0), (1.0, 1.0, -1.0))
    assert not carry_over(swapped.pair, state_at(first, rates=RATES), second)[0]


def test_the_secant_of_two_places():
    after = moved(PLACE, 0.25, RATES)
    assert secant(PLACE, after, 0.25) == pytest.approx(RATES, abs=1e-15)


def test_only_what_follows_by_feedforward_is_fed_by_it():
    assert [feeds(k, True) for k in range(4)] == [False, False, True, True]
    assert not any(feeds(k, False) for k in range(4))


def tracked_at(place, rates=NO_RATES, normal=(0.0, 0.0, 1.0), distance=2.0, inside=False):
    found = Found(CERTIFIED, place, distance, distance - 1e-12, distance, normal)
    shown = without_rates(PAIR, POSE, found, inside, Integrated(NO_RATES, LAST, 7.0)).shown
    return Tracked(shown._replace(rates=rates), Integrated(NO_RATES, LAST, 7.0))


H = 0.25
AFTER = moved(PLACE, H, RATES)


def kept(before, tracked=None, feed=True, status=CONVERGED, h=H):
    motion = motion_of(POSE, (1.0, 2.0, 3.0))
    return next_state(PAIR, before, motion, h, tracked or tracked_at(AFTER, RATES), feed, status)


def test_a_frame_keeps_its_answer_and_its_motion():
    before = state_at(PLACE, time=1.5, cut=3)
    state = kept(before, tracked_at(AFTER, RATES, (0.0, 1.0, 0.0), -0.5, True))
    assert state.place == AFTER
    assert state.motion == motion_of(POSE, (1.0, 2.0, 3.0))
    assert (state.time, state.last_step) == (1.75, H)
    assert (state.normal, state.distance, state.inside) == ((0.0, 1.0, 0.0), -0.5, True)
    assert state.lower == -0.5 - 1e-12
    assert state.integrated == Integrated(NO_RATES, LAST, 7.0)


def test_a_feedforward_is_kept_beside_the_last_one_where_there_was_one():
    first = kept(state_at(PLACE))
    assert (first.rates, first.history, first.fed) == (RATES, 1, True)
    second = kept(state_at(PLACE, rates=LAST, history=1, fed=True))
    assert (second.rates, second.last_rates, second.history) == (RATES, LAST, 2)
    # the last rates were a secant's, or another feature's
    assert kept(state_at(PLACE, rates=LAST, history=1, fed=False)).history == 1
    edge = state_at(place_of(on_edge(0.5)), rates=LAST, history=2, fed=True)
    assert kept(edge).history == 1


def test_without_a_feedforward_the_secant_is_kept():
    state = kept(state_at(PLACE), feed=False)
    assert state.rates == pytest.approx(RATES, abs=1e-15)
    assert (state.history, state.fed) == (1, False)
    assert kept(state_at(PLACE), feed=False, h=0.0).history == 0
    assert kept(state_at(place_of(on_edge(0.5))), feed=False).history == 0


def test_points_cut_off_on_their_way_have_no_rate():
    state = kept(state_at(PLACE, cut=3), feed=False, status=DEADLINE)
    assert (state.history, state.cut) == (0, 4)
    assert kept(state_at(PLACE), feed=False, status=NOT_RESTARTED).history == 0
    for status in (CONVERGED, GLOBAL, NOT_CERTIFIED):
        assert kept(state_at(PLACE, cut=3), status=status).cut == 0


def test_a_frame_without_certified_points_is_lost():
    lost = {s: kept(state_at(PLACE), status=s).lost for s in range(8)}
    assert {s for s, is_lost in lost.items() if is_lost} == {
        OVERLAPPING,
        NOT_CERTIFIED,
        NOT_RESTARTED,
        NOT_RESTARTED,
    }


def test_what_is_carried_may_be_given():
    before = state_at(PLACE, rates=LAST, history=1, fed=True)
    motion = motion_of(POSE, (1.0, 2.0, 3.0))
    tracked = tracked_at(AFTER, RATES)
    carried = carry_over(PAIR, before, AFTER)
    own = kept_state(carried, before, motion, H, tracked, True, CONVERGED)
    assert own == kept(before)
    anew = kept_state((False, PLACE, LAST), before, motion, H, tracked, False, CONVERGED)
    assert (anew.rates, anew.history) == (LAST, 0)


@pytest.mark.parametrize("feed", [True, False])
def test_a_point_in_linear_motion_over_a_face_is_predicted_to_the_digit(feed):
    """Above (0.3, -0.2) + t (0.4, 0.8) the foot's parameters are (-y, x)."""
    h = 0.125
    rates = (-0.8, 0.4, 0.0, 0.0)
    state = state_at(PLACE)
    for k in range(1, 4):
        place = place_of(on_top(0.3 + 0.4 * h * k, -0.2 + 0.8 * h * k))
        assert place.feature_a == TOP
        if k > 1:
            step = predict(state, PREDICT_FEEDFORWARD_2 if feed else PREDICT_SECANT, h)
            assert moved(state.place, 1.0, step) == pytest.approx(place, abs=1e-15)
        tracked = tracked_at(place, rates if feed else NO_RATES)
        state = next_state(PAIR, state, motion_of(POSE), h, tracked, feed, CONVERGED)


def test_points_found_without_the_law_show_their_own_jets():
    shown = tracked_at(PLACE, RATES).shown
    assert isinstance(shown, Shown)
    assert shown.jets[0][0] == pytest.approx((0.3, -0.2, 1.0), abs=1e-15)
    assert shown.jets[1][0] == pytest.approx(ABOVE, abs=1e-15)
    assert not shown.fresh


def test_the_law_begins_with_the_errors_of_its_place():
    """Psi of a point 2 above (0.3, -0.2), from the middle of the top: the tangents are (-y, x)."""
    place = place_of(on_top(0.0, 0.0))
    errors = errors_at(PAIR, POSE, place)
    assert errors == pytest.approx((-0.2, -0.3, 0.0, 0.0), abs=1e-15)
    assert begun(PAIR, POSE, place, 7.0) == Integrated(errors, NO_RATES, 7.0)
