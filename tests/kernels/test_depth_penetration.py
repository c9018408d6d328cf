"""Steps of the depth's descent and Newton's method there: balls, boxes and hand-made jets."""

import math

import numpy as np
import pytest
from hand_made import new_work
from hand_made_pairs import (
    Placed,
    X,
    Y,
    Z,
    ball,
    box,
    ellipsoid,
    half_space,
    packed,
    pair_of,
    point,
    segment,
    turn,
    unit,
    vector,
)

import standoff as so
from standoff.kernels.depth.penetration import (
    CUT_OFF,
    MINIMUM,
    NOTHING,
    SADDLE,
    UP,
    begin_along,
    box_depth,
    box_support,
    contact_scale,
    from_last,
    is_planar,
    minimum_along,
    plane_normal,
    principal_radii,
    radii,
    shifted,
    stationary_along,
    tangents,
    wall_height,
)
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import LIMIT, RESTARTS
from standoff.kernels.tolerances import FLAT_RADIUS, MAX_RESTARTS, NEWTON_TURN, SHIFTED_GAP
from standoff.kernels.values import Depth

TOLERANCE = 1e-10
P = (0.4, 0.3, 1.2)
"""Where the second ball stands: 1.3 from the first."""
BALLS = Placed(ball(1.0), ball(0.7), P)
WAY = unit(*P)
"""The only local minimum of their depth, 1.7 - 1.3."""
DIRECTIONS = [X, Y, Z, unit(-1, 2, -3), unit(0.61, -0.6, 0.5), unit(-1, 1e-9, 0)]


def poles(case: Placed, n=WAY):
    """The place of two balls' points farthest along n and -n."""
    r_a, r_b = (solid.support(np.array(X)) for solid in (case.a, case.b))
    return case.place(r_a * np.array(n), -r_b * np.array(n))


def along(case: Placed, n, distance=None) -> Depth:
    """A direction of two balls with its points, and their distance along it."""
    return Depth(False, -case.depth(n) if distance is None else distance, n, poles(case, n))


def test_the_scale_is_of_both_sizes_and_radii():
    cube = box(1.0, 1.0, 1.0)
    assert contact_scale(Placed(cube, point(), X).pair) == pytest.approx(math.sqrt(12.0))
    assert contact_scale(Placed(cube, point(0.5), X).pair) == pytest.approx(math.sqrt(12.0) + 0.5)
    assert contact_scale(Placed(point(0.25), point(0.5), X).pair) == 0.75
    assert contact_scale(Placed(point(), point(), X).pair) == 1.0


def test_a_pair_is_planar_where_either_body_is():
    loop = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
    solid = so.shapes.box(1.0, 1.0, 1.0)
    dot = so.shapes.point()
    assert is_planar(pair_of(loop, loop))
    assert is_planar(pair_of(loop, dot))
    assert is_planar(pair_of(dot, loop))
    assert not is_planar(pair_of(solid, dot))


def test_the_box_supports_at_least_as_far_as_the_core():
    """A diagonal segment's box has the corners (1, 2, 3) and (4, 5, 7)."""
    line = segment((1.0, 2.0, 3.0), (4.0, 5.0, 7.0))
    reals = line.body.reals
    assert box_support(reals, X) == 4.0
    assert box_support(reals, (-1.0, 0.0, 0.0)) == -1.0
    assert box_support(reals, (1.0, -1.0, 2.0)) == pytest.approx(4.0 - 2.0 + 14.0)
    for n in DIRECTIONS:
        assert box_support(reals, n) >= line.support(np.array(n)) - 1e-15
        egg = ellipsoid(1.0, 0.8, 0.6)
        assert box_support(egg.body.reals, n) >= egg.support(np.array(n)) - 1e-15


def test_a_wall_is_as_high_as_its_plane():
    for n, offset in ((Z, 0.3), (unit(1, 2, 2), -1.5)):
        wall = half_space(n, offset)
        assert wall_height(*packed(wall.body), n) == pytest.approx(offset, abs=1e-15)


