"""Cells: that they fill the box, and that no sample of it contradicts what is told of them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from standoff.sweep.job import Job
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof import search as searches
from standoff.sweep.proof.box import CellFindings, ParameterBox
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.pair_box import PairBox
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import TOGETHER, _parted, search
from standoff.sweep.proof.summary import Kind, ProofSummary
from standoff.tracking.many_distances import answered_rows
from sweep.conftest import PARAMETERS, TOP, Make

BOX = f"""{TOP}{PARAMETERS.replace('rotation = "uniform"', 'what = "turn_z"')}
[sampler]
kind = "sobol"
rows = 2000
""".replace('what = "turn_z"', 'what = "turn_z"\nfrom = -0.6\nto = 0.9')


def box_of(job: Job, clearance: float, finest: float) -> PairBox:
    box = Proof(job, clearance).box
    assert isinstance(box, PairBox)
    box.finest = finest
    return box


def searched(
    make: Make, clearance: float, finest: float = 0.5, queries: int = 20_000
) -> tuple[Job, PairBox, ProofSummary, Cells, np.ndarray]:
    """A search, and all cells that it closed."""
    job, closed = make(BOX), []
    box = box_of(job, clearance, finest)
    found = search(box, Cells.whole(4), queries, 20, lambda *told: closed.append(told))
    every = Cells.together([cells for cells, _, _ in closed])
    kinds = np.concatenate([kind for _, kind, _ in closed])
    return job, box, found, every.at(kinds >= 0), kinds[kinds >= 0]


def test_halves_fill_their_cell() -> None:
    rng = np.random.default_rng(5)
    cells = Cells.whole(3)
    for _ in range(40):
        cells = cells.halved(rng.integers(0, 3, len(cells.place)))
        cells = cells.at(rng.permutation(len(cells.place))[:50])
    halves = cells.halved(np.full(len(cells.place), 1))
    assert (halves.levels == np.repeat(cells.levels + 1, 2)).all()
    low, high = (x.middles - x.halves for x in (halves, cells))
    assert (low[::2] == high).all()
    assert (halves.middles[::2] + halves.halves[::2])[:, 1].tolist() == (
        (halves.middles[1::2] - halves.halves[1::2])[:, 1].tolist()
    )
    assert (halves.middles[1::2] + halves.halves[1::2] == cells.middles + cells.halves).all()


@pytest.mark.parametrize(("clearance", "queries"), [(0.3, 20_000), (1.5, 5000), (0.3, 500)])
def test_no_sample_contradicts_a_cell(make: Make, clearance: float, queries: int) -> None:
    job, _, found, cells, kinds = searched(make, clearance, queries=queries)
    assert sum((found.share(kind) for kind in Kind), Fraction(0)) == 1
    assert [found.number(kind) for kind in Kind] == np.bincount(kinds, minlength=3).tolist()
    points = job.source.points(0, 2000)
    rows = job.distances(0, 2000)
    low, high = cells.middles - cells.halves, cells.middles + cells.halves
    counts = np.zeros(len(Kind))
    for point, lower, upper in zip(points, rows.lower_bound, rows.upper_bound, strict=True):
        holding = np.flatnonzero(((low <= point) & (point < high)).all(axis=1))
        assert len(holding) == 1
        kind = kinds[holding[0]]
        counts[kind] += 1
        assert upper >= clearance if kind == Kind.PROVEN else True
        assert lower < clearance if kind == Kind.VIOLATED else True
    for kind in Kind:
        assert abs(counts[kind] / 2000 - float(found.share(kind))) < 0.04
    assert found.bound <= rows.upper_bound.min()


def test_a_box_that_is_free_is_proven_whole(make: Make) -> None:
    job = make(BOX.replace("from = -5.0\nto = 2.0", "from = 0.5\nto = 5.0"))
    found = search(box_of(job, 0.5, 0.01), Cells.whole(4), 10**6, 5)
    assert found.verdict.name == "PROVEN"
    assert found.share(Kind.PROVEN) == 1
    assert 0.5 <= found.bound <= job.distances(0, 2000).upper_bound.min()
    assert found.counterexamples.count == 0


def test_counterexamples_are_places_that_are_nearer(make: Make) -> None:
    job, _, found, _, _ = searched(make, 0.3)
    places = found.counterexamples.places
    assert found.verdict.name == "VIOLATED"
    assert len(places.distance) == 20 < found.counterexamples.count
    assert (np.diff(places.distance) >= 0.0).all()
    there = answered_rows(*job.bodies, *job.poses(places.numbers))
    assert (there.upper_bound == places.distance).all()
    assert places.distance[0] == found.nearest.places.distance[0]


def test_parts_of_a_box_come_to_the_same(make: Make) -> None:
    """What the search itself would halve a cell into, searched alone; and as JSON has it."""
    box = box_of(make(BOX), 0.3, 2.0)
    first = Cells.whole(4)
    whole = search(box, first, 10**6, 20)
    first = first.halved(box.look(first).along)
    again = ProofSummary(20, 4)
    for k in range(2):
        part = search(box, first.at([k]), 10**6, 20)
        again.add(ProofSummary.from_facts(part.facts(), 20, 4))
    assert again.cells == whole.cells
    assert again.open.facts() == whole.open.facts()
    assert sum((again.share(kind) for kind in Kind), Fraction(0)) == 1
    assert 0.0 < again.share(Kind.PROVEN) < 1.0
    told = ProofSummary.from_facts(again.facts(), 20, 4)
    assert told.facts() == again.facts()


def test_a_level_that_is_too_large_is_parted_with_its_queries() -> None:
    n = 3 * TOGETHER
    cells = Cells(np.arange(n)[:, None], np.full((n, 1), 30), np.zeros((n, 0)))
    parts = _parted(cells, 1001)
    assert sum(left for _, left in parts) == 1001
    assert np.array_equal(np.concatenate([c.place for c, _ in parts[::-1]]), cells.place)
    assert max(len(c.place) for c, _ in parts) <= TOGETHER // 2 + 1


class HalfEasy(ParameterBox):
    """One parameter: cells of its lower half are soon proven, those of the upper one never."""

    block = 16

    def __init__(self) -> None:
        super().__init__([Parameter("x", "tool", "x")], 0.0)

    def moves(self, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
        return cells.halves[:, 0], cells.halves

    def look(self, cells: Cells) -> CellFindings:
        n = len(cells.place)
        easy = (cells.middles[:, 0] < 0.5) & (cells.levels >= 8)
        kind, zero = np.where(easy, int(Kind.PROVEN), -1), np.zeros(n)
        return CellFindings(kind, zero.astype(int), zero, zero, n, 0, cells.known)


def test_what_a_group_does_not_use_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searches, "TOGETHER", 64)
    found = search(HalfEasy(), Cells.whole(1), 4000, 5)
    assert found.queries == 4000
    assert found.share(Kind.PROVEN) == Fraction(1, 2)


def test_without_queries_all_is_open(make: Make) -> None:
    found = search(box_of(make(BOX), 0.3, 0.05), Cells.whole(4), 0, 5)
    assert found.share(Kind.OPEN) == 1
    assert found.verdict.name == "UNDECIDED"
    assert found.facts()["bound"] is None
