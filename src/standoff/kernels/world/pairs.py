"""The pairs of pieces that may be near each other: found, merged, bounded, and which are due."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.compiler.decorators import ahead, kernel
from standoff.kernels.state.arrays import CONVERGED, GLOBAL
from standoff.kernels.tolerances import EPS, FARTHEST
from standoff.kernels.world.arrays import (
    C_BOUND,
    C_HORIZON,
    C_TIME,
    C_TRAVEL,
    C_UPPER,
    E_A,
    E_B,
    E_KEY,
    F_REACH,
    FAR,
    I_A,
    I_B,
    I_FRAME,
    I_INSIDE,
    I_KEY,
    I_ROW,
    I_STATUS,
    MOVED,
    N_EMIT,
    N_FACT,
    N_INTS,
    N_KNOWN,
    N_PLACED,
    NEW,
    P_TRAVEL,
    RESTING,
)
from standoff.kernels.world.filter import position
from standoff.kernels.world.pieces import apart

KEPT_BEYOND = 0.1
"""Of the pieces' reach: so far beyond its horizon a pair keeps the state of its tracker."""


class Pieces(NamedTuple):
    """Of all pieces of a world: pointers, and how many a body has at most."""

    owners: Any
    first: Any  # of each body: the number of its first piece
    facts: Any  # (n, N_FACT)
    placed: Any  # (n, N_PLACED)
    searched: Any  # 1 where a piece has left its padded box, and its pairs are sought anew
    still: Any  # 1 where it is where it was in the frame before
    n_bodies: int
    most: int


class Pairs(NamedTuple):
    """A table of pairs, sorted by their keys; pointers."""

    ints: Any  # (n, N_INTS)
    known: Any  # (n, N_KNOWN)
    n: int


@kernel
def write_pair(pieces, p, q, emit, n_found):
    """Write a pair of pieces, that of the body of lesser number first."""
    if pieces.owners[p] > pieces.owners[q]:
        p, q = q, p
    rows, room = emit
    if n_found < room:
        i, j = pieces.owners[p], pieces.owners[q]
        row = ahead(rows, N_EMIT * n_found)
        within = (p - pieces.first[i]) * pieces.most + (q - pieces.first[j])
        row[E_KEY] = (i * pieces.n_bodies + j) * pieces.most * pieces.most + within
        row[E_A], row[E_B] = p, q
    return n_found + 1


@kernel
def horizon_of(pair_of_bodies, margins, within):
    """Beyond what distance a bound is enough: `margins` are sorted numbers of pairs of bodies,
    their margins, and how many there are."""
    numbers, values, n = margins
    at = position(numbers, n, pair_of_bodies)
    if at < n and numbers[at] == pair_of_bodies:
        return max(within, values[at])
    return within


@kernel
def begin(pieces, found, horizon, ints, known):
    """A pair of which nothing is known yet."""
    ints[I_KEY], ints[I_A], ints[I_B] = found[E_KEY], found[E_A], found[E_B]
    ints[I_ROW], ints[I_FRAME], ints[I_STATUS], ints[I_INSIDE] = -1, -1, -1, 0
    known[C_BOUND], known[C_UPPER], known[C_HORIZON] = -inf, inf, horizon
    known[C_TRAVEL], known[C_TIME] = travel_of(pieces, found[E_A], found[E_B]), 0.0


@kernel
def travel_of(pieces, p, q):
    return pieces.placed[N_PLACED * p + P_TRAVEL] + pieces.placed[N_PLACED * q + P_TRAVEL]


@kernel
def copy_pair(old, k, new, at):
    for i in range(N_INTS):
        new.ints[N_INTS * at + i] = old.ints[N_INTS * k + i]
    for i in range(N_KNOWN):
        new.known[N_KNOWN * at + i] = old.known[N_KNOWN * k + i]


