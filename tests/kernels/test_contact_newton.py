"""Newton's method on the contact-regular form: normals, scales, linear algebra, roots and rates."""

import math

import numpy as np
import pytest
from hand_made import BOX, EDGE, new_work
from hand_made_frames import motion_of
from hand_made_pairs import (
    Placed,
    X,
    Y,
    Z,
    across,
    ball,
    box,
    edge_side,
    ellipsoid,
    half_space,
    pair_of,
    point,
    side_at,
    turn,
    unit,
    vector,
    wedge,
)

import standoff as so
from standoff.kernels.body.features import pair_span
from standoff.kernels.pair.contact_newton import (
    common_normal,
    contact_rates,
    contact_scales,
    factor_and_solve,
    newton,
    polish,
    scaled_jacobian,
    scaled_residual,
    solve_contact,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, LIMIT
from standoff.kernels.pair.system import contact_residual
from standoff.kernels.tolerances import CONTACT_STEPS, NEAR_CONTACT
from standoff.kernels.values import NO_CHART, Place, Pose, Side, moved, together

P = (0.4, 0.3, 1.2)
WAY = unit(*P)
BALLS = Placed(ball(1.0), ball(0.7), P)
EGGS = Placed(
    ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (0.3, 0.2, 0.9), turn((1, 2, 3), 0.9)
)


def normal_of(case, place):
    return common_normal(*case.both, place, pair_jets(*case.both, place))


def test_a_face_gives_the_normal_of_its_own():
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (0.2, 0.1, 2.0))
    place = case.place((0.2, 0.1, 1.0), 0.5 * np.array(unit(0.6, 0, -0.8)))
    assert normal_of(case, place) == (Z, True)


def test_against_a_corner_it_is_that_of_the_other_s_face():
    R = turn((1, 2, 3), 0.9)
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (2.0, 2.0, 2.0), R)
    m = unit(-1, 0.2, 0.3)
    n, sharp = normal_of(case, case.place((1.0, 1.0, 1.0), 0.5 * np.array(m)))
    assert sharp
    assert n == pytest.approx(vector(-np.array(R).reshape(3, 3) @ m), abs=1e-14)


@pytest.mark.parametrize("spin", [0.0, math.pi])
@pytest.mark.parametrize(
    ("first", "second"), [(30.0, 30.0), (60.0, 0.0), (0.0, 30.0), (120.0, 120.0)]
)
@pytest.mark.parametrize("height", [0.5, 1e-9, -0.3])
def test_two_edges_give_their_common_perpendicular_from_a_to_b(height, first, second, spin):
    """Wedges, B upside down above A and across it, whichever way its edge runs: z in penetration
    too, and of sharp edges, whose normals are not all on one side of a plane along them."""
    (a, edge_a), (b, edge_b) = wedge(first), wedge(second)
    pair, pose = pair_of(a, b), across(height, spin)
    place = together(edge_side(edge_a, 0.5), edge_side(edge_b, 0.5))
    n, sharp = common_normal(pair, pose, place, pair_jets(pair, pose, place))
    assert sharp
    assert n == pytest.approx(Z, abs=1e-15)


@pytest.mark.parametrize("spin", [0.0, math.pi])
def test_two_segments_give_the_side_on_which_b_is(spin):
    """They have no faces that tell, and nothing inside."""
    (line, edge), place = wedge(0.0), together(edge_side(0, 0.5), edge_side(0, 0.5))
    assert edge == 0
    for height in (0.5, 1e-9, -1e-9):
        pair, pose = pair_of(line, line), across(height, spin)
        n, _ = common_normal(pair, pose, place, pair_jets(pair, pose, place))
        assert n == pytest.approx(np.sign(height) * np.array(Z), abs=1e-15)


def test_corners_have_the_direction_of_their_points_alone():
    case = Placed(box(1.0, 1.0, 1.0), box(1.0, 1.0, 1.0), (2.3, 2.4, 2.0 + 1.2))
    n, sharp = normal_of(case, case.place((1.0, 1.0, 1.0), (-1.0, -1.0, -1.0)))
    assert not sharp
    assert n == pytest.approx(unit(0.3, 0.4, 1.2), abs=1e-15)
    parallel = together(edge_side(EDGE, 0.5), edge_side(EDGE, 0.5))
    pair, pose = pair_of(BOX, BOX), Pose(case.R, (3.0, 0.0, 3.0))
    n, sharp = common_normal(pair, pose, parallel, pair_jets(pair, pose, parallel))
    assert not sharp


