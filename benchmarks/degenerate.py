"""Table of degenerate bodies: every kind at rising levels, apart and overlapping.

Run from the repository's root: ``python -m benchmarks.degenerate --poses 200 [KIND ...]``. Kinds,
poses and judge are those of ``tests/tracking/test_degenerate.py``; ``--how deep`` compares with an
independent search and is slow. The table is that of docs/robustness.md.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

TESTS = Path(__file__).resolve().parents[1] / "tests"
HOWS = ("apart", "sunk", "deep")
COLUMNS = (
    "kind",
    "level",
    "how",
    "poses",
    "wrong",
    "uncertified",
    "restarted",
    "error",
    "gap",
    "evaluations",
)


def row(tally: Any, how: str) -> tuple[str, ...]:
    """Return one line: the greatest error and gap over the size, evaluations median/max."""
    spent = tally.evaluations
    return (
        tally.name,
        f"{tally.level:g}",
        how,
        str(tally.queries),
        str(len(tally.failures)),
        str(tally.uncertified),
        str(tally.restarted),
        f"{max(tally.errors):.1e}" if tally.errors else "-",
        f"{max(tally.gaps):.1e}" if tally.gaps else "-",
        f"{np.median(spent):.0f}/{max(spent)}" if spent else "-",
    )


def levels(kind: Any, harder: bool) -> list[float]:
    """The levels of a kind, from harmless to degenerate."""
    chosen = kind.levels + (kind.harder if harder else ())
    return sorted(chosen, key=lambda level: abs(np.log(level)))


def arguments(kinds: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("kinds", nargs="*", help=f"parts of names; default: all of {kinds}")
    parser.add_argument("--poses", type=int, default=200, help="poses of each kind and level")
    parser.add_argument("--how", choices=HOWS, action="append", help="default: apart and sunk")
    parser.add_argument("--harder", action="store_true", help="beyond the levels of the tests")
    parser.add_argument("--scale", type=float, default=1.0, help="size of the bodies")
    parser.add_argument("--seed", type=int, help="default: a fresh one")
    return parser.parse_args()


def main() -> int:
    """Print the table; the exit code is 1 if any answer was wrong."""
    # The judges live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    from families.degenerate import KINDS
    from families.degenerate_queries import run

    given = arguments(list(KINDS))
    seed = given.seed
    if seed is None:
        seed = int(np.random.default_rng().integers(1 << 31))
    chosen = [k for k in KINDS if not given.kinds or any(part in k for part in given.kinds)]
    if not chosen:
        print(f"no kind has {given.kinds} in its name; there are {list(KINDS)}", file=sys.stderr)
        return 2
    print(f"seed {seed}, size {given.scale:g}; error and gap over the pair's size\n")
    print("| " + " | ".join(COLUMNS) + " |")
    print("|" + "---|" * len(COLUMNS))
    failures: list[str] = []
    for name in chosen:
        for level in levels(KINDS[name], given.harder):
            for how in given.how or HOWS[:2]:
                rng = np.random.default_rng([seed, *name.encode()])
                try:
                    tally = run(name, level, given.poses, rng, scale=given.scale, how=how)
                except ValueError as refusal:  # a body refused: said, not silent
                    print(f"| {name} | {level:g} | {how} | refused: {str(refusal)[:60]} |")
                    continue
                print("| " + " | ".join(row(tally, how)) + " |", flush=True)
                failures += tally.failures
    print()
    for failure in failures[:20]:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
