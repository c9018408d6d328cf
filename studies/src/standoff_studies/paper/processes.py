"""Chapters of figures made in parallel processes; one that dies loses only its figure."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

from standoff.kernels.compiler import cache
from standoff.kernels.compiler.notices import QUIET
from standoff.kernels.entries.preparing import prepare_named
from standoff_studies.paper.figure import Entry
from standoff_studies.paper.making import Made, make_and_write

Tell = Callable[[Entry, Made | None], None]
"""Called when a figure is begun (with None) and with its result."""


class Needed(NamedTuple):
    """A worker's message that it needs an entry of the kernels that is not on disk."""

    module: str
    name: str


class Order(NamedTuple):
    """Where the files go, and whether animations are drawn."""

    folder: Path
    animations: bool


def make_all(entries: Sequence[Entry], order: Order, jobs: int, tell: Tell) -> list[Made]:
    """Make figures and write their files.

    Parameters
    ----------
    entries : sequence of Entry
    order : Order
    jobs : int
        Greatest number of processes. The figures of a chapter share one, and with it their run.
    tell : callable

    Returns
    -------
    list of Made
        In the order of `entries`. A figure that fails is one of them.
    """
    chapters = _by_chapter(entries)
    made: dict[str, Made] = {}

    def hear(entry: Entry, result: Made | None) -> None:
        if result is not None:
            made[entry.key] = result
        tell(entry, result)

    if jobs < 2 or len(chapters) < 2:
        for entry in (entry for chapter in chapters for entry in chapter):
            hear(entry, None)
            hear(entry, make_and_write(entry, *order))
    else:
        _side_by_side(chapters, order, jobs, hear)
    return [made[entry.key] for entry in entries]


def _by_chapter(entries: Sequence[Entry]) -> list[list[Entry]]:
    ordered = sorted(entries, key=lambda entry: entry.chapter)
    chapters = [list(group) for _, group in groupby(ordered, key=lambda entry: entry.chapter)]
    # restore the report's order, which sorting by name has lost
    return sorted(chapters, key=lambda chapter: entries.index(chapter[0]))


class _Worker:
    """A process that makes one chapter after another, and the pipe to it."""

    def __init__(self, order: Order) -> None:
        # spawn: a fork would copy the locks of the threads of Numba and of the progress bar
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=_work, args=(other, order), daemon=True)
        self.process.start()
        other.close()
        self.left: list[Entry] = []

    def give(self, chapter: list[Entry]) -> None:
        """Send a chapter; `left` are its figures without a result."""
        self.left = list(chapter)
        self.pipe.send(self.left)

    def end(self) -> None:
        self.process.terminate()
        self.process.join()
        self.pipe.close()


def _side_by_side(chapters: Sequence[list[Entry]], order: Order, jobs: int, hear: Tell) -> None:
    waiting = list(chapters)
    workers: list[_Worker] = []
    try:
        while waiting or workers:
            while waiting and len(workers) < jobs:
                workers.append(_Worker(order))
                workers[-1].give(waiting.pop(0))
            for pipe in wait([worker.pipe for worker in workers]):
                worker = next(worker for worker in workers if worker.pipe is pipe)
                again = _receive(worker, hear)
                if again is None:
                    continue
                if again:
                    waiting.insert(0, again)
                if waiting and worker.process.is_alive():
                    worker.give(waiting.pop(0))
                else:
                    workers.remove(worker)
                    worker.end()
    finally:
        for worker in workers:
            worker.end()


def _receive(worker: _Worker, hear: Tell) -> list[Entry] | None:
    """Receive one message from a worker: None while it works, else what another must make."""
    try:
        word = worker.pipe.recv()
        if isinstance(word, Needed):
            _compile(word)
            worker.pipe.send(word)
            return None
        entry, result = word
    except (EOFError, OSError):
        # the process is gone: killed, or out of memory. Its figure fails, the others continue.
        worker.process.join()
        lost = worker.left.pop(0)
        code = worker.process.exitcode
        hear(lost, Made(lost, 0.0, error=f"its process ended unexpectedly (exit code {code})"))
        return worker.left
    hear(entry, result)
    if result is not None:
        worker.left.pop(0)
    return None if worker.left else []


def _compile(needed: Needed) -> None:
    """Compile here, once, what every worker would compile separately."""
    with suppress(Exception):  # the worker gets the same error, and its figure reports it
        prepare_named(*needed)


def asking(pipe: Connection) -> Callable[[Any], None]:
    """Return what a worker calls for a function's entry that is not on disk."""

    def ask(function: Any) -> None:
        pipe.send(Needed(function.__module__, function.__name__))
        pipe.recv()  # it is on disk now, if it can be cached

    return ask


def _work(pipe: Connection, order: Order) -> None:
    """Make chapters until the pipe closes."""
    cache.compiled_elsewhere = asking(pipe)
    os.environ[QUIET] = "1"  # the parent has already reported on the compiler
    # The parent ends its workers on Ctrl-C; their tracebacks would only hide its message.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Leave by an exception, so that no half-written file is left.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    for chapter in _received(pipe):
        for entry in chapter:
            pipe.send((entry, None))
            pipe.send((entry, make_and_write(entry, *order)))


def _received(pipe: Connection) -> Iterator[list[Entry]]:
    while True:
        try:
            yield pipe.recv()
        except (EOFError, OSError):
            return
