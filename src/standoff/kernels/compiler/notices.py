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
    """What entries are needed for, and about how much processor time compiling them takes, s."""

    what: str
    seconds: int
    alone: int
    """The same if only bodies were compiled before in the process: then the kernels that all works
    share are read too."""
    parts: int
    """Number of entries; 0 if the kinds of a pair may need others."""


WORK = {
    "bodies": Work("the geometry of bodies", 15, 15, 19),
    "query": Work("queries of bodies that are apart", 24, 30, 2),
    "contact": Work("queries in contact and penetration", 20, 40, 3),
    "frames": Work("single frames", 3, 4, 5),
    "law": Work("frames of the predictor-corrector", 12, 35, 1),
    "smooth": Work("frames on faces of this pair's kinds", 3, 5, 0),
    "runs": Work("runs of many frames", 5, 6, 2),
    "paper": Work("frames of the paper's law", 15, 30, 2),
    "derivatives": Work("derivatives by the poses", 7, 25, 3),
    "patches": Work("patches of bodies", 8, 25, 2),
    "simulation": Work("simulations of bodies", 50, 80, 2),
    "coupler": Work("the virtual coupler", 2, 3, 1),
    "servo": Work("the servo loop", 25, 60, 3),
    "world": Work("worlds of many bodies", 8, 45, 10),
    "solids": Work("solids in space", 50, 65, 22),
    "planar": Work("planar solids", 15, 20, 4),
}

ALL_SECONDS = 245
"""About how much processor time compiling all of them takes, s."""

BUSY = 1.3
"""Seconds by the clock for a second of a processor, from which on a machine is called busy."""

PACE_SHARE = 0.01
"""Share of a processor below which a pace is not told."""

SEEN = 1.0
"""Processor time from which on its pace is told by what was seen of it, s."""

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
_taken = [0.0, 0.0]
"""By the clock and of a processor, s: what compiling took so far."""
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


def pace() -> float:
    """Return how many seconds by the clock a second of a processor takes, 1 or more: as it was
    while this process compiled, and before that by the machine's load."""
    clock, spent = _taken
    if spent >= SEEN:
        return max(1.0, clock / spent)
    try:
        load = os.getloadavg()[0]
    except (AttributeError, OSError):  # not on Windows, or not known
        return 1.0
    return max(1.0, (load + 1.0) / (os.cpu_count() or 1))


def takes(seconds: float) -> str:
    """Return in words how long work of so many seconds of processor time takes here."""
    slower = pace()
    busy = f", {seconds * slower:.0f} s or so as busy as this machine is" if slower >= BUSY else ""
    return f"about {seconds} s of processor time{busy}"


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
    spent: float
    watching: ExitStack
    told: bool = False
    watched: bool = False

    def still(self) -> str:
        clock, spent = self.taken()
        told = f"still compiling {self.name}{self.place}: {clock:.0f} s so far"
        slower = clock / max(spent, clock * PACE_SHARE)
        if slower < BUSY:
            return f"{told} ..."
        seconds = WORK[self.work].seconds
        return (
            f"{told}, {spent:.0f} s of them on a processor, which others use too; at this pace "
            f"{seconds} s of it take {seconds * slower:.0f} s ..."
        )

    def taken(self) -> tuple[float, float]:
        """By the clock, and of a processor [s]."""
        return time.perf_counter() - self.started, time.process_time() - self.spent


_current: _Part | None = None
"""Only one at a time: the compiler has a lock."""


@contextmanager
def waiting(work: str, name: str) -> Iterator[None]:
    """While an entry is loaded or compiled; says how long it took if its compilation was
    announced."""
    global _current
    _begun[work] += 1
    with ExitStack() as watching:
        began = time.perf_counter(), time.process_time()
        part = _Part(work, name, _place_of(work), *began, watching)
        _current = part
        try:
            yield
        finally:
            _current = None
    if not part.watched:  # it was found on disk
        return
    clock, spent = part.taken()
    _taken[:] = _taken[0] + clock, _taken[1] + spent
    if part.told and clock > 1.0:
        busy = f", {spent:.0f} s of them on a processor" if clock >= BUSY * spent else ""
        say(f"{name} compiled in {clock:.0f} s{busy}")


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
            f"compiling the kernels for {work.what} ({part.name}{part.place}): {takes(seconds)}"
            f"{', kept for next time' if kept else ''}{hint} ..."
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
