"""``python -m standoff_studies.soak.solid_pairs``: proven distances of solids against closed forms.

Pairs of solids that need not be convex, at gaps of 1 to 1e-6, aligned and nearly so, in overlap and
inside one another. Every answer is judged by `solid_judge`: no bound may exclude what an exhaustive
search finds on sampled boundaries, no status may be wrong, a common ball is inside both solids.

Block k of a seed, twenty poses of a pair, is always the same: ``--first`` goes on where a run was
cut off by ``--minutes``. Every half minute a line says what was judged. A fault is told with the
poses that repeat it, and the exit code is then 1.
"""

from __future__ import annotations

import argparse
from functools import cache, partial
from typing import Any

import numpy as np

from standoff.cli.terminal import tell
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.solid import Solid
from standoff_studies.soak import blocks, solid_judge
from standoff_studies.soak.solid_judge import Verdict
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import Known, draw_poses, known, pairs_of

BLOCK = 20
"""Poses of a pair that are judged at once."""


@cache
def made(name: str) -> tuple[Known, Solid]:
    """A part and its solid, made when first asked for."""
    part = known(MAKERS[name]())
    return part, Solid(part.part.boundary)


def judge_block(
    number: int, seed: int, pairs: list[tuple[str, str]], poses: int | None = None, ask: Any = None
) -> tuple[Verdict, list[str]]:
    """A block of poses of a pair, and its faults' lines."""
    (one, first), (two, second) = (made(name) for name in pairs[number % len(pairs)])
    drawn = draw_poses(one, two, poses or BLOCK, np.random.default_rng([seed, number]))
    lines: list[str] = []
    ask = ask or spatial_distance
    verdict = solid_judge.judged(one, two, (first, second), drawn, ask, lines.append)
    return verdict, [f"seed {seed}, block {number}: {line}" for line in lines]


def table(verdict: Verdict) -> str:
    """Statuses by gap, in parts of the poses at it."""
    bins = [*(name for name, _ in solid_judge.BINS), "touching", "inside", "overlap"]
    names = sorted({status for _, status in verdict.statuses})
    lines = ["gap        poses " + " ".join(f"{name:>12}" for name in names)]
    for gap in bins:
        counts = [verdict.statuses[gap, name] for name in names]
        total = sum(counts)
        shares = " ".join(f"{count / max(total, 1):12.2%}" for count in counts)
        lines.append(f"{gap:<8} {total:>7} {shares}")
    return "\n".join(lines)


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "poses", 100_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    return run_and_tell(given, partial(judge_block, seed=given.seed, pairs=pairs_of(given.parts)))


def run_and_tell(given: argparse.Namespace, work: blocks.Work) -> int:
    """Run all blocks, and tell the statuses by gap; 1 if anything was wrong."""
    verdict = blocks.run(given, BLOCK, work)
    if verdict is None:
        return 0
    tell(table(verdict))
    return 0 if verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
