"""Times of impact in cases whose contact is known: how many are late, and the lead they keep.

Run from the repository's root: ``python -m benchmarks.time_of_impact --cases 100000 [--seed 1]``.
The cases are those of ``tests/families/impacts.py``, built backward from the instant of contact.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

TESTS = Path(__file__).resolve().parents[1] / "tests"
KINDS = ("closing", "free", "passing", "swinging")
PAIRS = 500
"""Pairs of bodies in a run, or one for ten cases: making them costs more than asking for them."""

SAMPLED = 20
"""Of so many "free" cases one is sampled before the contact by support functions."""


@dataclass
class Tally:
    """What came of the cases of one kind."""

    cases: int = 0
    wrong: list[str] = field(default_factory=list)
    statuses: Counter[str] = field(default_factory=Counter)
    leads: list[float] = field(default_factory=list)
    gaps: list[float] = field(default_factory=list)
    evaluations: list[int] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    sampled: int = 0
    apart: int = 0

    def add(self, case: Any, found: Any, seconds: float, wrong: str) -> None:
        """Count one case."""
        self.cases += 1
        self.statuses[found.status.name] += 1
        if wrong:
            self.wrong.append(f"{wrong} in {case.describe()}")
        if case.beyond == 0.0 and found.status.name in ("IMPACT", "GRAZING"):
            # what is proven: contact at `latest` of an impact, and at the time it was built for
            until = found.latest if found.status.name == "IMPACT" else case.time
            self.leads.append((min(case.time, until) - found.time) / case.time)
            size = found.tolerance * 1e9
            self.gaps.append((found.proximity.distance - case.clearance) / size)
        self.evaluations.append(found.evaluations)
        self.steps.append(found.steps)
        self.seconds.append(seconds)


def line(name: str, tally: Tally) -> str:
    """Return one row of the table."""
    leads, gaps = np.array(tally.leads or [np.nan]), np.array(tally.gaps or [np.nan])
    counts = "/".join(
        str(tally.statuses[status])
        for status in ("IMPACT", "GRAZING", "NO_IMPACT", "AT_START", "UNDECIDED")
    )
    apart = f"{tally.apart}/{tally.sampled}" if tally.sampled else "proven"
    return (
        f"{name:10s} {tally.cases:7d} {len(tally.wrong):5d}  {counts:30s} {apart:>11s} "
        f"{np.median(leads):8.1e}/{leads.max():7.1e} {gaps.max():8.1e} "
        f"{np.median(tally.steps):6.0f}/{max(tally.steps):5d} "
        f"{np.median(tally.evaluations):6.0f}/{max(tally.evaluations):5d} "
        f"{1e3 * np.median(tally.seconds):7.2f}/{1e3 * np.mean(tally.seconds):7.2f}"
    )


HEADER = (
    f"{'kind':10s} {'cases':>7s} {'wrong':>5s}  {'impact/graze/none/start/open':30s} "
    f"{'apart':>11s} {'lead med/max':>16s} {'gap max':>8s} {'steps':>12s} "
    f"{'evaluations':>12s} {'ms med/mean':>15s}"
)


def main() -> int:
    """Print the table; the exit code is 1 if any answer was wrong."""
    # The cases live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    import standoff as so
    from families.impacts import apart_before, draw_case, draw_twins, judge

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, help="default: a fresh one")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="of time_of_impact")
    arguments = parser.parse_args()
    seed = arguments.seed
    if seed is None:
        seed = int(np.random.default_rng().integers(1 << 31))
    rng = np.random.default_rng(seed)
    twins = [draw_twins(rng) for _ in range(max(1, min(PAIRS, arguments.cases // 10)))]
    tallies = {kind: Tally() for kind in KINDS}
    so.distance(twins[0][0].body, so.shapes.point(), so.Pose.identity(), so.Pose.identity())
    for k in range(arguments.cases):
        kind = KINDS[k % len(KINDS)]
        a, b = twins[(k // len(KINDS)) % len(twins)]
        case, tally = draw_case(kind, a, b, rng), tallies[kind]
        begun = time.perf_counter()
        found = so.time_of_impact(
            a.body,
            b.body,
            case.path_a,
            case.path_b,
            case.duration,
            clearance=case.clearance,
            tolerance=arguments.tolerance,
        )
        tally.add(case, found, time.perf_counter() - begun, judge(case, found))
        if kind == "free" and k % SAMPLED < len(KINDS):
            tally.sampled += 1
            tally.apart += apart_before(case)
    print(f"seed {seed}; tolerance {arguments.tolerance:g}; {len(twins)} pairs of bodies")
    print("lead: of the time of contact; gap: distance left over the sum of sizes;")
    print("apart: cases whose bodies are apart before, as sampled; steps, evaluations: median/max")
    print(HEADER)
    for kind, tally in tallies.items():
        if tally.cases:
            print(line(kind, tally))
    wrong = [text for tally in tallies.values() for text in tally.wrong]
    for text in wrong[:20]:
        print(text)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
