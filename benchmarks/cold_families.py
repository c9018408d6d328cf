"""Table of cold and tracked queries over random families, each proven by support functions.

Run from the repository's root: ``python -m benchmarks.cold_families --poses 3000 [FAMILY ...]``.
The families, the poses and the proof are those of ``tests/tracking/test_cold_families.py`` and
``test_tracked_families.py``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

TESTS = Path(__file__).resolve().parents[1] / "tests"
HEADER = (
    f"{'family':29s} {'start':10s} {'poses':>6s} {'wrong':>5s} {'certificate gap':>17s} "
    f"{'independent gap':>17s} {'restarts':>12s} {'evaluations':>11s}"
)


def row(report: Any) -> str:
    """Return one line: median/max of the gaps over the pair's size, of restarts and evaluations."""
    wrong = len(report.failures)
    if not report.independent:
        return f"{report.name:29s} {report.how:10s} {wrong:6d} {wrong:5d}"
    gaps = [
        f"{np.median(values):.1e}/{np.max(values):.1e}"
        for values in (report.certificate, report.independent)
    ]
    restarted = int(np.count_nonzero(report.restarts))
    restarts = f"{restarted} ({max(report.restarts)})"
    evaluations = f"{np.median(report.evaluations):.0f}/{max(report.evaluations)}"
    return (
        f"{report.name:29s} {report.how:10s} {wrong + len(report.independent):6d} {wrong:5d} "
        f"{gaps[0]:>17s} {gaps[1]:>17s} {restarts:>12s} {evaluations:>11s}"
    )


def main() -> int:
    """Print the table; the exit code is 1 if any answer was wrong."""
    # The judges live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    from families.cold_queries import run_family
    from families.pairs import FAMILIES
    from families.tracked_motions import run_tracked, tracked_families

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("families", nargs="*", help=f"default: all of {', '.join(FAMILIES)}")
    parser.add_argument("--poses", type=int, default=3000, help="poses of each family")
    parser.add_argument("--seed", type=int, help="default: a fresh one")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.families) - set(FAMILIES))
    if unknown:
        parser.error(f"unknown families {unknown}: choose from {sorted(FAMILIES)}")
    seed = arguments.seed
    if seed is None:
        seed = int(np.random.default_rng().integers(1 << 31))
    print(f"seed {seed}; gaps and evaluations median/max, gaps over the pair's size;")
    print("restarts: queries with any (most of one query)")
    print(HEADER)
    failures: list[str] = []
    for name in arguments.families or FAMILIES:
        reports = [*run_family(name, arguments.poses, seed)]
        if name in tracked_families():
            reports.append(run_tracked(name, arguments.poses, seed))
        for report in reports:
            print(row(report), flush=True)
            failures += report.failures
    for failure in failures[:20]:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
