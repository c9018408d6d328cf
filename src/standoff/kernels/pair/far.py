"""Lower bounds of a pair's distance that need no witness points: of its boxes, and of the last
frame's bound less the way that the bodies have gone since. Where one exceeds the horizon, nothing
more is asked.
"""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.turns import turn_norm
from standoff.kernels.algebra.vectors import add, dot, rotate, rotate_back, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import pair_slack
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS


@kernel
def box_of(reals):
    """(centre, half its sides) of the box around a core, body frame."""
    centre = (reals[L.BOX_CENTRE], reals[L.BOX_CENTRE + 1], reals[L.BOX_CENTRE + 2])
    return centre, (reals[L.BOX_HALF], reals[L.BOX_HALF + 1], reals[L.BOX_HALF + 2])


@kernel
def taxicab(x):
    return abs(x[0]) + abs(x[1]) + abs(x[2])


@kernel
def over_box(n, half):
    """How far a box reaches from its centre along a unit vector in its frame."""
    return abs(n[0]) * half[0] + abs(n[1]) * half[1] + abs(n[2]) * half[2]


@kernel
def boxes_apart(pair, pose):
    """A lower bound of the swept bodies' distance along the line of their boxes' centres; -inf with
    a half-space, which has none."""
    if pair.ints_a[L.UNBOUNDED] != 0 or pair.ints_b[L.UNBOUNDED] != 0:
        return -inf
    centre_a, half_a = box_of(pair.reals_a)
    centre_b, half_b = box_of(pair.reals_b)
    d = sub(add(rotate(pose.R, centre_b), pose.p), centre_a)
    length = sqrt(dot(d, d))
    if not length > 0.0:
        return -inf
    n = scale(1.0 / length, d)
    reach = over_box(n, half_a) + over_box(rotate_back(pose.R, n), half_b)
    swept = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS] + pair_slack(pair)
    lengths = length + reach + swept + taxicab(pose.p) + taxicab(centre_a) + taxicab(centre_b)
    return length - reach - swept - BOUND_ROUNDINGS * EPS * lengths


@kernel
def way_between(pair, before, now):
    """How far any point of B may have gone from one pose to another, seen from A (length); inf of a
    half-space."""
    if pair.ints_b[L.UNBOUNDED] != 0:
        return inf
    centre, half = box_of(pair.reals_b)
    squares = 0.0
    for k in range(9):
        change = now.R[k] - before.R[k]
        squares += change * change
    old, new = add(rotate(before.R, centre), before.p), add(rotate(now.R, centre), now.p)
    gone = sub(new, old)
    way = sqrt(dot(gone, gone)) + turn_norm(squares) * sqrt(dot(half, half))
    lengths = taxicab(before.p) + taxicab(now.p) + taxicab(centre) + pair.reals_b[L.SIZE] + way
    return way + BOUND_ROUNDINGS * EPS * lengths
