"""Rows shared between threads: each is done once, and what goes wrong in a thread is told."""

import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from standoff.tracking.threads import in_parts


@settings(max_examples=30)
@given(st.integers(0, 200), st.integers(1, 9))
def test_each_row_is_done_once(n, workers):
    done, lock = [], threading.Lock()

    def work(first, end):
        with lock:
            done.extend(range(first, end))

    in_parts(work, n, workers)
    assert sorted(done) == list(range(n))


def test_all_workers_take_part():
    met = threading.Barrier(3, timeout=60.0)
    waited = threading.local()

    def work(first, end):
        if not getattr(waited, "once", False):  # a worker's first part
            waited.once = True
            met.wait()

    in_parts(work, 100, 3)


@pytest.mark.parametrize("workers", [1, 2, 3])
@pytest.mark.parametrize("bad", [0, 41, 99])
def test_an_error_in_any_part_is_told(bad, workers):
    def work(first, end):
        if first <= bad < end:
            raise ValueError(f"row {bad}")

    with pytest.raises(ValueError, match=f"row {bad}"):
        in_parts(work, 100, workers)
