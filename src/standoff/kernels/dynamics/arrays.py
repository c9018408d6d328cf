"""Where everything of a simulated system is: its flat arrays, its state and its rates.

A free body is kept by its rotation, its centre of mass, that centre's velocity and its angular
momentum about it, all in world axes. Momentum, not angular velocity, so that without a torque
nothing of it is integrated at all. A fixed or driven body has its origin in place of the centre
and its angular velocity in place of the momentum.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state.arrays import N_OPTIONS, N_OUT, N_STATE
from standoff.kernels.state.options import read_options

# Kinds of bodies.
FREE, FIXED, DRIVEN = range(3)

# Integers of a system: header, a row a body, a row a pair, then the flat parts of the bodies. Of a
# coupler: the number of the tool, -1 without one; where its numbers stand; ticks a reading. And
# where the pairs' kept polytopes stand in the state, 0 where none are kept; where what the search
# for near pairs reads stands in these integers, 0 without one, and in the numbers; where in the
# state stands what pairs of solids have kept, 0 without such a pair.
I_BODIES, I_PAIRS, I_METHOD, I_INSIDE, I_TOOL, I_COUPLER, I_READING, I_POLYTOPES = range(8)
I_NEAR, I_NEAR_NUMBERS, I_SOLIDS = 8, 9, 10
INT_HEADER = 11
# A body: its kind, where its packed arrays begin among all bodies', its column in the table of
# driven motions, where its flat parts begin in these integers, and where the starts of its arrays
# among the solids' stand, 0 for one that meets no solid and is none.
B_KIND, B_INTS, B_REALS, B_DRIVEN, B_FLATS, B_SOLID = range(6)
INT_BODY = 6
# A pair: the numbers of its two bodies; of a pair of solids where what it keeps begins among what
# all of them do, -1 for another, and for how many rows of pairs of pieces there is room in it.
P_SOLID, P_ROWS = 2, 3
INT_PAIR = 4

# Numbers of a system: gravity (3), the step, a row a body, a row a pair, the flat parts, then those
# of a coupler (``coupler_arrays``).
GRAVITY, STEP = 0, 3
REAL_HEADER = 4
B_MASS, B_CENTRE, B_INERTIA, B_INVERSE = 0, 1, 4, 13  # centre and inertia in the body's axes
B_REACH = 22  # from its centre, or of a body that is not free its origin, to its farthest point
REAL_BODY = 23
# A pair: its contact, then what a pair of solids is asked: the depth it is meant for, the sizes of
# both, the tolerance, lengths, the part of the sizes and distances that is for rounding, and within
# which length spots share a spring; and how deep a tick may have hidden the bodies in each other
# before it is counted.
P_STIFFNESS, P_DAMPING, P_FRICTION, P_SLIP, P_DEPTH, P_SIZE, P_TOLERANCE, P_ROUNDING = range(8)
P_SPAN, P_UNSEEN = 8, 9
REAL_PAIR = 10

# The state: time, energy lost in contacts, energy that driven bodies and a coupler gave, the
# greatest depth so far, ticks with a pair that was not certified, places of contact of solids that
# ended deep, energy that springs have by being shared anew, ticks whose friction was eased; a row a
# body; a row a pair; a coupler's own (``coupler_arrays``); and, not recorded, what pairs of solids
# have kept (``kernels.solids.contact_places``) and the polytopes that pairs in penetration have.
S_TIME, S_LOST, S_GIVEN, S_DEEPEST, S_UNCERTIFIED, S_JUMPS, S_SHARED, S_EASED = range(8)
STATE_HEADER = 8
X_ROTATION, X_CENTRE, X_VELOCITY, X_SPIN = 0, 9, 12, 15
N_BODY = 18
# A pair: its tracker's state, its answer, ticks in which its bodies may have crossed, and when the
# first of them ended.
N_PAIR = N_STATE + N_OUT + 2

# Rates of the state: of the energies lost, given and shared; a body's turn (body axes), velocity,
# acceleration and torque; a pair's four parameters.
R_LOST, R_GIVEN, R_SHARED = 0, 1, 2
RATE_HEADER = 3
R_TURN, R_SPEED, R_PUSH, R_TORQUE = 0, 3, 6, 9
RATE_BODY = 12
RATE_PAIR = 4

# What a pair's contact comes to, for records: force on B (world), energy stored, depth, spots.
T_FORCE, T_STORED, T_DEPTH, T_SPOTS = 0, 3, 4, 5
N_TOUCH = 6
# What spots push, as it is told: how many there were since an account began, for how many of them
# there is room; then a row each: its pair, where it is, its normal, its depth, its share of a
# spring, and its force on B; world.
TOLD, TOLD_ROOM = 0, 1
TOLD_HEADER = 2
U_PAIR, U_POINT, U_NORMAL, U_DEPTH, U_SHARE, U_FORCE = 0, 1, 4, 7, 8, 9
N_TOLD = 12
# A body's loads: force, and torque about its centre, world. Behind those of all bodies, for each:
# by what friction slows its slip, 1/time, and the part of it that is taken (``eased_friction``);
# then what flat contacts are given by sharing their springs, power (``flat_sharing``).
N_LOAD = 6
E_SLOWED, E_PART = 0, 1
N_EASED = 2

# A row of the table of driven motions: a pose (12) and a twist (6).
N_DRIVEN = 18


class Solids(NamedTuple):
    """Arrays of all solids, one behind the other, as pointers: of the boundaries, of leaves and
    trees, of the directions from vertices.
    """

    ints: Any
    reals: Any
    own: Any
    numbers: Any
    fan_ints: Any
    fan_reals: Any


class System(NamedTuple):
    """A packed system, as pointers: a reference to an array is counted at every call."""

    layout: Any
    numbers: Any
    ints: Any  # of all bodies, one behind the other
    reals: Any
    options: Any  # N_OPTIONS numbers a pair
    coupler: Any  # the numbers of a coupler (``coupler_arrays``), where there is one
    solids: Any


class Drives(NamedTuple):
    """What drives bodies and a coupler, as pointers: a row of motions a half tick, and how many
    numbers a row has; readings, and how many; and the time on their clock (`pull_tool`)."""

    table: Any
    width: Any
    readings: Any
    count: Any
    clock: Any


class Scratch(NamedTuple):
    """What one tick writes over, as pointers."""

    stage: Any  # rows of the bodies at a stage, as a state has them; then at the start
    rates: Any  # of one stage, and behind them as they were when it began
    total: Any  # of the whole step
    first: Any  # of its first stage
    loads: Any  # N_LOAD numbers a body, then N_EASED a body, then one
    motion: Any  # N_MOTION numbers
    touch: Any  # N_TOUCH numbers a pair
    spots: Any  # see ``flat_contact``
    told: Any  # what spots push, where there is room for it
    change: Any  # N_CHANGE numbers of the pair whose frame it is
    polytope: Any  # of a pair that keeps none
    ways: Any  # how far each body has gone (``crossing``)
    contact: Any  # what a frame of two solids fills (``solid_pairs``)
    near: Any  # integers of the search for near pairs, and what it finds (``near_arrays``)
    near_numbers: Any  # and its numbers


@kernel
def n_bodies(system):
    return system.layout[I_BODIES]


@kernel
def n_pairs(system):
    return system.layout[I_PAIRS]


@kernel
def body_ints(body):
    """Where a body's row stands among the integers."""
    return INT_HEADER + INT_BODY * body


