"""Processes that work for this one: quiet, and ended with it."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TypeVar

from standoff.kernels.compiler.notices import QUIET

Result = TypeVar("Result")


def result_of(ended: Future[Result]) -> Result:
    """What a worker gave; raises OSError if its process ended."""
    try:
        return ended.result()
    except BrokenProcessPool as error:
        raise OSError(
            "a worker's process ended by itself, as when memory runs out; run the same command "
            "again to go on, with fewer --workers if it happens again"
        ) from error


@contextmanager
def worker_processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of them; what is running is given up where this ends by an exception."""
    # spawn: a fork would copy the locks of the threads of Numba and of the progress bar
    pool = ProcessPoolExecutor(
        workers,
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_begin,
    )
    try:
        yield pool
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _begin() -> None:
    """Make a new process a worker, which ends with its parent."""
    os.environ[QUIET] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what an interrupt ends
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
