"""The smooth frame by its parts: what it sees of a chart, when it answers, and that it writes
nothing where it does not.

It takes functions, which compiled code knows by name: here it runs as plain Python over compiled
kernels.
"""

import math

import numpy as np
import pytest
from hand_made_frames import flat, inputs, motion_of, options, state_at
from hand_made_pairs import (
    IDENTITY,
    Placed,
    X,
    Z,
    ball,
    box,
    ellipsoid,
    on_atlas,
    packed,
    turn,
    unit,
    vector,
)
from numba.core.dispatcher import Dispatcher

import standoff as so
from standoff.geometry.ellipsoid_patches import ellipsoid_octants
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, chart_normal, edge_jet
from standoff.kernels.frame import smooth
from standoff.kernels.frame.record import Called
from standoff.kernels.frame.smooth import (
    EDGE_AND_FACE,
    FACES,
    inside_features,
    may_be_smooth,
    seen_as,
    seen_as_nurbs,
    seen_by,
    seen_on_line,
)
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, N_COUNTS
from standoff.kernels.state.arrays import (
    CONVERGED,
    DISTANCE,
    LOWER_BOUND,
    N_OUT,
    N_STATE,
    NORMAL,
    OUT_COUNTS,
    OUT_RATE,
    POINT_A,
    POINT_B,
    PREDICT_NONE,
    STATUS,
    VELOCITY_A,
)
from standoff.kernels.state.state import read_state, write_state
from standoff.kernels.tolerances import POLISHED, SHIFTED_GAP, SMOOTH_CORRECTIONS
from standoff.kernels.values import NO_CHART

H = 0.01
EGG = so.shapes.ellipsoid(1.0, 0.8, 0.6)


def python_of(function):
    """A kernel as plain Python."""
    return function.py_func if isinstance(function, Dispatcher) else function


@pytest.fixture(autouse=True)
def plain(monkeypatch):
    """Those that take functions run as plain Python."""
    for name in ("look", "descended", "smooth_frame"):
        monkeypatch.setattr(smooth, name, python_of(getattr(smooth, name)))


def look_sphere(ints, reals, chart, u, v):
    return seen_as(L.SPHERE, ints, reals, chart, u, v)


def look_plane(ints, reals, chart, u, v):
    return seen_as(L.PLANE, ints, reals, chart, u, v)


def test_a_chart_of_its_kind_is_seen_as_it_is():
    for u, v in ((0.0, 0.0), (0.3, -0.7)):
        seen = seen_as(L.SPHERE, *packed(EGG), 2, u, v)
        assert seen.fits
        assert seen.jet == chart_jet(*packed(EGG), 2, u, v)
        assert seen.cone.first == pytest.approx(chart_normal(*packed(EGG), 2, u, v), abs=1e-15)
        assert seen.cone.noise == 0.0
        gradient = np.array(seen.jet[0]) / np.array([1.0, 0.64, 0.36])
        assert seen.cone.first == pytest.approx(unit(*gradient), abs=1e-14)
    assert not seen_as(L.PLANE, *packed(EGG), 2, 0.0, 0.0).fits
    assert not seen_as(L.SPHERE, *packed(so.shapes.box(1.0, 1.0, 1.0)), 2, 0.0, 0.0).fits


def test_a_collapsed_tangent_does_not_fit():
    """At a cone's apex the tangent round it is gone."""
    cone = so.shapes.cone(0.6, 1.5)
    side = next(
        k
        for k in range(cone.ints[L.N_CHARTS])
        if cone.ints[L.chart_record(cone.ints, k) + L.CHART_KIND] == L.CONE
    )
    o = cone.ints[L.chart_record(cone.ints, side) + L.CHART_REALS]
    jet = chart_jet(*packed(cone), side, 0.3, 0.5)
    assert seen_by(L.CONE, cone.reals, o, jet).fits
    for column in (1, 2):
        gone = tuple((0.0, 0.0, 0.0) if k == column else x for k, x in enumerate(jet))
        assert not seen_by(L.CONE, cone.reals, o, gone).fits


