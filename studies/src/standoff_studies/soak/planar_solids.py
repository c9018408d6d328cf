"""``python -m standoff_studies.soak.planar_solids``: planar solids against the study's own curves.

Pairs of drawn solids, of 10 to 400 lines, arcs, Bezier curves and splines, some with a hole, some
small enough to be inside others; at drawn poses, and with two places facing each other at gaps of
1e-1 to 1e-9 of the size. `planar_judge` judges every answer.

Pool k of a seed is always the same, whatever comes before it: ``--first`` goes on where a run was
cut off by ``--minutes``. Every half minute a line says what was judged. A fault is told with what
repeats it, and the exit code is then 3.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

import standoff as so
from standoff.solids import SolidProximity, distance
from standoff_studies.soak import blocks
from standoff_studies.soak.planar_drawn import Judged, Poses, drawn_poses, judged
from standoff_studies.soak.planar_judge import faults_of, truth_of

Ask = Callable[[so.PlanarSolid, so.PlanarSolid, so.Pose, so.Pose], SolidProximity]

SOLIDS = 12
"""Of a pool."""
QUERIES = 20_000
"""Of a pool."""


@dataclass(frozen=True)
class Verdict:
    """Counts, and the greatest excess of a distance over the judge's, of the size."""

    queries: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    wrong: int = 0
    silent: int = 0
    excess: float = 0.0
    asked: float = 0.0

    def plus(self, other: Verdict) -> Verdict:
        return Verdict(
            self.queries + other.queries,
            self.statuses + other.statuses,
            self.faults + other.faults,
            self.wrong + other.wrong,
            self.silent + other.silent,
            max(self.excess, other.excess),
            self.asked + other.asked,
        )

    def __str__(self) -> str:
        kinds = "".join(f", {count} {name}" for name, count in sorted(self.faults.items()))
        mean = 1e3 * self.asked / max(self.queries, 1)
        return (
            f"{self.queries:,} queries; {self.wrong} wrong{kinds}; {self.silent} of them certified;"
            f" {dict(self.statuses.most_common())}; worst excess {self.excess:.1e} of the size; "
            f"{mean:.2f} ms a query"
        )


def pool_of(seed: int, number: int, solids: int = 0) -> list[Judged]:
    """The solids of a pool; so many."""
    rng = np.random.default_rng([seed, number])
    return [judged(rng) for _ in range(solids or SOLIDS)]


def judge_pool(
    number: int, seed: int, queries: int = 0, ask: Ask = distance, solids: int = 0
) -> tuple[Verdict, list[str]]:
    """All queries of a pool, and the faults' lines."""
    pool, rng = pool_of(seed, number, solids), np.random.default_rng([seed, number, 1])
    verdict, lines = Verdict(), []
    a = b = pool[0]
    waiting: list[Poses] = []
    for k in range(queries or QUERIES):
        if not waiting:
            a, b = (pool[i] for i in rng.integers(len(pool), size=2))
            waiting = drawn_poses(a, b, rng)
        poses = waiting.pop()
        begun = time.perf_counter()
        told = ask(a.solid, b.solid, *poses)
        spent = time.perf_counter() - begun
        true = truth_of(a, b, *poses)
        found = faults_of(a, b, *poses, told, true)
        excess = 0.0 if told.overlap else (told.distance - true.least) / true.size
        verdict = verdict.plus(
            Verdict(
                1,
                Counter({told.status.name: 1}),
                Counter({name for name, _ in found}),
                bool(found),
                bool(found) and told.certified,
                excess if told.certified else 0.0,
                spent,
            )
        )
        if found:
            what = "; ".join(f"{name}: {text}" for name, text in found)
            lines.append(f"seed {seed}, pool {number}, query {k}: {told!r}: {what}")
    return verdict, lines


def main() -> int:
    """Read the options, run, and tell; 3 if anything was wrong."""
    given = blocks.options(__doc__, "queries", 1_000_000, QUERIES).parse_args()
    total = blocks.run(given, QUERIES, partial(judge_pool, seed=given.seed))
    return 3 if total and total.wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
