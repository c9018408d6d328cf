"""The claims on an update's cost, Newton's basin and a body's own witness point."""

from __future__ import annotations

import numpy as np
import pytest

from standoff_studies.paper import update_cost
from standoff_studies.paper.control import basins
from standoff_studies.paper.simulation_e.own_point import decisions


def test_iterations_come_to_what_is_asked() -> None:
    """Each method's answers are within the accuracy, by the certified points; Newton's count is
    that of its steps and one evaluation that finds them enough."""
    for name in update_cost.ITERATIONS:
        got = update_cost.spent(name, 1e-5)
        assert np.isfinite(got.evaluations).all()
        assert 0.0 < got.error <= 1e-5
    assert set(update_cost.spent("Newton", 1e-5).evaluations.tolist()) == {2.0}


def test_the_laws_error_is_of_second_order_in_the_step() -> None:
    assert 1e-9 < update_cost.law_spent().error < 1e-6


def test_the_verdict_follows_the_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    holds = [statement.holds for statement in update_cost.statements()]
    assert holds == [True, True, True, True]
    free = update_cost.Spent(np.ones(update_cost.UPDATES), 0.0)
    monkeypatch.setattr(update_cost, "spent", lambda name, target: free)
    assert [s.holds for s in update_cost.statements()] == [True, False, False, False]


def test_parts_of_a_map_join_over_the_seam_and_at_the_poles() -> None:
    cells = np.zeros((basins.ROWS, basins.COLUMNS), dtype=bool)
    cells[10, 0] = cells[10, -1] = True
    assert basins.parts(cells.ravel()) == [2]
    cells[20, 40:43] = True
    assert basins.parts(cells.ravel()) == [3, 2]
    cells[0, 5] = cells[0, 60] = True
    assert basins.parts(cells.ravel()) == [3, 2, 2]


def test_printed_tests_do_not_ask_for_the_own_witness_point() -> None:
    right, tried, _ = decisions("voronoi")
    assert right == tried >= 200
    # the others do: the measure can tell
    right, tried, _ = decisions("multipliers")
    assert right < 0.8 * tried
