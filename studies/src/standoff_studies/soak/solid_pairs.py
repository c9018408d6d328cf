"""``python -m standoff_studies.soak.solid_pairs``: proven distances of solids against closed forms.

Pairs of solids that need not be convex, at gaps of 1 to 1e-6, aligned and nearly so, in overlap and
inside one another. Every answer is judged by `solid_judge`: no bound may exclude what an exhaustive
search finds on sampled boundaries, no status may be wrong, a common ball is inside both solids.
With --points, signed distances of points are judged too. With --occ, so many poses are compared
with OpenCASCADE's ``BRepExtrema_DistShapeShape``, which `cadquery-ocp-novtk` has.

Every half minute a line says what was judged so far: it stands where a run is cut off. A fault is
told with the poses that repeat it, and the exit code is then 1.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from standoff.cli.terminal import tell
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.solid import Solid
from standoff_studies.soak import solid_judge, solid_occ, solid_points
from standoff_studies.soak.solid_judge import Verdict
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import Known, draw_poses, known, pairs_of

BLOCK = 20
"""Poses of a pair that are judged at once."""
TELL = 30.0
"""Seconds between two lines."""
TOLD = 40
"""Faults that are told in full."""
POINT_PARTS = ("bracket", "elbow", "hollow", "plate", "ring")


class Stock:
    """Parts and their solids, each made when it is first asked for."""

    def __init__(self) -> None:
        self.parts: dict[str, Known] = {}
        self.solids: dict[str, Solid] = {}

    def get(self, name: str) -> tuple[Known, Solid]:
        if name not in self.parts:
            self.parts[name] = known(MAKERS[name]())
            self.solids[name] = Solid(self.parts[name].part.boundary)
        return self.parts[name], self.solids[name]


def run(stock: Stock, pairs: list[tuple[str, str]], poses: int, seed: int) -> Verdict:
    """Judge so many poses, the same number of every pair, and tell how far it is."""
    verdict, told, faults = solid_judge.nothing(), time.monotonic(), 0
    begun = told

    def log(text: str) -> None:
        nonlocal faults
        faults += 1
        if faults <= TOLD:
            tell(text)

    blocks = -(-poses // BLOCK)
    for number in range(blocks):
        a, b = pairs[number % len(pairs)]
        rng = np.random.default_rng([seed, number])
        (one, first), (two, second) = stock.get(a), stock.get(b)
        drawn = draw_poses(one, two, min(BLOCK, poses - number * BLOCK), rng)
        verdict = verdict.plus(
            solid_judge.judged(one, two, (first, second), drawn, spatial_distance, log)
        )
        now = time.monotonic()
        if now - told > TELL:
            told = now
            each = 1e3 * (now - begun) / verdict.poses
            tell(f"of {poses:,}: {verdict} ({each:.0f} ms a pose)")
    return verdict


def beside_occ(
    stock: Stock, pairs: list[tuple[str, str]], poses: int, seed: int
) -> solid_occ.Comparison:
    """So many poses at least that are apart, of all pairs in turn."""
    found, number = solid_occ.Comparison(), 0
    while found.poses < poses:
        a, b = pairs[number % len(pairs)]
        rng = np.random.default_rng([seed, number, 2])
        (one, first), (two, second) = stock.get(a), stock.get(b)
        drawn = draw_poses(one, two, BLOCK, rng)
        found = found.plus(solid_occ.compared(one, two, (first, second), drawn, spatial_distance))
        number += 1
    return found


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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=100_000)
    parser.add_argument("--points", type=int, default=0)
    parser.add_argument("--occ", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    stock, begun = Stock(), time.monotonic()
    verdict = run(stock, pairs_of(given.parts), given.poses, given.seed)
    sound = verdict.sound
    tell(f"{len(pairs_of(given.parts))} pairs, {time.monotonic() - begun:.0f} s: {verdict}")
    tell(table(verdict))
    if given.points:
        names = [name for name in POINT_PARTS if name in given.parts]
        for name in names:
            count = -(-given.points // len(names))
            found = solid_points.judged(*stock.get(name), count, given.seed)
            tell(f"{name}: {found}")
            sound &= found.sound
    if given.occ:
        compare = beside_occ(stock, pairs_of(solid_occ.PARTS), given.occ, given.seed)
        tell(str(compare))
        sound &= not compare.library
    return 0 if sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
