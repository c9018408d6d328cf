"""Where everything of a servo loop is: its plan, what it shares, publishes and keeps."""

# The plan, integers: nanoseconds of a period, of the spin at its end and of the longest gap; ticks
# to run, 0 for no end; whether the scripted readings begin again; whether bodies are left alone.
V_PERIOD, V_SPIN, V_GAP, V_TICKS, V_REPEAT, V_EMPTY = range(6)
# Addresses of POSIX clock_gettime and clock_nanosleep; the clocks' numbers.
V_CLOCK, V_SLEEP, V_MONOTONIC, V_BOOT = range(6, 10)
N_PLAN = 10

# What the slower side asks for, integers: to stop; how often to engage, to let go. Drills: what is
# added to the clock and to the time asleep, ns. Each on a cache line of its own side.
W_STOP, W_ENGAGE, W_REST, W_SHIFT, W_ASLEEP = range(5)
N_ASKED = 8
# And numbers: the greatest force and torque; only ever lowered.
L_FORCE, L_TORQUE = range(2)
N_LIMITS = 8

# A box between threads: rows in turn, and the number of the newest, which alone tells them.
BOX_ROWS = 4

# What is published each tick, before the whole state.
(
    TOLD_TICK,
    TOLD_CLOCK,
    TOLD_ENDED,
    TOLD_LATE,
    TOLD_WORK,
    TOLD_MISSED,
    TOLD_FORCE_LIMIT,
    TOLD_TORQUE_LIMIT,
) = range(8)
OUT_HEADER = 8

# Why a loop ended; 0 while it runs.
RUNNING, STOPPED, DONE, BROKEN, JUMPED, STALLED, SUSPENDED = range(7)

# What is measured, ns, in histograms: from a tick's start to the next, from its deadline to its
# start, and from its start to its end.
H_PERIOD, H_LATE, H_WORK = range(3)
N_MEASURED = 3
# Bins: one a nanosecond below EXACT, then EXACT / 2 for each doubling, so that each is within
# 1/128 of its value.
EXACT = 256
DOUBLINGS = 34
BINS = EXACT + EXACT // 2 * DOUBLINGS
# Beside the histograms, integers: ticks, deadlines missed, worst of each measure, ns; engaged
# ticks; readings that were new; the gap or sleep at which the loop ended, ns.
Y_TICKS, Y_MISSED, Y_WORST, Y_ENGAGED, Y_FRESH, Y_AWAY = 0, 1, 2, 5, 6, 7
N_TALLIES = 8

# A row of the log.
(
    J_TICK,
    J_CLOCK,
    J_LATE,
    J_WORK,
    J_ENGAGED,
    J_WHY,
    J_DISTANCE,
    J_HANDLE,
) = range(8)
J_TURN = J_HANDLE + 3
J_TOOL = J_TURN + 9
J_FORCE = J_TOOL + 3
J_LOGGED = J_FORCE + 6