def test_boxes_bound_the_depth_along_any_direction():
    """Aligned ones are it; of others, and of curved bodies, they are more."""
    aligned = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), (1.0, 0.2, -0.3))
    turned = Placed(box(1.0, 0.8, 0.6), ellipsoid(0.3, 0.4, 0.5), P, turn((1, 2, 3), 0.7))
    for n in DIRECTIONS:
        assert box_depth(*aligned.both, n) == pytest.approx(aligned.depth(n), abs=1e-15)
        assert box_depth(*turned.both, n) >= turned.depth(n) - 1e-15
    assert box_depth(*turned.both, WAY) > turned.depth(WAY) + 0.1


def test_over_a_half_space_there_is_one_direction():
    """B's plane has the normal (1, 2, 2) / 3 in its own frame, which stands turned."""
    n, R = unit(1, 2, 2), turn((3, -1, 1), 0.8)
    wall, cube = half_space(n, 0.3), box(1.0, 1.0, 1.0)
    under = Placed(wall, cube, (0.5, 0.0, 1.0), R)
    assert plane_normal(*under.both) == (True, pytest.approx(n, abs=1e-15))
    over = Placed(cube, wall, (0.5, 0.0, 1.0), R)
    toward = vector(-np.array(R).reshape(3, 3) @ n)
    assert plane_normal(*over.both) == (True, pytest.approx(toward, abs=1e-15))
    assert plane_normal(*BALLS.both) == (False, UP)
    for case, way in ((under, n), (over, toward)):
        assert box_depth(*case.both, way) >= case.depth(way) - 1e-15


def test_it_begins_at_the_corners_farthest_along_a_direction():
    case = Placed(box(1.0, 0.8, 0.6), box(0.3, 0.4, 0.5), P, turn((1, 2, 3), 0.7))
    for n in DIRECTIONS:
        place = begin_along(*case.both, n)
        assert -float(np.dot(n, case.gap(place))) == pytest.approx(case.depth(n), abs=1e-14)


def test_tangents_are_square_to_the_normal_and_to_each_other():
    for n in DIRECTIONS:
        e, f = tangents(n)
        frame = np.array([n, e, f])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)


def bent(F, S, z=0.0):
    """The jet of a surface below its tangent plane z, of the tangents F (2, 2) in that plane and
    the shape operator S (2, 2) there: x.Sx = 2 (z - height)."""
    F, S = np.array(F, dtype=float), np.array(S, dtype=float)
    B = F.T @ S @ F
    second = (-B[0, 0], -B[0, 1], -B[1, 1])
    return (
        (0.0, 0.0, z),
        (*F[:, 0].tolist(), 0.0),
        (*F[:, 1].tolist(), 0.0),
        *((0.0, 0.0, float(b)) for b in second),
    )


@pytest.mark.parametrize("F", [np.eye(2), [[2.0, 0.0], [0.0, 0.1]], [[1.0, 0.9], [-0.3, 0.5]]])
def test_radii_of_a_face_are_the_inverse_of_its_shape_operator(F):
    S = np.array([[2.0, 0.5], [0.5, 1.0]])
    inverse = np.linalg.inv(S)
    expected = inverse[0, 0], inverse[0, 1], inverse[1, 1]
    assert radii(bent(F, S), Z, X, Y, 1e12) == pytest.approx(expected, rel=1e-9)


def test_radii_of_edges_vertices_and_planes():
    """A circle of radius 0.5, seen at 60 degrees from its plane, turns as one of radius 1."""
    circle = (
        (0.0, 0.0, 0.0),
        X,
        (0.0, 0.0, 0.0),
        (0.0, 0.0, -2.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
    )
    leaning = unit(0.0, math.sqrt(3.0), 1.0)
    e, f = X, vector(np.cross(leaning, X))
    assert radii(circle, leaning, e, f, 1e12) == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)
    mixed = radii(circle, Z, unit(1, 1, 0), unit(-1, 1, 0), 1e12)
    assert mixed == pytest.approx((0.25, -0.25, 0.25), abs=1e-15)
    corner = (X, *5 * ((0.0, 0.0, 0.0),))
    assert radii(corner, Z, X, Y, 1e12) == (0.0, 0.0, 0.0)
    flat = 1e6
    assert radii(bent(np.eye(2), np.zeros((2, 2))), Z, X, Y, flat) == pytest.approx(
        (flat, 0.0, flat), rel=1e-6
    )
    straight = (X, Y, *4 * ((0.0, 0.0, 0.0),))
    assert radii(straight, Z, X, Y, flat) == pytest.approx((0.0, 0.0, flat))


