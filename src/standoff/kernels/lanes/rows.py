"""A cold query of two ellipsoids, row by row: what the lanes do to each of a block's rows, and a
thread of a GPU to its own.

The normal is found by support functions, the witness points by one step of the pair system from
there; the certificate weighs them as it does any others.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import add, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, moved_jet, outward, pair_span
from standoff.kernels.body.jets import affine_at, gnomonic, mapped_by, sphere_jet
from standoff.kernels.compiler.decorators import kernel, small, small_uncontracted
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.frame.answer import swept_point
from standoff.kernels.lanes.layout import put_strided, strided
from standoff.kernels.lanes.support import (
    ahead,
    begun,
    ellipsoid_of,
    farthest,
    is_settled,
    turned,
)
from standoff.kernels.pair.certificate import SINGLE, Cones, NormalCone, certify_cones
from standoff.kernels.pair.certified import CERTIFIED, outcome_of
from standoff.kernels.pair.newton import ldl, ldl_solve, metric_norm, pair_metric
from standoff.kernels.pair.system import gradient, hessian, projection_errors
from standoff.kernels.state.arrays import (
    DISTANCE,
    LOWER_BOUND,
    NORMAL,
    OUT_COUNTS,
    OUT_MODE,
    OUT_Q,
    POINT_A,
    POINT_B,
    RESIDUAL,
    UPPER_BOUND,
)
from standoff.kernels.tolerances import AT_REST, EPS, LANE_TURNS, POLISHED
from standoff.kernels.values import ORIGIN, Place, Vector

# An answer's numbers: those of a row before its counts, then how many normals were tried.
TRIED = OUT_COUNTS


class Best(NamedTuple):
    """The chart that sees a point the deepest."""

    chart: int
    y: Vector  # the point in the chart's axes


class Witness(NamedTuple):
    """A point of a body, in a chart of its."""

    chart: int
    p: float
    q: float
    outward: float  # 1 or -1
    affine: Any  # the chart's map, 12 numbers


class Weighed(NamedTuple):
    """What the certificate says of two witness points, of the cores."""

    distance: float
    lower: float
    normal: Vector
    slope: float
    x_a: Vector  # in A's frame
    x_b: Vector
    good: bool  # converged, proven and apart


NONE_SEES = Best(0, ORIGIN)


@small
def whole_ellipsoid(ints):
    """Is a body's boundary one face of charts of an ellipsoid, without any edge?"""
    if ints[L.DIMENSION] != 3 or ints[L.N_FACES] != 1 or ints[L.N_EDGES] + ints[L.N_VERTICES] > 0:
        return False
    for c in range(ints[L.N_CHARTS]):
        if ints[chart_record(ints, c) + L.CHART_KIND] != L.SPHERE:
            return False
    return True


@small
def map_of(ints, reals, chart):
    return affine_at(reals, ints[chart_record(ints, chart) + L.CHART_REALS] + L.AFFINE)


@small_uncontracted
def seen_by(reals, o, x):
    """A point in the axes of the chart whose reals begin at o: the third number is how deep the
    chart sees it.

    Blocks of one pair ask this in vectors, others row by row: they find the same numbers.
    """
    m = o + L.AFFINE
    arm = (x[0] - reals[m + 9], x[1] - reals[m + 10], x[2] - reals[m + 11])
    k = o + L.INVERSE
    return (
        reals[k] * arm[0] + reals[k + 1] * arm[1] + reals[k + 2] * arm[2],
        reals[k + 3] * arm[0] + reals[k + 4] * arm[1] + reals[k + 5] * arm[2],
        reals[k + 6] * arm[0] + reals[k + 7] * arm[1] + reals[k + 8] * arm[2],
    )


@small
def deeper_of(best, chart, y):
    """A chart that sees a point as y, where it sees it deeper than the best before it."""
    deeper = y[2] > best.y[2]
    way = (y[0] if deeper else best.y[0], y[1] if deeper else best.y[1], max(y[2], best.y[2]))
    return Best(chart if deeper else best.chart, way)


@small
def deepest(ints, reals, x):
    """The chart that sees a point of the body the deepest."""
    best = NONE_SEES
    for c in range(ints[L.N_CHARTS]):
        y = seen_by(reals, ints[chart_record(ints, c) + L.CHART_REALS], x)
        best = deeper_of(best, c, y)
    return best


@small
def seen(witness):
    """(jet, normal) of a witness point, in its body's frame."""
    jet = mapped_by(witness.affine, sphere_jet(witness.p, witness.q))
    return jet, outward(witness.outward, jet)


@small
def correction(pose, a, b):
    """Newton's step of the pair system, to be taken off the parameters."""
    jet_a, jet_b = seen(a)[0], moved_jet(pose, seen(b)[0])
    g = gradient(projection_errors(jet_a, jet_b))
    return ldl_solve(ldl(hessian(jet_a, jet_b)), g)


