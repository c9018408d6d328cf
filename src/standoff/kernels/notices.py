"""What the library says on stderr while somebody waits for the compiler."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

QUIET = "STANDOFF_QUIET"
"""Set to 1 in the environment: nothing is said."""

WORK = {
    "bodies": ("the geometry of bodies", 6),
    "query": ("queries of bodies that are apart", 15),
    "contact": ("queries in contact and penetration", 10),
    "frames": ("frames of the predictor-corrector", 4),
    "runs": ("runs of many frames", 2),
    "paper": ("frames of the paper's law", 5),
    "paper runs": ("runs of the paper's law", 2),
    "study": ("the paper's studies", 4),
}
"""What entries are needed for, and about how long one core of 2024 compiles them, s."""

_said: set[str] = set()


def say(text: str) -> None:
    """One line on stderr, at once, also where stderr is a pipe or a file."""
    if os.environ.get(QUIET, "0") in ("", "0") and sys.stderr is not None:
        print(f"standoff: {text}", file=sys.stderr, flush=True)


def compiling(work: str | None) -> None:
    """Say, once a process for each work, that its kernels are compiled now."""
    if work is None or work in _said:
        return
    what, seconds = WORK[work]
    hint = "" if _said else " (`standoff warmup` compiles all of them ahead)"
    _said.add(work)
    say(f"compiling the kernels for {what}: once, about {seconds} s{hint} ...")


_waits: list[str] = []


@contextmanager
def waiting(work: str) -> Iterator[None]:
    """While an entry is loaded or compiled; says how long it took where it was compiled."""
    started, new = time.perf_counter(), work not in _said
    _waits.append(work)
    try:
        yield
    finally:
        _waits.pop()
    seconds = time.perf_counter() - started
    if new and work in _said and seconds > 1.0:
        say(f"compiled in {seconds:.0f} s")
