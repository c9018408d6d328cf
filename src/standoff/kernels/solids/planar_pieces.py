"""Points and pieces of a planar solid's boundary, and how far their capsules are apart."""

from math import atan2, pi

from standoff.kernels.algebra.roots import sqrt
from standoff.kernels.body.jets import curve_jet
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.solids.planar_layout import (
    BEND,
    DATA,
    END,
    FORM,
    FROM,
    KIND,
    LEAF,
    LINE,
    N_LEAF,
    N_LEAF_INT,
    N_NODE,
    N_NODE_INT,
    PAD,
    START,
    UNTIL,
    Piece,
)


@small
def leaf_of(outline, node):
    return outline.node_ints[N_NODE_INT * node + LEAF]


@small
def leaf_real(outline, leaf, which):
    return outline.leaves[N_LEAF * leaf + which]


@small
def leaf_int(outline, leaf, which):
    return outline.leaf_ints[N_LEAF_INT * leaf + which]


@small
def placed(outline, x, y):
    return (
        outline.c * x - outline.s * y + outline.p,
        outline.s * x + outline.c * y + outline.q,
    )


@kernel
def jet_at(outline, leaf, t):
    """(x, y, x_t, y_t, x_tt, y_tt) of a leaf's curve."""
    at, kind = leaf_int(outline, leaf, DATA), leaf_int(outline, leaf, KIND)
    x, xt, xtt = curve_jet(outline.reals, kind, at, t)
    c, s = outline.c, outline.s
    px, py = placed(outline, x[0], x[1])
    return (
        px,
        py,
        c * xt[0] - s * xt[1],
        s * xt[0] + c * xt[1],
        c * xtt[0] - s * xtt[1],
        s * xtt[0] + c * xtt[1],
    )


@kernel
def frame_at(outline, leaf, t):
    """(x, y, T_x, T_y, curvature): T the unit tangent with the solid on its left."""
    x, y, dx, dy, ddx, ddy = jet_at(outline, leaf, t)
    speed = sqrt(dx * dx + dy * dy)
    sign = 1.0 if leaf_real(outline, leaf, UNTIL) > leaf_real(outline, leaf, FROM) else -1.0
    k = sign * (dx * ddy - dy * ddx) / (speed * speed * speed)
    return x, y, sign * dx / speed, sign * dy / speed, k


@kernel
def node_piece(outline, node):
    """A whole node."""
    at, leaf = N_NODE * node, leaf_of(outline, node)
    nodes = outline.nodes
    x0, y0 = placed(outline, nodes[at], nodes[at + 1])
    x1, y1 = placed(outline, nodes[at + 2], nodes[at + 3])
    if leaf < 0:
        return Piece(node, 0.0, 0.0, x0, y0, x1, y1, nodes[at + 4])
    first, last = leaf_real(outline, leaf, FROM), leaf_real(outline, leaf, UNTIL)
    return Piece(node, first, last, x0, y0, x1, y1, nodes[at + 4])


@kernel
def halves(outline, piece):
    """The two parts of a node, or of a piece of a leaf.

    A chord leaves its curve by no more than max |x_tt| (length in t)² / 8.
    """
    leaf = leaf_of(outline, piece.node)
    if leaf < 0:
        at = N_NODE_INT * piece.node
        left, right = outline.node_ints[at], outline.node_ints[at + 1]
        return node_piece(outline, left), node_piece(outline, right)
    middle = 0.5 * (piece.first + piece.last)
    x, y, _, _, _, _ = jet_at(outline, leaf, middle)
    step = max(abs(middle - piece.first), abs(piece.last - middle))
    sag = 0.125 * leaf_real(outline, leaf, BEND) * step * step
    radius = sag + leaf_real(outline, leaf, PAD)
    return (
        Piece(piece.node, piece.first, middle, piece.x0, piece.y0, x, y, radius),
        Piece(piece.node, middle, piece.last, x, y, piece.x1, piece.y1, radius),
    )


@small
def width(piece):
    """What decides which piece of two is cut."""
    dx, dy = piece.x1 - piece.x0, piece.y1 - piece.y0
    return sqrt(dx * dx + dy * dy) + 2.0 * piece.radius


@small
def to_segment(x, y, x0, y0, x1, y1):
    """The distance of a point from a segment."""
    dx, dy = x1 - x0, y1 - y0
    ex, ey = x - x0, y - y0
    size = dx * dx + dy * dy
    s = (dx * ex + dy * ey) / size if size > 0.0 else 0.0
    s = min(1.0, max(0.0, s))
    ex -= s * dx
    ey -= s * dy
    return sqrt(ex * ex + ey * ey)


@kernel
def segments_apart(p, q):
    """The distance of two pieces' chords."""
    ax, ay, bx, by = p.x1 - p.x0, p.y1 - p.y0, q.x1 - q.x0, q.y1 - q.y0
    ex, ey = q.x0 - p.x0, q.y0 - p.y0
    area = ax * by - ay * bx
    if area != 0.0:
        s, t = (ex * by - ey * bx) / area, (ex * ay - ey * ax) / area
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            return 0.0
    return min(
        min(
            to_segment(p.x0, p.y0, q.x0, q.y0, q.x1, q.y1),
            to_segment(p.x1, p.y1, q.x0, q.y0, q.x1, q.y1),
        ),
        min(
            to_segment(q.x0, q.y0, p.x0, p.y0, p.x1, p.y1),
            to_segment(q.x1, q.y1, p.x0, p.y0, p.x1, p.y1),
        ),
    )


@small
def apart(p, q):
    """No points of two pieces are nearer than this, which is below 0 where nothing is known."""
    return segments_apart(p, q) - p.radius - q.radius


@kernel
def arc_parameter(outline, leaf, ux, uy):
    """The parameter at which a circle's point lies in a direction from its centre."""
    o = leaf_int(outline, leaf, DATA)
    c, s, reals = outline.c, outline.s, outline.reals
    vx, vy = c * ux + s * uy, c * uy - s * ux
    along_a = vx * reals[o] + vy * reals[o + 3]
    along_b = vx * reals[o + 1] + vy * reals[o + 4]
    return atan2(along_b, along_a)


@small
def turned_into(t, low):
    """The angle t plus the turns that make it the least one not below `low`."""
    turns = (low - t) / (2.0 * pi)
    whole = float(int(turns))
    if whole < turns:
        whole += 1.0
    return t + 2.0 * pi * whole


@kernel
def start_of(outline, leaf):
    x, y = leaf_real(outline, leaf, START), leaf_real(outline, leaf, START + 1)
    return placed(outline, x, y)


@kernel
def end_of(outline, leaf):
    return placed(outline, leaf_real(outline, leaf, END), leaf_real(outline, leaf, END + 1))


@small
def straight(outline, leaf):
    return leaf_int(outline, leaf, FORM) == LINE
