"""Nearest points of two pieces, found and not proven: candidates, and what potential suits them."""

from math import pi
from typing import NamedTuple

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids.planar_layout import (
    AFTER,
    ARC,
    BEFORE,
    CENTRE,
    FORM,
    FROM,
    GREATEST_SPEED,
    UNTIL,
    Potential,
)
from standoff.kernels.solids.planar_pieces import (
    arc_parameter,
    frame_at,
    jet_at,
    leaf_int,
    leaf_of,
    leaf_real,
    placed,
    turned_into,
)
from standoff.kernels.solids.planar_tolerances import (
    AT_OPTIMUM,
    END_OF_PIECE,
    NEWTON_END,
    NEWTON_STEPS,
    SAFE_NORMAL,
    SAME_POINT,
    SINGULAR_STEP,
    STRAIGHT_LEVEL,
)


class Nearest(NamedTuple):
    """Points of two pieces' leaves, and their parameters."""

    distance: float
    t: float
    s: float
    ax: float
    ay: float
    bx: float
    by: float


@small
def held(t, piece):
    low, high = min(piece.first, piece.last), max(piece.first, piece.last)
    return min(high, max(low, t))


@kernel
def foot(outline, piece, x, y, start):
    """The parameter of a piece's point that is nearest to (x, y), from a start."""
    leaf = leaf_of(outline, piece.node)
    if leaf_int(outline, leaf, FORM) == ARC:
        return foot_on_arc(outline, leaf, piece, x, y)
    t = held(start, piece)
    for _ in range(NEWTON_STEPS):
        px, py, dx, dy, ddx, ddy = jet_at(outline, leaf, t)
        ex, ey = px - x, py - y
        slope, speed = dx * ex + dy * ey, dx * dx + dy * dy
        bend = speed + ddx * ex + ddy * ey
        new = held(t - slope / (bend if bend > 0.25 * speed else speed), piece)
        if abs(new - t) <= NEWTON_END * abs(piece.last - piece.first):
            return new
        t = new
    return t


@kernel
def foot_on_arc(outline, leaf, piece, x, y):
    cx, cy = leaf_real(outline, leaf, CENTRE), leaf_real(outline, leaf, CENTRE + 1)
    cx, cy = placed(outline, cx, cy)
    low, high = min(piece.first, piece.last), max(piece.first, piece.last)
    if x == cx and y == cy:
        return 0.5 * (low + high)
    t = turned_into(arc_parameter(outline, leaf, x - cx, y - cy), low)
    if t <= high:
        return t
    # beyond the end: the nearer of both, by the angle that is left
    return high if t - high <= low + 2.0 * pi - t else low


@kernel
def pair_at(a, piece_a, b, piece_b, t, s):
    ax, ay, _, _, _, _ = jet_at(a, leaf_of(a, piece_a.node), t)
    bx, by, _, _, _, _ = jet_at(b, leaf_of(b, piece_b.node), s)
    dx, dy = bx - ax, by - ay
    return Nearest(sqrt(dx * dx + dy * dy), t, s, ax, ay, bx, by)


@small
def nearer(found, other):
    return other if other.distance < found.distance else found


@kernel
def common_normal(a, piece_a, b, piece_b, t, s):
    """Newton on parallel tangents and a difference perpendicular to them: regular in contact too,
    where the curvatures differ."""
    leaf_a, leaf_b = leaf_of(a, piece_a.node), leaf_of(b, piece_b.node)
    for _ in range(NEWTON_STEPS):
        ax, ay, ux, uy, uux, uuy = jet_at(a, leaf_a, t)
        bx, by, vx, vy, vvx, vvy = jet_at(b, leaf_b, s)
        ex, ey = bx - ax, by - ay
        turn, slope = ux * vy - uy * vx, ux * ex + uy * ey
        tt, ts = uux * vy - uuy * vx, ux * vvy - uy * vvx
        st, ss = uux * ex + uuy * ey - ux * ux - uy * uy, ux * vx + uy * vy
        area = tt * ss - ts * st
        if abs(area) <= SINGULAR_STEP * (abs(tt * ss) + abs(ts * st)):
            return t, s
        new_t = held(t - (turn * ss - ts * slope) / area, piece_a)
        new_s = held(s - (tt * slope - turn * st) / area, piece_b)
        steps = abs(new_t - t) / abs(piece_a.last - piece_a.first)
        steps += abs(new_s - s) / abs(piece_b.last - piece_b.first)
        t, s = new_t, new_s
        if steps <= NEWTON_END:
            break
    return t, s


