"""Rows shared between threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np


def in_parts(work: Callable[[int, int], None], n: int, workers: int) -> None:
    """Do ``work(first, end)`` for n rows: one part for each worker, each part in a thread.

    One worker, or one row, is done in the caller's thread: starting another takes some 0.1 ms.
    """
    if workers == 1 or n <= 1:
        work(0, n)
        return
    ends = np.linspace(0, n, workers + 1).astype(int).tolist()
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(work, ends[:-1], ends[1:]))