@pytest.mark.parametrize("degree", [3, 4])
def test_a_nurbs_fits_its_own_degree_alone(degree):
    """It is seen as by the general jet, and outward."""
    patches = ellipsoid_octants(1.0, 0.8, 0.6)
    body = so.Body.from_patches([patch.elevated(degree, degree) for patch in patches])
    for d in (2, 3, 4, 5):
        assert seen_as_nurbs(d, *packed(body), 0, 0.4, 0.3).fits == (d == degree)
    seen = seen_as_nurbs(degree, *packed(body), 0, 0.4, 0.3)
    for mine, general in zip(seen.jet, chart_jet(*packed(body), 0, 0.4, 0.3), strict=True):
        assert mine == pytest.approx(general, abs=1e-13)
    gradient = np.array(seen.jet[0]) / np.array([1.0, 0.64, 0.36])
    assert seen.cone.first == pytest.approx(unit(*gradient), abs=1e-12)
    assert 0.0 < seen.cone.noise < 1e-13
    mixed = so.Body.from_patches([patch.elevated(3, 4) for patch in patches])
    assert not any(seen_as_nurbs(d, *packed(mixed), 0, 0.4, 0.3).fits for d in (3, 4))
    assert not seen_as_nurbs(2, *packed(EGG), 0, 0.4, 0.3).fits


BALLS = Placed(ball(1.0), ball(0.7), (0.0, 0.0, 2.0))


def over(angle, distance=2.0):
    """The second ball at an angle from z about y."""
    return BALLS.at(distance * math.sin(angle), 0.0, distance * math.cos(angle))


def before_of(case, **known):
    n = np.array(unit(*case.p))
    gap = float(np.linalg.norm(case.p)) - 1.7
    told = {"motion": motion_of(case.pose), "normal": vector(n), "distance": gap, "lower": gap}
    return state_at(case.place(n, -0.7 * n), **(told | known))


def test_points_are_inside_where_both_are_central():
    place = BALLS.place((0.0, 0.0, 1.0), (0.0, 0.0, -0.7))
    assert inside_features(FACES, BALLS.pair, place)
    assert not inside_features(FACES, BALLS.pair, place._replace(u=1.3))
    assert not inside_features(FACES, BALLS.pair, place._replace(s=-1.3))
    cube = Placed(box(1.0, 1.0, 1.0), ball(0.7), (0.0, 0.0, 2.0))
    top = cube.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.7))
    assert inside_features(FACES, cube.pair, top)
    assert not inside_features(FACES, cube.pair, top._replace(u=1.001))


def test_only_a_frame_on_faces_and_apart_may_be_smooth():
    near = SHIFTED_GAP * 2.0 * 1.7 * math.sqrt(3.0)
    allowed = before_of(BALLS, distance=1.001 * near)
    assert may_be_smooth(FACES, BALLS.pair, allowed)
    for known in ({"distance": 0.999 * near}, {"lost": True}, {"inside": True}, {"cut": 1}):
        assert not may_be_smooth(FACES, BALLS.pair, allowed._replace(**known)), known
    cube = Placed(box(1.0, 1.0, 1.0), ball(0.7), (0.0, 0.0, 3.0))
    corner = cube.place((1.0, 1.0, 1.0), (0.0, 0.0, -0.7))
    assert not may_be_smooth(FACES, cube.pair, state_at(corner, distance=1.0))
    swapped = Placed(cube.b, cube.a, (0.0, 0.0, 3.0))
    corner = swapped.place((0.0, 0.0, 0.7), (1.0, 1.0, -1.0))
    assert not may_be_smooth(FACES, swapped.pair, state_at(corner, distance=1.0))


def descended(
    case, place, most=SMOOTH_CORRECTIONS, tolerance=1e-10, looks=(look_sphere, look_sphere)
):
    motion = motion_of(case.pose)
    return smooth.descended(*looks, FACES, case.pair, motion, place, tolerance, most)


def test_it_descends_to_the_nearest_points():
    case = over(0.002)
    done, corrections, place, looked, rates = descended(case, before_of(over(0.0)).place)
    assert done
    assert 1 <= corrections <= 2
    np.testing.assert_allclose(case.gap(place), 0.3 * np.array(unit(*case.p)), atol=1e-9)
    np.testing.assert_allclose(looked.jets[0][0], case.points(place)[0], atol=1e-15)
    assert rates == (0.0, 0.0, 0.0, 0.0)


