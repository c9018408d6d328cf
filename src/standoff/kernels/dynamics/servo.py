"""Parts of a servo loop: waiting for a tick, what the slower side asks, what is told and kept."""

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.compiler.decorators import kernel, pointer
from standoff.kernels.compiler.shared_memory import (
    clock_into,
    fence_acquired,
    fence_released,
    load_acquired,
    load_relaxed,
    sleep_until,
    store_relaxed,
    store_released,
)
from standoff.kernels.dynamics.arrays import (
    I_COUPLER,
    body_row,
    coupler_row,
    n_pairs,
    pair_row,
)
from standoff.kernels.dynamics.coupled_tool import tool_motion
from standoff.kernels.dynamics.coupler import put_vector
from standoff.kernels.dynamics.coupler_arrays import (
    C_CLOCK,
    C_COUNTS,
    C_DEVICE,
    C_ENGAGED,
    C_FAULT,
    C_HANDLE,
    C_HELD,
    C_ON_DEVICE,
    C_RAMP,
    C_SEEN,
    C_SEQUENCE,
    C_TIME,
    NO_FAULT,
    Q_ENGAGE,
    Q_FORCE,
    Q_HELD,
    Q_TORQUE,
)
from standoff.kernels.dynamics.servo_arrays import (
    BOX_ROWS,
    EXACT,
    J_CLOCK,
    J_DISTANCE,
    J_ENGAGED,
    J_FORCE,
    J_HANDLE,
    J_LATE,
    J_TICK,
    J_TOOL,
    J_TURN,
    J_WHY,
    J_WORK,
    L_FORCE,
    L_TORQUE,
    OUT_HEADER,
    TOLD_CLOCK,
    TOLD_ENDED,
    TOLD_FORCE_LIMIT,
    TOLD_LATE,
    TOLD_MISSED,
    TOLD_TICK,
    TOLD_TORQUE_LIMIT,
    TOLD_WORK,
    V_BOOT,
    V_CLOCK,
    V_MONOTONIC,
    V_PERIOD,
    V_SLEEP,
    V_SPIN,
    W_ASLEEP,
    W_SHIFT,
    Y_MISSED,
    Y_WORST,
)
from standoff.kernels.state.arrays import N_STATE

BILLION = 1_000_000_000
ABSOLUTE = 1  # POSIX TIMER_ABSTIME
TRIES = 4  # of a box whose writer overtakes the reader
TORN = -1  # in place of a row's number: the writer overtook every try


@kernel
def nanoseconds(plan, clock, moment):
    """A clock's time."""
    clock_into(plan[V_CLOCK], clock, moment)
    return moment[0] * BILLION + moment[1]


@kernel
def now(plan, asked, moment):
    """The loop's clock, ns: the monotonic one."""
    return nanoseconds(plan, plan[V_MONOTONIC], moment) + load_relaxed(asked, W_SHIFT)


@kernel
def time_asleep(plan, asked, moment):
    """How long the machine was suspended since it was started, ns."""
    awake = nanoseconds(plan, plan[V_MONOTONIC], moment)
    return nanoseconds(plan, plan[V_BOOT], moment) - awake + load_relaxed(asked, W_ASLEEP)


@kernel
def wait(plan, asked, moment, deadline):
    """Sleep, then spin, until the deadline; the time then. Earlier only where the clock jumped
    back: it runs backwards, or the deadline is more than a period ahead."""
    last = now(plan, asked, moment)
    while last < deadline and deadline - last <= plan[V_PERIOD]:
        if deadline - last > plan[V_SPIN]:
            until = deadline - plan[V_SPIN] - load_relaxed(asked, W_SHIFT)
            moment[0], moment[1] = until // BILLION, until % BILLION
            sleep_until(plan[V_SLEEP], plan[V_MONOTONIC], ABSOLUTE, moment)
        time = now(plan, asked, moment)
        if time < last:
            return time
        last = time
    return last


@kernel
def put_in_box(newest, rows, row, count):
    """Publish a row: never waits for who reads. One thread alone may do it."""
    number = load_relaxed(newest, 0) + 1
    fence_released()
    start = (number % BOX_ROWS) * rows.shape[1]
    for k in range(count):
        store_relaxed(rows, start + k, row[k])
    store_released(newest, 0, number)


@kernel
def take_from_box(newest, rows, seen, row, count):
    """Copy the newest row where it is not number `seen`; the number of what `row` has, or TORN.

    Never waits for who writes: a row is written over only after BOX_ROWS - 1 newer ones, which the
    reader sees by their number.
    """
    for _ in range(TRIES):
        number = load_acquired(newest, 0)
        if number == seen:
            return seen
        start = (number % BOX_ROWS) * rows.shape[1]
        for k in range(count):
            row[k] = load_relaxed(rows, start + k)
        fence_acquired()
        if load_relaxed(newest, 0) - number < BOX_ROWS - 1:
            return number
    return TORN


