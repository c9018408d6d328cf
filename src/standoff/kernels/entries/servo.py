"""The servo loop as Python calls it: one call that lasts from its first tick to its last.

All of it is compiled, including the waiting, and it does not hold Python's lock: whatever the
interpreter does meanwhile, its garbage collector included, the loop does not wait for it. It
allocates only before its first tick.
"""

import numpy as np
from numba import types

from standoff.kernels.compiler.decorators import ahead, entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, INTS, ROWS, WRITE, WRITE_INTS
from standoff.kernels.compiler.shared_memory import load_relaxed
from standoff.kernels.dynamics.arrays import (
    I_READING,
    S_TIME,
    STEP,
    TOLD_HEADER,
    coupler_row,
)
from standoff.kernels.dynamics.coupler_arrays import (
    C_ENGAGED,
    G_FAULT,
    G_SEQUENCE,
    G_TIME,
    MISSING,
    N_READING,
)
from standoff.kernels.dynamics.near_arrays import near_arrays
from standoff.kernels.dynamics.servo import (
    BILLION,
    TORN,
    engage,
    keep,
    lower_limits,
    measure,
    now,
    put_in_box,
    rest,
    take_from_box,
    tell,
    time_asleep,
    wait,
)
from standoff.kernels.dynamics.servo_arrays import (
    BROKEN,
    DONE,
    H_LATE,
    H_PERIOD,
    H_WORK,
    JUMPED,
    RUNNING,
    STALLED,
    STOPPED,
    SUSPENDED,
    V_EMPTY,
    V_GAP,
    V_PERIOD,
    V_REPEAT,
    V_TICKS,
    W_ENGAGE,
    W_REST,
    W_STOP,
    Y_AWAY,
    Y_ENGAGED,
    Y_FRESH,
    Y_MISSED,
    Y_TICKS,
)
from standoff.kernels.dynamics.solid_pairs import begin_solids
from standoff.kernels.entries.simulation import (
    SYSTEM,
    drives_of,
    keep_alive,
    pointed,
    scratch_for,
    system_of,
    tick_bodies,
    track_pairs,
)
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.state.arrays import FINE
from standoff.kernels.values import Work

BOX = types.Tuple((WRITE_INTS, ROWS))
ASKED = types.Tuple((WRITE_INTS, WRITE))
GIVEN = types.Tuple((ROWS, ROWS))
MEASURED = types.Tuple((types.Array(INT, 2, "C"), WRITE_INTS, ROWS))


@kernel
def read_device(plan, given, box, tick, seconds, seen, reading):
    """The newest reading, scripted or from the box; the number of what is read."""
    script = given[1]
    count = script.shape[0]
    if count == 0:
        number = take_from_box(box[0], box[1], seen, reading, N_READING)
        if number == TORN:
            reading[G_FAULT] = MISSING
        return number
    if tick >= count and not plan[V_REPEAT]:
        reading[G_FAULT] = MISSING
        return seen
    for k in range(N_READING):
        reading[k] = script[tick % count, k]
    # what is scripted is read at this very instant
    reading[G_TIME], reading[G_SEQUENCE] = seconds, float(tick)
    return seen + 1


@kernel
def move_bodies(system, state, given, tick, begun, work, scratch):
    """The steps of one tick of the loop; FINE, or what a tracker refuses."""
    h, steps = system.numbers[STEP], system.layout[I_READING]
    table, reading, seconds = given
    for k in range(steps):
        step = tick * steps + k
        drives = drives_of(table, reading, seconds + k * h)
        tick_bodies(system, state, h, drives, step, work, scratch)
        state[S_TIME] = begun + (step + 1) * h
        # the whole state is told after the last step of a tick
        why = track_pairs(system, state, h, (step, k == steps - 1, steps > 1), work, scratch)
        if why != FINE:
            return why
    return FINE


@kernel
def must_end(plan, asked, moment, times, asleep, tallies):
    """Why the loop ends before a tick; `times` are (last start, deadline, start, tick)."""
    last, deadline, start, tick = times
    if load_relaxed(asked, W_STOP) != 0:
        return STOPPED
    if start < last or start < deadline:
        tallies[Y_AWAY] = max(last, deadline) - start
        return JUMPED
    away = time_asleep(plan, asked, moment) - asleep
    if away > plan[V_GAP]:
        tallies[Y_AWAY] = away
        return SUSPENDED
    gap = start - last - plan[V_PERIOD]
    if gap > plan[V_GAP]:
        tallies[Y_AWAY] = gap
        return STALLED
    if plan[V_TICKS] > 0 and tick >= plan[V_TICKS]:
        return DONE
    return RUNNING


@kernel
def answer(asked, answered, coupler, state):
    """Obey what was asked since: letting go comes last, so it wins if both were asked."""
    wanted, released = load_relaxed(asked, W_ENGAGE), load_relaxed(asked, W_REST)
    if wanted != answered[0]:
        answered[0] = wanted
        engage(coupler, state)
    if released != answered[1]:
        answered[1] = released
        rest(coupler, state)


