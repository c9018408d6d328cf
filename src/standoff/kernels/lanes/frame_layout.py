"""How a block of frames lies in lanes: of every row both sides, the motion, the points, and what
is found of them."""

from typing import Any, NamedTuple

from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import reals_on_stack, small
from standoff.kernels.lanes.layout import (
    N_POSE,
    ROWS,
    bounded_pair,
    lane,
    pose_of,
    put_pose,
    put_vector,
    vector_of,
)
from standoff.kernels.values import Motion

# One side: its chart's affine map (12), the sign of its normals, the rectangle well inside the
# face (4), and the header of the body's reals (10).
MAP, OUTWARD, INNER, HEADER = 0, 12, 13, 17
N_SIDE = (17 + L.REAL_HEADER) * ROWS

# B's motion in A's frame: its pose (12), v, w.
VELOCITY, TURN = 12, 15
N_MOTION = N_POSE + 6 * ROWS

# A descent: the parameters (4), what it has come to, corrections made, what the last was to gain
# (2), rates of the parameters (4); then the tolerance, and how many corrections are allowed.
PHASE, CORRECTIONS, ENERGY, FALL, RATES, TOLERANCE, MOST = 4, 5, 6, 7, 8, 12, 13
N_DESCENT = 14 * ROWS

# What is found: distance and bound of the cores, normal, both points and their tangents.
D, LOWER, NORMAL, JETS = 0, 1, 2, 5
N_FOUND = 23 * ROWS


class Block(NamedTuple):
    """The lanes of a block of frames, as pointers."""

    a: Any  # N_SIDE
    b: Any
    motion: Any  # N_MOTION
    descent: Any  # N_DESCENT
    found: Any  # N_FOUND


class Descent(NamedTuple):
    """A row's descent."""

    place: Any  # 4 parameters
    phase: float
    corrections: float
    energy: float  # of a `Fall`
    fall: float  # its descent
    rates: Any  # 1/s
    tolerance: float  # of the gap, in spans
    most: float


@small
def block_on_stack():
    return Block(
        reals_on_stack(N_SIDE),
        reals_on_stack(N_SIDE),
        reals_on_stack(N_MOTION),
        reals_on_stack(N_DESCENT),
        reals_on_stack(N_FOUND),
    )


@small
def clear(numbers, count, row):
    for k in range(count // ROWS):
        numbers[lane(k, row)] = 0.0


@small
def clear_row(block, row):
    """Let a row be none: 0 in all lanes. What happens to lie there may be denormal, and slow."""
    clear(block.a, N_SIDE, row)
    clear(block.b, N_SIDE, row)
    clear(block.motion, N_MOTION, row)
    clear(block.descent, N_DESCENT, row)


@small
def four_of(block, k, row):
    """Four numbers of a row, the k-th and those behind it."""
    x, y, z = vector_of(block, k, row)
    return x, y, z, block[lane(k + 3, row)]


@small
def put_four(x, block, k, row):
    for i in range(4):
        block[lane(k + i, row)] = x[i]


@small
def pair_of(block, row):
    """Both bodies of a row, of which no more than the headers is known."""
    return bounded_pair(block.a, block.b, HEADER, row)


@small
def motion_of(block, row):
    at = block.motion
    return Motion(pose_of(at, row), vector_of(at, VELOCITY, row), vector_of(at, TURN, row))


@small
def put_motion(motion, block, row):
    put_pose(motion.pose, block.motion, row)
    put_vector(motion.v, block.motion, VELOCITY, row)
    put_vector(motion.w, block.motion, TURN, row)


@small
def descent_of(block, row):
    at = block.descent
    return Descent(
        four_of(at, 0, row),
        at[lane(PHASE, row)],
        at[lane(CORRECTIONS, row)],
        at[lane(ENERGY, row)],
        at[lane(FALL, row)],
        four_of(at, RATES, row),
        at[lane(TOLERANCE, row)],
        at[lane(MOST, row)],
    )


@small
def put_descent(descent, block, row):
    at = block.descent
    put_four(descent.place, at, 0, row)
    at[lane(PHASE, row)], at[lane(CORRECTIONS, row)] = descent.phase, descent.corrections
    at[lane(ENERGY, row)], at[lane(FALL, row)] = descent.energy, descent.fall
    put_four(descent.rates, at, RATES, row)
    at[lane(TOLERANCE, row)], at[lane(MOST, row)] = descent.tolerance, descent.most


@small
def put_jets(jet_a, jet_b, block, row):
    """Keep both points and their tangents."""
    for k in range(3):
        put_vector(jet_a[k], block.found, JETS + 3 * k, row)
        put_vector(jet_b[k], block.found, JETS + 9 + 3 * k, row)


@small
def tangents_of(block, k, row):
    """A point and its tangents, as a jet whose second derivatives are not known."""
    x = vector_of(block.found, k, row)
    u, v = vector_of(block.found, k + 3, row), vector_of(block.found, k + 6, row)
    zero = (0.0, 0.0, 0.0)
    return x, u, v, zero, zero, zero
