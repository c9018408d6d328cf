"""The normal between two ellipsoids that are apart, by their support functions.

The distance of convex bodies is the greatest f(n) = n.(c_B - c_A) - h_A(n) - h_B(-n) over unit
vectors n, with h the support functions from the centres c: of an ellipsoid sqrt(n'Q n), Q = M M'
of its affine map M. Where f >= 0 it is concave along great circles, and Newton's method climbs it.
"""

from math import inf
from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import add, axpy, dot, norm, rotate, rotate_back, scale, sub
from standoff.kernels.compiler.decorators import small
from standoff.kernels.tolerances import LEAST_DIVISOR, LONGEST_TURN, NO_GAIN, SHORTENED, TURNED
from standoff.kernels.values import ORIGIN, Vector


class Ellipsoid(NamedTuple):
    """In its body's frame."""

    centre: Vector
    Q: tuple[float, ...]  # M M', 6 numbers: xx, xy, xz, yy, yz, zz


class Supported(NamedTuple):
    """An ellipsoid along a unit vector."""

    height: float  # of its support function, from its centre
    arm: Vector  # from the centre to the farthest point


class Apart(NamedTuple):
    """Both farthest points along a normal."""

    a: Supported  # in A's frame
    b: Supported  # in B's
    x_a: Vector  # in A's frame
    x_b: Vector


@small
def ellipsoid_of(affine):
    """What an affine map makes of the unit sphere."""
    a, b, c = affine[0:3], affine[3:6], affine[6:9]
    Q = (dot(a, a), dot(a, b), dot(a, c), dot(b, b), dot(b, c), dot(c, c))
    return Ellipsoid((affine[9], affine[10], affine[11]), Q)


@small
def times(Q, n):
    return (
        Q[0] * n[0] + Q[1] * n[1] + Q[2] * n[2],
        Q[1] * n[0] + Q[3] * n[1] + Q[4] * n[2],
        Q[2] * n[0] + Q[4] * n[1] + Q[5] * n[2],
    )


@small
def supported(Q, n):
    q = times(Q, n)
    height = sqrt(max(dot(n, q), LEAST_DIVISOR))
    return Supported(height, scale(1.0 / height, q))


@small
def bent(Q, at, t):
    """The second derivative of the support function, applied to t."""
    return scale(1.0 / at.height, axpy(-dot(at.arm, t), at.arm, times(Q, t)))


@small
def square_pair(n):
    """Two unit vectors square to n and to each other, without a branch (Duff et al., 2017)."""
    s = 1.0 if n[2] >= 0.0 else -1.0
    a = -1.0 / (s + n[2])
    b = n[0] * n[1] * a
    return (1.0 + s * n[0] * n[0] * a, s * b, -s * n[0]), (b, s + n[1] * n[1] * a, -n[1])


@small
def farthest(a, b, pose, n):
    """A's farthest point along n, and B's against it."""
    of_a, of_b = supported(a.Q, n), supported(b.Q, scale(-1.0, rotate_back(pose.R, n)))
    x_b = add(rotate(pose.R, add(b.centre, of_b.arm)), pose.p)
    return Apart(of_a, of_b, add(a.centre, of_a.arm), x_b)


class Turn(NamedTuple):
    """Newton's method between two of its steps."""

    normal: Vector  # the best so far
    value: float  # f there
    step: Vector  # from there, square to it
    share: float  # how much of the step is tried next
    count: float  # of normals tried


@small
def begun(way):
    """At a direction, with nothing known of it."""
    return Turn(scale(1.0 / norm(way), way), -inf, ORIGIN, 1.0, 0.0)


@small
def turned(a, b, pose, last):
    """Try a share of the last step: where f has grown take it, and find the next; elsewhere a
    smaller share is due. Settled ones stay as they are, whatever their neighbours do."""
    still = is_settled(last)
    n = ahead(last)
    at = farthest(a, b, pose, n)
    gap = sub(at.x_b, at.x_a)
    f = dot(n, gap)
    better = f >= last.value - NO_GAIN * (at.a.height + at.b.height)
    step = newton_step(a, b, pose, n, at, gap, f)
    take = better and not still
    share = 1.0 if better else SHORTENED * last.share
    return Turn(
        chosen(take, n, last.normal),
        f if take else last.value,
        chosen(take, step, last.step),
        last.share if still else share,
        last.count if still else last.count + 1.0,
    )


@small
def is_settled(turn):
    """Is the next step the last?"""
    return turn.count > 0.0 and dot(turn.step, turn.step) <= TURNED * TURNED


@small
def ahead(turn):
    """The unit normal that is tried next."""
    tried = axpy(turn.share, turn.step, turn.normal)
    return scale(1.0 / norm(tried), tried)


@small
def chosen(first, x, y):
    return (x[0] if first else y[0], x[1] if first else y[1], x[2] if first else y[2])


@small
def newton_step(a, b, pose, n, at, gap, f):
    """The step to the maximum of f, in the plane square to n, at most LONGEST_TURN long."""
    f = max(f, 0.0)  # so that the matrix is definite in overlap too
    t1, t2 = square_pair(n)
    own1, own2 = rotate_back(pose.R, t1), rotate_back(pose.R, t2)
    bent_a, bent_b = bent(a.Q, at.a, t1), bent(b.Q, at.b, own1)
    h11 = dot(t1, bent_a) + dot(own1, bent_b) + f
    h12 = dot(t2, bent_a) + dot(own2, bent_b)
    h22 = dot(t2, bent(a.Q, at.a, t2)) + dot(own2, bent(b.Q, at.b, own2)) + f
    g1, g2 = dot(t1, gap), dot(t2, gap)
    by = 1.0 / max(h11 * h22 - h12 * h12, LEAST_DIVISOR)
    s1, s2 = by * (h22 * g1 - h12 * g2), by * (h11 * g2 - h12 * g1)
    shorter = LONGEST_TURN / max(sqrt(s1 * s1 + s2 * s2), LONGEST_TURN)
    return axpy(shorter * s1, t1, scale(shorter * s2, t2))