@kernel
def kind_of(system, body):
    return system.layout[body_ints(body) + B_KIND]


@kernel
def bodies_of(system, pair):
    """The numbers of a pair's two bodies."""
    o = INT_HEADER + INT_BODY * n_bodies(system) + INT_PAIR * pair
    return system.layout[o], system.layout[o + 1]


@kernel
def solid_pair(system, pair):
    """Where what a pair of solids keeps begins among what all of them do; -1 for another pair."""
    return system.layout[INT_HEADER + INT_BODY * n_bodies(system) + INT_PAIR * pair + P_SOLID]


@kernel
def kept_rows(system, pair):
    """For how many rows of pairs of pieces there is room in what a pair of solids keeps."""
    return system.layout[INT_HEADER + INT_BODY * n_bodies(system) + INT_PAIR * pair + P_ROWS]


@kernel
def body_numbers(body):
    return REAL_HEADER + REAL_BODY * body


@kernel
def pair_numbers(system, pair):
    return REAL_HEADER + REAL_BODY * n_bodies(system) + REAL_PAIR * pair


@kernel
def body_row(body):
    """Where a body's row stands in the state."""
    return STATE_HEADER + N_BODY * body


@kernel
def pair_row(system, pair):
    return STATE_HEADER + N_BODY * n_bodies(system) + N_PAIR * pair


@kernel
def eased_row(system, body):
    """Where a body's friction stands among the loads."""
    return N_LOAD * n_bodies(system) + N_EASED * body


@kernel
def shared_row(system):
    """Where what sharing gives stands among the loads."""
    return eased_row(system, n_bodies(system))


@kernel
def crossings_row(system, pair):
    """Where the count of ticks stands in which a pair's bodies may have crossed."""
    return pair_row(system, pair) + N_STATE + N_OUT


@kernel
def body_rates(body):
    return RATE_HEADER + RATE_BODY * body


@kernel
def pair_rates(system, pair):
    return RATE_HEADER + RATE_BODY * n_bodies(system) + RATE_PAIR * pair


@kernel
def n_rates(system):
    """How many: pairs have rates only where the trackers are inside the operator."""
    return pair_rates(system, n_pairs(system) if system.layout[I_INSIDE] else 0)


@kernel
def coupler_row(system):
    """Where the coupler's state stands in the state."""
    return pair_row(system, n_pairs(system))


@kernel
def options_of(system, pair):
    """A pair's law, with all options."""
    return read_options(ahead(system.options, N_OPTIONS * pair))


@kernel
def polytope_row(system, pair):
    """Where a pair's kept polytope stands in the state; 0 where none are kept."""
    first = system.layout[I_POLYTOPES]
    return first + N_POLYTOPE * pair if first > 0 else 0
