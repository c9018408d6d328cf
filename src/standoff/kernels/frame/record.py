"""How a compiled frame calls another one by its address: with a record of addresses."""

from typing import Any, NamedTuple

from standoff.kernels.compiler.calls import address_of, call_frame
from standoff.kernels.compiler.decorators import (
    ahead,
    ints_at,
    ints_on_stack,
    kernel,
    reals_at,
    small,
)
from standoff.kernels.frame.inputs import N_CHANGE, Inputs, inputs_at
from standoff.kernels.pair.events import EVENT_COLUMNS, MAX_EVENTS, N_COUNT_SLOTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state.arrays import (
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_STATE,
    N_OPTIONS,
    N_OUT,
    N_STATE,
)
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair, Work

CALL_INTS_A, CALL_REALS_A, CALL_INTS_B, CALL_REALS_B = range(4)
CALL_POSE_A, CALL_POSE_B, CALL_TWIST_A, CALL_TWIST_B, CALL_CHANGE, CALL_HAS_TWIST = range(4, 10)
CALL_OPTIONS, CALL_STATE, CALL_OUT = range(10, 13)
CALL_COUNTS, CALL_EVENTS, CALL_LAST_POLYTOPE, CALL_POLYTOPE = range(13, 17)
N_CALL = 17

N_POSE, N_TWIST = 12, 6
NO_WORK = 0  # a smooth frame's


class Called(NamedTuple):
    """The arguments of a frame."""

    pair: Any
    inputs: Any
    options: Any
    state: Any  # pointer
    out: Any  # pointer
    work: Any


@small
def called_in_block(pair, options, block):
    """The arguments of a frame on a block (``entries.blocks``) that counts nothing on the way."""
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    return Called(pair, inputs, options, ahead(block, BLOCK_STATE), block, NO_WORK)


@kernel
def call_at(address, pair, inputs, h, options, state, out, work):
    """Call the frame at an address, and return its result."""
    call = ints_on_stack(N_CALL)
    call[CALL_INTS_A], call[CALL_REALS_A] = address_of(pair.ints_a), address_of(pair.reals_a)
    call[CALL_INTS_B], call[CALL_REALS_B] = address_of(pair.ints_b), address_of(pair.reals_b)
    call[CALL_POSE_A], call[CALL_POSE_B] = address_of(inputs.pose_a), address_of(inputs.pose_b)
    call[CALL_TWIST_A], call[CALL_TWIST_B] = address_of(inputs.twist_a), address_of(inputs.twist_b)
    call[CALL_CHANGE] = address_of(inputs.change)
    call[CALL_HAS_TWIST] = 1 if inputs.has_twist else 0
    call[CALL_OPTIONS] = address_of(options.numbers)
    call[CALL_STATE], call[CALL_OUT] = address_of(state), address_of(out)
    call[CALL_COUNTS], call[CALL_EVENTS] = address_of(work.counts), address_of(work.events)
    call[CALL_LAST_POLYTOPE] = address_of(work.last_polytope)
    call[CALL_POLYTOPE] = address_of(work.polytope)
    return call_frame(address, address_of(call), h)


@kernel
def read_call(record):
    """The arguments in the record at an address. The lengths of bodies' arrays are not known here,
    and not needed."""
    call = ints_at(record, N_CALL)
    return Called(
        Pair(
            ints_at(call[CALL_INTS_A], 0),
            reals_at(call[CALL_REALS_A], 0),
            ints_at(call[CALL_INTS_B], 0),
            reals_at(call[CALL_REALS_B], 0),
        ),
        Inputs(
            reals_at(call[CALL_POSE_A], N_POSE),
            reals_at(call[CALL_POSE_B], N_POSE),
            reals_at(call[CALL_TWIST_A], N_TWIST),
            reals_at(call[CALL_TWIST_B], N_TWIST),
            reals_at(call[CALL_CHANGE], N_CHANGE),
            call[CALL_HAS_TWIST] != 0,
        ),
        read_options(reals_at(call[CALL_OPTIONS], N_OPTIONS)),
        reals_at(call[CALL_STATE], N_STATE),
        reals_at(call[CALL_OUT], N_OUT),
        Work(
            ints_at(call[CALL_COUNTS], N_COUNT_SLOTS),
            reals_at(call[CALL_EVENTS], EVENT_COLUMNS * MAX_EVENTS),
            reals_at(call[CALL_LAST_POLYTOPE], N_POLYTOPE),
            reals_at(call[CALL_POLYTOPE], N_POLYTOPE),
        ),
    )
