"""How far the pieces of a pair can move against each other while the joints stay in a box.

Let the joints leave their places q0 by at most h. Seen from any link of the pair's chain (the
*cut*), no point of A goes farther than Σ cₖ rₖ over the motions k between the cut and A, and none
of B farther than the same sum on B's side. c of a shift is h, and of a turn its chord 2 sin(h/2); r
of a shift is 1, and of a turn it is the greatest distance of the piece's points from the axis at
q0: the motions are made one after the other, that nearest to the cut first, so that what is behind
an axis still is as at q0 while it turns. The radius of a swept body moves with its core and has no
part in it.

Along a normal n, motion k gives what it does along n at q0 by itself, and no more than Nₖ cₖ rₖ
beside that: the motions before it carry its way as they turn it, by which n, seen from it, is
another direction, at most Nₖ away.

With the joints' speeds u and accelerations α, no point of A is accelerated by more than
Σ wₖ (uₖ (uₖ + 2 Σᵢ uᵢ) + αₖ), i over the *turns* between the cut and k, the first uₖ of turns only:
the second derivatives of the kinematics are ωᵢ × ∂x/∂qₖ. w is r in the whole box: how far the
motions between an axis and the piece can carry its points is added.
docs/certify.md has the proofs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.robots.certify_tolerances import BOUND_INFLATION, REACH_ROUNDOFF
from standoff.robots.motions import LinkFrames
from standoff.robots.watched import PlacedCores, Watched
from standoff.typing import Array, Bools, Ints


class Reaches(NamedTuple):
    """Of k pairs, each at one configuration with a box of joints around it.

    Attributes
    ----------
    chain : (k, n) array of int
        The motions between B and A; -1 behind the end.
    h : (k, n) array
        How far each motion of the chain can go from that configuration, radians or length.
    turns : (k, n) array
        1 for a turn, 0 for a shift.
    r_a, r_b : (k, n) arrays
        How far a point of A, or of B, goes at most for each unit of a motion from that
        configuration: length, or 1.
    w_a, w_b : (k, n) arrays
        The same from any configuration in the box.
    only_a, only_b : (k,) arrays of bool
        Is B a half-space, so that everything is seen from it, or A?
    axes, origins : (k, n, 3) arrays
        Of the motions, world, at that configuration.
    """

    chain: Ints
    h: Array
    turns: Array
    r_a: Array
    r_b: Array
    w_a: Array
    w_b: Array
    only_a: Bools
    only_b: Bools
    axes: Array
    origins: Array


class Cut(NamedTuple):
    """A bound for each pair, and the place in its chain from which the motion is seen.

    Attributes
    ----------
    bound : (k,) array
    place : (k,) array of int
        How many motions of the chain are on B's side.
    """

    bound: Array
    place: Ints


def reaches_of(
    watched: Watched,
    pairs: Ints,
    frames: LinkFrames,
    at: Ints,
    ways: Array,
    seen: tuple[PlacedCores, PlacedCores],
) -> Reaches:
    """The reaches of pairs, each at the configuration `at` of several.

    Parameters
    ----------
    watched : Watched
    pairs, at : (k,) arrays of int
    frames : LinkFrames
        At those configurations.
    ways : (k, nm + 1) array
        How far each of the robot's motions can go from there; the last is 0.
    seen : (Seen, Seen)
        The cores of A and B there.
    """
    motions = watched.motions
    chain = watched.chains.motions[watched.chain[pairs]]
    h = np.take_along_axis(ways, chain, axis=1) if chain.shape[1] else np.zeros(chain.shape)
    turns = np.append(motions.turns, False)[chain].astype(float)
    own = np.concatenate([motions.axes, np.zeros((1, 3))])[chain]
    rows = at[:, None]
    origins = frames.origins[rows, chain]
    axes = np.einsum("knij,knj->kni", frames.rotations[rows, chain], own)
    a, b = watched.a[pairs], watched.b[pairs]
    far_a = _from_axes(seen[0], watched.cores.half[a], axes, origins)
    far_b = _from_axes(seen[1], watched.cores.half[b], axes, origins)
    n = chain.shape[1]
    planes = watched.cores.planes
    return Reaches(
        chain,
        h,
        turns,
        _raised(turns * far_a + 1.0 - turns, watched.length),
        _raised(turns * far_b + 1.0 - turns, watched.length),
        _raised(_carried(far_a, h, turns, range(n - 1, -1, -1)), watched.length),
        _raised(_carried(far_b, h, turns, range(n)), watched.length),
        planes[b],
        planes[a],
        axes,
        origins,
    )


def _raised(w: Array, length: float) -> Array:
    """Bounds that hold after roundoff too, of the robot's lengths."""
    return w * (1.0 + BOUND_INFLATION) + length * REACH_ROUNDOFF


