"""How long a pair of leaves rests in which Newton's method came to no common normal."""

from standoff.kernels.algebra.vectors import dot, norm, scale, sub
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_minimum import first_normal, moved_side
from standoff.kernels.solids.front_branches import steepest_side
from standoff.kernels.solids.front_minima import RESTS
from standoff.kernels.solids.spatial_minimum import jets_at
from standoff.kernels.solids.spatial_progress import SIZE
from standoff.kernels.solids.spatial_tolerances import HELD_SLOPE

# Of the distance of leaves that are curved round each other: how far B may move before they are
# looked at again.
RESTS_APART = 0.5
# Times that distance by which the points of both may be beside each other, for it to tell anything.
BESIDE = 4.0


@kernel
def curvature_along(jet, n):
    """The greater curvature of a surface or curve along its parameters, in the direction n."""
    most = 0.0
    for k in range(2):
        tangent, bend = jet[1 + k], jet[3] if k == 0 else jet[5]
        square = dot(tangent, tangent)
        if square > 0.0:
            most = max(most, abs(dot(n, bend)) / square)
    return most


@kernel
def apart_for(a, b, q, best):
    """Of the motion of B that could bring two leaves, as parts, together, some, length: of their
    distance along a normal at parameters `q`, less what their slopes make of it within the leaves;
    0 or less where they may be near. What there is apart of them may be found later."""
    ja, jb = jets_at(a.side, a.leaf, b.side, b.leaf, q)
    n = first_normal(a.side, a.leaf, ja, b.side, b.leaf, jb, q, best[SIZE])
    delta = sub(jb[0], ja[0])
    d = dot(n, delta)
    beside = norm(sub(delta, scale(d, n)))
    if beside > BESIDE * d:  # neither is over the other there
        return 0.0
    bent = 0.5 * beside * beside * (curvature_along(ja, n) + curvature_along(jb, n))
    u, v = 0.5 * (a.box.u1 - a.box.u0), 0.5 * (a.box.v1 - a.box.v0)
    s, t = 0.5 * (b.box.u1 - b.box.u0), 0.5 * (b.box.v1 - b.box.v0)
    of_a = abs(dot(n, ja[1])) * u + abs(dot(n, ja[2])) * v
    of_b = abs(dot(n, jb[1])) * s + abs(dot(n, jb[2])) * t
    return RESTS_APART * (d - of_a - of_b - bent)


@kernel
def held_for(a, b, q, away, turn):
    """Of the motion of B that could level the slope at a side of two leaves, as parts, at which
    they are nearest moved apart by a vector, some, length; 0 where they are held at none. `turn`:
    as of `rests_for`."""
    moved = S.Part(moved_side(b.side, away), b.leaf, b.box)
    sine, _, _ = steepest_side(a, moved, q, False)
    ja, jb = jets_at(a.side, a.leaf, moved.side, b.leaf, q)
    distance = norm(sub(jb[0], ja[0]))
    if sine <= HELD_SLOPE or distance == 0.0:
        return 0.0
    return RESTS * sine / (1.0 / distance + turn)
