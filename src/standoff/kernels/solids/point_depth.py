"""How far a point is from a solid's boundary, and on which side of it."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.algebra.rigid import read_vector
from standoff.kernels.algebra.vectors import add, dot, norm, rotate, rotate_back, scale, sub
from standoff.kernels.body import features
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_pieces import ZERO, leaf_ints, leaf_jet
from standoff.kernels.solids.spatial_progress import (
    AT,
    BEST_REALS,
    BUDGET,
    LEAF_B,
    LEAST,
    MEETING,
    MET,
    MINIMUM_REALS,
    MOST_MINIMA,
    N_MINIMA,
    OPEN,
    ROUNDING,
    SIZE,
    TOLERANCE,
)
from standoff.kernels.solids.spatial_search import search
from standoff.kernels.solids.spatial_tolerances import (
    ACROSS_EDGE,
    ALONG_NORMAL,
    BESIDE_EDGE,
    NO_SIDE,
    UNCLEAR_NORMAL,
)
from standoff.kernels.values import Pose

UNTURNED = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
# Nearest pairs of points that a search keeps.
MOST_TIES = 256
# Nearest places that are asked for the side of a point.
MOST_PLACES = 16
# Of a depth: to what it is proven where many are asked.
LOOSE_DEPTH = 0.1


class Known(NamedTuple):
    """A solid in its own frame, and what was found out of it beforehand.

    Attributes
    ----------
    side : its boundary.
    normals : of each vertex a vector that tells outside from inside; nan where none does.
    references, n_references : points of its boundary, 3 numbers each.
    size : length.
    """

    side: Any
    normals: Any
    references: Any
    n_references: Any
    size: Any


class Probe(NamedTuple):
    """What asks of points.

    Attributes
    ----------
    point : the origin as a solid.
    rounding, proof, deadline : of a size, and evaluations: what bounds are computed and proven to.
    lists : what a search fills.
    heap, space : its room.
    counts : what it takes.
    """

    point: Any
    rounding: Any
    proof: Any
    deadline: Any
    lists: Any
    heap: Any
    space: Any
    counts: Any


@kernel
def seen_from(side, x):
    """A solid with a point of its frame at the origin."""
    placed = Pose(UNTURNED, scale(-1.0, x))
    return S.Side(side.ints, side.reals, side.own, side.numbers, placed, S.EITHER)


@kernel
def ask_search(best, size, away, rounding, tolerance, deadline):
    """What is asked of a search for the nearest points alone, at how far the solids' frames are
    from each other."""
    for k in range(BEST_REALS):
        best[k] = 0.0
    best[LEAST], best[OPEN], best[TOLERANCE], best[MEETING] = inf, inf, tolerance, tolerance
    best[ROUNDING], best[SIZE] = rounding * (size + away), size
    best[BUDGET], best[MOST_MINIMA] = deadline, MOST_TIES


@kernel
def look(known, x, tolerance, below, probe):
    """Search for the nearest points of a boundary up to a distance; the solid as it is seen."""
    best, minima = probe.lists
    ask_search(best, known.size, norm(x), probe.rounding, tolerance, probe.deadline)
    best[LEAST] = below
    if below < inf:
        best[MEETING] = -1.0
    seen = seen_from(known.side, x)
    search(probe.point, seen, best, minima, probe.heap, probe.space, probe.counts)
    return seen


@kernel
def across_edge(seen, leaf, u, v):
    """The sum of both faces' normals at a point of an edge, own frame."""
    ints = seen.ints
    first = ints[L.EDGES]
    feature = seen.own[leaf_ints(seen, leaf) + S.FEATURE]
    row = first + L.EDGE_STRIDE * (feature - ints[L.N_FACES])
    tangent = leaf_jet(seen, leaf, u, v)[1]
    size = norm(tangent)
    if size == 0.0:
        return ZERO
    way = scale(1.0 / size, tangent)
    k, other = ints[row + L.EDGE_COEDGE_0], ints[row + L.EDGE_COEDGE_1]
    one = features.coedge_conormal(ints, seen.reals, k, way, u)[1]
    total = add(one, features.coedge_conormal(ints, seen.reals, other, way, u)[1])
    return total if norm(total) > NO_SIDE else ZERO


@kernel
def outwards(seen, normals, leaf, u, v):
    """A vector d at a point y of the boundary, own frame: a point p whose nearest point of the
    boundary is y is outside where d . (p - y) > 0; 0 where it is not known."""
    r = leaf_ints(seen, leaf)
    dim = seen.own[r + S.DIM]
    if dim == 2:
        jet = features.chart_jet(seen.ints, seen.reals, seen.own[r + S.CHART], u, v)
        n, noise = features.noisy_normal(seen.ints, seen.reals, seen.own[r + S.CHART], jet)
        return n if noise < UNCLEAR_NORMAL else ZERO
    if dim == 1:
        return across_edge(seen, leaf, u, v)
    number = seen.own[r + S.FEATURE] - seen.ints[L.N_FACES] - seen.ints[L.N_EDGES]
    d = read_vector(normals, 3 * number)
    return d if d[0] == d[0] else ZERO


