"""The log of switches, and the net events of a frame."""

import numpy as np

from standoff.kernels.compiler.decorators import kernel

# Counts, in one int64 array.
EVALUATIONS, CORRECTIONS, SATURATIONS, CHART_CHANGES, RESTARTS, REGULARISED, EVENTS = range(7)
SEARCHES, FOOT_POINTS, SOLVED_PARAMETERS, GENERAL_FRAMES = range(7, 11)
N_COUNTS = 11
# Behind them, the evaluations after which the frame must end (its deadline).
LIMIT = N_COUNTS
# May the frame begin with the polytope that was kept, and keep its own; has it kept one?
KEEPING, KEPT = N_COUNTS + 1, N_COUNTS + 2
N_COUNT_SLOTS = N_COUNTS + 3
NO_LIMIT = 1 << 40

# Columns of the log, a flat array of MAX_EVENTS rows: body (0 A, 1 B), from, to, value of the
# switching function, slope.
BODY, SOURCE, TARGET, VALUE, SLOPE_COLUMN = range(5)
EVENT_COLUMNS = 5
MAX_EVENTS = 64
ERASED = -1.0


def new_counts() -> np.ndarray:
    """Counts of zero, without a deadline, for kernels called by themselves."""
    counts = np.zeros(N_COUNT_SLOTS, dtype=np.int64)
    counts[LIMIT] = NO_LIMIT
    return counts


@kernel
def exhausted(work):
    """Has the frame spent the evaluations that its deadline allows?"""
    return work.counts[EVALUATIONS] >= work.counts[LIMIT]


@kernel
def log_event(work, body, source, target, value, slope):
    """Append a switch; beyond the log's length it is dropped."""
    counts, events = work.counts, work.events
    k = counts[EVENTS]
    if k < MAX_EVENTS:
        events[EVENT_COLUMNS * k + BODY] = body
        events[EVENT_COLUMNS * k + SOURCE] = source
        events[EVENT_COLUMNS * k + TARGET] = target
        events[EVENT_COLUMNS * k + VALUE] = value
        events[EVENT_COLUMNS * k + SLOPE_COLUMN] = slope
        counts[EVENTS] = k + 1


@kernel
def erase(events, body, first, last):
    for k in range(first, last):
        if events[EVENT_COLUMNS * k + BODY] == body:
            events[EVENT_COLUMNS * k + BODY] = ERASED


@kernel
def erase_loops(events, n, body, start, end):
    """Keep only the loop-free path from start to end of one body's events. True if there is one.

    A prediction may cross a boundary and the correction come back: that is no event.
    """
    for k in range(n):
        if events[EVENT_COLUMNS * k + BODY] != body:
            continue
        if events[EVENT_COLUMNS * k + TARGET] == start:
            erase(events, body, 0, k + 1)
            continue
        for m in range(k):
            if (
                events[EVENT_COLUMNS * m + BODY] == body
                and events[EVENT_COLUMNS * m + TARGET] == events[EVENT_COLUMNS * k + TARGET]
            ):
                erase(events, body, m + 1, k + 1)
                break
    at = start
    for k in range(n):
        if events[EVENT_COLUMNS * k + BODY] == body:
            if events[EVENT_COLUMNS * k + SOURCE] != at:
                return False
            at = events[EVENT_COLUMNS * k + TARGET]
    return at == end


@kernel
def tidy_events(work, old_a, old_b, new_a, new_b):
    """Reduce the log to the net events of a frame, packed to its front, and count them.

    Where a restart has cut a path, one event without value or slope stands for the whole change.
    """
    counts, events = work.counts, work.events
    n = counts[EVENTS]
    cut_a = not erase_loops(events, n, 0, old_a, new_a)
    cut_b = not erase_loops(events, n, 1, old_b, new_b)
    if cut_a:
        erase(events, 0, 0, n)
    if cut_b:
        erase(events, 1, 0, n)
    kept = 0
    for k in range(n):
        if events[EVENT_COLUMNS * k + BODY] >= 0.0:
            for j in range(EVENT_COLUMNS):
                events[EVENT_COLUMNS * kept + j] = events[EVENT_COLUMNS * k + j]
            kept += 1
    counts[EVENTS] = min(kept, MAX_EVENTS - 2)
    if cut_a and old_a != new_a:
        log_event(work, 0, old_a, new_a, np.nan, np.nan)
    if cut_b and old_b != new_b:
        log_event(work, 1, old_b, new_b, np.nan, np.nan)