def test_principal_radii_are_those_of_both_bodies_together():
    """At its pole along z an ellipsoid has the radii a²/c along x and b²/c along y."""
    case = Placed(ellipsoid(1.0, 0.8, 0.5), ellipsoid(0.6, 0.9, 0.3), (0.0, 0.0, 0.7))
    jets = pair_jets(*case.both, case.place((0.0, 0.0, 0.5), (0.0, 0.0, -0.3)))
    least, way, most, other = principal_radii(case.pair, *jets, Z, case.size)
    along_x, along_y = 1.0 / 0.5 + 0.36 / 0.3, 0.64 / 0.5 + 0.81 / 0.3
    assert (least, most) == pytest.approx((along_x, along_y), rel=1e-9)
    assert np.abs(way) == pytest.approx(X, abs=1e-9)
    assert np.abs(other) == pytest.approx(Y, abs=1e-9)
    swapped = Placed(ellipsoid(0.8, 1.0, 0.5), ellipsoid(0.9, 0.6, 0.3), (0.0, 0.0, 0.7))
    jets = pair_jets(*swapped.both, swapped.place((0.0, 0.0, 0.5), (0.0, 0.0, -0.3)))
    assert np.abs(principal_radii(swapped.pair, *jets, Z, case.size)[1]) == pytest.approx(
        Y, abs=1e-9
    )


def test_principal_radii_of_a_turned_pair_are_eigenvectors():
    S, T = np.diag([1.0, 3.0]), np.array([[1.0, 0.4], [0.4, 0.6]])
    of_b = tuple(vector(-np.array(x)) if k > 2 else x for k, x in enumerate(bent(np.eye(2), T)))
    least, way, most, other = principal_radii(BALLS.pair, bent(np.eye(2), S), of_b, Z, 1.0)
    total = np.linalg.inv(S) + np.linalg.inv(T)
    values, vectors = np.linalg.eigh(total)
    assert (least, most) == pytest.approx(values, rel=1e-9)
    assert abs(np.dot(way[:2], vectors[:, 0])) == pytest.approx(1.0, abs=1e-9)
    assert abs(np.dot(other[:2], vectors[:, 1])) == pytest.approx(1.0, abs=1e-9)


def test_in_the_plane_there_is_one_radius():
    """A disc of radius 1 and a point: the way lies in the plane."""
    loop = so.shapes.planar_loop([so.geometry.ConicArc((0, 0), (1, 0), (0, 1), 0, 2 * np.pi)])
    pair = pair_of(loop, so.shapes.point())
    rim = (X, Y, (0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    dot = (X, *5 * ((0.0, 0.0, 0.0),))
    least, way, most, other = principal_radii(pair, rim, dot, X, 1.0)
    assert least == pytest.approx(1.0)
    assert (most, other) == (math.inf, UP)
    assert np.abs(way) == pytest.approx(Y)
    assert FLAT_RADIUS > 1e6


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.5, 1.2])
@pytest.mark.parametrize("gap", [SHIFTED_GAP, 0.5])
def test_a_step_of_two_balls_leads_where_they_are_nearest_when_shifted_out(angle, gap):
    """Shifted by T = (g - d) n the centres are p + T apart, and that is the next direction."""
    n = vector(np.cos(angle) * np.array(WAY) + np.sin(angle) * np.array(unit(3, -4, 0)))
    start = along(BALLS, n)
    shift = (gap * contact_scale(BALLS.pair) - start.distance) * np.array(n)
    out = unit(*(np.array(P) + shift))
    apart, step = shifted(*BALLS.both, start, gap, new_work())
    assert apart
    assert step.normal == pytest.approx(out, abs=1e-12)
    assert step.distance == pytest.approx(-BALLS.depth(out), abs=1e-12)
    assert step.distance >= start.distance - 1e-12
    assert not step.found
    np.testing.assert_allclose(BALLS.points(step.place)[0], out, atol=1e-11)


