"""A soak's parts in parallel processes; the result depends only on the seed."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection, wait
from typing import Any, NamedTuple

from standoff.kernels.compiler.notices import QUIET
from standoff.kernels.entries.preparing import prepare_all
from standoff_studies.soak.adversary import run_round
from standoff_studies.soak.cases import draw_case
from standoff_studies.soak.failures import (
    Facts,
    breach_facts,
    exception_facts,
    failure_facts,
)
from standoff_studies.soak.ledger import Ledger, Part
from standoff_studies.soak.preparing import compile_kernels
from standoff_studies.soak.running import run_case
from standoff_studies.soak.tally import Tally

PATIENCE = 300.0
"""Seconds after which a pair counts as hanging: thousands of times the usual. Time in which this
process does not run either, as in a suspended computer, does not count."""

PREPARATION = 3600.0
"""Seconds that a process may take to load the kernels, or to compile them if they cannot be cached:
minutes on a busy machine."""

LOOK = 1.0
"""Seconds between checks for a pair that hangs."""


class Done(NamedTuple):
    """A part, its counts, and the failure of the first pair that failed, as plain data."""

    part: Part
    tally: Tally
    failed: int | None = None
    facts: Facts | None = None


Tell = Callable[[Done], None]
"""Called with every finished part."""


def run_part(
    seed: int, frames: int, part: Part, at: Callable[[int], None] = lambda number: None
) -> Done:
    """Run pairs first .. end - 1, each with a round of the adversary, up to the first that fails.

    Parameters
    ----------
    seed, frames : int
    part : (first, end)
    at : callable
        Called with the number of every pair that begins.
    """
    tally = Tally()
    for number in range(*part):
        at(number)
        try:
            case, a, b, moves = draw_case(seed, number, frames)
            counted, failure = run_case(case, a, b, moves)
            provoked, breaches = run_round(seed, number)
        except Exception:
            facts = exception_facts(seed, number, frames, traceback.format_exc())
            return Done(part, tally, number, facts)
        if failure is not None:
            return Done(part, tally, number, failure_facts(failure))
        if breaches:
            return Done(part, tally, number, breach_facts(breaches[0]))
        tally.add(counted)
        tally.add(provoked)
    return Done(part, tally)


def soak(ledger: Ledger, pairs: int, jobs: int, tell: Tell) -> Done | None:
    """Run what is left of a number of pairs; finished parts are added to the ledger.

    With one job they run in this process, otherwise in `jobs` others, which are watched: if one
    dies or hangs, its pair fails.

    Returns
    -------
    Done or None
        The part with the failure of the lowest pair.
    """
    parts = ledger.left(pairs)

    def hear(done: Done) -> None:
        if done.facts is None:
            ledger.add(done.part, done.tally)
        tell(done)

    if jobs > 1:
        return _side_by_side(ledger, parts, jobs, hear)
    for part in parts:
        done = run_part(ledger.seed, ledger.frames, part)
        hear(done)
        if done.facts is not None:
            return done
    return None


class _Worker:
    """A process that runs one part after another, the pipe to it, and its current pair."""

    def __init__(self, seed: int, frames: int) -> None:
        # spawn: a fork would copy the locks of the threads of Numba and of the progress bar
        context = multiprocessing.get_context("spawn")
        self.seed, self.frames = seed, frames
        self.pipe, other = context.Pipe()
        self.place: Any = context.Value("q", 0, lock=False)
        arguments = (other, seed, frames, self.place)
        self.process = context.Process(target=_work, args=arguments, daemon=True)
        self.process.start()
        other.close()
        self.part: Part = (0, 0)
        self.ready = False
        self.begin()

    def begin(self) -> None:
        """Start the clock of a part's first pair, or of preparation if the process is not ready."""
        self.seen, self.waited, self.looked = self.part[0], 0.0, time.monotonic()

    def give(self, part: Part) -> None:
        """Send a part, to begin when the process is ready."""
        self.part = part
        self.place.value = part[0]
        self.begin()
        self.pipe.send(part)

    def hear(self) -> Done | None:
        """Return a finished part, or None if the process reports that it is ready.

        Raises
        ------
        EOFError, OSError
            It died.
        """
        said: Done | None = self.pipe.recv()
        if said is None:
            self.ready = True
            self.begin()
        return said

    def lost(self, why: str) -> Done:
        """Return the failure of the pair at which the process died or hangs."""
        number = int(self.place.value)
        facts = exception_facts(self.seed, number, self.frames, why)
        return Done(self.part, Tally(), number, facts)

    def hangs(self) -> bool:
        """Has the pair, or the preparation, been running for too long?"""
        now, number = time.monotonic(), int(self.place.value)
        passed = min(now - self.looked, 2.0 * LOOK)
        self.waited = self.waited + passed if number == self.seen else 0.0
        self.seen, self.looked = number, now
        return self.waited > (PATIENCE if self.ready else PREPARATION)

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()


def _side_by_side(ledger: Ledger, parts: list[Part], jobs: int, hear: Tell) -> Done | None:
    """Hand out the parts in order; after a failure, wait only for parts before it."""
    if parts:
        prepare_all()  # once, here, not in every worker in parallel
    waiting = list(parts)
    workers: list[_Worker] = []
    first: Done | None = None
    try:
        while waiting or workers:
            while waiting and len(workers) < jobs:
                workers.append(_Worker(ledger.seed, ledger.frames))
                workers[-1].give(waiting.pop(0))
            for worker, done in _heard(workers):
                hear(done)
                if done.facts is not None and (first is None or done.part < first.part):
                    first, waiting = done, []
                if waiting and worker.process.is_alive():
                    worker.give(waiting.pop(0))
                else:
                    workers.remove(worker)
                    worker.end()
            if first is not None:
                for worker in [w for w in workers if w.part > first.part]:
                    workers.remove(worker)
                    worker.end()
    finally:
        for worker in workers:
            worker.end()
    return first


def _heard(workers: list[_Worker]) -> Iterator[tuple[_Worker, Done]]:
    """Wait briefly for messages from the workers, and check for those that hang."""
    ready = wait([worker.pipe for worker in workers], timeout=LOOK)
    for worker in list(workers):
        if worker.pipe in ready:
            try:
                done = worker.hear()
            except (EOFError, OSError):
                worker.process.join()
                code = worker.process.exitcode
                done = worker.lost(f"the process died (exit code {code})")
            if done is not None:
                yield worker, done
        elif worker.hangs():
            worker.process.kill()
            worker.process.join()
            why = f"no answer in {PATIENCE:g} s: the pair hangs"
            if not worker.ready:
                why = f"the kernels were not ready in {PREPARATION:g} s"
            yield worker, worker.lost(why)


def _work(pipe: Connection, seed: int, frames: int, place: Any) -> None:
    """Load the kernels, say so, and run parts until the pipe closes or the parent is gone."""
    os.environ[QUIET] = "1"  # the parent has already reported on the compiler
    # The parent ends its workers on Ctrl-C; their tracebacks would only hide its message.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    threading.Thread(target=_end_with_parent, daemon=True).start()

    def at(number: int) -> None:
        place.value = number

    compile_kernels()
    try:
        pipe.send(None)
        while True:
            pipe.send(run_part(seed, frames, pipe.recv(), at))
    except (EOFError, OSError):
        return


def _end_with_parent() -> None:
    """End this process as soon as the one that started it has ended, for whatever reason."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
