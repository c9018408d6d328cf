"""The smooth cold query by its parts, as plain Python over compiled kernels: whether it finds
the distance, goes on in other charts, and gives up where it can't prove an answer."""

import numpy as np
import pytest
from hand_made_frames import flat, inputs
from hand_made_pairs import IDENTITY, Placed, ball, box, ellipsoid, turn, unit
from test_smooth_parts import look_plane, look_sphere, python_of

import standoff as so
from draws import draws
from standoff.kernels.frame import smooth, smooth_start
from standoff.kernels.frame.smooth import FACES, inside_features
from standoff.kernels.frame.smooth_start import SIDELESS, beside, has_charts, part_inside
from standoff.kernels.pair import cold_start
from standoff.kernels.pair.cold_start import at_sample, on_other_face, sample_point
from standoff.kernels.state import arrays as K
from standoff.kernels.values import NO_CHART, ORIGIN, moved, side_of

EGGS = Placed(
    ellipsoid(1.0, 0.8, 0.6), ellipsoid(0.3, 0.7, 0.5), (1.2, 0.7, 1.1), turn((1, 2, 3), 0.9)
)
BALLS = Placed(ball(1.0), ball(0.7), (0.0, 0.0, 1.7 + 1e-7))
BOX = Placed(box(1.0, 1.0, 1.0), ball(0.7), (0.2, 0.3, 3.0))
CYLINDER = so.shapes.cylinder(0.4, 0.9)


@pytest.fixture(autouse=True)
def plain(monkeypatch):
    """Those that take functions run as plain Python."""
    for module, names in (
        (smooth, ("look",)),
        (cold_start, ("nearest_of", "first_nearest", "alternating_of")),
        (
            smooth_start,
            ("look", "alternating_of", "descended_from", "smooth_start", "relative_pose"),
        ),
    ):
        for name in names:
            monkeypatch.setattr(module, name, python_of(getattr(module, name)))


def nearest(ints, reals, z, chart):
    """The nearest sample on a face, not in a chart."""
    return cold_start.nearest_of(on_other_face, ints, reals, z, ORIGIN, chart)


def started(case, looks=(look_sphere, look_sphere)):
    """(good, row) of a cold query."""
    out = np.full(K.N_OUT, np.nan)
    poses = flat(IDENTITY, (0.0, 0.0, 0.0)), flat(case.R, case.p)
    given = inputs(*poses, 6 * [0.0], 6 * [0.0], False)
    return smooth_start.smooth_start(*looks, case.pair, given, 1e-6, out), out


def test_it_answers_wherever_the_witness_points_are(rng):
    """Near the rims of charts too: points as far apart as the supporting planes square to the
    normal, which no two points of the bodies undercut."""
    charts, looks = set(), []
    for n in rng.normal(size=(draws(30), 3)):
        case = EGGS.at(*(1.9 * np.array(unit(*n))))
        good, row = started(case)
        assert good
        normal, x, y = (row[o : o + 3] for o in (K.NORMAL, K.POINT_A, K.POINT_B))
        size = 1e-12 * (case.a.body.size + case.b.body.size)
        assert row[K.DISTANCE] == pytest.approx(-case.depth(normal), abs=size)
        assert row[K.DISTANCE] == pytest.approx(np.linalg.norm(y - x), abs=size)
        np.testing.assert_allclose(y - x, row[K.DISTANCE] * normal, rtol=0.0, atol=1e3 * size)
        assert ((x / (1.0, 0.8, 0.6)) ** 2).sum() == pytest.approx(1.0, abs=1e-12)
        assert row[K.DISTANCE] - size <= row[K.LOWER_BOUND] <= row[K.DISTANCE]
        assert row[K.UPPER_BOUND] == row[K.DISTANCE]
        assert row[K.STATUS] == K.CONVERGED
        assert np.isnan(row[K.OUT_RATE : K.RESIDUAL]).all()
        charts.add(row[K.OUT_MODE + 1])
        looks.append(row[K.OUT_COUNTS])
    assert len(charts) > 3
    assert 3 <= np.mean(looks) < 8


def test_it_writes_nothing_where_it_proves_nothing():
    """Bodies in each other, all but touching, on an edge, of another kind."""
    for case, looks in (
        (EGGS.at(0.1, 0.0, 0.0), (look_sphere, look_sphere)),
        (BALLS, (look_sphere, look_sphere)),
        (BOX.at(2.0, 2.0, 2.0), (look_plane, look_sphere)),
        (EGGS, (look_plane, look_sphere)),
    ):
        good, row = started(case, looks)
        assert not good
        assert np.isnan(row).all()
    assert started(BOX, (look_plane, look_sphere))[0]


def test_only_samples_of_other_charts_on_faces_are_taken():
    ints, reals, z = CYLINDER.ints, CYLINDER.reals, (3.0, 0.2, 0.1)
    best = nearest(ints, reals, z, NO_CHART)
    first = at_sample(ints, reals, best)
    assert first.chart >= 0
    other = nearest(ints, reals, (3.0, 0.2, 3.0), first.chart)
    assert at_sample(ints, reals, other).chart not in (NO_CHART, first.chart)
    assert sample_point(ints, reals, other)[2] == pytest.approx(0.45)
    # nothing else faces a point beside the middle of its side
    lone = at_sample(ints, reals, nearest(ints, reals, z, first.chart))
    assert lone.chart != first.chart or lone.chart == NO_CHART


def test_a_point_that_leaves_its_chart_goes_on_in_another():
    ints, reals = EGGS.pair.ints_a, EGGS.pair.reals_a
    place = EGGS.place((1.0, 0.0, 0.0), (0.3, 0.0, 0.0))
    side = side_of(place, 0)
    assert beside(ints, reals, side, 0.1, 0.0, (3.0, 0.0, 0.0)) == side._replace(p=side.p + 0.1)
    y = (0.3, 3.0, 0.2)
    left = beside(ints, reals, side, 9.0, 0.0, y)
    assert left == at_sample(ints, reals, nearest(ints, reals, y, side.chart))
    assert left.chart not in (side.chart, NO_CHART)
    # from within no sample faces the point
    assert beside(ints, reals, side, 9.0, 0.0, (0.0, 0.0, 0.0)) == SIDELESS
    assert has_charts(place)
    assert not has_charts(place._replace(chart_b=NO_CHART))


def test_a_step_is_halved_until_it_stays():
    place = EGGS.place((1.0, 0.0, 0.0), (0.3, 0.0, 0.0))
    for length, halvings, part in ((0.5, 4, 1.0), (3.0, 4, 0.25), (3.0, 1, 0.0), (1e9, 4, 0.0)):
        step = (0.0, 0.0, length, 0.0)
        assert part_inside(EGGS.pair, place, step, halvings) == part
        if part:
            assert inside_features(FACES, EGGS.pair, moved(place, part, step))
