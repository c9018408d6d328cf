"""From witness points to an answer in world axes: two spheres, whose rates have closed forms."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_frames import flat, inputs, motion_of, state_at
from hand_made_pairs import IDENTITY, Placed, X, Z, ball, box, pair_of, point, turn, unit, vector
from pointed import pointed

import standoff as so
from standoff.kernels.algebra.rigid import relative_pose, relative_twist
from standoff.kernels.body import layout as L
from standoff.kernels.frame.answer import (
    normal_rate,
    write_answer,
    write_points,
    write_rates,
    write_vector,
)
from standoff.kernels.frame.feedforward import feedforward_now
from standoff.kernels.frame.inputs import moving, refused, twisted
from standoff.kernels.pair.certified import CERTIFIED
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import EVALUATIONS, REGULARISED
from standoff.kernels.state.arrays import (
    BAD_POSE_A,
    BAD_POSE_B,
    BAD_TWIST,
    CONVERGED,
    DISTANCE,
    FINE,
    LOWER_BOUND,
    N_OUT,
    NORMAL,
    OUT_COUNTS,
    OUT_MODE,
    OUT_OF_PLANE,
    OUT_Q,
    OUT_RATE,
    OVERLAPPING,
    POINT_A,
    POINT_B,
    RESIDUAL,
    SOLVE_PLAIN,
    SOLVE_RANKED,
    STATUS,
    UPPER_BOUND,
    VELOCITY_A,
    VELOCITY_B,
)
from standoff.kernels.state.tracked import Shown
from standoff.kernels.values import NO_RATES, ORIGIN, Found, Motion

R_A, R_B = turn((1, 2, 3), 0.9), turn((3, -1, 1), 0.4)
CENTRE_A, CENTRE_B = np.array([0.5, -1.0, 2.0]), np.array([1.5, 1.0, 4.0])
V_A, W_A = np.array([0.3, -0.2, 0.5]), np.array([0.7, 0.1, -0.4])
V_B, W_B = np.array([-1.0, 0.4, 0.2]), np.array([-0.3, 0.9, 0.6])
"""Both bodies turn and move in world; |B - A| is 3."""
GIVEN = inputs(flat(R_A, CENTRE_A), flat(R_B, CENTRE_B), [*V_A, *W_A], [*V_B, *W_B], True)
SILENT = GIVEN._replace(has_twist=False)
N = (CENTRE_B - CENTRE_A) / 3.0
SLIP = V_B - V_A
N_RATE = (SLIP - N * (N @ SLIP)) / 3.0
"""The rate of the direction between the centres."""


def rotated(R, x):
    return np.array(R).reshape(3, 3) @ x


def rotated_back(R, x):
    return np.array(R).reshape(3, 3).T @ x


def between(a, b, core_a, core_b):
    """The pair at the poses GIVEN, with both cores' points, and what is found of them."""
    pose = relative_pose(GIVEN.pose_a, GIVEN.pose_b)
    case = Placed(a, b, vector(pose.p), pose.R)
    n_a, n_b = rotated_back(R_A, N), -rotated_back(R_B, N)
    place = case.place(core_a * n_a, core_b * n_b)
    d = 3.0 - core_a - core_b
    found = Found(CERTIFIED, place, d, d - 1e-12, d + 1e-12, vector(n_a))
    return case, found, pair_jets(*case.both, place)


SPHERES = between(point(0.7), point(0.4), 0.0, 0.0)
BALLS = between(ball(0.7), ball(0.4), 0.7, 0.4)


def test_a_vector_goes_where_it_belongs():
    to = np.zeros(5)
    write_vector((1.0, 2.0, 3.0), to, 1)
    assert to.tolist() == [0.0, 1.0, 2.0, 3.0, 0.0]