def test_it_gives_up_beyond_its_corrections_and_off_the_faces():
    start = before_of(over(0.0)).place
    eggs = Placed(ellipsoid(1.0, 0.8, 1.0), ellipsoid(0.7, 0.5, 0.7), (0.5, 0.3, 1.9))
    assert not descended(eggs, start, most=1)[0]
    done, corrections, place, _, _ = descended(eggs, start, most=9)
    assert done
    assert corrections > 1
    gap = eggs.gap(place)
    assert eggs.rises_around(unit(*gap))
    assert np.linalg.norm(gap) == pytest.approx(-eggs.depth(unit(*gap)), abs=1e-12)
    cube = Placed(box(1.0, 1.0, 1.0), ball(0.7), (1.5, 0.0, 2.5))
    top = cube.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.7))
    assert not descended(cube, top, looks=(look_plane, look_sphere))[0]
    assert not descended(cube, top)[0]  # of another kind
    inside = cube.at(0.3, 0.0, 2.5)
    assert descended(inside, top, looks=(look_plane, look_sphere))[0]
    # points that touch have no direction
    touching = over(0.0, 1.7)
    assert not descended(touching, start)[0]


def framed(case, before, told=True, law=None, rate=0.2):
    """(answered, state, out) of a frame in which B goes round A at `rate` about y."""
    state, out = np.zeros(N_STATE), np.full(N_OUT, np.nan)
    write_state(before, state)
    given = inputs(
        flat(IDENTITY, (0.0, 0.0, 0.0)),
        flat(case.R, case.p),
        6 * [0.0],
        [*np.cross((0.0, rate, 0.0), case.p), 0.0, 0.0, 0.0],
        told,
    )
    law = law or options()
    looks = look_sphere, look_sphere
    call = Called(case.pair, given, law, state, out, None)
    answered = smooth.smooth_frame(*looks, FACES, call, H)
    return answered, state, out


@pytest.mark.parametrize("told", [True, False])
def test_a_smooth_frame_is_answered_whole(told):
    case, before = over(0.002), before_of(over(0.0), time=1.0)
    answered, state, out = framed(case, before, told)
    assert answered == 1
    n = np.array(unit(*case.p))
    assert out[STATUS] == CONVERGED
    assert out[DISTANCE] == pytest.approx(0.3, abs=1e-12)
    assert 0.3 - 1e-10 < out[LOWER_BOUND] <= out[DISTANCE]
    np.testing.assert_allclose(out[NORMAL : NORMAL + 3], n, atol=1e-9)
    np.testing.assert_allclose(out[POINT_A : POINT_A + 3], n, atol=1e-9)
    np.testing.assert_allclose(out[POINT_B : POINT_B + 3], 1.3 * n, atol=1e-9)
    if told:
        assert out[OUT_RATE] == pytest.approx(0.0, abs=1e-12)
        # round A at 0.2 rad/s
        np.testing.assert_allclose(
            out[VELOCITY_A : VELOCITY_A + 3], [0.2 * n[2], 0.0, -0.2 * n[0]], atol=1e-6
        )
    else:
        assert math.isnan(out[OUT_RATE])
    counts = out[OUT_COUNTS : OUT_COUNTS + N_COUNTS]
    assert counts[EVALUATIONS] == counts[CORRECTIONS] == counts.sum() / 2.0
    assert 1 <= counts[EVALUATIONS] <= SMOOTH_CORRECTIONS
    after = read_state(state)
    assert (after.time, after.last_step) == (1.0 + H, H)
    assert after.distance == out[DISTANCE]
    assert (after.fed, after.history) == (told, 1)
    assert not after.inside
    assert not after.lost


def test_where_it_does_not_answer_it_writes_nothing():
    assert POLISHED * BALLS.size > 5e-5
    assert framed(over(1e-4, 1.7 + 7e-5), before_of(over(0.0)), law=options(PREDICT_NONE))[0] == 1
    case, before = over(0.002), before_of(over(0.0))
    axis_b = on_atlas(BALLS.b.body, (0.7, 0.0, 0.0))
    far = case.place((0.0, 0.0, -1.0), (0.0, 0.0, 0.7))
    beside = before.place._replace(feature_b=axis_b.feature, chart_b=axis_b.chart, r=1.3, s=0.0)
    refused = {
        "lost": (case, before._replace(lost=True), options()),
        "no evaluations": (case, before, options(deadline=0)),
        "too far": (over(3.0), before, options(PREDICT_NONE)),
        "predicted off its face": (
            case,
            before._replace(history=1, rates=(200.0, 0.0, 0.0, 0.0)),
            options(),
        ),
        "off its face": (case, before._replace(place=beside), options()),
        "on far sides": (case, before._replace(place=far), options(PREDICT_NONE)),
        "polish": (over(1e-4, 1.7 + 5e-5), before, options(PREDICT_NONE)),
    }
    for name, (pair, known, law) in refused.items():
        answered, state, out = framed(pair, known, law=law)
        assert answered == 0, name
        same = np.zeros(N_STATE)
        write_state(known, same)
        np.testing.assert_array_equal(state, same, err_msg=name)
        assert np.isnan(out).all(), name


