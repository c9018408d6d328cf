"""Rows shared between threads, in calls so short that an interrupt is heard."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event, Lock

PARTS = 8
"""Of the rows, for each worker: one that begins late, or whose core is slow, takes fewer."""
FIRST_ROWS = 1024
"""Rows of a first call: of pairs that are apart 1 ms, of those deep in each other up to a second.
Most calls have no more rows, and are not split."""
HEARD_WITHIN = 0.2
"""Seconds that a later call should take at most: Python hears Ctrl-C only between two calls."""
MOST_GROWTH = 8
"""Times as many rows as in the call before, at most: later ones may take longer."""


def in_parts(work: Callable[[int, int], None], n: int, workers: int) -> None:
    """Do ``work(first, end)`` for n rows, in parts that the workers take one after another.

    The caller's thread is one of them: starting another takes some 0.1 ms. One worker does all in
    one part. An error, or an interrupt, ends what the others do after their present call.
    """
    ended = Event()
    if workers == 1 or n <= 1:
        _in_calls(work, 0, n, ended)
        return
    rows = -(-n // (PARTS * workers))
    firsts, taken = iter(range(0, n, rows)), Lock()

    def take() -> None:
        while True:
            with taken:
                first = next(firsts, n)
            if first == n or ended.is_set():
                return
            _in_calls(work, first, min(first + rows, n), ended)

    with ThreadPoolExecutor(workers - 1) as pool:
        others = [pool.submit(take) for _ in range(workers - 1)]
        try:
            take()
            for each in others:
                each.result()
        finally:
            ended.set()


def _in_calls(work: Callable[[int, int], None], first: int, end: int, ended: Event) -> None:
    """One part, in calls of about `HEARD_WITHIN` until it is done or has ended."""
    rows = FIRST_ROWS
    while True:
        last = min(first + rows, end)
        begun = time.monotonic()
        work(first, last)
        if last == end or ended.is_set():
            return
        took = max(time.monotonic() - begun, HEARD_WITHIN / MOST_GROWTH)
        rows = max(1, int(rows * HEARD_WITHIN / took))
        first = last
