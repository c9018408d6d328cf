"""What got slower from one commit to another: ``python -m benchmarks.regression A B``.

Both commits are checked out beside each other and run the same work (`benchmarks.regression_work`,
of this checkout) in turn, each in processes of their own with its own cache of compiled kernels. A
time is compared with the other commit's of the same round, so that a machine whose speed drifts
does not look like a change. ``--compile`` also takes the processor time of an empty cache.

Commits from 0.2.0 on can be compared: the work calls the public interface and the entry
``run``.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROUNDS = 7
"""Times in turn. Fewer than six cannot tell a change from chance (see `judged`)."""
NOTABLE = 1.03
"""A change of less than 3 % is not told, however steady: relinking alone moves code so far."""
WORK = Path(__file__).with_name("regression_work.py")
COMPILING = "compile, s of processor"


@dataclass(frozen=True)
class Row:
    """A piece of work's times on both commits, in the unit of its name, round by round."""

    name: str
    before: tuple[float, ...]
    after: tuple[float, ...]
    same_answer: bool

    @property
    def ratios(self) -> np.ndarray:
        """(rounds,) after over before, within each round."""
        return np.array(self.after) / np.array(self.before)

    @property
    def ratio(self) -> float:
        return float(np.median(self.ratios))


def judged(row: Row) -> str:
    """Return "slower", "faster" or "": a notable change that all rounds but one show.

    By chance alone at least 6 of 7 rounds lie on a given side once in 16.
    """
    rounds = len(row.ratios)
    if row.ratio > NOTABLE and np.count_nonzero(row.ratios > 1.0) >= rounds - 1:
        return "slower"
    if row.ratio < 1.0 / NOTABLE and np.count_nonzero(row.ratios < 1.0) >= rounds - 1:
        return "faster"
    return ""


def table(rows: list[Row], before: str, after: str) -> str:
    """Return the rows as Markdown: medians, the ratio with its least and greatest, the verdict."""
    lines = [
        f"| work | {before} | {after} | ratio | least to greatest | | same answers |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        ratios = row.ratios
        lines.append(
            f"| {row.name} | {np.median(row.before):.4g} | {np.median(row.after):.4g} "
            f"| {row.ratio:.3f} | {ratios.min():.3f} to {ratios.max():.3f} | {judged(row)} "
            f"| {'yes' if row.same_answer else '**no**'} |"
        )
    return "\n".join(lines)


@contextmanager
def checked_out(commit: str, folder: Path) -> Iterator[Path]:
    """A working tree of a commit, taken away at the end."""
    subprocess.run(
        ["git", "worktree", "add", "--quiet", "--detach", str(folder), commit], check=True
    )
    try:
        yield folder
    finally:
        subprocess.run(["git", "worktree", "remove", "--force", str(folder)], check=True)


def worked(tree: Path, cache: Path, named: str = "") -> dict[str, tuple[float, str]]:
    """Run the work on a tree: of each piece its time and its answer in full digits. With `named`
    only the pieces whose names hold that text."""
    cache.mkdir(mode=0o700, exist_ok=True)
    settings = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "STANDOFF_"))}
    settings |= {"PYTHONPATH": str(tree / "src"), "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, str(WORK), named],
        env=settings,
        cwd=cache,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return {name: (time, answer) for name, time, answer in json.loads(done.stdout)}


def compared(
    trees: tuple[Path, Path], scratch: Path, rounds: int, compiling: bool = False, named: str = ""
) -> list[Row]:
    """Work on both trees in turn and return a row for each piece."""
    times: dict[str, tuple[list[float], list[float]]] = {}
    answers: dict[str, set[str]] = {}
    for number in range(-1, rounds):  # the first fills the caches
        for side, tree in enumerate(trees):
            fresh = f"{number}" if compiling else ""
            for name, (time, answer) in worked(
                tree, scratch / f"cache{side}{fresh}", named
            ).items():
                if number < 0 or (name == COMPILING and not compiling):
                    continue
                times.setdefault(name, ([], []))[side].append(time)
                answers.setdefault(name, set()).add(answer)
    return [
        Row(name, tuple(before), tuple(after), len(answers[name]) == 1)
        for name, (before, after) in times.items()
    ]


def main() -> None:
    reader = argparse.ArgumentParser(description="Name what got slower from one commit to another.")
    reader.add_argument("before", help="a commit")
    reader.add_argument("after", help="another")
    reader.add_argument("--rounds", type=int, default=ROUNDS, help="times that both run in turn")
    reader.add_argument("--named", default="", metavar="TEXT", help="work named so alone")
    reader.add_argument("--compile", action="store_true", help="with empty caches in every round")
    asked = reader.parse_args()
    with ExitStack() as stack:
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        trees = tuple(
            stack.enter_context(checked_out(commit, scratch / side))
            for side, commit in (("before", asked.before), ("after", asked.after))
        )
        rows = compared((trees[0], trees[1]), scratch, asked.rounds, asked.compile, asked.named)
    print(table(rows, asked.before, asked.after))
    slower = [row.name for row in rows if judged(row) == "slower"]
    print("\nSlower by more than the noise: " + (", ".join(slower) or "nothing") + ".")
    sys.exit(bool(slower))


if __name__ == "__main__":
    main()
