"""A pair of a system: its packed bodies, and its poses and twists as the tracker reads them."""

from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.dynamics.arrays import (
    B_INTS,
    B_REALS,
    N_BODY,
    bodies_of,
    body_ints,
)
from standoff.kernels.dynamics.rigid_body import pose_and_twist, put
from standoff.kernels.state.arrays import POSE_A, POSE_B, TWIST_A, TWIST_B
from standoff.kernels.values import Pair


@kernel
def packed_pair(system, pair):
    """Its two bodies, as pointers."""
    a, b = bodies_of(system, pair)
    row_a, row_b = body_ints(a), body_ints(b)
    return Pair(
        ahead(system.ints, system.layout[row_a + B_INTS]),
        ahead(system.reals, system.layout[row_a + B_REALS]),
        ahead(system.ints, system.layout[row_b + B_INTS]),
        ahead(system.reals, system.layout[row_b + B_REALS]),
    )


@kernel
def write_motion(system, pair, rows, first, motion):
    """The row of N_MOTION numbers of a pair; its bodies' rows begin at `first`."""
    a, b = bodies_of(system, pair)
    for body, pose, twist in ((a, POSE_A, TWIST_A), (b, POSE_B, TWIST_B)):
        R, p, v, w = pose_and_twist(system, body, rows, first + N_BODY * body)
        put(R, motion, pose)
        put(p, motion, pose + 9)
        put(v, motion, twist)
        put(w, motion, twist + 3)