@small
def along(piece, x, y):
    """The parameter at which a piece's chord is nearest to a point."""
    dx, dy = piece.x1 - piece.x0, piece.y1 - piece.y0
    size = dx * dx + dy * dy
    part = ((x - piece.x0) * dx + (y - piece.y0) * dy) / size if size > 0.0 else 0.5
    part = min(1.0, max(0.0, part))
    return piece.first + part * (piece.last - piece.first)


@kernel
def nearest_points(a, piece_a, b, piece_b):
    """The best of: each end with its foot point on the other, and the common normal."""
    s = foot(b, piece_b, piece_a.x0, piece_a.y0, along(piece_b, piece_a.x0, piece_a.y0))
    found = pair_at(a, piece_a, b, piece_b, piece_a.first, s)
    s = foot(b, piece_b, piece_a.x1, piece_a.y1, along(piece_b, piece_a.x1, piece_a.y1))
    found = nearer(found, pair_at(a, piece_a, b, piece_b, piece_a.last, s))
    t = foot(a, piece_a, piece_b.x0, piece_b.y0, along(piece_a, piece_b.x0, piece_b.y0))
    found = nearer(found, pair_at(a, piece_a, b, piece_b, t, piece_b.first))
    t = foot(a, piece_a, piece_b.x1, piece_b.y1, along(piece_a, piece_b.x1, piece_b.y1))
    found = nearer(found, pair_at(a, piece_a, b, piece_b, t, piece_b.last))
    t, s = common_normal(
        a,
        piece_a,
        b,
        piece_b,
        0.5 * (piece_a.first + piece_a.last),
        0.5 * (piece_b.first + piece_b.last),
    )
    # a crossing's points are nearest without a common normal: a foot point or two more
    s = foot(b, piece_b, *point_of(a, piece_a, t), s)
    t = foot(a, piece_a, *point_of(b, piece_b, s), t)
    found = nearer(found, pair_at(a, piece_a, b, piece_b, t, s))
    return crossing(a, piece_a, b, piece_b, found)


@small
def point_of(outline, piece, t):
    x, y, _, _, _, _ = jet_at(outline, leaf_of(outline, piece.node), t)
    return x, y


@kernel
def crossing(a, piece_a, b, piece_b, found):
    """Where two pieces that cross meet, by Newton on their difference."""
    leaf_a, leaf_b = leaf_of(a, piece_a.node), leaf_of(b, piece_b.node)
    t, s = found.t, found.s
    for _ in range(NEWTON_STEPS):
        ax, ay, ux, uy, _, _ = jet_at(a, leaf_a, t)
        bx, by, vx, vy, _, _ = jet_at(b, leaf_b, s)
        ex, ey = bx - ax, by - ay
        area = ux * vy - uy * vx
        if abs(area) <= AT_OPTIMUM * (abs(ux * vy) + abs(uy * vx)):
            return found
        new_t = held(t + (ex * vy - ey * vx) / area, piece_a)
        new_s = held(s + (ex * uy - ey * ux) / area, piece_b)
        if new_t == t and new_s == s:
            break
        t, s = new_t, new_s
        found = nearer(found, pair_at(a, piece_a, b, piece_b, t, s))
    return found


