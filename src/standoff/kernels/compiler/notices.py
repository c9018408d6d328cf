"""What the library says on stderr while someone waits, above all for the compiler."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

QUIET = "STANDOFF_QUIET"
"""Set to 1 in the environment: nothing is said."""


class Work(NamedTuple):
    """What entries are needed for, and about how long one core compiles them, s."""

    what: str
    seconds: int
    alone: int
    """The same if only bodies were compiled before in the process: then the kernels that all works
    share are read too."""
    parts: int
    """Number of entries; 0 if the kinds of a pair may need others."""


WORK = {
    "bodies": Work("the geometry of bodies", 10, 10, 17),
    "query": Work("queries of bodies that are apart", 20, 25, 2),
    "contact": Work("queries in contact and penetration", 12, 35, 3),
    "frames": Work("single frames", 2, 3, 5),
    "law": Work("frames of the predictor-corrector", 12, 35, 1),
    "smooth": Work("frames on faces of this pair's kinds", 3, 5, 0),
    "runs": Work("runs of many frames", 1, 2, 2),
    "paper": Work("frames of the paper's law", 8, 25, 2),
    "derivatives": Work("derivatives by the poses", 3, 25, 3),
    "patches": Work("patches of bodies", 5, 25, 2),
    "simulation": Work("simulations of bodies", 30, 60, 2),
    "coupler": Work("the virtual coupler", 2, 3, 1),
    "servo": Work("the servo loop", 25, 60, 3),
    "world": Work("worlds of many bodies", 5, 45, 10),
    "solids": Work("solids in space", 36, 50, 20),
    "planar": Work("planar solids", 15, 20, 4),
}

ALL_SECONDS = 180
"""About how long one core compiles all of them, s."""

PERIOD = 10.0
"""Longest time without a line while somebody waits, s."""

SHORTEST_LOOK = 0.05
"""Between two looks at the clock, s."""

LET_GO = 1.0
"""Longest time that the end of a wait is delayed by a line that is being written, s: a full pipe
may have no reader."""

Item = TypeVar("Item")

_said: set[str] = set()
_begun: Counter[str] = Counter()
_place: ContextVar[tuple[int, int] | None] = ContextVar("place", default=None)
_spoken = 0.0
_lines: list[Callable[[], str]] = []


def quiet() -> bool:
    """Has somebody asked for silence?"""
    return os.environ.get(QUIET, "0") not in ("", "0")


def say(text: str) -> None:
    """One line on stderr, at once, also where stderr is a pipe or a file."""
    global _spoken
    _spoken = time.monotonic()
    if not quiet() and sys.stderr is not None:
        with suppress(OSError, ValueError):  # nobody reads it: the work goes on
            print(f"standoff: {text}", file=sys.stderr, flush=True)


@contextmanager
def alive(line: Callable[[], str]) -> Iterator[None]:
    """While this lasts, a line is printed whenever nothing was printed for `PERIOD`.

    A thread prints it: LLVM lets other threads run while it compiles. If one such wait is part of
    another, the inner one's line is printed.
    """
    ended, begun = threading.Event(), time.monotonic()

    def silence() -> float:
        return time.monotonic() - max(begun, _spoken)

    def watch() -> None:
        while not ended.wait(max(SHORTEST_LOOK, PERIOD - silence())):
            if silence() >= PERIOD and _lines[-1:] == [line]:
                say(line())

    watcher = threading.Thread(target=watch, name="standoff-notices", daemon=True)
    with suppress(RuntimeError):  # no thread to be had: the work goes on without
        if not quiet():
            watcher.start()
    _lines.append(line)
    try:
        yield
    finally:
        _lines.remove(line)
        ended.set()
        if watcher.ident is not None:
            watcher.join(LET_GO)


def parts(items: Iterable[Item]) -> Iterator[Item]:
    """Each of the items; what is compiled for it is reported as that part of so many."""
    each = list(items)
    for number, item in enumerate(each, 1):
        token = _place.set((number, len(each)))
        try:
            yield item
        finally:
            _place.reset(token)


@dataclass
class _Part:
    """An entry that is loaded, or compiled where it is not found."""

    work: str
    name: str
    place: str
    started: float
    watching: ExitStack
    told: bool = False
    watched: bool = False

    def still(self) -> str:
        seconds = time.perf_counter() - self.started
        return f"still compiling {self.name}{self.place}: {seconds:.0f} s so far ..."


_current: _Part | None = None
"""Only one at a time: the compiler has a lock."""


@contextmanager
def waiting(work: str, name: str) -> Iterator[None]:
    """While an entry is loaded or compiled; says how long it took if its compilation was
    announced."""
    global _current
    _begun[work] += 1
    with ExitStack() as watching:
        part = _Part(work, name, _place_of(work), time.perf_counter(), watching)
        _current = part
        try:
            yield
        finally:
            _current = None
    seconds = time.perf_counter() - part.started
    if part.told and seconds > 1.0:
        say(f"{name} compiled in {seconds:.0f} s")


def _place_of(work: str) -> str:
    """Which part of how many the entry begun now is."""
    place, most = _place.get(), WORK[work].parts
    if place is not None and place[1] > 1:
        return f", part {place[0]} of {place[1]}"
    return f", part {_begun[work]} of at most {most}" if place is None and most > 1 else ""


def compiling(kept: bool) -> None:
    """Say that the present entry was not found and is compiled now; once per process for each work.

    Parameters
    ----------
    kept : bool
        Can the machine code be kept?
    """
    part = _current
    if part is None:
        return
    if part.work not in _said:
        work = WORK[part.work]
        seconds = work.seconds if _said - {"bodies"} else work.alone
        hint = "" if _said else "; `standoff warmup` compiles all of them ahead"
        _said.add(part.work)
        part.told = True
        say(
            f"compiling the kernels for {work.what} ({part.name}{part.place}): at most about "
            f"{seconds} s of one core{', kept for next time' if kept else ''}{hint} ..."
        )
    if not part.watched:
        part.watched = True
        part.watching.enter_context(alive(part.still))


@contextmanager
def told_elsewhere() -> Iterator[None]:
    """While someone else reports what is compiled: `compiling` only says that it is still
    running."""
    before = set(_said)
    _said.update(WORK)
    try:
        yield
    finally:
        _said.intersection_update(before)
