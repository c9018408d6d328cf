"""The descent by hand, on a box and a point: Armijo's rule, boundaries held, the multipliers."""

import math

import numpy as np
import pytest
from hand_made import (
    BOX,
    CORNER,
    CORNER_AT,
    EDGE,
    FACES,
    TOP,
    at_vertex,
    beside,
    new_work,
    on_edge,
    on_top,
    place_of,
    unit,
)

from standoff.kernels.pair.descent import (
    CONTACT,
    EXHAUSTED,
    NO_EDGE,
    STATIONARY,
    Step,
    advance,
    line_search,
    release_along,
    settle,
)
from standoff.kernels.pair.events import (
    BODY,
    CORRECTIONS,
    EVALUATIONS,
    EVENTS,
    LIMIT,
    SLOPE_COLUMN,
    SOURCE,
    TARGET,
    VALUE,
)
from standoff.kernels.tolerances import ARMIJO, MAX_HALVINGS
from standoff.kernels.values import resting

SLOPE_FLOOR = 1e-10
ABOVE = (0.0, 0.0, 3.0)


def along_x(start: float, change: float, descent: float | None = None) -> tuple[tuple, Step]:
    """A place on the top at x = start below a point at (0, 0, 3), and a step along x.

    E(s) = (4 + (start + s change)²) / 2, so g.step is start change unless it is given.
    """
    energy = 0.5 * (4.0 + start * start)
    slope = start * change if descent is None else descent
    return place_of(on_top(start, 0.0)), Step((0.0, change, 0.0, 0.0), energy, slope, 0.0, 0)


@pytest.mark.parametrize(
    ("change", "share"), [(-0.5, 1.0), (-0.9, 1.0), (-1.1, 0.5), (-5.0, 0.125)]
)
def test_a_step_is_halved_until_it_falls_enough(change, share):
    """From 0.5 the whole of -0.5 is Newton's; -5 overshoots until an eighth of it is left."""
    place, step = along_x(0.5, change)
    s, ok, on_step, trial, jets = line_search(*beside(ABOVE), place, step, 1.0)
    assert (s, ok, on_step) == (share, True, True)
    assert trial.v == pytest.approx(0.5 + share * change, abs=1e-15)
    assert jets[0][0] == pytest.approx((0.5 + share * change, 0.0, 1.0), abs=1e-15)


def test_it_must_fall_by_armijo_s_share_of_the_slope():
    """A step of 2 (1 - c) start lowers E by c's share of what the slope promises, no more."""
    for c, whole in ((0.5 * ARMIJO, False), (2.0 * ARMIJO, True)):
        # E(0) - E(1) = start² (1 - (1 - 2 (1 - c))²) / 2 = 2 c (1 - c) start²
        place, step = along_x(0.5, -2.0 * (1.0 - c) * 0.5)
        s, ok, *_ = line_search(*beside(ABOVE), place, step, 1.0)
        assert ok
        assert (s == 1.0) is whole


def test_a_step_uphill_is_none():
    place, step = along_x(0.5, 0.3, descent=-0.15)
    s, ok, *_ = line_search(*beside(ABOVE), place, step, 1.0)
    assert not ok
    assert s == 0.5**MAX_HALVINGS
    work = new_work()
    made = advance(*beside(ABOVE), place, step, NO_EDGE, work)
    assert not made.ok
    assert work.counts[CORRECTIONS] == 0


def test_a_rise_within_roundoff_is_taken():
    place, step = along_x(0.0, 1e-9)
    uphill = step._replace(noise=1e-15)
    assert line_search(*beside(ABOVE), place, uphill, 1.0)[:2] == (1.0, True)


def test_a_boundary_that_is_reached_is_held():
    """Towards a point beyond the edge: a third of the step fits; the switch is in the log."""
    work = new_work()
    step = Step((0.0, 3.0, 0.0, 0.0), 0.5 * (16.0 + 4.0), -12.0, 0.0, 0)
    made = advance(*beside((4.0, 0.0, 3.0)), place_of(on_top(0.0, 0.0)), step, NO_EDGE, work)
    assert (made.ok, made.held, made.changed) == (True, True, True)
    assert (made.place.feature_a, made.place.chart_a) == (EDGE, -1)
    assert made.place.u == pytest.approx(0.5, abs=1e-15)
    assert made.jets[0][0] == pytest.approx((1.0, 0.0, 1.0), abs=1e-15)
    assert work.counts[CORRECTIONS] == work.counts[EVENTS] == 1
    assert work.events[[BODY, SOURCE, TARGET]].tolist() == [0, TOP, EDGE]
    assert work.events[VALUE] == pytest.approx(2.0 / 3.0, abs=1e-15)
    assert work.events[SLOPE_COLUMN] == 0.0


