"""Beyond convex bodies: which readings of the paper's sentences hold, and what flips them."""

from __future__ import annotations

import numpy as np
import pytest

import standoff as so
from standoff_studies.paper import furthest, nonconvex, nonconvex_bore, nonconvex_runs
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.nonconvex_runs import READINGS, run
from standoff_studies.paper.nonconvex_scene import PAIRS, STEP, lobes, truth

VERDICTS = {
    "nonconvex": [True, True, False, False, None, True, None],
    "furthest": [True, True, False, False],
}


@pytest.mark.parametrize("key", ["furthest", pytest.param("nonconvex", marks=pytest.mark.soak)])
def test_the_figure_states_what_holds(key: str) -> None:
    (entry,) = chosen([key])
    artwork = make(entry)
    assert [s.holds for s in artwork.statements] == VERDICTS[key]
    for columns in artwork.tables.values():
        assert len({len(np.asarray(column)) for column in columns.values()}) == 1
    assert artwork.draw().axes or artwork.draw().subfigs


def test_the_truth_of_chains_is_that_of_their_lobes() -> None:
    """Closed form beside ``so.distance``: the least over all pairs of lobes."""
    known = truth()
    for k in np.linspace(0, len(known.time) - 1, 5).astype(int):
        found = [
            so.distance(lobes(3)[i], lobes(2)[j], so.Pose.identity(), known.poses[k]).distance
            for i, j in PAIRS
        ]
        assert min(found) == pytest.approx(known.distance[k], abs=1e-12)
        alive = known.alive[k]
        np.testing.assert_allclose(np.array(found)[alive], known.apart[k][alive], atol=1e-12)
        assert known.alive[k, known.apart[k].argmin()]


def test_all_pairs_answer_and_the_minima_of_the_start_do_not() -> None:
    """And one pair left out is noticed, where it is the nearest."""
    every, start = run(READINGS[2]), run(READINGS[1])
    assert not nonconvex.wrong(every).any()
    assert (every.branches == len(PAIRS)).all()
    bad = nonconvex.wrong(start)
    assert bad.mean() > 0.2
    assert start.branches[0] == truth().alive[0].sum() > 1
    # what it tells is never below the truth, and each wrong frame comes after a birth
    assert (start.distance > truth().distance - nonconvex.WRONG).all()
    fresh = run(READINGS[3])  # all it lacked are births
    assert not nonconvex.wrong(fresh)[1:].any()
    assert np.median(fresh.branches) < len(PAIRS)
    unseen, births, near = nonconvex_runs.at_seams(start)
    assert 0.5 * births < unseen <= births
    assert near < 10.0 * STEP
    nearest = int(truth().apart.min(axis=0).argmin())
    without = nonconvex.wrong(run(READINGS[2], leave_out=nearest))
    np.testing.assert_array_equal(without, truth().apart.argmin(axis=1) == nearest)


@pytest.mark.parametrize("swing", [nonconvex_bore.SWING, 0.05])
def test_the_pin_is_lost_where_its_minima_end(swing: float) -> None:
    """Within the evolute both minima live for ever, and the law keeps them."""
    found = nonconvex_bore.in_bore(swing)
    lives = all(len(minima) == 2 for minima in found.minima)
    assert lives == (swing < nonconvex_bore.SWING)
    assert (found.wrong.max() < nonconvex.WRONG) == lives
    assert (found.least.min() > 0.0) == lives
    assert found.errors[int(found.wrong.argmax())].max() < 1e-4  # it has converged, to a saddle
    np.testing.assert_allclose(found.proven, found.distance, atol=1e-8)


def test_stationary_pairs_are_of_the_kind_of_their_direction() -> None:
    """docs/penetration.md: the signs of H are those of the Hessian of s, and two below 0."""
    every = [kind for found in furthest.kinds() for kind in found]
    assert {kind.up for kind in every} == {0, 1, 2}
    assert all(kind.signs == (kind.up, 4 - kind.up) for kind in every)
    assert max(kind.error for kind in every) < 1e-12
    assert {found[0].up for found in furthest.kinds()} == {2}


def test_through_contact_it_depends_on_the_speed() -> None:
    quick, slow = furthest.followed(*furthest.QUICK), furthest.followed(*furthest.slow())
    assert quick.error.max() < furthest.FOLLOWS
    assert abs(slow.told[-1]) < 1e-6 < 5e-4 < -slow.true[-1]
    for one in (quick, slow):
        np.testing.assert_allclose(one.own, one.true, atol=1e-9)
