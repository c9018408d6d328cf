"""The study of which starts arrive: its bodies, laws, causes, intervals, summary and statements."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

import standoff as so
from standoff_studies.paper import catalogue
from standoff_studies.paper.convergence import as_committed, cells
from standoff_studies.paper.convergence.lenses import PARAMETRISATIONS, lens
from standoff_studies.paper.convergence.pairs import DRAWN_PAIRS, LENSES, pair
from standoff_studies.paper.convergence.starts import CAUSES, STEP, frames_of, outcome, trial

STRETCHED = np.diag([0.8, 0.6, 0.7])


def test_the_printed_law_is_the_printed_system() -> None:
    assert cells.law_of("printed", 25.0) == so.PaperLaw.as_printed(gain=25.0)
    left = so.PaperLaw.as_printed(gain=25.0, far_side="left")
    assert cells.law_of("printed-left", 25.0) == left
    assert not any(cells.law_of(key, 25.0).restarts for key in cells.LAWS)


@pytest.mark.parametrize("linear", [None, STRETCHED])
def test_three_parametrisations_are_one_body(linear: np.ndarray | None) -> None:
    """A point of the patches is, at its place in each parametrisation, the same point."""
    home, rng = lens("patches", linear), np.random.default_rng(0)
    for key in PARAMETRISATIONS:
        if key == "patches":
            continue
        other = lens(key, linear)
        for face in range(3):
            for u, v in rng.uniform(size=(20, 2)).tolist():
                x = home.body.face_parts[face].charts[0].jet(u, v)[0]
                place = other.place(face, x)
                y = other.body.face_parts[face].charts[0].jet(*place)[0]
                np.testing.assert_allclose(y, x, atol=1e-14)


@pytest.mark.parametrize("key", DRAWN_PAIRS)
def test_drawn_pairs_are_apart_by_their_gap(key: str) -> None:
    one = pair(key)
    path = one.path_of("moving")
    last = frames_of(cells.GAINS[0]) * STEP
    for time in (0.0, 0.5 * last, last):
        answer = so.distance(one.a, one.b, so.Pose.identity(), path.pose(time))
        assert answer.certified
        assert answer.distance > 0.2


def test_intervals_are_wilsons() -> None:
    for arrived, tried in ((0, 1000), (37, 1000), (999, 1000), (1000, 1000)):
        known = binomtest(arrived, tried).proportion_ci(0.95, "wilson")
        assert cells.wilson(arrived, tried) == pytest.approx((known.low, known.high), abs=1e-5)


def test_starts_that_do_not_arrive_are_traced() -> None:
    """On simulation D's grid: 34 of 75 as printed, the rest pinned on the right face."""
    cell, traces = cells.made(("D patches, grid", "rest", "printed", 25.0))
    assert (cell.arrived, cell.tried) == (34, 75)
    assert (cell.definite, cell.definite_arrived) == (34, 34)
    assert cell.causes == {"pinned": 41}
    assert len(traces) == 41
    for trace in traces:
        assert trace["zeroed"] > 0
        assert trace["least"] < 0.0
        assert trace["psi"] > 1e-3


def test_a_start_at_the_closest_points_arrives_at_once() -> None:
    """Also where it stands still, bit for bit, before it has stayed long enough."""
    one = pair("E patches")
    near = so.distance(one.a, one.b, so.Pose.identity(), one.path_of("rest").pose(0.0))
    for gain in cells.GAINS:
        tried = trial(one, "rest", cells.law_of("covariant", gain))
        found = outcome(tried, near.place_a, near.place_b)
        assert found.time == STEP
        assert found.end is None
        assert found.right
        assert found.definite


@pytest.mark.parametrize("key", ["E gnomonic", "E stereographic", "drawn 7", "A vaults"])
@pytest.mark.parametrize("motion", list(cells.MOTIONS))
def test_every_start_arrives_with_covariant_m_and_held_boundaries(key: str, motion: str) -> None:
    cell, traces = cells.made((key, motion, "covariant-hold", 400.0), starts=25)
    assert cell.arrived == 25, traces


def test_the_summary_is_of_the_study() -> None:
    found = cells.committed()
    every = set(cells.every_cell())
    assert {cell.options for cell in found} <= every
    assert len({cell.options for cell in found}) == len(found)
    # held boundaries: at least ten pairs, every gain, both motions, a thousand starts
    for name in DRAWN_PAIRS:
        for motion in cells.MOTIONS:
            for gain in cells.GAINS:
                (cell,) = (c for c in found if c.options == (name, motion, "covariant-hold", gain))
                assert cell.tried >= 1000
                assert cell.part >= 0.999
    for cell in found:
        assert sum(cell.causes.values()) == cell.tried - cell.arrived, cell
        assert {cause.split(",")[0] for cause in cell.causes} <= set(CAUSES)


@pytest.mark.parametrize(
    "options",
    [
        ("E patches", "rest", "printed", 1000.0),
        ("D stereographic", "moving", "printed", 100.0),
        ("drawn 1", "rest", "printed", 400.0),
    ],
)
def test_a_cell_is_what_running_it_gives(options: cells.Options) -> None:
    (written,) = (cell for cell in cells.committed() if cell.options == options)
    part = cells.made(options, starts=40)[0].part
    spread = np.sqrt(written.part * (1.0 - written.part) / 40.0)
    assert abs(part - written.part) <= 4.0 * spread + 0.02


def test_shares_of_the_covariant_law_do_not_depend_on_the_parametrisation() -> None:
    """Equal within their intervals by the covariant law, apart by the printed one."""
    for which in ("D", "E"):
        for law, alike in (("covariant", True), ("printed", False)):
            bounds = []
            for name in (key for key in LENSES if key.startswith(which)):
                own = [c for c in cells.committed() if (c.pair, c.law) == (name, law)]
                bounds.append(cells.wilson(sum(c.arrived for c in own), sum(c.tried for c in own)))
            low, high = max(b[0] for b in bounds), min(b[1] for b in bounds)
            assert (low <= high) is alike, (which, law, bounds)


def test_statements_follow_the_cells() -> None:
    statements = as_committed().statements
    assert [s.holds for s in statements[:3]] == [True, True, False]
    assert "far_side=left" in statements[0].by
    assert all("restarts=False" in s.by for s in statements)


def test_the_study_is_made_only_where_it_is_asked_for() -> None:
    keys = [entry.key for entry in catalogue.chosen(["all"])]
    assert "arrivals" in keys
    assert "convergence" not in keys
    assert [entry.key for entry in catalogue.chosen(["convergence"])] == ["convergence"]