@kernel
def side_by(seen, normals, leaf, u, v):
    """+1: the origin is outside, by its nearest point; -1: inside; 0: not told by that one.

    A nearest place on a side of a face may be found as one of that face, whose plane may hold the
    point: so only a place decides from which the point is along the normal, or clearly on one side
    of an edge's or a vertex's normals. At an edge's end the point may be off across it.
    """
    d = outwards(seen, normals, leaf, u, v)
    jet, dim = leaf_jet(seen, leaf, u, v), seen.own[leaf_ints(seen, leaf) + S.DIM]
    away, size = scale(-1.0, jet[0]), norm(d) * norm(jet[0])
    if size == 0.0:
        return 0.0
    if dim == 1 and abs(dot(away, jet[1])) > ACROSS_EDGE * norm(away) * norm(jet[1]):
        return 0.0
    along = dot(d, away) / size
    if abs(along) < (ALONG_NORMAL if dim == 2 else BESIDE_EDGE):
        return 0.0
    return 1.0 if along > 0.0 else -1.0


@kernel
def side_found(seen, normals, best, minima):
    """The same by the nearest places that a search has found."""
    told = side_by(seen, normals, int(best[LEAF_B]), best[AT + 2], best[AT + 3])
    for k in range(min(int(best[N_MINIMA]), MOST_PLACES)):
        o = MINIMUM_REALS * k
        if told == 0.0 and minima[o] <= best[LEAST] + best[TOLERANCE]:
            told = side_by(seen, normals, int(minima[o + 2]), minima[o + 5], minima[o + 6])
    return told


@kernel
def depth_beside(known, x, about, probe):
    """(side, how far a point is from the boundary at least, its nearest point), own frame, where
    the boundary is known to be no farther than `about`, length. The side is -1 inside, 1 outside,
    on the boundary, or where nothing is proven, 0 where it is not known.

    It is proven to a share of itself only, which takes a tenth of the time.
    """
    best, minima = probe.lists
    reach = about
    while True:
        tolerance = LOOSE_DEPTH * reach
        below = about + 2.0 * tolerance
        seen = look(known, x, tolerance, below, probe)
        upper = best[LEAST]
        if upper >= below:  # no boundary is as near as was thought
            return 1.0, upper, x
        y = leaf_jet(seen, int(best[LEAF_B]), best[AT + 2], best[AT + 3])[0]
        lower = min(upper - tolerance, best[OPEN])
        if lower > 0.0:
            return side_found(seen, known.normals, best, minima), lower, add(x, y)
        if upper >= reach or upper <= probe.proof * known.size:
            return 1.0, upper, add(x, y)
        reach = upper


@kernel
def may_hold(known, x):
    """Is a point, own frame, in the box at the root of the tree?"""
    m, o = known.side.numbers, known.side.own[S.R_NODES]
    away = sub(x, read_vector(m, o + S.CENTRE))
    for k in range(3):
        if abs(dot(read_vector(m, o + S.AXES + 3 * k), away)) > m[o + S.HALF + k]:
            return False
    return True


@kernel
def holds_point(known, x, probe):
    """1 where a point is proven to be inside, -1 outside; 0: it may be on the boundary; 2: it is
    not, but its side is not known."""
    if not may_hold(known, x):
        return -1
    tolerance = probe.proof * known.size
    seen = look(known, x, tolerance, inf, probe)
    best, minima = probe.lists
    if best[MET] > 0.0 or min(best[LEAST] - tolerance, best[OPEN]) <= 0.0:
        return 0
    side = side_found(seen, known.normals, best, minima)
    return 2 if side == 0.0 else (1 if side < 0.0 else -1)


@kernel
def inside_other(own, other, pose, forth, probe):
    """As `holds_point`, of a solid whose boundary does not meet the other's; the pose is B's in
    A's frame, and `forth` tells that its own frame is B's."""
    unknown = 0
    for k in range(own.n_references):
        x = read_vector(own.references, 3 * k)
        spot = add(rotate(pose.R, x), pose.p) if forth else rotate_back(pose.R, sub(x, pose.p))
        told = holds_point(other, spot, probe)
        if told == 1 or told == -1:
            return told
        unknown = max(unknown, told)
    return unknown


@kernel
def which_is_inside(a, b, pose, probe):
    """1: A is inside B's material, 2: B inside A's, 0: neither, if their boundaries do not meet;
    -1: that is not known."""
    first = inside_other(a, b, pose, False, probe)
    if first == 1:
        return 1
    other = inside_other(b, a, pose, True, probe)
    if other == 1:
        return 2
    return -1 if first == 2 or other == 2 else 0