@pytest.mark.parametrize("made", [SPHERES, BALLS])
def test_points_stand_in_world_on_the_swept_surfaces(made):
    """Swept about points or curved themselves: 0.7 and 0.4 along the line of centres."""
    case, found, jets = made
    out = np.full(N_OUT, np.nan)
    write_points(case.pair, GIVEN, jets, found, out)
    assert out[DISTANCE] == pytest.approx(1.9, abs=1e-15)
    assert out[LOWER_BOUND] == pytest.approx(1.9 - 1e-12, abs=1e-15)
    assert out[UPPER_BOUND] == pytest.approx(1.9 + 1e-12, abs=1e-15)
    np.testing.assert_allclose(out[NORMAL : NORMAL + 3], N, atol=1e-15)
    np.testing.assert_allclose(out[POINT_A : POINT_A + 3], CENTRE_A + 0.7 * N, atol=1e-15)
    np.testing.assert_allclose(out[POINT_B : POINT_B + 3], CENTRE_B - 0.4 * N, atol=1e-15)
    assert out[RESIDUAL] == pytest.approx(0.0, abs=1e-14)
    assert np.isnan(out[OUT_MODE : OUT_Q + 8]).all()


def test_the_residual_is_the_slope_of_points_that_are_not_the_nearest():
    """Over a box's top the slope is the tangential part of the gap: 0.5."""
    case = Placed(box(1.0, 1.0, 1.0), point(), (0.3, 0.4, 3.0))
    place = case.place((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    out = np.full(N_OUT, np.nan)
    found = Found(CERTIFIED, place, 2.0, 1.0, 2.0, Z)
    still = inputs(flat(IDENTITY, ORIGIN), flat(IDENTITY, case.p), 6 * [0.0], 6 * [0.0], True)
    write_points(case.pair, still, pair_jets(*case.both, place), found, out)
    assert out[RESIDUAL] == pytest.approx(0.5, abs=1e-15)


def test_the_normal_turns_by_what_is_square_to_it():
    found = BALLS[1]._replace(normal=X, distance=2.0)
    assert normal_rate((5.0, 1.0, -3.0), found) == (0.0, 0.5, -1.5)
    assert normal_rate((5.0, 1.0, -3.0), found._replace(distance=0.0)) == ORIGIN
    assert normal_rate((5.0, 1.0, -3.0), found._replace(distance=-1.0)) == ORIGIN


def test_b_s_motion_is_seen_from_a():
    """B turns by w_B - w_A, and its origin moves by what A's own motion leaves."""
    pose = relative_pose(GIVEN.pose_a, GIVEN.pose_b)
    motion = twisted(GIVEN, pose)
    assert motion.pose == pose
    arm = CENTRE_B - CENTRE_A
    v = rotated_back(R_A, V_B - V_A - np.cross(W_A, arm))
    np.testing.assert_allclose(motion.v, v, atol=1e-15)
    np.testing.assert_allclose(motion.w, rotated_back(R_A, W_B - W_A), atol=1e-15)
    np.testing.assert_allclose(pose.p, rotated_back(R_A, arm), atol=1e-15)
    before = state_before(pose)
    assert moving(GIVEN, before, 0.1) == motion


def state_before(pose):
    return state_at(BALLS[1].place, motion=motion_of(pose))


def test_without_twists_it_is_the_motion_since_the_frame_before():
    """A turn by 0.2 about B's own z and a shift by (1, 2, 3), in 0.1 s."""
    before = relative_pose(GIVEN.pose_a, flat(R_B, CENTRE_B))
    shift = np.array([1.0, 2.0, 3.0])
    R = np.array(R_B).reshape(3, 3) @ np.array(turn(Z, 0.2)).reshape(3, 3)
    after = SILENT._replace(pose_b=flat(R.ravel(), CENTRE_B + shift))
    motion = moving(after, state_before(before), 0.1)
    assert motion.pose == relative_pose(after.pose_a, after.pose_b)
    np.testing.assert_allclose(motion.v, 10.0 * rotated_back(R_A, shift), atol=1e-12)
    own_z = rotated_back(R_A, rotated(R_B, np.array(Z)))
    np.testing.assert_allclose(motion.w, 2.0 * own_z, atol=1e-12)
    still = moving(SILENT, state_before(before), 0.1)
    np.testing.assert_allclose([still.v, still.w], 0.0, atol=1e-13)


def test_a_pose_that_is_none_is_refused():
    """Named in the order of poses and twists; a planar body must stay in z = 0."""
    case = BALLS[0]
    assert refused(case.pair, GIVEN) == FINE
    mirrored = flat(IDENTITY, CENTRE_A)
    mirrored[0] = -1.0
    assert refused(case.pair, replaced(pose_a=mirrored)) == BAD_POSE_A
    stretched = flat(IDENTITY, CENTRE_A)
    stretched[4] = 1.001
    assert refused(case.pair, replaced(pose_b=stretched)) == BAD_POSE_B
    for number in (math.nan, math.inf):
        assert refused(case.pair, replaced(twist_b=np.full(6, number))) == BAD_TWIST
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
    for pair in (pair_of(disc, so.shapes.point()), pair_of(so.shapes.point(), disc)):
        level = replaced(pose_a=flat(turn(Z, 0.3), (1, 2, 0)), pose_b=flat(IDENTITY, (3, 2, 0)))
        assert refused(pair, level) == FINE
        for pose in (flat(IDENTITY, (3, 2, 1e-9)), flat(turn(X, 1e-9), (3, 2, 0))):
            assert refused(pair, level._replace(pose_b=pointed(pose))) == OUT_OF_PLANE


def replaced(**numbers):
    return GIVEN._replace(**{name: pointed(value) for name, value in numbers.items()})


def test_the_feedforward_at_an_answer_is_that_of_its_points():
    """The balls' points as they follow the line of centres, by one evaluation."""
    case, found, jets = BALLS
    for solve in (SOLVE_RANKED, SOLVE_PLAIN):
        work = new_work()
        rates = feedforward_now(case.pair, relative(), found.place, solve, work)
        assert rates == pytest.approx(rates_of(case, jets, seen_rate()), abs=1e-12)
        assert (work.counts[EVALUATIONS], work.counts[REGULARISED]) == (1, 0)


def test_two_planes_have_a_feedforward_by_the_rank_rule_alone():
    """Box on box: H is singular. The plain solve makes no step, and both count it."""
    case = Placed(box(1.0, 1.0, 1.0), box(0.5, 0.5, 0.5), (0.2, 0.1, 2.0))
    place = case.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.5))
    motion = motion_of(case.pose, (0.3, 0.0, 0.0))
    for solve, along in ((SOLVE_RANKED, 0.15), (SOLVE_PLAIN, 0.0)):
        work = new_work()
        rates = feedforward_now(case.pair, motion, place, solve, work)
        # half of the slip each is the least; (u, v) of a top are (-y, x)
        assert rates[1] == pytest.approx(along, abs=1e-12)
        assert work.counts[REGULARISED] == 1


