"""A simulated system as Python calls it: many ticks of the whole operator in one compiled loop; and
one tick of a virtual coupler by itself.
"""

import numpy as np
from numba import types

from standoff.kernels.compiler.decorators import ahead, entry, kernel, pointer
from standoff.kernels.compiler.entry import INT, INTS, READ, REAL, ROWS, WRITE
from standoff.kernels.dynamics.arrays import (
    FREE,
    I_COUPLER,
    I_SOLIDS,
    N_EASED,
    N_LOAD,
    N_TOUCH,
    S_DEEPEST,
    S_TIME,
    S_UNCERTIFIED,
    STEP,
    T_STORED,
    TOLD,
    TOLD_HEADER,
    Drives,
    Scratch,
    Solids,
    System,
    body_row,
    kind_of,
    n_bodies,
    n_pairs,
    n_rates,
    options_of,
    pair_row,
    polytope_row,
    shared_row,
)
from standoff.kernels.dynamics.coupled_tool import (
    book_pull,
    coupled,
    power_of_pull,
    pull_tool,
    stored_in_coupler,
)
from standoff.kernels.dynamics.coupler import Moment, couple
from standoff.kernels.dynamics.coupler_arrays import N_READING
from standoff.kernels.dynamics.crossing import (
    N_WAY,
    UNSEEN_END,
    begin_crossing,
    book_crossing,
    goes_far_enough,
)
from standoff.kernels.dynamics.eased_friction import begin_friction, ease_friction
from standoff.kernels.dynamics.flat_contact import N_SPOTS
from standoff.kernels.dynamics.near_arrays import n_visited, near_arrays, searches, visited
from standoff.kernels.dynamics.near_pairs import catch_up, find_near
from standoff.kernels.dynamics.operator import change_of, step_bodies
from standoff.kernels.dynamics.pair_motion import packed_pair, write_motion
from standoff.kernels.dynamics.rigid_body import kinetic, potential, power
from standoff.kernels.dynamics.solid_pairs import begin_solids, is_of_solids, track_solids
from standoff.kernels.dynamics.system import clear_loads, touch_tracked
from standoff.kernels.entries.frames import frame
from standoff.kernels.frame.inputs import (
    CHANGE,
    FIRST_CHANGE,
    N_CHANGE,
    inputs_at,
    refused,
    with_change,
)
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.solids.contact_frame import CONTACT_ROOM
from standoff.kernels.state.arrays import (
    CONVERGED,
    DISTANCE,
    FAR,
    FINE,
    GLOBAL,
    LOCAL,
    N_MOTION,
    N_STATE,
    STATUS,
    TRACKING,
)
from standoff.kernels.state.state import write_numbers
from standoff.kernels.values import Work

# Columns of an account, after which come N_TOUCH numbers a pair, and what is stored in a coupler.
A_KINETIC, A_POTENTIAL, A_STORED = range(3)
ACCOUNT_HEADER = 3


@kernel
def scratch_for(system, told):
    """What a tick writes over; `told` is what spots push."""
    rows = n_bodies(system)
    rates = n_rates(system)
    return (
        np.zeros(body_row(rows)),
        np.zeros(2 * rates),
        np.zeros(rates),
        np.zeros(rates),
        np.zeros((N_LOAD + N_EASED) * rows + 1),
        np.zeros(N_MOTION),
        np.zeros(N_TOUCH * n_pairs(system) + 1),
        np.zeros(N_SPOTS),
        np.zeros(N_CHANGE),
        np.zeros(N_POLYTOPE),
        np.zeros(CONTACT_ROOM if system.layout[I_SOLIDS] > 0 else 1),
        told,
        np.zeros(N_WAY * rows + 1),
    )


@kernel
def pointed(arrays, near):
    return Scratch(
        pointer(arrays[0], 0),
        pointer(arrays[1], 0),
        pointer(arrays[2], 0),
        pointer(arrays[3], 0),
        pointer(arrays[4], 0),
        pointer(arrays[5], 0),
        pointer(arrays[6], 0),
        pointer(arrays[7], 0),
        pointer(arrays[11], 0),
        pointer(arrays[8], 0),
        pointer(arrays[9], 0),
        pointer(arrays[12], 0),
        pointer(arrays[10], 0),
        pointer(near[0], 0),
        pointer(near[1], 0),
    )


@kernel
def keep_alive(arrays, near, counts, log):
    """Call this after the last use of what points into the arrays: Numba frees an array after its
    own last use, and a pointer is not one."""
    total = len(counts) + len(log) + len(near[0]) + len(near[1])
    for k in range(13):
        total += len(arrays[k])
    return total


@kernel
def work_for(system, pair, state, counts, log, scratch):
    """What a pair's frame writes on: its kept polytope stands in the state, where any are kept."""
    at = polytope_row(system, pair)
    own = ahead(state, at) if at > 0 else scratch.polytope
    if at == 0:
        own[N_VERTICES] = 0.0
    return Work(counts, log, own, own)


