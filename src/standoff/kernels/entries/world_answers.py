"""The answers of a world's pairs as Python calls them: each from its kept state, or anew."""

from typing import Any, NamedTuple

from numba import types

from standoff.kernels.algebra.vectors import cross
from standoff.kernels.compiler.decorators import (
    ahead,
    entry,
    ints_at,
    kernel,
    pointer,
    reals_at,
    reals_on_stack,
    shared,
    small,
)
from standoff.kernels.compiler.entry import (
    INT,
    INTS,
    READ,
    READ_BLOCKS,
    WRITE_INTS,
)
from standoff.kernels.entries.blocks import Polytopes, answered_by, started_by
from standoff.kernels.entries.world import (
    PAIRS,
    PIECES,
    PLACED,
    READ_2,
    READ_INTS_2,
    ROWS_OF_INTS,
    pairs_at,
    pieces_at,
)
from standoff.kernels.frame.restart import anywhere
from standoff.kernels.lanes.frames import frames_in_lanes
from standoff.kernels.pair.polytope_layout import N_POLYTOPE, N_VERTICES
from standoff.kernels.state.arrays import (
    BLOCK_EVENTS,
    BLOCK_HAS_TWIST,
    BLOCK_MOTION,
    BLOCK_POLYTOPE,
    BLOCK_STATE,
    BLOCK_TIME_STEP,
    FINE,
    INSIDE,
    LOWER_BOUND,
    N_BLOCK,
    N_LONG_BLOCK,
    N_OPTIONS,
    N_STATE,
    POSE_A,
    POSE_B,
    START_ANYWHERE,
    STATUS,
    TWIST_A,
    TWIST_B,
    UPPER_BOUND,
)
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair
from standoff.kernels.world.arrays import (
    C_BOUND,
    C_TRAVEL,
    C_UPPER,
    F_PLACED,
    I_A,
    I_B,
    I_INSIDE,
    I_STATUS,
    N_FACT,
    N_INTS,
    N_KNOWN,
    N_PLACED,
    P_PAD,
)
from standoff.kernels.world.pairs import (
    travel_of,
)


class Bodies(NamedTuple):
    """What the frames of all pairs read; pointers."""

    addresses: Any  # (n pieces, 4): ints, how many, reals, how many
    classes: Any  # of each piece, by the kinds of its faces
    options: Any  # (n_classes, n_classes, N_OPTIONS): each with the addresses of its frames
    n_classes: int


@kernel
def pair_of(bodies, p, q):
    a, b = ahead(bodies.addresses, 4 * p), ahead(bodies.addresses, 4 * q)
    return Pair(
        ints_at(a[0], a[1]), reals_at(a[2], a[3]), ints_at(b[0], b[1]), reals_at(b[2], b[3])
    )


@kernel
def options_of(bodies, p, q):
    row = bodies.classes[p] * bodies.n_classes + bodies.classes[q]
    return read_options(ahead(bodies.options, N_OPTIONS * row))


@kernel
def put_twist(twist, row, fact, motion):
    """The twist of a piece in the world: that of its body, at the piece's own origin."""
    w = (twist[3], twist[4], twist[5])
    for k in range(6):
        motion[k] = twist[k]
    if fact[F_PLACED] != 0.0:
        # row[9:12] is the piece's origin; its body's lies R s before it, in twist[6:9]
        arm = (row[9] - twist[6], row[10] - twist[7], row[11] - twist[8])
        turn = cross(w, arm)
        for k in range(3):
            motion[k] += turn[k]


@kernel
def put_motion(pieces, p, q, twists, has_twist, block):
    """A pair's poses and twists, into its block."""
    motion = ahead(block, BLOCK_MOTION)
    a, b = ahead(pieces.placed, N_PLACED * p), ahead(pieces.placed, N_PLACED * q)
    for k in range(12):
        motion[POSE_A + k], motion[POSE_B + k] = a[k], b[k]
    for k in range(6):
        motion[TWIST_A + k], motion[TWIST_B + k] = 0.0, 0.0
    block[BLOCK_HAS_TWIST] = 1.0 if has_twist else 0.0
    if has_twist:
        fact_a, fact_b = ahead(pieces.facts, N_FACT * p), ahead(pieces.facts, N_FACT * q)
        put_twist(ahead(twists, 9 * pieces.owners[p]), a, fact_a, ahead(motion, TWIST_A))
        put_twist(ahead(twists, 9 * pieces.owners[q]), b, fact_b, ahead(motion, TWIST_B))


@shared
def answer_anew(pair, options, block):
    """A cold query of a pair, at the poses in its block."""
    for k in range(N_STATE):
        block[BLOCK_STATE + k] = 0.0
    block[BLOCK_POLYTOPE] = 0.0
    return started_by(anywhere, pair, options, block, START_ANYWHERE)


@kernel
def composed(pieces, p):
    """What roundoff of a placement may have moved a piece by (length)."""
    placed = pieces.facts[N_FACT * p + F_PLACED] != 0.0
    return pieces.placed[N_PLACED * p + P_PAD] if placed else 0.0