def test_a_planar_edge_gives_its_own_normal():
    disc = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
    dot = so.shapes.point()
    rim, centre = edge_side(0, math.pi / 2.0), Side(np.int64(0), NO_CHART, 0.0, 0.0)
    for a, b, place, p, expected in (
        (disc, dot, together(rim, centre), (0.5, 1.5, 0.0), Y),
        (dot, disc, together(centre, rim), (0.5, -1.5, 0.0), (0.0, -1.0, 0.0)),
    ):
        pair, pose = pair_of(a, b), Pose(BALLS.R, p)
        n, sharp = common_normal(pair, pose, place, pair_jets(pair, pose, place))
        assert sharp
        assert n == pytest.approx(expected, abs=1e-15)


def test_scales_are_spans_over_the_lengths_of_tangents():
    jets = pair_jets(*EGGS.both, EGGS.place((1.0, 0.0, 0.0), (0.0, 0.0, -0.5)))
    scales = np.full(8, np.nan)
    contact_scales(*jets, 3.0, scales)
    tangents = (jets[0][1], jets[0][2], jets[1][1], jets[1][2])
    expected = [3.0 / np.linalg.norm(t) for t in tangents]
    assert scales.tolist() == pytest.approx([*expected, 1.0, 1.0, 1.0, 3.0])
    corner = (X, *5 * ((0.0, 0.0, 0.0),))
    contact_scales(corner, jets[1], 4.0, scales)
    assert scales[:2].tolist() == [2.0, 2.0]


def test_the_residual_is_measured_in_spans():
    """A ball's point 0.1 beside the pole: r = (sin, 0, sin, 0, miss), each by its scale."""
    place = BALLS.place(unit(0.1, 0, 1), -0.7 * np.array(Z))
    jets = pair_jets(*BALLS.both, place)
    scales, r = np.zeros(8), np.zeros(8)
    contact_scales(*jets, 2.0, scales)
    error = scaled_residual(*jets, Z, -0.3, 2.0, scales, r)
    whole = np.array(contact_residual(*jets, Z, -0.3)) * scales / 2.0
    np.testing.assert_allclose(r, whole, atol=1e-15)
    assert error == pytest.approx(float(np.linalg.norm(whole)))
    exact = pair_jets(*BALLS.both, BALLS.place(np.array(WAY), -0.7 * np.array(WAY)))
    contact_scales(*exact, 2.0, scales)
    assert scaled_residual(*exact, WAY, -0.4, 2.0, scales, r) < 1e-14


@pytest.mark.parametrize("n", [1, 3, 8])
def test_linear_equations_are_solved_by_pivoting(n, rng):
    for _ in range(5):
        A, x = rng.normal(size=(n, n)), rng.normal(size=n)
        A[0, 0] = 0.0 if n > 1 else 2.0  # no pivot there
        J, r = A.ravel().copy(), A @ x
        assert factor_and_solve(J, r, n)
        np.testing.assert_allclose(r, x, atol=1e-12)


def test_a_singular_matrix_is_told():
    J, r = np.array([1.0, 2.0, 2.0, 4.0]), np.array([1.0, 2.0])
    assert not factor_and_solve(J, r, 2)
    assert not factor_and_solve(np.zeros(4), r, 2)


def test_the_jacobian_is_the_derivative_of_the_residual():
    """By central differences in the scaled columns of (q, n, d)."""
    place = EGGS.place((0.8 * np.array(unit(0, 1, 0))), 0.5 * np.array((0.0, 0.0, -1.0)))
    span, n, d = 3.0, np.array(unit(1, 2, 3)), -0.2
    scales, J = np.zeros(8), np.zeros(64)
    contact_scales(*pair_jets(*EGGS.both, place), span, scales)
    scaled_jacobian(*pair_jets(*EGGS.both, place), vector(n), d, span, scales, J)
    step = 1e-6

    def residual(y):
        at = moved(place, 1.0, tuple(float(q) for q in y[:4] * scales[:4]))
        jets = pair_jets(*EGGS.both, at)
        r = contact_residual(*jets, vector(n + y[4:7]), float(d + span * y[7]))
        return np.array(r) * scales / span

    for k in range(8):
        y = np.zeros(8)
        y[k] = step
        column = (residual(y) - residual(-y)) / (2.0 * step)
        np.testing.assert_allclose(J.reshape(8, 8)[:, k], column, atol=1e-8)


