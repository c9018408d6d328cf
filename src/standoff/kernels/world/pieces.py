"""Where the pieces of a world are: boxes around them, and how far each may have gone."""

from math import inf

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.algebra.turns import turn_norm
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.state.arrays import is_pose
from standoff.kernels.tolerances import BOUND_ROUNDINGS, EPS, FARTHEST
from standoff.kernels.world.arrays import (
    F_CENTRE,
    F_HALF,
    F_NORMAL,
    F_OFFSET,
    F_PLACED,
    F_PLANAR,
    F_PLANE,
    F_RADIUS,
    F_REACH,
    F_ROTATION,
    F_SHIFT,
    LEVEL,
    N_PLACED,
    P_CENTRE,
    P_HIGH,
    P_LOW,
    P_OFFSET,
    P_PAD,
    P_ROTATION,
    P_SHIFT,
    P_TRAVEL,
)


@kernel
def flat_pose(matrix, flat):
    """Copy a (4, 4) pose as R by rows and p. Is it one?"""
    for i in range(3):
        for j in range(3):
            flat[3 * i + j] = matrix[4 * i + j]
        flat[9 + i] = matrix[4 * i + 3]
    last = matrix[12] == 0.0 and matrix[13] == 0.0 and matrix[14] == 0.0 and matrix[15] == 1.0
    return last and is_pose(flat)


@kernel
def put_pose(body, fact, row):
    """The world pose of a piece: its body's, and its placement in it."""
    if fact[F_PLACED] == 0.0:
        for k in range(12):
            row[P_ROTATION + k] = body[k]
        return
    for i in range(3):
        shift = body[9 + i]
        for j in range(3):
            total = 0.0
            for k in range(3):
                total += body[3 * i + k] * fact[F_ROTATION + 3 * k + j]
            row[P_ROTATION + 3 * i + j] = total
            shift += body[3 * i + j] * fact[F_SHIFT + j]
        row[P_SHIFT + i] = shift
    if fact[F_PLACED] == LEVEL:
        # the tilt that is let pass in a planar pose times the placement would be out of plane
        row[P_ROTATION + 2], row[P_ROTATION + 5] = 0.0, 0.0
        row[P_ROTATION + 6], row[P_ROTATION + 7] = 0.0, 0.0
        row[P_SHIFT + 2] = 0.0


@kernel
def put_box(fact, row):
    """The box around a piece at its pose, in the axes of the world."""
    lengths = fact[F_RADIUS]
    for k in range(3):
        lengths += abs(row[P_SHIFT + k]) + abs(fact[F_CENTRE + k]) + fact[F_HALF + k]
        lengths += abs(fact[F_SHIFT + k])
    # three products and sums a coordinate, of the pose and of the point
    row[P_PAD] = BOUND_ROUNDINGS * EPS * lengths
    for i in range(3):
        centre, half = row[P_SHIFT + i], fact[F_RADIUS] + row[P_PAD]
        for j in range(3):
            entry = row[P_ROTATION + 3 * i + j]
            centre += entry * fact[F_CENTRE + j]
            half += abs(entry) * fact[F_HALF + j]
        row[P_CENTRE + i] = centre
        row[P_LOW + i], row[P_HIGH + i] = centre - half, centre + half


@kernel
def put_plane(fact, row):
    """A half-space: its normal and offset in the world; its box is all of it."""
    along = 0.0
    lengths = abs(fact[F_OFFSET]) + fact[F_RADIUS]
    for i in range(3):
        total = 0.0
        for j in range(3):
            total += row[P_ROTATION + 3 * i + j] * fact[F_NORMAL + j]
        row[P_CENTRE + i] = total
        along += total * row[P_SHIFT + i]
        lengths += abs(row[P_SHIFT + i]) + abs(fact[F_SHIFT + i])
        row[P_LOW + i], row[P_HIGH + i] = -inf, inf
    row[P_OFFSET] = fact[F_OFFSET] + along + fact[F_RADIUS]
    row[P_PAD] = BOUND_ROUNDINGS * EPS * lengths