def test_a_step_cut_by_the_line_search_holds_nothing():
    """Halved before it reaches the edge: the place stays on the face."""
    work = new_work()
    place, step = along_x(0.5, -5.0)
    made = advance(*beside(ABOVE), place, step, NO_EDGE, work)
    assert (made.ok, made.held, made.changed) == (True, False, False)
    assert made.place.feature_a == TOP
    assert work.counts[EVENTS] == 0


def release(x, side, slope_floor=SLOPE_FLOOR):
    """(released, place, work): the multipliers' test at a place of the box."""
    pair, pose = beside(x)
    place, work = place_of(side), new_work()
    at = {EDGE: (1.0, 1.0 - 2.0 * side.p, 1.0), CORNER: (1.0, 1.0, 1.0)}[int(side.feature)]
    n, d = unit(*np.subtract(x, at)), math.dist(x, at)
    return *release_along(pair, pose, place, n, d, slope_floor, work), work


def test_a_negative_multiplier_releases_its_face():
    """The point stands 0.5 behind the edge and 2 above it: the slope is -0.5 / |(0.5, 2)|."""
    released, place, work = release((0.5, 0.0, 3.0), on_edge(0.5))
    assert released
    assert place.feature_a == TOP
    assert (place.u, place.v) == pytest.approx((0.0, 1.0), abs=1e-15)
    d = math.hypot(0.5, 2.0)
    assert work.events[[BODY, SOURCE, TARGET]].tolist() == [0, EDGE, TOP]
    assert work.events[SLOPE_COLUMN] == pytest.approx(-0.5 / d, abs=1e-15)
    assert work.events[VALUE] == pytest.approx(-0.5, abs=1e-15)


def test_positive_multipliers_release_nothing():
    for x, side in (
        ((2.0, 0.0, 3.0), on_edge(0.5)),
        ((1.0, 0.0, 3.0), on_edge(0.5)),  # on the Voronoi plane itself
        ((2.0, 2.0, 1.5), at_vertex(CORNER_AT)),
    ):
        released, place, work = release(x, side)
        assert not released
        assert place == place_of(side)
        assert work.counts[EVENTS] == 0


def test_a_slope_above_the_floor_is_none():
    behind = 0.5 / math.hypot(0.5, 2.0)
    assert release((0.5, 0.0, 3.0), on_edge(0.5), 0.99 * behind)[0]
    assert not release((0.5, 0.0, 3.0), on_edge(0.5), 1.01 * behind)[0]


def settled(x, side, tolerance=1e-12, limit=None):
    pair, pose = beside(x)
    work = new_work()
    if limit is not None:
        work.counts[LIMIT] = limit
    return settle(pair, resting(pose), place_of(side), 1, tolerance, work), work


@pytest.mark.parametrize(
    "x", [(0.3, -0.2, 3.0), (3.0, 0.4, 2.0), (2.0, 3.0, 1.5), (-0.2, 0.1, 1.01)]
)
def test_from_every_vertex_it_comes_to_the_nearest_point(x):
    nearest = np.clip(x, -1.0, 1.0)
    for vertex in range(BOX.n_vertices):
        found, work = settled(x, at_vertex(vertex))
        assert found.outcome == STATIONARY
        assert found.jets[0][0] == pytest.approx(nearest, abs=1e-12)
        # as many of the box's coordinates are free as the feature has dimensions
        free = int((np.abs(nearest) < 1.0).sum())
        feature = found.place.feature_a
        assert free == (2 if feature < FACES else 1 if feature < FACES + BOX.n_edges else 0)
        assert work.counts[EVALUATIONS] <= 10


def test_a_stationary_place_stays():
    found, work = settled((0.3, -0.2, 3.0), on_top(0.3, -0.2))
    assert found.outcome == STATIONARY
    assert found.place == place_of(on_top(0.3, -0.2))
    assert work.counts[EVENTS] == 0


def test_where_the_points_meet_it_is_contact():
    assert settled((0.3, -0.2, 1.0), on_top(0.3, -0.2))[0].outcome == CONTACT


def test_a_deadline_ends_it():
    found, work = settled((0.3, -0.2, 3.0), at_vertex(0), limit=0)
    assert found.outcome == EXHAUSTED
    assert work.counts[EVALUATIONS] == 0
