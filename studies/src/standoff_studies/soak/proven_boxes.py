"""``python -m standoff_studies.soak.proven_boxes JOB.toml --clearance LENGTH``: a proof, sampled.

The box of the job's parameters is searched, and every cell that was looked at is kept. Then rows of
the job are asked one by one, and each is held against what was told of the cell that it is in: none
in a proven cell may be nearer than the clearance, none in a violated one proven to keep it, none
anywhere nearer than the bound.
"""

from __future__ import annotations

import argparse
import time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.cli.terminal import tell
from standoff.sweep.job import Job
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.proof import Proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind, ProofSummary
from standoff.sweep.reading import load_job
from standoff.sweep.sample_file import SampleFile

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

BLOCK = 1 << 16
TELL = 30.0
"""Seconds between two lines."""


class Tree(NamedTuple):
    """All cells that were looked at.

    Attributes
    ----------
    kinds, along : (n,) arrays
        As of `Looked`.
    halves : (n, 2) array
        Where the two halves of a cell are, if it was halved.
    first : int
        Where the whole box is.
    """

    kinds: Whole
    along: Whole
    halves: Whole
    first: int

    @classmethod
    def of(cls, looked: list[tuple[Cells, Whole, Whole]], columns: int) -> Tree:
        cells = Cells.together([cells for cells, _, _ in looked])
        kinds, along = (np.concatenate([told[k] for told in looked]) for k in (1, 2))
        drawn = np.random.default_rng(1).integers(1, 1 << 63, 2 * columns, dtype=np.uint64)
        factors = drawn | np.uint64(1)
        keys = key_of(cells.place, cells.depth, factors)
        order = np.argsort(keys)
        if (np.diff(keys[order]) == 0).any():
            raise ValueError("two cells have one key: draw other factors")

        def at(place: Whole, depth: Whole) -> Whole:
            wanted = key_of(place, depth, factors)
            found = np.searchsorted(keys[order], wanted)
            if not np.array_equal(keys[order][found], wanted):
                raise ValueError("a cell was halved, and a half of it not looked at")
            return order[found]

        halved = np.flatnonzero(kinds < 0)
        place, depth = cells.place[halved].copy(), cells.depth[halved].copy()
        rows = np.arange(len(halved)), along[halved]
        place[rows] *= 2
        depth[rows] += 1
        halves = np.full((len(kinds), 2), -1)
        halves[halved, 0] = at(place, depth)
        place[rows] += 1
        halves[halved, 1] = at(place, depth)
        none = np.zeros((1, columns), dtype=np.int64)
        return cls(kinds, along, halves, int(at(none, none)[0]))

    def kinds_at(self, points: Array) -> Whole:
        """Of the cells that hold points (n, columns) of the unit cube."""
        found = np.full(len(points), -1)
        left, within = np.arange(len(points)), points.copy()  # where in its cell each point is
        at = np.full(len(points), self.first)
        while len(left):
            kind = self.kinds[at]
            found[left] = kind
            on = kind < 0
            left, at = left[on], at[on]
            place = left, self.along[at]
            # exact; the last cell has its upper end too
            x = 2.0 * within[place]
            upper = x >= 1.0
            within[place] = x - upper
            at = self.halves[at, upper.astype(np.int64)]
        return found


def key_of(place: Whole, depth: Whole, factors: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """One number of each cell."""
    columns = place.shape[1]
    mixed = (
        place.astype(np.uint64) * factors[:columns] + depth.astype(np.uint64) * factors[columns:]
    )
    keys: NDArray[np.uint64] = np.bitwise_xor.reduce(mixed ^ (mixed >> np.uint64(29)), axis=1)
    return keys


class Verdict(NamedTuple):
    """Samples in cells of each kind; those of them that contradict what is told."""

    inside: Whole
    contradictions: int

    def __str__(self) -> str:
        counts = ", ".join(f"{int(self.inside[kind]):,} {kind.name}" for kind in Kind)
        return f"{int(self.inside.sum()):,} samples: {counts}; {self.contradictions} contradict it"


def judged(
    job: Job, proof: Proof, found: ProofSummary, tree: Tree, first: int, end: int
) -> Verdict:
    """Rows first .. end - 1 against what is told of their cells."""
    assert not isinstance(job.source, SampleFile)  # which a proof refuses
    kinds = tree.kinds_at(job.source.points(first, end))
    rows = job.answers(first, end)
    wrong = (kinds == Kind.PROVEN) & (rows.distance < proof.clearance)
    wrong |= (kinds == Kind.VIOLATED) & (rows.lower_bound >= proof.clearance)
    wrong |= ~(rows.distance >= found.bound) | (kinds < 0)
    return Verdict(np.bincount(kinds, minlength=len(Kind)), int(np.count_nonzero(wrong)))


def main() -> int:
    """Search, sample, and tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("job")
    parser.add_argument("--clearance", type=float, required=True)
    parser.add_argument("--queries", type=int, default=200_000)
    parser.add_argument("--samples", type=int, default=100_000_000)
    given = parser.parse_args()
    job = load_job(given.job)
    proof, looked = Proof(job, given.clearance), []
    began = time.monotonic()
    found = search(proof.box, proof.box.whole, given.queries, 10, lambda *one: looked.append(one))
    shares = ", ".join(f"{float(found.share(kind)):.6f} {kind.name}" for kind in Kind)
    tell(f"{time.monotonic() - began:.0f} s, {found.queries:,} queries: {shares}")
    tree = Tree.of(looked, len(job.parameters))
    total, told = Verdict(np.zeros(len(Kind), dtype=np.int64), 0), time.monotonic()
    for first in range(0, given.samples, BLOCK):
        one = judged(job, proof, found, tree, first, min(first + BLOCK, given.samples))
        total = Verdict(total.inside + one.inside, total.contradictions + one.contradictions)
        if time.monotonic() - told > TELL:
            told = time.monotonic()
            tell(f"{told - began:.0f} s: {total}")
    tell(f"{time.monotonic() - began:.0f} s: {total}")
    return 1 if total.contradictions else 0


if __name__ == "__main__":
    raise SystemExit(main())
