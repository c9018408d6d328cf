"""What the C interface calls: a start and a step on a long block of memory, without Python.

A block is as ``blocks`` has it, of N_LONG_BLOCK numbers. Bodies and options are reached by a table
of their addresses.
"""

from standoff.kernels.compiler.decorators import reals_at, shared
from standoff.kernels.entries.blocks import answered_in_place, started
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.pair.polytope_layout import N_VERTICES
from standoff.kernels.state.arrays import (
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    FIRST_POLYTOPE,
    N_LONG_BLOCK,
    N_STATE,
    START_ANYWHERE,
)


@shared
def start_in_block(table, address):
    """Begin anywhere, by a global query, at the poses in a block.

    Returns FINE, or which of the poses and twists is refused.
    """
    block = reals_at(address, N_LONG_BLOCK)
    for k in range(N_STATE):
        block[BLOCK_STATE + k] = 0.0
    block[BLOCK_POLYTOPE] = FIRST_POLYTOPE
    block[FIRST_POLYTOPE + N_VERTICES] = 0.0
    return started(anywhere, table, block, START_ANYWHERE)


@shared
def step_in_block(table, address):
    """A frame of the pair's law: FINE or, with nothing changed, which of the poses and twists is
    refused.
    """
    return answered_in_place(table, reals_at(address, N_LONG_BLOCK), N_LONG_BLOCK)
