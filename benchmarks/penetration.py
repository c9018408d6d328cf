"""How often the least depth of overlapping bodies is found, against a proven search over s(n).

Run from the repository's root: ``python -m benchmarks.penetration --cases 2000 [KIND ...]``. Each
case is asked three times: cold, and at the end of a motion into depth by a tracker that proves
every frame and by one that follows its local minimum. The kinds, cases and the judge are those of
``tests/families/penetrating.py``; the reference is ``tests/oracles/depth.py``.

``--accuracy`` instead measures the errors on smooth pairs whose depth, points and normal are known
by construction, up to the focal depth where their branch ends.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import standoff as so

TESTS = Path(__file__).resolve().parents[1] / "tests"
WAYS = ("cold", "global", "local")
SHOWN = 20
"""Failures printed in the end."""
BINS = (1e-6, 1e-3, 1e-1, np.inf)
"""Relative excess over the least depth: found, within GLOBAL's promise, and beyond."""


@dataclass
class Tally:
    """What one way of asking found in one kind of pair."""

    excess: list[float] = field(default_factory=list)
    statuses: Counter[str] = field(default_factory=Counter)
    evaluations: list[int] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    def row(self, name: str, way: str) -> str:
        over = np.array(self.excess)
        edges = np.histogram(over, bins=[-1, *BINS])[0] if len(over) else [0] * 4
        told = " ".join(f"{count} {name.lower()}" for name, count in self.statuses.most_common())
        return (
            f"{name:16s} {way:7s} {len(over):6d} {100 * edges[0] / max(len(over), 1):8.2f}% "
            f"{edges[1]:5d} {edges[2]:5d} {edges[3]:5d} {over.max(initial=0.0):9.1e} "
            f"{len(self.failures):5d} "
            f"{np.median(self.evaluations):6.0f}/{max(self.evaluations):<6d} "
            f"{np.median(self.times):7.0f}/{max(self.times):<8.0f} {told}"
        )


HEADER = (
    f"{'pairs':16s} {'way':7s} {'cases':>6s} {'found':>9s} {'<1e-3':>5s} {'<0.1':>5s} {'more':>5s} "
    f"{'worst':>9s} {'wrong':>5s} {'evaluations':>13s} {'µs':>16s} status"
)


def timed(ask: Callable[[], Any]) -> tuple[Any, float]:
    begun = time.perf_counter()
    answer = ask()
    return answer, 1e6 * (time.perf_counter() - begun)


def ask_cold(case: Any) -> tuple[list[so.Proximity], float]:
    answer, spent = timed(lambda: so.distance(case.a.body, case.b.body, *case.poses))
    return [answer], spent


def measure(name: str, cases: int, seed: int, ways: tuple[str, ...]) -> dict[str, Tally]:
    """Ask for all cases of a kind in every way."""
    from families.penetrating import draw_case, excess, faults, track_into

    tallies = {way: Tally() for way in ways}
    for number in range(cases):
        case = draw_case(name, seed, number)
        for way, tally in tallies.items():
            try:
                if way == "cold":
                    answers, spent = ask_cold(case)
                else:
                    blind = bool(number % 2)
                    answers, spent = timed(lambda c=case, w=way, b=blind: track_into(c, w, b))
            except Exception as error:  # a benchmark counts what a test would stop at
                tally.failures.append(f"{case.label}, {way}: {error!r}")
                continue
            last = answers[-1]
            found = faults(case, last)
            found += [f"nan in frame {k}" for k, x in enumerate(answers) if np.isnan(x.distance)][
                :1
            ]
            if found:
                tally.failures.append(f"{case.label}, {way}: {'; '.join(found)}; {last!r}")
            tally.excess.append(excess(case, last))
            tally.statuses[last.status.name] += 1
            tally.evaluations.append(max(x.counts.evaluations for x in answers[-20:]))
            tally.times.append(spent / len(answers))
    return tallies


def accuracy(cases: int, seed: int) -> None:
    """Print the errors on constructed smooth pairs, by share of the focal depth."""
    from families.focal import KINDS, SHARES, focal_errors

    print(
        "errors over the pair's size, the normal's in radians: median/worst; where the constructed"
    )
    print("direction is the least by the reference, as a share of the focal depth")
    for name in KINDS:
        for low, high in SHARES:
            rows, total, statuses = focal_errors(name, low, high, cases, seed)
            if not len(rows):
                print(f"{name:24s} {low:8g}-{high:<7g} none of {total} is the least")
                continue
            columns = [f"{np.median(c):.1e}/{c.max():.1e}" for c in rows.T]
            told = " ".join(f"{count} {status.lower()}" for status, count in statuses.most_common())
            print(
                f"{name:24s} {low:8g}-{high:<7g} {len(rows):6d}/{total:<6d} distance "
                f"{columns[0]:16s} points {columns[1]:16s} normal {columns[2]:16s} {told}",
                flush=True,
            )


def main() -> int:
    """Print the table; the exit code is 1 if any answer was wrong."""
    # The judges live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    from families.penetrating import KINDS

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("kinds", nargs="*", help=f"default: all of {', '.join(KINDS)}")
    parser.add_argument("--cases", type=int, default=2000, help="cases of each kind")
    parser.add_argument("--seed", type=int, help="default: a fresh one")
    parser.add_argument("--ways", nargs="*", choices=WAYS, default=WAYS)
    parser.add_argument("--accuracy", action="store_true", help="errors on constructed pairs")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.kinds) - set(KINDS))
    if unknown:
        parser.error(f"unknown kinds {unknown}: choose from {sorted(KINDS)}")
    seed = arguments.seed
    if seed is None:
        seed = int(np.random.default_rng().integers(1 << 31))
    print(f"seed {seed}")
    if arguments.accuracy:
        accuracy(arguments.cases, seed)
        return 0
    print(
        "evaluations of a query, the most of a step; µs a query, the mean of a step: median/worst"
    )
    print(HEADER)
    failures: list[str] = []
    for name in arguments.kinds or KINDS:
        for way, tally in measure(name, arguments.cases, seed, tuple(arguments.ways)).items():
            print(tally.row(name, way), flush=True)
            failures += tally.failures
    for failure in failures[:SHOWN]:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