@kernel
def note(pieces, known, ints, block):
    """What a pair's answer says, into the table of pairs."""
    p, q = ints[I_A], ints[I_B]
    doubt = composed(pieces, p) + composed(pieces, q)
    if doubt > 0.0:
        block[LOWER_BOUND] -= doubt
        block[UPPER_BOUND] += doubt
    known[C_BOUND], known[C_UPPER] = block[LOWER_BOUND], block[UPPER_BOUND]
    known[C_TRAVEL] = travel_of(pieces, p, q)
    ints[I_STATUS] = int(block[STATUS])
    ints[I_INSIDE] = 1 if block[BLOCK_STATE + INSIDE] != 0.0 else 0


# What the frames of a world's pairs read: addresses, classes, options.
BODIES = types.Tuple((READ_INTS_2, INTS, READ_BLOCKS))
# Of each pair asked: its row in the table; addresses of the block before (0: none), of its own, of
# the polytopes before and its own (0: none); its time since the frame before, s.
ASKED = types.Tuple((ROWS_OF_INTS, READ))
A_PAIR, A_OLD, A_OWN, A_LAST_POLYTOPE, A_POLYTOPE = range(5)
# Velocities (n bodies, 9): twist, and the body's origin; and whether there are any.
TWISTS = types.Tuple((READ_2, INT))
PART = types.UniTuple(INT, 2)


@kernel
def answer_next(pair, options, block, asked):
    """A frame of a pair from the state in its block. Of more switches than a block holds the first
    are kept, and counted are all."""
    scratch = reals_on_stack(N_POLYTOPE)
    scratch[N_VERTICES] = 0.0
    before, kept = asked[A_LAST_POLYTOPE], asked[A_POLYTOPE]
    last = reals_at(before, N_POLYTOPE) if before != 0 else scratch
    own = reals_at(kept, N_POLYTOPE) if kept != 0 else scratch
    long = reals_on_stack(N_LONG_BLOCK)
    for k in range(BLOCK_STATE, BLOCK_EVENTS):
        long[k] = block[k]
    done = answered_by(pair, options, long, N_LONG_BLOCK, Polytopes(last, own))
    for k in range(N_BLOCK):
        block[k] = long[k]
    block[BLOCK_POLYTOPE] = 0.0
    return done


class Answering(NamedTuple):
    """What the answers of pairs read and write, in one frame of a world."""

    bodies: Any
    pieces: Any
    pairs: Any
    asked: Any  # pointer to rows: A_PAIR ...
    steps: Any  # pointer, s
    twists: Any  # pointer to rows
    has_twist: bool
    done: Any  # pointer


@small
def asked_of(answering, k):
    """(what is asked, pieces) of row k."""
    asked = ahead(answering.asked, 5 * k)
    ints = ahead(answering.pairs.ints, N_INTS * asked[A_PAIR])
    return asked, ints[I_A], ints[I_B]


@kernel
def frame_of_asked(answering, k):
    """(pair, options, block) of row k."""
    asked, p, q = asked_of(answering, k)
    pair, options = pair_of(answering.bodies, p, q), options_of(answering.bodies, p, q)
    return pair, options, reals_at(asked[A_OWN], N_BLOCK)


@kernel
def begin_asked(answering, k):
    """Make the block of row k ready: what is given, and the state before. Is there one?"""
    asked, p, q = asked_of(answering, k)
    block = reals_at(asked[A_OWN], N_BLOCK)
    put_motion(answering.pieces, p, q, answering.twists, answering.has_twist, block)
    block[BLOCK_TIME_STEP], block[BLOCK_POLYTOPE] = answering.steps[k], 0.0
    if asked[A_OLD] == 0:
        return False
    old = reals_at(asked[A_OLD], N_BLOCK)
    for i in range(N_STATE):
        block[BLOCK_STATE + i] = old[BLOCK_STATE + i]
    return True


@kernel
def end_asked(answering, k, good):
    """Answer row k where it is not, and note what its answer says.

    A row that keeps a polytope was inside, and is never answered by a smooth frame.
    """
    asked, p, q = asked_of(answering, k)
    block, done = reals_at(asked[A_OWN], N_BLOCK), FINE
    if not good:
        pair, options = pair_of(answering.bodies, p, q), options_of(answering.bodies, p, q)
        if asked[A_OLD] == 0:
            done = answer_anew(pair, options, block)
        else:
            done = answer_next(pair, options, block, asked)
    if done == FINE:
        at = asked[A_PAIR]
        known, ints = answering.pairs.known, answering.pairs.ints
        note(answering.pieces, ahead(known, N_KNOWN * at), ahead(ints, N_INTS * at), block)
    answering.done[k] = done


@entry(BODIES, PIECES, PLACED, PAIRS, ASKED, TWISTS, PART, WRITE_INTS, work="world")
def answer(bodies, fixed, frame, table, asked, twists, part, done):
    """The answers of the pairs asked from part[0] to part[1] - 1, each into its own block; the
    table of pairs is brought up to date. done[k] is FINE, or what is refused."""
    addresses, classes, options = bodies
    answering = Answering(
        Bodies(pointer(addresses, 0), pointer(classes, 0), pointer(options, 0), options.shape[0]),
        pieces_at(fixed, frame),
        pairs_at(table, len(table[0])),
        pointer(asked[0], 0),
        pointer(asked[1], 0),
        pointer(twists[0], 0),
        twists[1] != 0,
        pointer(done, 0),
    )
    frames_in_lanes(begin_asked, frame_of_asked, end_asked, answering, part[0], part[1])
    return 0