@kernel
def book(system, state, plan, measured, told, last):
    """Count and log a tick that is done; the next deadline."""
    bins, tallies, log = measured
    tick, start, late, spent = told
    if tick > 0:
        measure(bins, tallies, H_PERIOD, start - last)
    measure(bins, tallies, H_LATE, late)
    measure(bins, tallies, H_WORK, spent)
    if log.shape[0] > 0:
        keep(system, state, told, log)
    tallies[Y_ENGAGED] += state[coupler_row(system) + C_ENGAGED] > 0.0
    tallies[Y_TICKS] = tick + 1
    deadline = start - late + plan[V_PERIOD]
    behind = start + spent - deadline
    if behind >= 0:
        # those that passed meanwhile are left out, not made up for
        skipped = behind // plan[V_PERIOD] + 1
        tallies[Y_MISSED] += skipped
        deadline += skipped * plan[V_PERIOD]
    return deadline


@entry(SYSTEM, WRITE, WRITE, INTS, ASKED, GIVEN, types.Tuple((BOX, BOX)), MEASURED, work="servo")
def serve(packed, numbers, state, plan, commands, given, boxes, measured):
    """A servo loop, until it is asked to stop, its ticks are done, or it cannot go on.

    Parameters
    ----------
    packed : tuple
        As of ``run_system``.
    numbers : array
        The packed system's own numbers, in which limits are lowered.
    state : array
        Changed in place.
    plan : integers
        ``servo_arrays``, V_.
    commands : tuple
        What the slower side asks (W_) and the limits that it lowers (L_).
    given : tuple
        A table of driven motions, a row each half step, and scripted readings, a row each tick; no
        rows of these where readings come through the box.
    boxes : tuple
        For the readings that come and for what is told, each (newest, rows).
    measured : tuple
        Histograms (H_), tallies (Y_) and the log (J_); no rows where none is kept.

    Returns
    -------
    why : int
        RUNNING excepted, one of those of ``servo_arrays``; no force is on the handle then.
    """
    asked, limits = commands
    tallies = measured[1]
    inbox, outbox = boxes
    system = system_of(packed)
    arrays, near = scratch_for(system, np.zeros(TOLD_HEADER)), near_arrays(system)
    scratch = pointed(arrays, near)
    counts = np.zeros(N_COUNT_SLOTS, dtype=np.int64)
    events = np.zeros(MAX_EVENTS * EVENT_COLUMNS)
    work = Work(pointer(counts, 0), pointer(events, 0), scratch.polytope, scratch.polytope)
    moment, answered = np.zeros(2, dtype=np.int64), np.zeros(2, dtype=np.int64)
    reading = np.zeros(N_READING)
    reading[G_FAULT] = MISSING
    live = pointer(state, 0)
    begin_solids(system, live, work.counts, scratch)
    joined = ahead(live, coupler_row(system))
    begun = live[S_TIME]
    asleep = time_asleep(plan, asked, moment)
    last = now(plan, asked, moment)
    deadline = last + plan[V_PERIOD]
    tick, seen, spent = 0, 0, 0
    ended = RUNNING
    while ended == RUNNING:
        start = wait(plan, asked, moment, deadline)
        ended = must_end(plan, asked, moment, (last, deadline, start, tick), asleep, tallies)
        if ended != RUNNING:
            break
        lower_limits(system, numbers, limits)
        answer(asked, answered, system.coupler, joined)
        seconds = start / BILLION
        before = seen
        seen = read_device(plan, given, inbox, tick, seconds, seen, reading)
        tallies[Y_FRESH] += seen != before
        if not plan[V_EMPTY]:
            drives = (given[0], reading, seconds)
            if move_bodies(system, live, drives, tick, begun, work, scratch) != FINE:
                ended = BROKEN
                break
        late = start - deadline
        tell(system, numbers, tallies, live, (tick, start, late, spent), RUNNING, outbox)
        spent = now(plan, asked, moment) - start
        deadline = book(system, live, plan, measured, (tick, start, late, spent), last)
        last, tick = start, tick + 1
    rest(system.coupler, joined)
    tell(system, numbers, tallies, live, (tick, last, 0, spent), ended, outbox)
    keep_alive(arrays, near, counts, events)
    return ended


@entry(WRITE_INTS, ROWS, WRITE, work="servo")
def put_row(newest, rows, row):
    """Publish a row in a box."""
    put_in_box(newest, rows, row, row.shape[0])
    return row.shape[0]


@entry(WRITE_INTS, ROWS, INT, WRITE, work="servo")
def take_row(newest, rows, seen, row):
    """Copy the newest row of a box; its number, or `seen` where there is none newer."""
    return take_from_box(newest, rows, seen, row, row.shape[0])