@kernel
def book_answer(state, o):
    """Count what a pair's row tells: whether it is sound, and how deep it is."""
    status = state[o + N_STATE + STATUS]
    # of an overlap alone the contact's depth is not known: its force is not either
    sound = status in (CONVERGED, TRACKING, LOCAL, GLOBAL, FAR)
    state[S_UNCERTIFIED] += 0.0 if sound else 1.0
    state[S_DEEPEST] = max(state[S_DEEPEST], -state[o + N_STATE + DISTANCE])


@kernel
def track_pair(system, pair, state, h, work, scratch):
    """The tracker's frame of a pair at the end of a tick; FINE, or what it refuses."""
    o = pair_row(system, pair)
    if is_of_solids(system, pair):
        why = track_solids(system, pair, state, work.counts, scratch)
        book_answer(state, o)
        return why
    write_motion(system, pair, state, body_row(0), scratch.motion)
    packed, options = packed_pair(system, pair), options_of(system, pair)
    inputs = inputs_at(scratch.motion, True)
    why = refused(packed, inputs)
    if why != FINE:
        return why
    if options.carried:
        change = scratch.change
        write_numbers(change_of(system, pair, h, scratch.total), change, CHANGE)
        write_numbers(change_of(system, pair, h, scratch.first), change, FIRST_CHANGE)
        inputs = with_change(inputs, change)
    kept, out = ahead(state, o), ahead(state, o + N_STATE)
    own = work_for(system, pair, state, work.counts, work.events, scratch)
    frame(packed, inputs, h, options, kept, out, own)
    book_answer(state, o)
    return FINE


@kernel
def track_pairs(system, state, h, told, work, scratch):
    """The frames of all pairs at the end of a tick; FINE, or what one refuses.

    `told` are the tick, whether the whole state is read after it, and whether ticks between are
    not: those visit only the pairs that may be near, and all others are FAR as they were.
    """
    tick, read, between = told
    by_tree = between and searches(system)
    everything = read or not by_tree
    if by_tree:
        everything = find_near(system, state, scratch) or everything
    for k in range(n_pairs(system) if everything else n_visited(system, scratch)):
        pair = k if everything else visited(scratch, k)
        if by_tree:
            catch_up(system, pair, state, h, tick, scratch)
        of_solids = is_of_solids(system, pair)
        looked_at = goes_far_enough(system, pair, scratch)
        begun = begin_crossing(system, pair, state, of_solids) if looked_at else UNSEEN_END
        why = track_pair(system, pair, state, h, work, scratch)
        if why != FINE:
            return why
        if looked_at:
            book_crossing(system, pair, state, begun, of_solids, scratch)
    return FINE


@kernel
def touch_all(system, state, row, scratch):
    """The contacts of a state, into a row of the accounts; and what its spots push."""
    clear_loads(system, scratch)
    scratch.told[TOLD] = 0.0
    row[A_STORED] = 0.0
    for pair in range(n_pairs(system)):
        touch_tracked(system, pair, state, state, body_row(0), scratch)
        for k in range(N_TOUCH):
            row[ACCOUNT_HEADER + N_TOUCH * pair + k] = scratch.touch[N_TOUCH * pair + k]
        row[A_STORED] += scratch.touch[N_TOUCH * pair + T_STORED]


@kernel
def account(system, state, row, scratch, steps):
    """Energies and contacts of a state, into a row of the accounts; and what its spots push, with
    as much of the friction as is taken where our own steps go on from it.
    """
    for k in range(ACCOUNT_HEADER):
        row[k] = 0.0
    for body in range(n_bodies(system)):
        if kind_of(system, body) == FREE:
            row[A_KINETIC] += kinetic(system, body, state, body_row(body))
            row[A_POTENTIAL] += potential(system, body, state, body_row(body))
    begin_friction(system, scratch.loads)
    touch_all(system, state, row, scratch)
    if steps and ease_friction(system, scratch.loads):
        touch_all(system, state, row, scratch)
    if coupled(system):
        row[ACCOUNT_HEADER + N_TOUCH * n_pairs(system)] = stored_in_coupler(system, state)


@kernel
def tick_bodies(system, state, h, drives, tick, work, scratch):
    """One tick of coupler, bodies and energies."""
    power = 0.0
    if coupled(system):
        pull_tool(system, state, drives, tick, h, scratch)
        power = power_of_pull(system, state)
    step_bodies(system, state, h, drives, tick, work, scratch)
    if coupled(system):
        book_pull(system, state, h, power)


@kernel
def system_of(packed):
    """A system by pointers, of its arrays (layout, numbers, ints, reals, options, solids)."""
    layout, numbers, ints, reals, options, solids = packed
    coupler = pointer(numbers, layout[I_COUPLER])
    x = Solids(
        pointer(solids[0], 0),
        pointer(solids[1], 0),
        pointer(solids[2], 0),
        pointer(solids[3], 0),
        pointer(solids[4], 0),
        pointer(solids[5], 0),
    )
    return System(
        pointer(layout, 0),
        pointer(numbers, 0),
        pointer(ints, 0),
        pointer(reals, 0),
        pointer(options, 0),
        coupler,
        x,
    )


