"""What the library says on stderr while somebody waits for the compiler."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NamedTuple

QUIET = "STANDOFF_QUIET"
"""Set to 1 in the environment: nothing is said."""


class Work(NamedTuple):
    """What entries are needed for, and about how long one core compiles them, s."""

    what: str
    seconds: int
    alone: int
    """Where nothing but bodies was compiled before in the process: the kernels below all works are
    read then."""


WORK = {
    "bodies": Work("the geometry of bodies", 10, 10),
    "query": Work("queries of bodies that are apart", 20, 25),
    "contact": Work("queries in contact and penetration", 12, 35),
    "frames": Work("frames of the predictor-corrector", 7, 25),
    "smooth": Work("frames on faces of this pair's kinds", 3, 5),
    "runs": Work("runs of many frames", 1, 2),
    "paper": Work("frames of the paper's law", 8, 25),
    "paper runs": Work("runs of the paper's law", 1, 2),
    "derivatives": Work("derivatives by the poses", 3, 25),
    "simulation": Work("simulations of bodies", 12, 45),
    "coupler": Work("the virtual coupler", 2, 3),
    "servo": Work("the servo loop", 7, 45),
    "study": Work("the paper's studies", 2, 3),
}

ALL_SECONDS = 85
"""About how long one core compiles all of them, s."""

_said: set[str] = set()


def say(text: str) -> None:
    """One line on stderr, at once, also where stderr is a pipe or a file."""
    if os.environ.get(QUIET, "0") in ("", "0") and sys.stderr is not None:
        with suppress(OSError, ValueError):  # nobody reads it: the work goes on
            print(f"standoff: {text}", file=sys.stderr, flush=True)


def compiling(work: str | None) -> None:
    """Say, once a process for each work, that its kernels are compiled now."""
    if work is None or work in _said:
        return
    seconds = WORK[work].seconds if _said - {"bodies"} else WORK[work].alone
    hint = "" if _said else " (`standoff warmup` compiles all of them ahead)"
    _said.add(work)
    say(
        f"compiling the kernels for {WORK[work].what}: once for this installation, about "
        f"{seconds} s{hint} ..."
    )


@contextmanager
def told_elsewhere() -> Iterator[None]:
    """While somebody else tells what is compiled: `compiling` says nothing."""
    before = set(_said)
    _said.update(WORK)
    try:
        yield
    finally:
        _said.intersection_update(before)


@contextmanager
def waiting(work: str) -> Iterator[None]:
    """While an entry is loaded or compiled; says how long it took where it was compiled."""
    started, new = time.perf_counter(), work not in _said
    yield
    seconds = time.perf_counter() - started
    if new and work in _said and seconds > 1.0:
        say(f"compiled in {seconds:.0f} s")