def _from_axes(seen: PlacedCores, half: Array, axes: Array, origins: Array) -> Array:
    """(k, n): the greatest distance of a core's points from axes, or from points where an axis is
    0, at the configuration itself."""
    arms = seen.centres[:, None] - origins
    arms = arms - np.einsum("kni,kni->kn", arms, axes)[..., None] * axes
    off = np.sqrt(np.einsum("kni,kni->kn", arms, arms))
    cosines = np.einsum("kni,kij->knj", axes, seen.axes)
    sines = np.sqrt(np.clip(1.0 - cosines**2, 0.0, None) + BOUND_INFLATION**2)
    across = np.einsum("knj,kj->kn", sines, half)
    ball = np.sqrt(np.einsum("kj,kj->k", half, half))
    found: Array = off + np.minimum(across, ball[:, None])
    return found


def _carried(far: Array, h: Array, turns: Array, order: range) -> Array:
    """w of each motion: what the motions between it and the piece, which come first in `order`, may
    do to the distance from its axis."""
    w, ways = np.empty_like(far), chords(h, turns)
    gone = np.zeros(len(far))
    for k in order:
        w[:, k] = turns[:, k] * (far[:, k] + gone) + (1.0 - turns[:, k])
        gone = gone + ways[:, k] * (turns[:, k] * far[:, k] + 1.0 - turns[:, k])
    return w


def least_way(reaches: Reaches) -> Cut:
    """How far the pieces can move against each other at most (length), from the best cut."""
    ways = chords(reaches.h, reaches.turns)
    return seen_from(_sums(ways * reaches.r_a, ways * reaches.r_b), reaches)


def least_speed(reaches: Reaches, rates: Array) -> Cut:
    """How fast at most, at speeds of the chain's motions (k, n) [length/s]."""
    return seen_from(_sums(rates * reaches.w_a, rates * reaches.w_b), reaches)


def least_way_along(
    reaches: Reaches, normals: Array, seen: tuple[PlacedCores, PlacedCores], half: Array
) -> Cut:
    """How far they can come together along directions (k, 3), from A to B, that stay fixed in the
    cut's frame (length): what each motion by itself does along them, and as much more as the
    motions before it can turn the direction.

    ``half`` (2, k, 3) are half the sides of the cores' boxes.
    """
    k, n = reaches.h.shape
    on_a, on_b = (
        _along(reaches, sign * normals, *core, r)
        for sign, core, r in (
            (1.0, (seen[0], half[0]), reaches.r_a),
            (-1.0, (seen[1], half[1]), reaches.r_b),
        )
    )
    cost, turned = np.zeros((k, n + 1)), np.zeros((k, n + 1))
    for i in range(n):
        _count(on_a, i, cost[:, : i + 1], turned[:, : i + 1])
    turned[:] = 0.0
    for i in range(n - 1, -1, -1):
        _count(on_b, i, cost[:, i + 1 :], turned[:, i + 1 :])
    return seen_from(cost, reaches)


class _Along(NamedTuple):
    """What motions (k, n) do to a piece along a direction, each by itself.

    Attributes
    ----------
    first : (k, n) array
        How far it goes along the direction [length].
    way : (k, n) array
        How far it goes at all [length].
    part : (k, n) array
        Of a unit of that way, how much can be along the direction.
    turn : (k, n) array
        How far it turns the direction, a unit vector.
    """

    first: Array
    way: Array
    part: Array
    turn: Array


def _count(on: _Along, i: int, cost: Array, turned: Array) -> None:
    """Add motion i as seen from some cuts (k, cuts), from which its direction was ``turned``."""
    way = on.way[:, i, None]
    part = np.minimum(1.0, on.part[:, i, None] + turned)
    cost += np.minimum(part * way, on.first[:, i, None] + turned * way)
    turned += on.turn[:, i, None]