def test_a_step_solves_the_scaled_system():
    place = EGGS.place((0.8 * np.array(unit(0, 1, 0))), 0.5 * np.array((0.0, 0.0, -1.0)))
    jets = pair_jets(*EGGS.both, place)
    scales, J, x = np.zeros(8), np.zeros(64), np.zeros(8)
    contact_scales(*jets, 3.0, scales)
    scaled_jacobian(*jets, unit(1, 2, 3), -0.2, 3.0, scales, J)
    r = np.linspace(-1.0, 1.0, 8)
    solve_contact(*jets, unit(1, 2, 3), -0.2, 3.0, scales, r, x)
    np.testing.assert_allclose(J.reshape(8, 8) @ x, r, atol=1e-11)


def test_parallel_features_take_the_least_step():
    """Two flat faces: the points may slide together, so the step is the shortest of many."""
    case = Placed(box(1.0, 1.0, 1.0), box(0.5, 0.5, 0.5), (0.2, 0.1, 1.4))
    place = case.place((0.3, -0.2, 1.0), (0.2, 0.1, -0.5))
    jets = pair_jets(*case.both, place)
    scales, J, x = np.zeros(8), np.zeros(64), np.zeros(8)
    contact_scales(*jets, 3.0, scales)
    scaled_jacobian(*jets, Z, -0.1, 3.0, scales, J)
    r = np.zeros(8)
    scaled_residual(*jets, Z, -0.1, 3.0, scales, r)
    solve_contact(*jets, Z, -0.1, 3.0, scales, r, x)
    expected = np.linalg.lstsq(J.reshape(8, 8), r, rcond=1e-9)[0]
    np.testing.assert_allclose(x, expected, atol=1e-11)


def test_what_is_not_finite_makes_no_step():
    jets = pair_jets(*BALLS.both, BALLS.place(X, (0.0, 0.0, -0.7)))
    bad = tuple(vector(np.full(3, math.nan)) if k == 3 else x for k, x in enumerate(jets[0]))
    x = np.full(8, 7.0)
    solve_contact(bad, jets[1], Z, 0.0, 3.0, np.ones(8), np.ones(8), x)
    assert not x.any()


def solved(case, place, n, d, work=None):
    work = work or new_work()
    return newton(*case.both, place, n, d, case.size, work), work


@pytest.mark.parametrize("distance", [1.3, 1.7, 2.0])
def test_newton_s_method_ends_on_the_line_of_centres(distance):
    """In penetration, touching and apart: the signed distance is that of the centres less 1.7."""
    case = BALLS.at(*(distance * np.array(WAY)))
    n = unit(*(np.array(WAY) + 0.1 * np.array(unit(3, -4, 0))))
    ended, work = solved(case, case.place(np.array(n), -0.7 * np.array(n)), n, 0.0)
    assert ended.fits
    assert ended.error < 1e-14
    assert ended.normal == pytest.approx(WAY, abs=1e-14)
    assert ended.distance == pytest.approx(distance - 1.7, abs=1e-14)
    np.testing.assert_allclose(case.points(ended.place)[0], WAY, atol=1e-13)
    assert 1 <= work.counts[CORRECTIONS] <= work.counts[EVALUATIONS] <= CONTACT_STEPS


def test_it_holds_its_features():
    """The ball stands beside the cube's top: the step would leave it, so the caller decides."""
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (2.5, 0.0, 1.2))
    place = case.place((0.5, 0.0, 1.0), (0.0, 0.0, -0.5))
    ended, work = solved(case, place, Z, 0.0)
    assert not ended.fits
    assert ended.place == place
    assert work.counts[CORRECTIONS] == 0
    over = case.at(0.7, 0.2, 1.2)
    ended, _ = solved(over, place, Z, 0.0)
    assert ended.fits
    assert ended.distance == pytest.approx(-0.3, abs=1e-14)
    np.testing.assert_allclose(over.points(ended.place)[0], (0.7, 0.2, 1.0), atol=1e-14)


