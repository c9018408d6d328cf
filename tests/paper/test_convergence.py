"""The study of which starts arrive: its law, its intervals, its summary and its page."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binomtest

import standoff as so
from standoff_studies.paper import catalogue
from standoff_studies.paper.convergence import as_committed, cells
from standoff_studies.paper.items import ITEMS, markdown

INDEX = Path(__file__).parents[2] / "docs" / "paper" / "index.md"


def test_the_printed_cell_is_the_printed_system() -> None:
    assert cells.law_of("voronoi", "plain", 25.0) == so.PaperLaw.as_printed(gain=25.0)
    assert not cells.law_of("multipliers", "ranked", 25.0).restarts


def test_intervals_are_wilsons() -> None:
    for arrived, tried in ((0, 1000), (37, 1000), (999, 1000), (1000, 1000)):
        cell = cells.Cell("rest", "voronoi", "plain", 25.0, tried, arrived, math.nan, math.nan)
        known = binomtest(arrived, tried).proportion_ci(0.95, "wilson")
        assert cell.interval == pytest.approx((known.low, known.high), abs=1e-5)


def test_the_summary_has_every_cell() -> None:
    found = cells.committed()
    assert [(c.motion, c.switching, c.solve, c.gain) for c in found] == list(cells.every_cell())
    assert all(cell.tried == cells.STARTS >= 1000 for cell in found)
    # a cell is what running it gives: some of its starts, by both solves
    for at in (("rest", "multipliers", "ranked", 1000.0), ("moving", "voronoi", "plain", 1000.0)):
        (written,) = (c for c in found if (c.motion, c.switching, c.solve, c.gain) == at)
        part = cells.made(at, starts=40).part
        spread = math.sqrt(written.part * (1.0 - written.part) / 40.0)
        assert abs(part - written.part) <= 4.0 * spread + 0.02


def test_times_to_arrive_are_the_last_entry() -> None:
    """Started at the closest points it has arrived in the first frame; from afar it takes some."""
    law = cells.law_of("multipliers", "ranked", 1000.0)
    times = cells.arrival_times("rest", law, 20)
    there = times[np.isfinite(times)]
    assert len(there) >= 18
    assert there.min() >= cells.STEP
    assert there.max() <= cells.frames_of(1000.0) * cells.STEP


def test_statements_follow_the_cells() -> None:
    statements = as_committed().statements
    assert statements[0].holds is False
    assert "as_printed" in statements[0].by
    assert all(statement.by for statement in statements)


def test_the_study_is_made_only_where_it_is_asked_for() -> None:
    keys = [entry.key for entry in catalogue.chosen(["all"])]
    assert "arrivals" in keys
    assert "convergence" not in keys
    assert [entry.key for entry in catalogue.chosen(["convergence"])] == ["convergence"]


def test_the_pages_list_the_items_that_the_report_lists() -> None:
    assert markdown() in INDEX.read_text("utf-8")
    known = {entry.key for entry in catalogue.CATALOGUE}
    assert {item.state for item in ITEMS} == {"done", "partial", "absent"}
    for item in ITEMS:
        assert set(item.figures) <= known
    # every figure of the paper's numbers is listed
    listed = {key for item in ITEMS for key in item.figures}
    assert {key for key in known if key.isdecimal()} <= listed
