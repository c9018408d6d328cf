"""Pairs of nodes: how far apart their boxes are, whether their cones of normals admit a nearest
pair, and the queue of those that wait."""

from math import acos, asin, inf, pi, sin

from standoff.kernels.algebra.vectors import add, dot, norm, rotate, scale, sub
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_tolerances import CONE_SPARE


@kernel
def node_reals(side, node):
    return side.own[S.R_NODES] + S.NODE_REALS * node


@kernel
def vector_at(m, o):
    return (m[o], m[o + 1], m[o + 2])


@kernel
def node_axis(side, node, k):
    return rotate(side.pose.R, vector_at(side.numbers, node_reals(side, node) + S.AXES + 3 * k))


@kernel
def node_centre(side, node):
    return add(rotate(side.pose.R, vector_at(side.numbers, node_reals(side, node))), side.pose.p)


@kernel
def half_along(m, o, axes, n):
    return (
        m[o] * abs(dot(axes[0], n))
        + m[o + 1] * abs(dot(axes[1], n))
        + m[o + 2] * abs(dot(axes[2], n))
    )


@kernel
def cone_of(side, node):
    """(axis, half angle) of the normals of features below a node; -1: there are none."""
    if side.sense == S.EITHER:
        return (0.0, 0.0, 1.0), pi
    m, R = side.numbers, side.pose.R
    o = node_reals(side, node) + (S.N_IN if side.sense == S.INSIDE else S.N_OUT)
    axis, angle = rotate(R, vector_at(m, o)), m[o + 3]
    if side.sense != S.PRESSED:
        return axis, angle
    o = node_reals(side, node) + S.N_IN
    return cone_of_both(axis, angle, scale(-1.0, rotate(R, vector_at(m, o))), m[o + 3])


@kernel
def cone_of_both(axis, angle, other, wide):
    """A cone round two, of which either may hold nothing, with a half angle of -1."""
    if wide < 0.0:
        return axis, angle
    if angle < 0.0:
        return other, wide
    between = angle_between(axis, other)
    if between + wide <= angle:
        return axis, angle
    if between + angle <= wide:
        return other, wide
    middle = add(axis, other)
    length = norm(middle)
    if length < 1.0:  # farther apart than a third of a turn
        return axis, pi
    middle = scale(1.0 / length, middle)
    reach = max(angle_between(middle, axis) + angle, angle_between(middle, other) + wide)
    return middle, min(reach + CONE_SPARE, pi)


@kernel
def gap_of(a, i, b, j):
    """A lower bound of the distance of two nodes' boxes; below 0 where nothing separates them."""
    return gap_along(a, i, b, j)[0]


@kernel
def gap_along(a, i, b, j):
    """(gap, n): the widest gap of two nodes' boxes along a direction, from A to B, of those that
    are tried: their axes, the line between their centres, and that between their nearest points."""
    axes_a = (node_axis(a, i, 0), node_axis(a, i, 1), node_axis(a, i, 2))
    axes_b = (node_axis(b, j, 0), node_axis(b, j, 1), node_axis(b, j, 2))
    ha, hb = node_reals(a, i) + S.HALF, node_reals(b, j) + S.HALF
    ma, mb = a.numbers, b.numbers
    delta = sub(node_centre(b, j), node_centre(a, i))
    length = norm(delta)
    best, way = -inf, (0.0, 0.0, 0.0)
    if length > 0.0:
        way = scale(1.0 / length, delta)
        best = length - half_along(ma, ha, axes_a, way) - half_along(mb, hb, axes_b, way)
    for k in range(3):
        n = axes_a[k]
        gap = abs(dot(delta, n)) - ma[ha + k] - half_along(mb, hb, axes_b, n)
        if gap > best:
            best, way = gap, n
        n = axes_b[k]
        gap = abs(dot(delta, n)) - mb[hb + k] - half_along(ma, ha, axes_a, n)
        if gap > best:
            best, way = gap, n
    # the nearest points of the boxes, found roughly, give a direction for corners
    x, y = (0.0, 0.0, 0.0), delta
    for _ in range(3):
        x = within(ma, ha, axes_a, y)
        y = add(delta, within(mb, hb, axes_b, sub(x, delta)))
    away = sub(y, x)
    length = norm(away)
    if length > 0.0:
        n = scale(1.0 / length, away)
        gap = dot(delta, n) - half_along(ma, ha, axes_a, n) - half_along(mb, hb, axes_b, n)
        if gap > best:
            best, way = gap, n
    return best, scale(-1.0, way) if dot(way, delta) < 0.0 else way