def _along(reaches: Reaches, normals: Array, seen: PlacedCores, half: Array, r: Array) -> _Along:
    """What each motion does to a core along directions."""
    axes, turns = reaches.axes, reaches.turns > 0.0
    free = ~axes.any(axis=2)  # of an axis of its own nothing is known
    arms = seen.centres[:, None] - reaches.origins
    cosines = np.einsum("kni,ki->kn", axes, normals)
    levers = np.cross(normals[:, None], axes)
    ahead = np.abs(np.einsum("kni,kni->kn", levers, arms)) + _spread(levers, seen, half)
    inward = cosines[..., None] * axes - normals[:, None]
    back = np.einsum("kni,kni->kn", inward, arms) + _spread(inward, seen, half)
    ahead, back = ahead + BOUND_INFLATION * (ahead + r), back + BOUND_INFLATION * (abs(back) + r)
    # sin(t) ahead + (1 - cos(t)) back grows until its slope is 0
    t = np.minimum(reaches.h, np.arctan2(ahead, -back))
    arc = np.sin(t) * ahead + 2.0 * np.sin(0.5 * t) ** 2 * back
    way = chords(reaches.h, reaches.turns) * r
    shift = np.minimum(1.0, np.abs(cosines) + BOUND_INFLATION)
    across = np.sqrt(np.einsum("kni,kni->kn", levers, levers)) + BOUND_INFLATION
    part = np.where(free, 1.0, np.where(turns, across, shift))
    first = np.where(free, way, np.where(turns, arc + BOUND_INFLATION * way, shift * way))
    turn = np.where(turns, chords(reaches.h, reaches.turns) * np.where(free, 1.0, across), 0.0)
    return _Along(first, way, part, turn)


def _spread(directions: Array, seen: PlacedCores, half: Array) -> Array:
    """(k, n): how far a core reaches from its centre along directions (k, n, 3)."""
    along = np.abs(np.einsum("kni,kij->knj", directions, seen.axes))
    found: Array = np.einsum("knj,kj->kn", along, half)
    return found


def chords(h: Array, turns: Array) -> Array:
    """How far motions by up to h move a point, each by itself, for each unit of the point's
    distance from the axis: the chord of a turn."""
    found: Array = np.where(turns > 0.0, 2.0 * np.sin(0.5 * np.minimum(h, np.pi)), h)
    return found


def bends(reaches: Reaches, rates: Array, gains: Array) -> Array:
    """(k, n + 1): the points' accelerations, A's and B's together, seen from each cut."""
    turning = reaches.turns * rates
    before = np.concatenate([np.zeros((len(rates), 1)), np.cumsum(turning, axis=1)], axis=1)
    way_a, way_b = rates * reaches.w_a, rates * reaches.w_b
    own_a = way_a * (turning + 2.0 * before[:, :-1]) + gains * reaches.w_a
    own_b = way_b * (turning - 2.0 * before[:, 1:]) + gains * reaches.w_b
    on_a = _behind(own_a) - 2.0 * before * _behind(way_a)
    found: Array = on_a + _ahead(own_b) + 2.0 * before * _ahead(way_b)
    # the two differences above lose digits of what is larger than they
    size = _behind(own_a) + 2.0 * before * _ahead(way_b)
    return found + BOUND_INFLATION * (size + _ahead(gains * reaches.w_b))


def _sums(on_a: Array, on_b: Array) -> Array:
    """(k, n + 1): for each cut, what is behind it of A's and before it of B's."""
    return _behind(on_a) + _ahead(on_b)


def _behind(terms: Array) -> Array:
    """(k, n + 1): sums of the terms from each place on."""
    none = np.zeros((len(terms), 1))
    return np.concatenate([np.cumsum(terms[:, ::-1], axis=1)[:, ::-1], none], axis=1)


def _ahead(terms: Array) -> Array:
    """(k, n + 1): sums of the terms before each place."""
    return np.concatenate([np.zeros((len(terms), 1)), np.cumsum(terms, axis=1)], axis=1)


def seen_from(cost: Array, reaches: Reaches) -> Cut:
    """The cut of the least bound; a half-space is endless, and is not seen from elsewhere."""
    k, n = cost.shape
    if reaches.only_a.any() or reaches.only_b.any():
        places = np.arange(n)
        cost = np.where(reaches.only_a[:, None] & (places > 0), np.inf, cost)
        cost = np.where(reaches.only_b[:, None] & (places < n - 1), np.inf, cost)
    place = np.argmin(cost, axis=1)
    bound = cost[np.arange(k), place] * (1.0 + BOUND_INFLATION)
    return Cut(bound, place)