def test_without_evaluations_it_stays():
    work = new_work()
    work.counts[LIMIT] = 0
    n = unit(*(np.array(WAY) + 0.1 * np.array(unit(3, -4, 0))))
    place = BALLS.place(np.array(n), -0.7 * np.array(n))
    ended, _ = solved(BALLS, place, n, -0.4, work)
    assert ended.fits
    assert (ended.place, ended.normal, ended.distance) == (place, n, -0.4)
    assert ended.error > 1e-3


def polished(case, place, work=None):
    return polish(*case.both, place, work or new_work())


@pytest.mark.parametrize("gap", [1e-4, 1e-8, 1e-12])
def test_polish_gives_the_common_normal_near_contact(gap):
    case = BALLS.at(*((1.7 + gap) * np.array(WAY)))
    start = case.place(unit(*(np.array(WAY) + 1e-4)), -0.7 * np.array(WAY))
    sharp, n, place = polished(case, start)
    assert sharp
    assert n == pytest.approx(WAY, abs=1e-13)
    np.testing.assert_allclose(case.points(place)[0], WAY, atol=1e-12)


def test_polish_leaves_what_is_far_or_has_no_normal_of_its_own():
    far = BALLS.at(*((1.7 + 2.0 * NEAR_CONTACT * BALLS.size) * np.array(WAY)))
    start = far.place(np.array(WAY), -0.7 * np.array(WAY))
    work = new_work()
    sharp, _, place = polished(far, start, work)
    assert not sharp
    assert place == start
    corners = Placed(box(1.0, 1.0, 1.0), box(1.0, 1.0, 1.0), (2.0, 2.0, 2.0 + 1e-9))
    start = corners.place((1.0, 1.0, 1.0), (-1.0, -1.0, -1.0))
    sharp, _, place = polished(corners, start, work)
    assert not sharp
    assert place == start
    assert work.counts[EVALUATIONS] == 0


@pytest.mark.parametrize("distance", [1.3, 1.7, 2.0])
def test_rates_of_the_normal_and_the_points(distance):
    """B's centre moves at v: n' is its part square to n over |p|, in contact too."""
    case = BALLS.at(*(distance * np.array(WAY)))
    v, w = np.array([0.3, -0.5, 0.2]), (0.4, 0.1, -0.7)
    place = case.place(np.array(WAY), -0.7 * np.array(WAY))
    jets = pair_jets(*case.both, place)
    work = new_work()
    rate, q = contact_rates(case.pair, motion_of(case.pose, v, w), jets, WAY, distance - 1.7, work)
    n = np.array(WAY)
    expected = (v - n * (n @ v)) / distance
    np.testing.assert_allclose(rate, expected, atol=1e-13)
    slide_a = q[0] * np.array(jets[0][1]) + q[1] * np.array(jets[0][2])
    np.testing.assert_allclose(slide_a, expected, atol=1e-13)
    slide_b = q[2] * np.array(jets[1][1]) + q[3] * np.array(jets[1][2])
    carried = v + np.cross(w, -0.7 * n)
    np.testing.assert_allclose(carried + slide_b, v - 0.7 * expected, atol=1e-13)
    assert work.counts[EVALUATIONS] == 1


def test_rates_over_a_plane_of_a_point_that_touches_it():
    """No length to measure by: the foot follows the point, the normal stays."""
    case = Placed(half_space(Z, 0.0), point(), (0.0, 0.0, 0.0))
    assert pair_span(case.pair, case.pose.p, 0.0) == 0.0
    origin = (0.0, 0.0, 0.0)
    flat = Side(np.int64(0), np.int64(0), 0.0, 0.0)
    place: Place = together(flat, side_at(case.b.body, origin))
    jets = pair_jets(*case.both, place)
    rate, q = contact_rates(
        case.pair, motion_of(case.pose, (0.3, -0.5, 0.2)), jets, Z, 0.0, new_work()
    )
    assert rate == pytest.approx(origin, abs=1e-15)
    slide = q[0] * np.array(jets[0][1]) + q[1] * np.array(jets[0][2])
    np.testing.assert_allclose(slide, (0.3, -0.5, 0.0), atol=1e-14)
