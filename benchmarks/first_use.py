"""What a first use costs: ``python -m benchmarks.first_use`` from an empty cache of kernels.

Prints the processor time until the first ``so.distance`` and the first ``tracker.step`` have
answered, how many entries and modules of machine code were compiled for them, and how many modules
of the package were loaded. ``--before COMMIT`` measures that commit too, in turn, for the ratio; it
needs no more than the public interface.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.regression import checked_out

HERE = Path(__file__).parent.parent
MOST_MODULES = 120
"""Goal: modules of ours that are loaded when the first tracker has stepped."""
MOST_TIME = 0.15
"""Goal: of the processor time of 3691686, before entries shared their kernels' code."""

WORK = """
import resource

def spent():
    now = resource.getrusage(resource.RUSAGE_SELF)
    return now.ru_utime + now.ru_stime

begun = spent()
import json, sys
import numpy as np
import standoff as so

def loaded():
    return sum(name.split(".")[0] == "standoff" for name in sys.modules)

bodies = so.shapes.ellipsoid(0.52, 1.04, 0.89), so.shapes.ellipsoid(0.76, 0.52, 0.95)
rest, first, second = np.eye(4), np.eye(4), np.eye(4)
first[0, 3], second[0, 3] = 2.3, 2.301
so.distance(*bodies, rest, first)
queried = spent() - begun, loaded()
tracker = so.Tracker(*bodies, 1e-3)
state = tracker.start(rest, first)
state, answer = tracker.step(state, rest, second)
done = spent() - begun, loaded()
try:
    from standoff.kernels.entries.preparing import every_entry, was_compiled
    every = list(every_entry())
    entries = sum(entry.ready and was_compiled(entry) for entry in every), len(every)
except ImportError:
    entries = 0, 0
print(json.dumps([*queried, *done, *entries, repr(answer.distance)]))
"""


@dataclass(frozen=True)
class FirstUse:
    """One process's costs, from its import of NumPy on."""

    query_time: float  # s of processor, until the first distance
    query_modules: int  # of the package
    time: float  # s of processor, until the first step
    modules: int
    entries: int  # compiled on the way
    all_entries: int  # that the package has
    answer: str
    code: int  # files of machine code


def used(tree: Path, cache: Path) -> FirstUse:
    """Use a tree's package with the cache that is given."""
    settings = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "STANDOFF_"))}
    settings |= {"PYTHONPATH": str(tree / "src"), "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", WORK],
        env=settings,
        cwd=cache,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    *costs, answer = json.loads(done.stdout)
    return FirstUse(*costs, answer, len(list(cache.rglob("*.nbc"))))


@contextmanager
def empty_cache() -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder) / "cache"
        cache.mkdir(mode=0o700)
        yield cache


def rounds_of(trees: Sequence[Path], rounds: int) -> list[list[tuple[FirstUse, FirstUse]]]:
    """Of each tree (from an empty cache, from the full one) round by round, the trees in turn."""
    found: list[list[tuple[FirstUse, FirstUse]]] = [[] for _ in trees]
    for _ in range(rounds):
        for kept, tree in zip(found, trees, strict=True):
            with empty_cache() as cache:
                kept.append((used(tree, cache), used(tree, cache)))
    return found


def median(values: Sequence[float]) -> float:
    return float(np.median(values))


def lines(found: list[tuple[FirstUse, FirstUse]]) -> list[str]:
    """The costs of one tree as rows of a table."""
    empty, full = [cold for cold, _ in found], [warm for _, warm in found]
    one = empty[0]
    modules = f"{one.modules} | ≤ {MOST_MODULES}"
    return [
        f"| s of processor to the first distance | {median([u.query_time for u in empty]):.1f} | |",
        f"| s of processor to the first step | {median([u.time for u in empty]):.1f} | |",
        f"| the same from the full cache | {median([u.time for u in full]):.2f} | |",
        f"| entries compiled, of all | {one.entries} of {one.all_entries} | |",
        f"| modules of machine code kept | {one.code} | |",
        f"| modules of the package loaded by the first distance | {one.query_modules} | |",
        f"| modules of the package loaded by the first step | {modules} |",
    ]


def main(given: Sequence[str] | None = None) -> None:
    reader = argparse.ArgumentParser(description="What a first use costs.")
    reader.add_argument("--before", metavar="COMMIT", help="another commit, for the ratio")
    reader.add_argument("--rounds", type=int, default=1, help="times in turn")
    asked = reader.parse_args(given)
    with ExitStack() as stack:
        trees = [HERE]
        if asked.before:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "before"
            trees.append(stack.enter_context(checked_out(asked.before, folder)))
        found = rounds_of(trees, asked.rounds)
    print(f"load {os.getloadavg()[0]:.1f}, {asked.rounds} rounds\n")
    print("\n".join(["| first use | here | goal |", "|---|---|---|", *lines(found[0])]))
    if asked.before:
        ratio = median(
            [here.time / other.time for (here, _), (other, _) in zip(*found, strict=True)]
        )
        print(
            f"| time to the first step over that of {asked.before} | {ratio:.3f} | ≤ {MOST_TIME} |"
        )
        print(
            "\n".join(["", f"| first use | {asked.before} | |", "|---|---|---|", *lines(found[1])])
        )


if __name__ == "__main__":
    main()
