"""Where an edge of one body crosses an edge of the other, seen along the normal."""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.vectors import dot
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import edge_record
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.patches.seen import EDGE, FIRST, LAST, edge_place, laid
from standoff.kernels.patches.tolerances import AT_CROSSING, FLAT_CROSSING, SPOT_STEPS


@kernel
def crossed(p, q, near):
    """(do they cross, share of the first, share of the second) of two pieces, pointers to them,
    which may each be longer by `near`."""
    px, py, qx, qy = p[FIRST + 1], p[FIRST + 2], q[FIRST + 1], q[FIRST + 2]
    ax, ay, bx, by = p[LAST + 1] - px, p[LAST + 2] - py, q[LAST + 1] - qx, q[LAST + 2] - qy
    first, second = sqrt(ax * ax + ay * ay), sqrt(bx * bx + by * by)
    det = ax * by - ay * bx
    if min(first, second) <= near or abs(det) <= FLAT_CROSSING * first * second:
        return False, 0.0, 0.0  # seen from its end, or along each other
    s = ((qx - px) * by - (qy - py) * bx) / det
    t = ((qx - px) * ay - (qy - py) * ax) / det
    inside = abs(s - 0.5) * first <= 0.5 * first + near
    inside = inside and abs(t - 0.5) * second <= 0.5 * second + near
    return inside, min(max(s, 0.0), 1.0), min(max(t, 0.0), 1.0)


@kernel
def is_straight(seen, feature):
    return seen.ints[edge_record(seen.ints, feature) + L.EDGE_KIND] == L.LINE


@kernel
def range_of(seen, feature):
    o = seen.ints[edge_record(seen.ints, feature) + L.EDGE_REALS]
    return seen.reals[o + L.EDGE_T0], seen.reals[o + L.EDGE_T1]


@kernel
def crossing(a, b, p, q, near):
    """(found, parameter on A's edge, on B's) of the crossing of two pieces, pointers to them."""
    edge_a, edge_b = int(p[EDGE]), int(q[EDGE])
    inside, s, t = crossed(p, q, near)
    if not inside:
        return False, 0.0, 0.0
    s, t = p[FIRST] + s * (p[LAST] - p[FIRST]), q[FIRST] + t * (q[LAST] - q[FIRST])
    if is_straight(a, edge_a) and is_straight(b, edge_b):
        return True, s, t
    s0, s1 = range_of(a, edge_a)
    t0, t1 = range_of(b, edge_b)
    enough = AT_CROSSING * (a.reals[L.SIZE] + b.reals[L.SIZE])
    off = inf
    for _ in range(SPOT_STEPS):
        x, xs = edge_place(a, edge_a, s)
        y, yt = edge_place(b, edge_b, t)
        ax, ay, _ = laid(a, x)
        bx, by, _ = laid(b, y)
        off = abs(bx - ax) + abs(by - ay)
        if off <= enough:
            break
        c, d, g, h = dot(xs, a.e), -dot(yt, a.e), dot(xs, a.f), -dot(yt, a.f)
        det = c * h - d * g
        if det == 0.0:
            break
        s = min(max(s + ((bx - ax) * h - d * (by - ay)) / det, s0), s1)
        t = min(max(t + (c * (by - ay) - g * (bx - ax)) / det, t0), t1)
    return off <= near, s, t
