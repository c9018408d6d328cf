"""Rows shared between threads: each is done once, and what goes wrong in a thread is told."""

import signal
import threading
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from standoff.tracking import threads
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


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize("seconds", [1e-9, 1e-4, 1e-2])
def test_no_call_is_long(workers, seconds, monkeypatch):
    """Of rows that take so long each, by a clock that only they move."""
    clock, calls, lock = [0.0], [], threading.Lock()
    monkeypatch.setattr("standoff.tracking.threads.time.monotonic", lambda: clock[0])

    def work(first, end):
        with lock:
            calls.append((first, end))
            clock[0] += seconds * (end - first)

    in_parts(work, 50_000, workers)
    assert sorted(k for first, end in calls for k in range(first, end)) == list(range(50_000))
    longest = max(end - first for first, end in calls)
    assert longest <= max(threads.FIRST_ROWS, 1.01 * threads.HEARD_WITHIN / seconds)
    few = 3 if workers == 1 else 8 * threads.PARTS * workers  # others move the clock, too
    assert len(calls) <= few + 2.0 * clock[0] / threads.HEARD_WITHIN


@pytest.fixture
def heard():
    """Ctrl-C is heard, though a shell that began this in the background has it ignored."""
    kept = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, kept)


@pytest.mark.usefixtures("heard")
@pytest.mark.parametrize("workers", [1, 3])
def test_an_interrupt_is_heard_between_two_calls(workers):
    """By the others, too, who do no more than the call they are in."""
    calls, raised = [], threading.Event()
    met, waited = threading.Barrier(workers, timeout=60.0), threading.local()

    def work(first, end):
        calls.append((first, end))
        if not getattr(waited, "once", False):  # each worker has a part
            waited.once = True
            met.wait()
        if threading.current_thread() is threading.main_thread():
            raised.set()
            signal.raise_signal(signal.SIGINT)
        raised.wait(60.0)
        time.sleep(0.2)

    with pytest.raises(KeyboardInterrupt):
        in_parts(work, 100_000, workers)
    assert len(calls) <= 2 * workers  # of some hundred
