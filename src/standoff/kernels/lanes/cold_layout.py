"""How a block of cold queries of ellipsoids lies in lanes: of every row both bodies and the poses,
the normal that is sought, the points, and the answer."""

from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import ints_on_stack, reals_on_stack, small
from standoff.kernels.lanes.layout import (
    N_POSE,
    N_VECTOR,
    ROWS,
    bounded_pair,
    lane,
    put_header,
    put_vector,
    six_of,
    vector_of,
)
from standoff.kernels.lanes.rows import TRIED
from standoff.kernels.lanes.support import Ellipsoid, Turn

# One side: the ellipsoid (3 and 6), the header of the reals of its body (10), the map of the chart
# that sees the point the deepest (12), the sign of its normals, the point in its axes (3), and the
# parameters in it.
CENTRE, SQUARE, HEADER, MAP, OUTWARD, SEEN, P, Q = 0, 3, 9, 19, 31, 32, 35, 36
N_SIDE = 37 * ROWS

# Newton's method for the normal: the normal, the step from there, the value, the share, the count.
STEP, VALUE, SHARE, COUNT = 3, 6, 7, 8
N_TURN = 9 * ROWS
N_STEPS = 4 * ROWS
N_ANSWER = (TRIED + 1) * ROWS  # an answer's lanes


class Side(NamedTuple):
    """One body's witness points, as pointers."""

    chart: Any  # numbers of charts
    at: Any  # N_SIDE
    points: Any  # N_VECTOR: in the body's frame


class Block(NamedTuple):
    """The lanes of a block of cold queries, as pointers."""

    poses: Any  # N_POSE: of B in A's frame
    poses_a: Any  # N_POSE: of A in world
    goals: Any  # ROWS: how narrow a proof's gap must be, in spans
    turns: Any  # N_TURN
    a: Side
    b: Side
    steps: Any  # N_STEPS
    answers: Any  # N_ANSWER
    good: Any  # ROWS: 1 where a row is converged and proven


@small
def side_on_stack():
    return Side(ints_on_stack(ROWS), reals_on_stack(N_SIDE), reals_on_stack(N_VECTOR))


@small
def block_on_stack():
    return Block(
        reals_on_stack(N_POSE),
        reals_on_stack(N_POSE),
        reals_on_stack(ROWS),
        reals_on_stack(N_TURN),
        side_on_stack(),
        side_on_stack(),
        reals_on_stack(N_STEPS),
        reals_on_stack(N_ANSWER),
        ints_on_stack(ROWS),
    )


@small
def put_body(ellipsoid, reals, side, row):
    """Put what a query reads of a body into lanes."""
    put_vector(ellipsoid.centre, side.at, CENTRE, row)
    for k in range(6):
        side.at[lane(SQUARE + k, row)] = ellipsoid.Q[k]
    put_header(reals, side.at, HEADER, row)


@small
def body_of(side, row):
    """A row's ellipsoid."""
    return Ellipsoid(vector_of(side.at, CENTRE, row), six_of(side.at, SQUARE, row))


@small
def pair_of(block, row):
    """Both bodies of a row, of which no more than the headers is known."""
    return bounded_pair(block.a.at, block.b.at, HEADER, row)


@small
def put_turn(turn, turns, row):
    put_vector(turn.normal, turns, 0, row)
    put_vector(turn.step, turns, STEP, row)
    turns[lane(VALUE, row)], turns[lane(SHARE, row)] = turn.value, turn.share
    turns[lane(COUNT, row)] = turn.count


@small
def turn_of(turns, row):
    return Turn(
        vector_of(turns, 0, row),
        turns[lane(VALUE, row)],
        vector_of(turns, STEP, row),
        turns[lane(SHARE, row)],
        turns[lane(COUNT, row)],
    )