def test_the_certificate_is_that_of_both_normals():
    """Planes and balls: the bound is the distance but for roundoff."""
    cube = Placed(box(1.0, 1.0, 1.0), ball(0.7), (0.2, 0.1, 2.5), turn(Z, 0.3))
    place = cube.place((0.2, 0.1, 1.0), (0.0, 0.0, -0.7))
    looked = smooth.look(look_plane, look_sphere, cube.pair, cube.pose, place)
    assert looked.fits
    assert looked.cones.a.first == Z
    np.testing.assert_allclose(looked.cones.b.first, (0.0, 0.0, -1.0), atol=1e-15)
    np.testing.assert_allclose(looked.cones.gap, (0.0, 0.0, 0.8), atol=1e-14)
    assert looked.cones.y_b == pytest.approx((0.0, 0.0, -0.7), abs=1e-15)
    assert not smooth.look(look_sphere, look_sphere, cube.pair, cube.pose, place).fits
    assert not smooth.look(look_plane, look_plane, cube.pair, cube.pose, place).fits


BRICK = Placed(box(1.0, 1.0, 1.0), ball(0.7), (2.0, 0.0, 2.0))
"""The ball is nearest to the edge x = z = 1, and no farther from one of its faces."""


def edge_of(ints, reals):
    """The edge along y at x = z = 1."""
    for edge in range(ints[L.N_FACES], ints[L.N_FACES] + ints[L.N_EDGES]):
        x, t, _ = edge_jet(ints, reals, edge, 0.5)
        if x[0] == x[2] == 1.0 and t[0] == t[2] == 0.0:
            return edge
    raise LookupError


def on_edge(case):
    ints, reals = case.pair.ints_a, case.pair.reals_a
    towards = unit(1.0 - case.p[0], -0.1, 1.0 - case.p[2])
    place = case.place((1.0, 0.0, 1.0), tuple(0.7 * np.array(towards)))
    return place._replace(feature_a=edge_of(ints, reals), chart_a=NO_CHART, u=0.4, v=0.0)


def test_a_straight_edge_is_seen_with_the_normals_of_its_faces():
    ints, reals = BRICK.pair.ints_a, BRICK.pair.reals_a
    edge = edge_of(ints, reals)
    seen = seen_on_line(ints, reals, edge, 0.4, 0.0)
    assert seen.fits
    assert seen.jet[:2] == edge_jet(ints, reals, edge, 0.4)[:2]
    assert {seen.cone.first, seen.cone.last} == {X, Z}
    inward = {tuple(-np.array(n)) for n in (X, Z)}
    assert {tuple(np.array(way) + 0.0) for way in seen.ways} == inward
    rim = so.shapes.cylinder(0.4, 0.9)
    arc = next(k for k in range(rim.n_faces, rim.n_faces + rim.n_edges))
    assert not seen_on_line(*packed(rim), arc, 0.3, 0.0).fits


def test_an_edge_is_held_where_neither_face_falls():
    """Beside the edge's wedge the frame leaves the faces to the general one."""
    looks = seen_on_line, look_sphere

    def ended(case):
        motion, start = motion_of(case.pose), on_edge(case)
        return smooth.descended(*looks, EDGE_AND_FACE, case.pair, motion, start, 1e-10, 9)

    done, _, place, looked, _ = ended(BRICK)
    assert done
    gap = BRICK.gap(place)
    assert np.linalg.norm(gap) == pytest.approx(math.sqrt(2.0) - 0.7, abs=1e-12)
    assert looked.cones.x_a == pytest.approx((1.0, 0.0, 1.0), abs=1e-9)
    assert ended(BRICK.at(1.001, 0.0, 2.0))[0]
    assert ended(BRICK.at(2.0, 0.0, 1.001))[0]
    assert not ended(BRICK.at(0.999, 0.0, 2.0))[0]
    assert not ended(BRICK.at(2.0, 0.0, 0.999))[0]
    assert not ended(BRICK.at(2.0, 1.001, 2.0))[0]  # beyond its end