@small
def at_end(piece, t):
    """1 at the piece's last point, -1 at its first, 0 between."""
    length = END_OF_PIECE * abs(piece.last - piece.first)
    if abs(t - piece.last) <= length:
        return 1.0
    return -1.0 if abs(t - piece.first) <= length else 0.0


@kernel
def direction(a, piece_a, b, piece_b, near, extent):
    """A unit normal from A to B at a pair: that of the points, or in contact that of a curve; zeros
    where there is none."""
    dx, dy, d = near.bx - near.ax, near.by - near.ay, near.distance
    if d > SAFE_NORMAL * extent:
        return dx / d, dy / d
    nx, ny = 0.0, 0.0
    if at_end(piece_a, near.t) == 0.0:
        _, _, tx, ty, _ = frame_at(a, leaf_of(a, piece_a.node), near.t)
        nx, ny = ty, -tx
    elif at_end(piece_b, near.s) == 0.0:
        _, _, tx, ty, _ = frame_at(b, leaf_of(b, piece_b.node), near.s)
        nx, ny = -ty, tx
    elif d > SAME_POINT * extent:
        return dx / d, dy / d
    if nx * dx + ny * dy < 0.0 and d > SAME_POINT * extent:
        return -nx, -ny
    return nx, ny


@kernel
def bend_toward(outline, piece, t, nx, ny, back):
    """The curvature toward the normal at a piece's point, with what a slope out of the piece's end
    adds to it; carried by `back`, half of the gap."""
    leaf = leaf_of(outline, piece.node)
    _, _, tx, ty, k = frame_at(outline, leaf, t)
    k *= nx * ty - ny * tx  # the outward normal is (ty, -tx)
    end = at_end(piece, t)
    if end != 0.0:
        slope = end * (nx * tx + ny * ty)
        length = leaf_real(outline, leaf, GREATEST_SPEED) * abs(piece.last - piece.first)
        k += 2.0 * max(0.0, slope) / length
    spread = 1.0 + back * k
    return k / spread if spread > 0.0 else 1.0 / back


@small
def potential_of(near, nx, ny, k, extent):
    k = 0.0 if abs(k) * extent < STRAIGHT_LEVEL else k
    x, y = 0.5 * (near.ax + near.bx), 0.5 * (near.ay + near.by)
    return Potential(False, x, y, nx, ny, k)


@small
def between(low, high, widths):
    """A curvature between two, not far beyond what is needed."""
    if low <= 0.0 <= high:
        return 0.0
    if low > 0.0:
        return low + min(0.5 * (high - low), 0.25 / widths)
    return high - min(0.5 * (high - low), 0.25 / widths)


@kernel
def slope_over(outline, leaf, t, nx, ny):
    """How fast a leaf's point goes along the normal: just before t and just after it, over the end
    of the leaf too."""
    first, last = leaf_real(outline, leaf, FROM), leaf_real(outline, leaf, UNTIL)
    _, _, tx, ty, _ = frame_at(outline, leaf, t)
    before = after = nx * tx + ny * ty
    near = END_OF_PIECE * abs(last - first)
    if abs(t - first) <= near:
        other = leaf_int(outline, leaf, BEFORE)
        _, _, tx, ty, _ = frame_at(outline, other, leaf_real(outline, other, UNTIL))
        before = nx * tx + ny * ty
    if abs(t - last) <= near:
        other = leaf_int(outline, leaf, AFTER)
        _, _, tx, ty, _ = frame_at(outline, other, leaf_real(outline, other, FROM))
        after = nx * tx + ny * ty
    return before, after


@kernel
def is_stationary(a, piece_a, b, piece_b, near, nx, ny):
    """Can no small step on the boundaries make a pair nearer, to first order?"""
    before, after = slope_over(a, leaf_of(a, piece_a.node), near.t, nx, ny)
    if after > AT_OPTIMUM or before < -AT_OPTIMUM:
        return False
    before, after = slope_over(b, leaf_of(b, piece_b.node), near.s, nx, ny)
    return not (after < -AT_OPTIMUM or before > AT_OPTIMUM)