def rates_of(case, jets, n_rate):
    """The rates of four parameters that keep both balls' points on the line of centres, in A's
    frame: the least-squares solution of their points' velocities."""
    motion = relative()
    away = np.array(motion.v)
    spin = np.array(motion.w)
    columns_a = np.array([jets[0][1], jets[0][2]]).T
    columns_b = np.array([jets[1][1], jets[1][2]]).T
    x_b = np.array(jets[1][0])
    slide_a = 0.7 * n_rate
    carried = away + np.cross(spin, x_b - np.array(motion.pose.p))
    slide_b = away - 0.4 * n_rate - carried
    a = np.linalg.lstsq(columns_a, slide_a, rcond=None)[0]
    b = np.linalg.lstsq(columns_b, slide_b, rcond=None)[0]
    return tuple(float(x) for x in (*a, *b))


def relative() -> Motion:
    return twisted(GIVEN, relative_pose(GIVEN.pose_a, GIVEN.pose_b))


OTHER_RATE = np.array([0.5, -0.25, 1.0])
"""Added to the normal's, in A's frame."""


def seen_rate():
    """N's rate seen from A."""
    return rotated_back(R_A, N_RATE - np.cross(W_A, N))


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize("made", [SPHERES, BALLS])
def test_witness_points_move_along_the_line_of_centres(made, inside):
    """x_A = c_A + r n: v_A + r n', whatever the spins are. In contact n' is given."""
    case, found, jets = made
    rates = rates_of(case, jets, seen_rate()) if made is BALLS else NO_RATES
    shown = Shown(found, jets, inside, True, rates)
    out = np.full(N_OUT, np.nan)
    write_points(case.pair, GIVEN, jets, found, out)
    # outside contact what is given does not count, and in contact it is all that does
    write_rates(case.pair, GIVEN, relative(), shown, vector(seen_rate() + OTHER_RATE), out)
    assert out[OUT_RATE] == pytest.approx(N @ SLIP, abs=1e-14)
    swept = case.a.body.reals[L.RADIUS], case.b.body.reals[L.RADIUS]
    more = rotated(R_A, OTHER_RATE) if inside else np.zeros(3)
    v_a, v_b = V_A + 0.7 * N_RATE + swept[0] * more, V_B - 0.4 * N_RATE - swept[1] * more
    np.testing.assert_allclose(out[VELOCITY_A : VELOCITY_A + 3], v_a, atol=1e-14)
    np.testing.assert_allclose(out[VELOCITY_B : VELOCITY_B + 3], v_b, atol=1e-14)