@kernel
def gone(before, row, fact):
    """How far any point of a piece may have gone from one pose to another, at most (length)."""
    turned, moved = 0.0, 0.0
    for k in range(9):
        change = row[P_ROTATION + k] - before[P_ROTATION + k]
        turned += change * change
    # the box's centre of a bounded piece; of a half-space, every point where it does not turn
    first = P_SHIFT if fact[F_PLANE] != 0.0 else P_CENTRE
    for k in range(3):
        change = row[first + k] - before[first + k]
        moved += change * change
    way = sqrt(moved)
    if turned > 0.0:
        if fact[F_PLANE] != 0.0:
            return FARTHEST
        way += turn_norm(turned) * fact[F_REACH]
    return way + 2.0 * (row[P_PAD] + before[P_PAD])


@kernel
def same_pose(before, row):
    """Is a piece where it was, to the last bit?"""
    same = True
    for k in range(12):
        same = same and row[P_ROTATION + k] == before[P_ROTATION + k]
    return same


@kernel
def put_piece(body, fact, before, row):
    """Fill in a piece's row; is it where it was?"""
    put_pose(body, fact, row)
    if same_pose(before, row):
        for k in range(N_PLACED):
            row[k] = before[k]
        return True
    if fact[F_PLANE] != 0.0:
        put_plane(fact, row)
    else:
        put_box(fact, row)
    row[P_TRAVEL] = 0.0
    if before[P_SHIFT] == before[P_SHIFT]:  # nan before the first frame
        travel = before[P_TRAVEL] + gone(before, row, fact)
        row[P_TRAVEL] = travel + 4.0 * EPS * travel  # the sum is rounded, maybe down
    return False


@kernel
def support_of(row, fact, d):
    """How far the box around a piece reaches from its centre along a unit vector, with radius."""
    reach = fact[F_RADIUS]
    for j in range(3):
        along = 0.0
        for i in range(3):
            along += row[P_ROTATION + 3 * i + j] * d[i]
        reach += abs(along) * fact[F_HALF + j]
    return reach


@kernel
def over_plane(plane, row, fact):
    """How far a bounded piece is above a half-space, at least."""
    n = (plane[P_CENTRE], plane[P_CENTRE + 1], plane[P_CENTRE + 2])
    height = 0.0
    for i in range(3):
        height += n[i] * row[P_CENTRE + i]
    height -= plane[P_OFFSET] + support_of(row, fact, n)
    lengths = abs(plane[P_OFFSET]) + abs(height)
    for i in range(3):
        lengths += abs(row[P_CENTRE + i])
    return height - plane[P_PAD] - row[P_PAD] - BOUND_ROUNDINGS * EPS * lengths


@kernel
def boxes_apart(a, fact_a, b, fact_b):
    """A lower bound of two bounded pieces' signed distance: of their boxes, along the line of their
    centres, and of the boxes about these in the axes of the world."""
    d = (
        b[P_CENTRE] - a[P_CENTRE],
        b[P_CENTRE + 1] - a[P_CENTRE + 1],
        b[P_CENTRE + 2] - a[P_CENTRE + 2],
    )
    length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    along = -inf
    if length > 0.0:
        n = (d[0] / length, d[1] / length, d[2] / length)
        reach = support_of(a, fact_a, n) + support_of(b, fact_b, n)
        along = length - reach - BOUND_ROUNDINGS * EPS * (length + reach)
    squares, deepest = 0.0, -inf
    # planar bodies lie in z = 0: there the boxes' thickness is no depth
    planar = fact_a[F_PLANAR] != 0.0 or fact_b[F_PLANAR] != 0.0
    for i in range(2 if planar else 3):
        gap = max(b[P_LOW + i] - a[P_HIGH + i], a[P_LOW + i] - b[P_HIGH + i])
        deepest = max(deepest, gap)
        squares += gap * gap if gap > 0.0 else 0.0
    axes = sqrt(squares) if deepest > 0.0 else deepest
    return max(along - a[P_PAD] - b[P_PAD], axes - BOUND_ROUNDINGS * EPS * abs(axes))


@kernel
def apart(a, fact_a, b, fact_b):
    """A lower bound of two pieces' signed distance, from their boxes alone."""
    if fact_a[F_PLANE] != 0.0:
        return over_plane(a, b, fact_b)
    if fact_b[F_PLANE] != 0.0:
        return over_plane(b, a, fact_a)
    return boxes_apart(a, fact_a, b, fact_b)