@kernel
def rest(coupler, state):
    """Put the coupler to rest, its wrenches zero: no fault, and its counts continue."""
    state[C_ENGAGED] = 0.0
    state[C_RAMP], state[C_SEEN] = 0.0, 0.0
    state[C_CLOCK], state[C_TIME], state[C_SEQUENCE] = float("nan"), float("nan"), -1.0
    for k in range(C_DEVICE, C_COUNTS):
        state[k] = 0.0
    for k in range(C_HANDLE, C_HELD + 6 * int(coupler[Q_HELD])):
        state[k] = 0.0


@kernel
def engage(coupler, state):
    """Engage the coupler, its wrenches growing from zero; does nothing if it is engaged."""
    if state[C_ENGAGED] == 0.0:
        rest(coupler, state)
        state[C_ENGAGED], state[C_FAULT] = 1.0, NO_FAULT
        state[C_RAMP] = 1.0 if coupler[Q_ENGAGE] == 0.0 else 0.0


@kernel
def lower_limits(system, numbers, limits):
    """The greatest force and torque become the lesser of what they are and what is asked for."""
    at = system.layout[I_COUPLER]
    force, torque = load_relaxed(limits, L_FORCE), load_relaxed(limits, L_TORQUE)
    if force < numbers[at + Q_FORCE]:
        numbers[at + Q_FORCE] = force
    if torque < numbers[at + Q_TORQUE]:
        numbers[at + Q_TORQUE] = torque


@kernel
def bin_of(value):
    """The bin of a histogram that counts a time, ns."""
    at = 0
    while value >= EXACT:
        value >>= 1
        at += EXACT // 2
    return max(value, 0) + at


@kernel
def measure(bins, tallies, which, value):
    """Count a time in its histogram."""
    at = min(bin_of(value), bins.shape[1] - 1)
    bins[which, at] += 1
    tallies[Y_WORST + which] = max(tallies[Y_WORST + which], value)


@kernel
def tell(system, numbers, tallies, state, told, ended, box):
    """Publish the tick and the state; `told` is (tick, clock in ns, late, work)."""
    newest, rows = box
    number = load_relaxed(newest, 0) + 1
    fence_released()
    o = (number % BOX_ROWS) * rows.shape[1]
    tick, clock, late, work = told
    store_relaxed(rows, o + TOLD_TICK, float(tick))
    store_relaxed(rows, o + TOLD_CLOCK, clock / BILLION)
    store_relaxed(rows, o + TOLD_ENDED, float(ended))
    store_relaxed(rows, o + TOLD_LATE, late / BILLION)
    store_relaxed(rows, o + TOLD_WORK, work / BILLION)
    store_relaxed(rows, o + TOLD_MISSED, float(tallies[Y_MISSED]))
    at = system.layout[I_COUPLER]
    store_relaxed(rows, o + TOLD_FORCE_LIMIT, numbers[at + Q_FORCE])
    store_relaxed(rows, o + TOLD_TORQUE_LIMIT, numbers[at + Q_TORQUE])
    for k in range(rows.shape[1] - OUT_HEADER):  # all but kept polytopes
        store_relaxed(rows, o + OUT_HEADER + k, state[k])
    store_released(newest, 0, number)


@kernel
def keep(system, state, told, log):
    """Write a tick into the log, over the oldest where it is full."""
    tick, clock, late, work = told
    row = pointer(log, (tick % log.shape[0]) * log.shape[1])
    own = coupler_row(system)
    row[J_TICK], row[J_CLOCK] = float(tick), clock / BILLION
    row[J_LATE], row[J_WORK] = late / BILLION, work / BILLION
    row[J_ENGAGED], row[J_WHY] = state[own + C_ENGAGED], state[own + C_FAULT]
    least = float("inf")
    for pair in range(n_pairs(system)):
        least = min(least, state[pair_row(system, pair) + N_STATE])
    row[J_DISTANCE] = least
    put_vector(read_vector(state, own + C_HANDLE + 9), row, J_HANDLE)
    for k in range(9):
        row[J_TURN + k] = state[own + C_HANDLE + k]
    put_vector(tool_motion(system, state, body_row(0)).pose.p, row, J_TOOL)
    for k in range(6):
        row[J_FORCE + k] = state[own + C_ON_DEVICE + k]