@kernel
def within(m, o, axes, x):
    """The point of a box about the origin that is nearest to x."""
    r = (0.0, 0.0, 0.0)
    for k in range(3):
        c = min(max(dot(axes[k], x), -m[o + k]), m[o + k])
        r = add(r, scale(c, axes[k]))
    return r


@kernel
def angle_between(a, b):
    return acos(min(max(dot(a, b), -1.0), 1.0))


@kernel
def node_reach(side, node):
    o = node_reals(side, node) + S.HALF
    return norm(vector_at(side.numbers, o))


@small
def admits(a, i, b, j, gap):
    """May two nodes hold a nearest pair of features, by their cones of normals? What is proven
    apart only; False is proven."""
    return shut_for(a, i, b, j, gap, 1.0) <= 0.0


@kernel
def shut_for(a, i, b, j, gap, radius):
    """How far B may move before two nodes may hold a nearest pair of features, by their cones of
    normals, length; 0 or less where they may.

    A motion counts as the greatest shift of B's points; it is at least `radius` times its angle.
    What is proven while the nodes are apart only."""
    if gap <= 0.0:
        return 0.0
    cones = cone_of(a, i), cone_of(b, j)
    if cones[0][1] < 0.0 or cones[1][1] < 0.0:
        return gap
    shut = unopposed_for(cones, radius)
    delta = sub(node_centre(b, j), node_centre(a, i))
    length = norm(delta)
    reach = node_reach(a, i) + node_reach(b, j)
    if length > reach:
        shut = max(shut, led_past_for(cones, scale(1.0 / length, delta), length, reach, radius))
    return min(gap, shut)


@kernel
def normals_shut_for(a, i, b, j, gap, radius):
    """How far B may move before two nodes may hold features with a common normal along the line
    between their points, from either to the other, length; 0 or less where they may. The nodes
    need not be apart."""
    cones = cone_of(a, i), cone_of(b, j)
    if cones[0][1] < 0.0 or cones[1][1] < 0.0:
        return inf
    shut = unopposed_for(cones, radius)
    delta = sub(node_centre(b, j), node_centre(a, i))
    length = norm(delta)
    reach = node_reach(a, i) + node_reach(b, j)
    if shut > 0.0 or gap <= 0.0 or length <= reach:
        return shut
    n = scale(1.0 / length, delta)
    there = led_past_for(cones, n, length, reach, radius)
    back = led_past_for(cones, scale(-1.0, n), length, reach, radius)
    return max(shut, min(gap, min(there, back)))


@kernel
def unopposed_for(cones, radius):
    """How far B may move while no two normals of both cones are opposed, length: a turn brings them
    nearer to it."""
    (axis_a, angle_a), (axis_b, angle_b) = cones
    return radius * (pi - angle_a - angle_b - CONE_SPARE - angle_between(axis_a, axis_b))


@kernel
def led_past_for(cones, n, length, reach, radius):
    """How far B may move while the normals of one node lead past the other along n, the unit vector
    between the middles of both, or against it; length, below 0 where they do not."""
    (axis_a, angle_a), (axis_b, angle_b) = cones
    spread, shut = asin(reach / length), -1.0
    # A's normals lead past B: a shift of B widens the directions to it
    free = angle_between(axis_a, n) - angle_a - CONE_SPARE
    if free > spread:
        shut = length * sin(min(free, 0.5 * pi)) - reach
    # B's lead past A: half of what is free for its turn, half for its shift
    free = pi - angle_b - CONE_SPARE - angle_between(axis_b, n)
    if free > spread:
        half = 0.5 * (free - spread)
        shift = length * sin(min(spread + half, 0.5 * pi)) - reach
        shut = max(shut, min(radius * half, shift))
    return shut


@kernel
def push(keys, firsts, others, count, key, i, j):
    """Put (key, i, j) into a heap with the least key first; its new count."""
    at = count
    while at > 0:
        above = (at - 1) // 2
        if keys[above] <= key:
            break
        keys[at], firsts[at], others[at] = keys[above], firsts[above], others[above]
        at = above
    keys[at], firsts[at], others[at] = key, i, j
    return count + 1


@kernel
def take(keys, firsts, others, count):
    """Take the least out of the heap: (key, i, j, new count)."""
    key, i, j = keys[0], firsts[0], others[0]
    count -= 1
    k, m, n = keys[count], firsts[count], others[count]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= count:
            break
        if below + 1 < count and keys[below + 1] < keys[below]:
            below += 1
        if k <= keys[below]:
            break
        keys[at], firsts[at], others[at] = keys[below], firsts[below], others[below]
        at = below
    keys[at], firsts[at], others[at] = k, m, n
    return key, i, j, count