@kernel
def drives_of(table, readings, clock):
    """What drives a system, by pointers, of its arrays."""
    count = readings.shape[0] // N_READING
    return Drives(pointer(table, 0), table.shape[1], pointer(readings, 0), count, clock)


# Boundaries, leaves and trees, directions from vertices: integers and numbers of each.
ALL_SOLIDS = types.Tuple((INTS, READ, INTS, READ, INTS, READ))
SYSTEM = types.Tuple((INTS, READ, INTS, READ, READ, ALL_SOLIDS))
RECORDS = types.Tuple((ROWS, ROWS))
DRIVES = types.Tuple((ROWS, WRITE))


@entry(SYSTEM, WRITE, DRIVES, INT, RECORDS, WRITE, work="simulation")
def run_system(packed, state, drives, every, records, told):
    """Many ticks; the state is changed in place.

    `packed` is (layout, numbers, ints, reals, options, solids). `records` are the states and the
    accounts: row 0 is of the start, each next one of a tick `every` later. `drives` are a table of
    the driven bodies' motions, one row per half tick, and readings of a coupler's device, N_READING
    numbers each (``coupler_arrays``), the first of which is for the first tick. `told` becomes what
    the spots of the last record push (``dynamics.arrays``), as far as its second number has room.
    Returns (-1, FINE), or the tick after which a pose or twist was refused, and why: the rows
    before it are written.
    """
    states, accounts = records
    system = system_of(packed)
    arrays, near = scratch_for(system, told), near_arrays(system)
    scratch = pointed(arrays, near)
    counts = np.zeros(N_COUNT_SLOTS, dtype=np.int64)
    log = np.zeros(MAX_EVENTS * EVENT_COLUMNS)
    work = Work(pointer(counts, 0), pointer(log, 0), scratch.polytope, scratch.polytope)
    h = system.numbers[STEP]
    begun, live = state[S_TIME], pointer(state, 0)
    begin_solids(system, live, work.counts, scratch)
    width = states.shape[1]  # all but what is kept beside it
    states[0, :] = state[:width]
    account(system, live, accounts[0], scratch, True)
    given = drives_of(drives[0], drives[1], np.nan)
    for tick in range(every * (states.shape[0] - 1)):
        tick_bodies(system, live, h, given, tick, work, scratch)
        live[S_TIME] = begun + (tick + 1) * h
        recorded = (tick + 1) % every == 0
        why = track_pairs(system, live, h, (tick, recorded, every > 1), work, scratch)
        if why != FINE:
            keep_alive(arrays, near, counts, log)
            return tick, why
        if recorded:
            row = (tick + 1) // every
            states[row, :] = state[:width]
            account(system, live, accounts[row], scratch, True)
    keep_alive(arrays, near, counts, log)
    return -1, FINE


@entry(READ, WRITE, READ, READ, REAL, REAL, work="coupler")
def couple_once(coupler, state, reading, tool, dt, clock):
    """One tick of a coupler, its state in place; `clock` is nan where the coupler's own serves."""
    moment = Moment(dt, clock, True, dt)
    couple(pointer(coupler, 0), pointer(state, 0), pointer(reading, 0), pointer(tool, 0), moment)
    return len(coupler) + len(state) + len(reading) + len(tool)  # alive until here, see `pointer`


@entry(SYSTEM, WRITE, WRITE, WRITE, work="simulation")
def load_system(packed, state, loads, row):
    """What contacts do to bodies at their places in a state, for methods that are not ours.

    The trackers go to the state's poses from where they are in it, in place. `loads` become those
    of the bodies, N_LOAD numbers each, then the power that the contacts lose, that driven bodies
    give and that springs have by being shared; `row` becomes the account of the state. Returns
    FINE, or why a pose or twist was refused.
    """
    system = system_of(packed)
    arrays, near = scratch_for(system, np.zeros(TOLD_HEADER)), near_arrays(system)
    scratch = pointed(arrays, near)
    counts = np.zeros(N_COUNT_SLOTS, dtype=np.int64)
    log = np.zeros(MAX_EVENTS * EVENT_COLUMNS)
    work = Work(pointer(counts, 0), pointer(log, 0), scratch.polytope, scratch.polytope)
    live = pointer(state, 0)
    begin_solids(system, live, work.counts, scratch)
    for pair in range(n_pairs(system)):
        why = track_pair(system, pair, live, system.numbers[STEP], work, scratch)
        if why != FINE:
            return why
    account(system, live, row, scratch, False)
    clear_loads(system, scratch)
    lost, given = 0.0, 0.0
    for pair in range(n_pairs(system)):
        lost += touch_tracked(system, pair, live, live, body_row(0), scratch)
    for body in range(n_bodies(system)):
        if kind_of(system, body) != FREE:
            given -= power(body, live, body_row(body), scratch.loads)
    end = N_LOAD * n_bodies(system)
    for k in range(end):
        loads[k] = scratch.loads[k]
    loads[end], loads[end + 1], loads[end + 2] = lost, given, scratch.loads[shared_row(system)]
    keep_alive(arrays, near, counts, log)
    return FINE
