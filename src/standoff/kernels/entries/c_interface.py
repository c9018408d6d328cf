"""What the C interface calls: a start and a step on a long block of memory, without Python.

A block is as ``blocks`` has it, of N_LONG_BLOCK numbers. Bodies and options are reached by a table
of their addresses.
"""

from standoff.kernels.compiler.decorators import (
    ahead,
    ints_at,
    kernel,
    reals_at,
    reals_on_stack,
    shared,
    stack_counts,
    stack_log,
)
from standoff.kernels.entries.blocks import (
    N_TABLE,
    TABLE_OPTIONS,
    Polytopes,
    answered,
    tabled_pair,
)
from standoff.kernels.entries.frames import frame_paper, frame_predicted, start_frame
from standoff.kernels.entries.tracker import inputs_at, refused
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.pair.events import N_COUNT_SLOTS
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    FINE,
    FIRST_POLYTOPE,
    N_LONG_BLOCK,
    N_STATE,
    START_ANYWHERE,
)
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Work


@shared
def start_in_block(table, address):
    """Begin anywhere, by a global query, at the poses in a block.

    Returns FINE, or what of the poses and twists is refused, with nothing changed.
    """
    block = reals_at(address, N_LONG_BLOCK)
    inputs = inputs_at(ahead(block, BLOCK_MOTION), block[BLOCK_HAS_TWIST] != 0.0)
    why = refused(inputs)
    if why != FINE:
        return why
    counts, log = stack_counts(), stack_log()
    for k in range(N_COUNT_SLOTS):
        counts[k] = 0
    tabled = ints_at(table, N_TABLE)
    options = read_options(reals_at(tabled[TABLE_OPTIONS], tabled[TABLE_OPTIONS + 1]))
    state = ahead(block, BLOCK_STATE)
    for k in range(N_STATE):
        state[k] = 0.0
    block[BLOCK_POLYTOPE] = FIRST_POLYTOPE
    block[FIRST_POLYTOPE + N_VERTICES] = 0.0
    none = reals_on_stack(N_POLYTOPE)  # a start has none, and keeps none
    work = Work(counts, log, none, none)
    return start_frame(
        anywhere, tabled_pair(tabled), inputs, options, state, START_ANYWHERE, block, work
    )


@kernel
def stepped(frame, table, address):
    """One frame in place in a block, by the law's own frame."""
    block = reals_at(address, N_LONG_BLOCK)
    own = ahead(block, FIRST_POLYTOPE)
    return answered(frame, table, block, FIRST_POLYTOPE, Polytopes(own, own))


@shared
def step_predicted_in_block(table, address):
    """A frame of the predictor-corrector: FINE or, with nothing changed, what of the poses and
    twists is refused.
    """
    return stepped(frame_predicted, table, address)


@shared
def step_paper_in_block(table, address):
    """`step_predicted_in_block`, of the paper's law."""
    return stepped(frame_paper, table, address)