@kernel
def merge(old, found, n_found, pieces, lasting, horizons, new):
    """The table after a search: old pairs of pieces that were not sought anew, and what was found,
    with what was known of it. `lasting` pieces, half-spaces, keep all their pairs. Returns how
    many.
    """
    margins, within = horizons
    k, at = 0, 0
    square = pieces.most * pieces.most
    for f in range(n_found + 1):
        row = ahead(found, N_EMIT * f)
        while k < old.n and (f == n_found or old.ints[N_INTS * k + I_KEY] <= row[E_KEY]):
            ints = ahead(old.ints, N_INTS * k)
            p, q = ints[I_A], ints[I_B]
            again = f < n_found and ints[I_KEY] == row[E_KEY]
            gone = pieces.searched[p] != 0 or pieces.searched[q] != 0
            if again or not gone or lasting[p] != 0 or lasting[q] != 0:
                copy_pair(old, k, new, at)
                at += 1
            k += 1
        if f < n_found and not (at > 0 and new.ints[N_INTS * (at - 1) + I_KEY] == row[E_KEY]):
            horizon = horizon_of(row[E_KEY] // square, margins, within)
            begin(
                pieces, row, horizon, ahead(new.ints, N_INTS * at), ahead(new.known, N_KNOWN * at)
            )
            at += 1
    return at


@kernel
def renew_bounds(pieces, pairs, k):
    """What is known of a pair after its pieces have moved on."""
    ints, known = ahead(pairs.ints, N_INTS * k), ahead(pairs.known, N_KNOWN * k)
    p, q = ints[I_A], ints[I_B]
    travel = travel_of(pieces, p, q)
    # beside a long travel a short way is lost in the sum: what stands still is told apart
    still = pieces.still[p] != 0 and pieces.still[q] != 0
    if not still:
        way = max(travel - known[C_TRAVEL], 0.0) + 4.0 * EPS * travel
        if travel >= FARTHEST:  # a half-space has turned: in such a sum all other ways are lost
            way = FARTHEST
        boxes = apart(
            ahead(pieces.placed, N_PLACED * p),
            ahead(pieces.facts, N_FACT * p),
            ahead(pieces.placed, N_PLACED * q),
            ahead(pieces.facts, N_FACT * q),
        )
        known[C_BOUND] = max(boxes, known[C_BOUND] - way)
        known[C_UPPER] += way
        known[C_TRAVEL] = travel
    elif known[C_BOUND] == -inf:
        known[C_BOUND] = apart(
            ahead(pieces.placed, N_PLACED * p),
            ahead(pieces.facts, N_FACT * p),
            ahead(pieces.placed, N_PLACED * q),
            ahead(pieces.facts, N_FACT * q),
        )


@kernel
def group_end(pairs, first, square):
    """The end of the pairs of pieces of one pair of bodies that begin at `first`."""
    group = pairs.ints[N_INTS * first + I_KEY] // square
    end = first + 1
    while end < pairs.n and pairs.ints[N_INTS * end + I_KEY] // square == group:
        end += 1
    return end


@kernel
def least_of(pairs, first, end, column):
    """Which of some pairs has the least number in a column of what is known."""
    least = first
    for k in range(first + 1, end):
        if pairs.known[N_KNOWN * k + column] < pairs.known[N_KNOWN * least + column]:
            least = k
    return least


@kernel
def limit_of(pairs, first, end, minima):
    """Beyond what bound no pair of pieces is the nearest of its bodies, and none is asked for."""
    horizon = pairs.known[N_KNOWN * first + C_HORIZON]
    if end - first == 1:
        return horizon
    upper = pairs.known[N_KNOWN * least_of(pairs, first, end, C_UPPER) + C_UPPER]
    if upper == inf:  # nothing is known yet: the nearest by its bound is looked at first
        upper = pairs.known[N_KNOWN * least_of(pairs, first, end, C_BOUND) + C_BOUND]
    return min(horizon, max(upper, minima))


@kernel
def fate_of(pieces, pairs, k, limit, last):
    """Is a pair far, resting since frame `last`, moved or new?"""
    ints, known = ahead(pairs.ints, N_INTS * k), ahead(pairs.known, N_KNOWN * k)
    if known[C_BOUND] > limit:
        return FAR
    if ints[I_ROW] < 0:
        return NEW
    p, q = ints[I_A], ints[I_B]
    still = pieces.still[p] != 0 and pieces.still[q] != 0
    proven = ints[I_STATUS] == CONVERGED or ints[I_STATUS] == GLOBAL  # others are tried again
    return RESTING if still and proven and ints[I_FRAME] == last else MOVED


@kernel
def forget_far(pieces, pairs, k):
    """Drop the tracker's state of a pair far beyond its horizon."""
    ints, known = ahead(pairs.ints, N_INTS * k), ahead(pairs.known, N_KNOWN * k)
    reach = pieces.facts[N_FACT * ints[I_A] + F_REACH] + pieces.facts[N_FACT * ints[I_B] + F_REACH]
    if known[C_BOUND] > known[C_HORIZON] + KEPT_BEYOND * reach:
        ints[I_ROW], ints[I_FRAME] = -1, -1


@kernel
def look(pieces, pairs, minima, last, fates):
    """What becomes of each pair in this frame; `last` is the number of the frame before, -1 where
    nothing may rest."""
    square = pieces.most * pieces.most
    first = 0
    while first < pairs.n:
        end = group_end(pairs, first, square)
        for k in range(first, end):
            renew_bounds(pieces, pairs, k)
        limit = limit_of(pairs, first, end, minima)
        for k in range(first, end):
            fates[k] = fate_of(pieces, pairs, k, limit, last)
            if fates[k] == FAR and pairs.ints[N_INTS * k + I_ROW] >= 0:
                forget_far(pieces, pairs, k)
        first = end


@kernel
def look_again(pieces, pairs, minima, fates, again):
    """Which pairs of pieces that were left out may be nearer than what was found: their fates, in
    place; `again` is 1 for those. Returns how many."""
    square = pieces.most * pieces.most
    first, n = 0, 0
    while first < pairs.n:
        end = group_end(pairs, first, square)
        limit = limit_of(pairs, first, end, minima) if end - first > 1 else -inf
        for k in range(first, end):
            again[k] = 0
            if fates[k] == FAR and pairs.known[N_KNOWN * k + C_BOUND] <= limit:
                fates[k] = NEW if pairs.ints[N_INTS * k + I_ROW] < 0 else MOVED
                again[k] = 1
                n += 1
        first = end
    return n
