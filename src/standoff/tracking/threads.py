"""Rows shared between threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Lock

PARTS = 8
"""Of the rows, for each worker: one that begins late, or whose core is slow, takes fewer."""


def in_parts(work: Callable[[int, int], None], n: int, workers: int) -> None:
    """Do ``work(first, end)`` for n rows, in parts that the workers take one after another.

    The caller's thread is one of them: starting another takes some 0.1 ms. One worker does all in
    one part.
    """
    if workers == 1 or n <= 1:
        work(0, n)
        return
    rows = -(-n // (PARTS * workers))
    firsts, taken = iter(range(0, n, rows)), Lock()

    def take() -> None:
        while True:
            with taken:
                first = next(firsts, n)
            if first == n:
                return
            work(first, min(first + rows, n))

    with ThreadPoolExecutor(workers - 1) as pool:
        others = [pool.submit(take) for _ in range(workers - 1)]
        take()
        for each in others:
            each.result()