def test_a_guess_that_is_too_great_leaves_the_bodies_overlapping():
    apart, step = shifted(*BALLS.both, along(BALLS, WAY, 0.5), SHIFTED_GAP, new_work())
    assert not apart
    assert (step.distance, step.normal) == (0.5, WAY)


def test_a_step_without_evaluations_left_keeps_its_direction():
    work = new_work()
    work.counts[LIMIT] = 0
    n = unit(*(np.array(WAY) + 0.1 * np.array(unit(3, -4, 0))))
    apart, step = shifted(*BALLS.both, along(BALLS, n), SHIFTED_GAP, work)
    assert not apart
    assert (step.distance, step.normal) == (-BALLS.depth(n), n)


@pytest.mark.parametrize(("restarts", "made"), [(0, 1), (MAX_RESTARTS, 0)])
def test_points_on_far_sides_start_anew_while_restarts_are_left(restarts, made):
    """The points of both balls farthest from each other are stationary too."""
    far = Depth(False, -BALLS.depth(WAY), WAY, poles(BALLS, vector(-np.array(WAY))))
    work = new_work()
    work.counts[RESTARTS] = restarts
    _, step = shifted(*BALLS.both, far, SHIFTED_GAP, work)
    assert work.counts[RESTARTS] == restarts + made
    right = np.linalg.norm(BALLS.points(step.place)[0] - WAY) < 1e-9
    assert right == bool(made)


def test_newtons_method_ends_at_the_stationary_direction():
    n = unit(*(np.array(WAY) + 0.2 * np.array(unit(3, -4, 0))))
    start = along(BALLS, n)
    kind, ended, _ = stationary_along(*BALLS.both, start, TOLERANCE, new_work())
    assert kind == MINIMUM
    assert ended.found
    assert ended.normal == pytest.approx(WAY, abs=1e-12)
    assert ended.distance == pytest.approx(1.3 - 1.7, abs=1e-12)
    np.testing.assert_allclose(BALLS.gap(ended.place), -0.4 * np.array(WAY), atol=1e-11)
    assert minimum_along(*BALLS.both, start, TOLERANCE, new_work())[:2] == (kind, ended)


def test_beyond_the_focal_depth_it_is_no_minimum():
    """Against the way s(n) is greatest: 1.7 + 1.3, more than both radii of curvature together."""
    back = vector(-np.array(WAY))
    kind, ended, way = stationary_along(*BALLS.both, along(BALLS, back), TOLERANCE, new_work())
    assert kind == SADDLE
    assert not ended.found
    assert ended.distance == pytest.approx(-3.0, abs=1e-12)
    assert np.dot(way, back) == pytest.approx(0.0, abs=1e-12)
    assert minimum_along(*BALLS.both, along(BALLS, back), TOLERANCE, new_work())[0] == SADDLE


def test_an_ellipsoid_s_middle_axis_is_a_saddle_that_falls_towards_the_least():
    """s(n) of two concentric ellipsoids is |a n| + |b n|: stationary along every axis."""
    case = Placed(ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.5, 0.4, 0.3), (0.0, 0.0, 0.0))
    for n, depth, expected in ((X, 1.5, SADDLE), (Y, 1.2, SADDLE), (Z, 0.9, MINIMUM)):
        start = Depth(
            False,
            -depth,
            n,
            case.place(
                0.0 + case.a.support(np.array(n)) * np.array(n),
                -case.b.support(np.array(n)) * np.array(n),
            ),
        )
        kind, ended, way = stationary_along(*case.both, start, TOLERANCE, new_work())
        assert kind == expected
        assert ended.distance == pytest.approx(-depth, abs=1e-12)
        if expected == SADDLE:
            assert abs(way[2]) == pytest.approx(1.0, abs=1e-9)


