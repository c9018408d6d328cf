"""Lower bounds of a pair's distance that need no witness points: of its boxes, and of the last
frame's bound less the way that the bodies have gone since. Where one exceeds the horizon, nothing
more is asked.
"""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.turns import OFF_ROTATION, turn_norm
from standoff.kernels.algebra.vectors import add, dot, rotate, rotate_back, scale, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_jet, chart_normal, pair_slack
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS
from standoff.kernels.values import Pose


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
def over_plane(plane, reals, pose, swept):
    """How far a box is above the plane of a half-space, at least; `plane` are the half-space's ints
    and reals, the pose is the box's in its frame."""
    ints, own = plane
    n = chart_normal(ints, own, 0, 0.0, 0.0)
    point = chart_jet(ints, own, 0, 0.0, 0.0)[0]
    centre, half = box_of(reals)
    d = sub(add(rotate(pose.R, centre), pose.p), point)
    height, reach = dot(n, d), over_box(rotate_back(pose.R, n), half)
    lengths = taxicab(d) + reach + swept + taxicab(pose.p) + taxicab(centre) + taxicab(point)
    return height - reach - swept - BOUND_ROUNDINGS * EPS * lengths


@kernel
def boxes_apart(pair, pose):
    """A lower bound of the swept bodies' distance along the line of their boxes' centres, or along
    the normal of a half-space."""
    swept = pair.reals_a[L.RADIUS] + pair.reals_b[L.RADIUS] + pair_slack(pair)
    if pair.ints_a[L.UNBOUNDED] != 0:
        return over_plane((pair.ints_a, pair.reals_a), pair.reals_b, pose, swept)
    if pair.ints_b[L.UNBOUNDED] != 0:
        bound = over_plane((pair.ints_b, pair.reals_b), pair.reals_a, inverse(pose), swept)
        return bound - off_inverse(pair.reals_a, pose)
    centre_a, half_a = box_of(pair.reals_a)
    centre_b, half_b = box_of(pair.reals_b)
    d = sub(add(rotate(pose.R, centre_b), pose.p), centre_a)
    length = sqrt(dot(d, d))
    if not length > 0.0:
        return -inf
    n = scale(1.0 / length, d)
    reach = over_box(n, half_a) + over_box(rotate_back(pose.R, n), half_b)
    lengths = length + reach + swept + taxicab(pose.p) + taxicab(centre_a) + taxicab(centre_b)
    return length - reach - swept - BOUND_ROUNDINGS * EPS * lengths


@kernel
def inverse(pose):
    """The pose of A in B's frame, of B's in A's: of a rotation, see `off_inverse`."""
    R = pose.R
    turned = (R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8])
    return Pose(turned, scale(-1.0, rotate_back(R, pose.p)))


@kernel
def off_inverse(reals, pose):
    """How far `inverse` may put a point of a core from where it is (length): the transpose of what
    is only nearly a rotation is only nearly its inverse."""
    centre, half = box_of(reals)
    return OFF_ROTATION * (taxicab(pose.p) + taxicab(centre) + taxicab(half))


@kernel
def way_between(pair, before, now):
    """How far any point of one body may have gone from one pose to another, seen from the other
    (length): of B, but of A where B is a half-space."""
    if pair.ints_b[L.UNBOUNDED] != 0:
        off = off_inverse(pair.reals_a, before) + off_inverse(pair.reals_a, now)
        return way_of(pair.reals_a, inverse(before), inverse(now)) + off
    return way_of(pair.reals_b, before, now)


@kernel
def way_of(reals, before, now):
    """How far any point of a core may have gone from one pose to another (length)."""
    centre, half = box_of(reals)
    squares = 0.0
    for k in range(9):
        change = now.R[k] - before.R[k]
        squares += change * change
    old, new = add(rotate(before.R, centre), before.p), add(rotate(now.R, centre), now.p)
    gone = sub(new, old)
    way = sqrt(dot(gone, gone)) + turn_norm(squares) * sqrt(dot(half, half))
    lengths = taxicab(before.p) + taxicab(now.p) + taxicab(centre) + reals[L.SIZE] + way
    return way + BOUND_ROUNDINGS * EPS * lengths