def whole(given):
    case, found, jets = BALLS
    shown = Shown(found, jets, False, True, rates_of(case, jets, seen_rate()))
    out = np.full(N_OUT, -7.0)
    write_answer(case.pair, given, relative(), shown, ORIGIN, CONVERGED, out)
    return found.place, out


def test_an_answer_tells_where_its_points_are_and_how_they_move():
    place, out = whole(GIVEN)
    mode = [place.feature_a, place.chart_a, place.feature_b, place.chart_b]
    assert out[OUT_MODE : OUT_MODE + 4].tolist() == mode
    assert out[OUT_Q : OUT_Q + 4].tolist() == [place.u, place.v, place.r, place.s]
    assert out[STATUS] == CONVERGED
    assert out[DISTANCE] == pytest.approx(1.9, abs=1e-15)
    assert out[OUT_RATE] == pytest.approx(N @ SLIP, abs=1e-14)
    assert (out[OUT_COUNTS:] == -7.0).all()
    assert math.isfinite(out[:OUT_COUNTS].sum())


def test_of_bodies_that_overlap_no_distance_is_told():
    """What their points are apart by tells nothing, and less than 0 what it parts them by."""
    case, found, jets = BALLS
    shown = Shown(found, jets, False, True, NO_RATES)
    for status, distance in ((CONVERGED, 1.9), (OVERLAPPING, 0.0)):
        out = np.full(N_OUT, np.nan)
        write_answer(case.pair, SILENT, relative(), shown, ORIGIN, status, out)
        assert out[DISTANCE] == pytest.approx(distance, abs=1e-15)
        assert out[UPPER_BOUND] == pytest.approx(distance, abs=1e-11)
        assert out[LOWER_BOUND] == pytest.approx(1.9, abs=1e-11)
        assert out[STATUS] == status
    deep = shown._replace(found=found._replace(distance=-0.3, upper=-0.2))
    write_answer(case.pair, SILENT, relative(), deep, ORIGIN, OVERLAPPING, out)
    assert (out[DISTANCE], out[UPPER_BOUND]) == (-0.3, -0.2)


def test_without_twists_an_answer_has_no_rates():
    _, out = whole(SILENT)
    assert np.isnan(out[OUT_RATE:RESIDUAL]).all()
    assert math.isfinite(out[:OUT_RATE].sum())
    assert math.isfinite(out[RESIDUAL:OUT_COUNTS].sum())


def test_what_stands_still_has_rates_of_zero():
    case, found, jets = BALLS
    still = GIVEN._replace(twist_a=np.zeros(6), twist_b=np.zeros(6))
    assert relative_twist(*still[:4]) == (ORIGIN, ORIGIN)
    out = np.full(N_OUT, np.nan)
    shown = Shown(found, jets, False, True, NO_RATES)
    write_answer(case.pair, still, motion_of(case.pose), shown, ORIGIN, CONVERGED, out)
    assert not out[OUT_RATE:RESIDUAL].any()
    assert unit(*out[NORMAL : NORMAL + 3]) == pytest.approx(vector(N), abs=1e-15)