@small
def cones_between(jet_a, n_a, jet_b, own_b, n_b):
    """What the certificate asks of two points inside faces; B's normal and own jet in its frame."""
    return Cones(
        NormalCone(SINGLE, n_a, n_a, ORIGIN, 0.0),
        NormalCone(SINGLE, n_b, n_b, ORIGIN, 0.0),
        jet_a[0],
        own_b[0],
        sub(jet_b[0], jet_a[0]),
    )


@small
def weighed(pair, tolerance, near, pose, a, b):
    """The certificate at two witness points; `near` is a distance that counts as contact."""
    radius_a, radius_b = pair.reals_a[L.RADIUS], pair.reals_b[L.RADIUS]
    (jet_a, n_a), (own_b, n_b) = seen(a), seen(b)
    jet_b = moved_jet(pose, own_b)
    cones = cones_between(jet_a, n_a, jet_b, own_b, n_b)
    place = Place(0, a.chart, 0, b.chart, a.p, a.q, b.p, b.q)
    d, lower, n, blur = certify_cones(pair, pose, place, cones, ORIGIN)
    slope = metric_norm(pair_metric(jet_a, jet_b), gradient(projection_errors(jet_a, jet_b)))
    at_rest = slope <= AT_REST * EPS * pair_span(pair, pose.p, d)
    proven = outcome_of(pair, pose, d, lower, blur, tolerance) == CERTIFIED
    apart = lower > radius_a + radius_b and d > near
    return Weighed(d, lower, n, slope, jet_a[0], jet_b[0], at_rest and proven and apart)


@small
def put_answer(answers, width, row, pair, world, witnesses, found):
    """Write a row's numbers before its counts, by `standoff.kernels.state.arrays`: of `width` rows
    that stand side by side. `world` is A's pose."""
    a, b = witnesses
    radius_a, radius_b = pair.reals_a[L.RADIUS], pair.reals_b[L.RADIUS]
    d, lower, n = found.distance, found.lower, found.normal
    answers[strided(DISTANCE, width, row)] = d - radius_a - radius_b
    answers[strided(LOWER_BOUND, width, row)] = lower - radius_a - radius_b
    answers[strided(UPPER_BOUND, width, row)] = d - radius_a - radius_b
    x_a = swept_point(world.R, world.p, found.x_a, radius_a, n)
    x_b = swept_point(world.R, world.p, found.x_b, -radius_b, n)
    put_strided(x_a, answers, POINT_A, width, row)
    put_strided(x_b, answers, POINT_B, width, row)
    put_strided(rotate(world.R, n), answers, NORMAL, width, row)
    answers[strided(OUT_MODE, width, row)] = 0.0
    answers[strided(OUT_MODE + 2, width, row)] = 0.0
    answers[strided(OUT_MODE + 1, width, row)] = float(a.chart)
    answers[strided(OUT_MODE + 3, width, row)] = float(b.chart)
    answers[strided(OUT_Q, width, row)], answers[strided(OUT_Q + 1, width, row)] = a.p, a.q
    answers[strided(OUT_Q + 2, width, row)], answers[strided(OUT_Q + 3, width, row)] = b.p, b.q
    answers[strided(RESIDUAL, width, row)] = found.slope


# What follows puts these together for one row; `ellipsoids` does so for a block of rows.


@small
def normal_between(a, b, pose):
    """Newton's method for the normal, to where the next step is the last, or too many were made."""
    turn = begun(sub(add(rotate(pose.R, b.centre), pose.p), a.centre))
    for _ in range(LANE_TURNS):
        turn = turned(a, b, pose, turn)
        if is_settled(turn):
            break
    return turn


@small
def witness_at(ints, reals, x):
    """A point in the chart that sees it the best."""
    best = deepest(ints, reals, x)
    o = ints[chart_record(ints, best.chart) + L.CHART_REALS]
    p, q, _ = gnomonic(best.y)
    return Witness(best.chart, p, q, reals[o + L.OUTWARD], affine_at(reals, o + L.AFFINE))


@small
def less(witness, dp, dq):
    """A witness point with a step taken off its parameters."""
    p, q = witness.p - dp, witness.q - dq
    return Witness(witness.chart, p, q, witness.outward, witness.affine)


@kernel
def query_row(pair, tolerance, pose, world, out):
    """Answer a row by itself into out; True where it is converged, proven and apart.

    pose, world: B's pose in A's frame, and A's in world.
    """
    ia, ra, ib, rb = pair
    of_a, of_b = ellipsoid_of(map_of(ia, ra, 0)), ellipsoid_of(map_of(ib, rb, 0))
    turn = normal_between(of_a, of_b, pose)
    at = farthest(of_a, of_b, pose, ahead(turn))
    a = witness_at(ia, ra, at.x_a)
    b = witness_at(ib, rb, add(of_b.centre, at.b.arm))
    step = correction(pose, a, b)
    a, b = less(a, step[0], step[1]), less(b, step[2], step[3])
    found = weighed(pair, tolerance, POLISHED * contact_scale(pair), pose, a, b)
    put_answer(out, 1, 0, pair, world, (a, b), found)
    out[TRIED] = turn.count
    return found.good