def test_an_end_deeper_than_the_start_is_nothing():
    """What is asked for is no deeper than the start, which claims 0.1 here."""
    start = along(BALLS, WAY, -0.1)
    kind, ended, _ = stationary_along(*BALLS.both, start, TOLERANCE, new_work())
    assert kind == NOTHING
    assert not ended.found
    kind, ended, _ = minimum_along(*BALLS.both, start, TOLERANCE, new_work())
    assert (kind, ended) == (NOTHING, start)


def test_a_step_that_leaves_its_feature_is_nothing():
    """The ball stands beside the top of the box: no point of the top is below it."""
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (2.5, 0.0, 1.2))
    start = Depth(False, -10.0, Z, case.place((0.5, 0.0, 1.0), (0.0, 0.0, -0.5)))
    assert stationary_along(*case.both, start, TOLERANCE, new_work())[0] == NOTHING
    over = case.at(0.7, 0.0, 1.2)
    kind, ended, _ = stationary_along(*over.both, start, TOLERANCE, new_work())
    assert kind == MINIMUM
    assert ended.distance == pytest.approx(1.2 - 1.0 - 0.5, abs=1e-12)


def test_without_evaluations_left_it_is_cut_off():
    work = new_work()
    work.counts[LIMIT] = 0
    n = unit(*(np.array(WAY) + 0.1 * np.array(unit(3, -4, 0))))
    start = along(BALLS, n)
    assert stationary_along(*BALLS.both, start, TOLERANCE, work)[0] == CUT_OFF
    assert minimum_along(*BALLS.both, start, TOLERANCE, work)[:2] == (NOTHING, start)
    found = from_last(*BALLS.both, start, TOLERANCE, work)
    assert not found.found
    assert math.isnan(found.distance)


def test_over_a_half_space_the_plane_gives_the_direction():
    """To the bit, as any other bounds nothing; Newton's own is off it by roundoff."""
    m = unit(1, 2, 3)
    tilted = Placed(half_space(m, 0.3), ball(0.5), vector(0.6 * np.array(m)))
    leaning = unit(*np.add(m, (0.1, 0.0, 0.0)))
    start = Depth(False, -1.0, leaning, tilted.over_plane(-0.5 * np.array(m)))
    kind, ended, _ = stationary_along(*tilted.both, start, TOLERANCE, new_work())
    assert kind == MINIMUM
    assert ended.normal == plane_normal(*tilted.both)[1]
    assert ended.distance == pytest.approx(0.6 - 0.5 - 0.3, abs=1e-15)
    case = Placed(half_space(Z, 0.3), ball(0.5), (0.1, -0.2, 0.6))
    start = Depth(False, -1.0, unit(0.1, 0.0, 1.0), case.over_plane((0.0, 0.0, -0.5)))
    kind, ended, _ = stationary_along(*case.both, start, TOLERANCE, new_work())
    assert kind == MINIMUM
    assert ended.normal == Z
    assert ended.distance == pytest.approx(0.6 - 0.5 - 0.3, abs=1e-15)


def test_from_the_last_frame_the_minimum_is_found_where_it_is_near():
    near = unit(*(np.array(WAY) + 0.5 * NEWTON_TURN * np.array(unit(3, -4, 0))))
    found = from_last(*BALLS.both, along(BALLS, near), TOLERANCE, new_work())
    assert found.found
    assert found.normal == pytest.approx(WAY, abs=1e-12)
    assert found.distance == pytest.approx(-0.4, abs=1e-12)


def test_a_minimum_far_from_the_last_frame_s_is_left_to_the_descent():
    """Over a box's top Newton's method gets to its normal from anywhere."""
    case = Placed(box(1.0, 1.0, 1.0), ball(0.5), (0.0, 0.0, 1.2))
    place = case.place((0.3, 0.0, 1.0), (0.0, 0.0, -0.5))
    for turned, near in ((0.5, True), (2.0, False)):
        last = Depth(False, math.nan, unit(turned * NEWTON_TURN, 0.0, 1.0), place)
        found = from_last(*case.both, last, TOLERANCE, new_work())
        assert found.found == near
        if near:
            assert found.distance == pytest.approx(-0.3, abs=1e-12)
        else:
            assert math.isnan(found.distance)
            assert (found.normal, found.place) == (last.normal, place)
