"""The claims on an update's cost, Newton's basin and a body's own point; what cannot fail."""

from __future__ import annotations

import numpy as np
import pytest

from standoff_studies.paper import update_cost
from standoff_studies.paper.catalogue import chosen, make
from standoff_studies.paper.control import basins
from standoff_studies.paper.simulation_e.own_point import decisions
from standoff_studies.paper.verdicts import Verdict


def test_iterations_come_to_what_is_asked() -> None:
    """Each method's answers are within the accuracy, by the certified points; Newton's count is
    that of its steps and one evaluation that finds them enough."""
    for name in update_cost.PRICES:
        got = update_cost.spent(name, 1e-5)
        assert np.isfinite(got.evaluations).all()
        assert 0.0 < got.error <= 1e-5
    assert set(update_cost.spent("Newton", 1e-5).evaluations.tolist()) == {2.0}


@pytest.mark.parametrize("integrator", ["heun", "euler"])
def test_the_laws_error_is_of_second_order_in_the_step(integrator: str) -> None:
    assert 1e-9 < update_cost.law_spent(integrator).error < 1e-6


def test_costs_tell_first_order_from_second() -> None:
    """The paper's integrator evaluates twice; BFGS and gradient descent never need M."""
    assert [update_cost.law_spent(name).cost for name in ("heun", "euler")] == [2.0, 1.0]
    got = {name: update_cost.spent(name, 1e-5) for name in update_cost.PRICES}
    assert got["Newton"].cost == 2.0
    for name in ("quasi-Newton (BFGS)", "gradient descent"):
        assert got[name].cost == pytest.approx(0.5 * got[name].evaluations.mean())
    table = update_cost.table()
    assert {len(column) for column in table.values()} == {2 + 3 * len(update_cost.TARGETS)}


def test_the_verdict_follows_the_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """By both integrators cheaper than Newton and gradient descent; than BFGS by Euler's only."""
    holds = [statement.holds for statement in update_cost.statements()]
    assert holds == [True, True, None, True, None]
    for count, verdict in ((0.0, False), (1.5, None), (3.0, True)):
        got = update_cost.Spent(np.full(update_cost.UPDATES, count), 0.0)
        monkeypatch.setattr(update_cost, "spent", lambda name, target, got=got: got)
        assert [s.holds for s in update_cost.statements()] == [True, *3 * [verdict], None]


CANNOT_FAIL = {
    "8": ["six external Voronoi lines"],
    "9": ["never grows at a switch", "both kinds of switches occur", "curve to curve outside"],
    "12": ["external and internal Voronoi regions"],
    "13": ["never grows at a switch", "the modes are vertex–vertex"],
    "16": ["visits faces, edges and a vertex"],
    "17": ["never grows at a switch"],
    "19": ["in five snapshots"],
    "20": ["never grows at a switch", "a second on the boundary curve", "enters an edge"],
}
"""Statements that a chosen motion, a chosen body or continuity settles, by figure."""


@pytest.mark.parametrize("key", CANNOT_FAIL)
def test_what_cannot_fail_is_marked(key: str) -> None:
    """And would still be told if it did."""
    (entry,) = chosen([key])
    statements = make(entry).statements
    for words in CANNOT_FAIL[key]:
        (found,) = (one for one in statements if words in one.stated)
        assert Verdict.of(found) is Verdict.CONSTRUCTED, found.stated
        assert found.why
        assert Verdict.of(found._replace(holds=False)) is Verdict.FAILS


def test_parts_of_a_map_join_over_the_seam_and_at_the_poles() -> None:
    cells = np.zeros((basins.ROWS, basins.COLUMNS), dtype=bool)
    cells[10, 0] = cells[10, -1] = True
    assert basins.parts(cells.ravel()) == [2]
    cells[20, 40:43] = True
    assert basins.parts(cells.ravel()) == [3, 2]
    cells[0, 5] = cells[0, 60] = True
    assert basins.parts(cells.ravel()) == [3, 2, 2]
    at = [basins.COLUMNS * row + column for row, column in ((0, 5), (0, 60), (10, 0), (10, 89))]
    assert basins.stray(cells.ravel()) == at


@pytest.mark.soak
def test_the_laws_own_stray_starts_are_those_of_long_steps() -> None:
    """Each is next to a singular M; in steps a fiftieth as long none is left."""
    found = basins.beside_a_point("raw law").found
    lone = basins.stray(found)
    assert len(lone) == 3
    assert sum(basins.parts(found)[1:]) == 3
    assert basins.strays_in_small_steps() == 0
    assert len(basins.parts(basins.beside_a_point("Newton").found)) > 3


def test_printed_tests_do_not_ask_for_the_own_witness_point() -> None:
    right, tried, _ = decisions("voronoi")
    assert right == tried >= 200
    # the others do: the measure can tell
    right, tried, _ = decisions("multipliers")
    assert right < 0.8 * tried
