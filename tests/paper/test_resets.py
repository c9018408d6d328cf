"""Each jump of the projection errors at a switch is what its reset implies, in B, C, D and E."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from standoff.motion import Path
from standoff.recording import Recording
from standoff.recording.times import even_times
from standoff.recording.track import track_along
from standoff.tracking import Feature, Tracker
from standoff.tracking.laws import PaperLaw
from standoff_studies.paper.bodies import lens_of_patches, planar_body
from standoff_studies.paper.pair_simulation import REST
from standoff_studies.paper.resets import (
    ROUNDED,
    Move,
    growth_statement,
    moves_of,
    projection_errors,
    reset_place,
    reset_statement,
    resets_of,
)
from standoff_studies.paper.simulation_b import run as b
from standoff_studies.paper.simulation_c import run as c
from standoff_studies.paper.simulation_d import runs as d
from standoff_studies.paper.simulation_e import runs as e

Case = tuple[Recording, tuple[Path, Path], float]


def of_b() -> Case:
    return b.run().paper.outside, (REST, b.run().path), b.GAIN


def of_c() -> Case:
    return c.SIMULATION.paper, c.SIMULATION.paths, c.SIMULATION.gain


def of_d() -> Case:
    return d.SIMULATION.paper, d.SIMULATION.paths, d.SIMULATION.gain


def of_e() -> Case:
    return e.SIMULATION.paper, e.SIMULATION.paths, e.SIMULATION.gain


@pytest.mark.parametrize(("case", "least"), [(of_b, 9), (of_c, 36), (of_d, 11), (of_e, 4)])
def test_the_errors_jump_by_what_the_reset_implies(case: Callable[[], Case], least: int) -> None:
    recording, paths, gain = case()
    resets = resets_of(recording, paths, gain)
    assert [r.frame for r in resets] == sorted({event.frame for event in recording.events})
    assert len(resets) >= least
    assert max(reset.off for reset in resets) <= ROUNDED
    # it is a jump that is compared: most resets change the errors by far more
    jumps = [abs(reset.found - reset.before) for reset in resets]
    assert np.median(jumps) > 1e-6
    assert reset_statement(resets, "").holds is True
    # the drawn curve has the resets' values in their frames
    errors = projection_errors(recording, paths)
    at = np.searchsorted(errors.time, [reset.time for reset in resets])
    assert errors.size[at] == pytest.approx([reset.found for reset in resets], rel=1e-12)


@pytest.mark.parametrize(
    ("moves", "least"), [(d.moves_by_resets, 40), (e.moves_by_resets, 20)], ids=["D", "E"]
)
def test_printed_resets_of_wrong_starts_move_the_points_together(
    moves: Callable[[], list[Move]], least: int
) -> None:
    """From afar they move witness points by up to a length, and never farther apart."""
    moved = [move for move in moves() if move.way > ROUNDED]
    assert len(moved) >= least
    assert max(move.way for move in moved) > 0.5
    assert all(abs(move.growth) <= move.way + ROUNDED for move in moved)
    assert max(move.growth for move in moved) <= ROUNDED


@pytest.mark.parametrize("case", [of_c, of_d])
def test_moves_are_those_of_the_resets(case: Callable[[], Case]) -> None:
    """A switch of the wrong start jumps in distance between two frames; the later ones do not."""
    recording, paths, gain = case()
    moves, resets = moves_of(recording, paths, gain), resets_of(recording, paths, gain)
    assert len(moves) == len(resets)
    steps = np.array(
        [recording.distance[r.frame] - recording.distance[r.frame - 1] for r in resets]
    )
    # beside the reset a frame has the law's own step, at K h = 0.025 and a few hundredths of a way
    assert np.array([move.growth for move in moves]) == pytest.approx(steps, abs=0.05)
    assert moves[0].growth < -0.1
    assert max(move.way for move in moves[1:]) <= ROUNDED


def test_a_distance_that_grows_is_told() -> None:
    moves = [Move(0.4, -0.3), Move(0.0, 0.0), Move(0.2, 0.1)]
    told = growth_statement(moves, 2, "").measured
    assert "from 2 wrong starts, move a witness point in 2 of 3 frames" in told
    assert "grows in 1, by up to 1.0e-01 length" in told
    assert growth_statement(moves[:1], 1, "").measured.endswith("grows in 0")
    assert growth_statement(moves[1:2], 1, "").measured.endswith("does not change")


def test_an_exact_reset_is_told() -> None:
    """Entered at the foot point, an edge leaves other errors than the printed reset implies."""
    runs = e.SIMULATION
    law = replace(PaperLaw.as_printed(gain=runs.gain), reset="foot")
    tracker = Tracker(runs.a, runs.b, runs.step, law=law)
    times = even_times(0.0, 1.2, runs.step)
    other = track_along(tracker, *runs.paths, times, state=runs.begin(tracker, runs.starts[0]))
    resets = resets_of(other, runs.paths, runs.gain)
    assert max(reset.off for reset in resets) > 1e6 * ROUNDED
    assert reset_statement(resets, "").holds is False


def test_resets_of_parameters(rng: np.random.Generator) -> None:
    """On the lens's straight boundary curves a reset keeps v; back on a face u is 0 or 1."""
    lens = lens_of_patches()
    for u, v in rng.uniform(0.05, 0.95, (5, 2)).tolist():
        for edge in {edge for edge, _ in lens.face_parts[0].loop}:
            onto, at = reset_place(
                lens, (Feature("face", 0), np.array([u, v])), Feature("edge", edge)
            )
            back, place = reset_place(lens, (onto, at), Feature("face", 0))
            assert back == Feature("face", 0)
            assert place[1] == pytest.approx(v, abs=1e-9)
            assert min(abs(place[0]), abs(place[0] - 1.0)) == 0.0


def test_ends_of_curves() -> None:
    body, point = planar_body(), np.empty(0)
    for curve in range(3):
        edge = body.edge_parts[curve]
        for vertex, t in ((edge.first, edge.curve.first), (edge.last, edge.curve.last)):
            found = reset_place(body, (Feature("vertex", vertex), point), Feature("edge", curve))
            assert found[1] == pytest.approx([t])
            back = reset_place(body, found, Feature("vertex", vertex))
            assert len(back[1]) == 0


def test_features_that_do_not_meet_have_no_reset() -> None:
    lens = lens_of_patches()
    held = Feature("face", 0), np.array([0.5, 0.5])
    far = max(set(range(lens.n_edges)) - {edge for edge, _ in lens.face_parts[0].loop})
    with pytest.raises(ValueError, match="no boundary curve"):
        reset_place(lens, held, Feature("edge", far))
    with pytest.raises(ValueError, match="no reset from face 0 to vertex 0"):
        reset_place(lens, held, Feature("vertex", 0))
