"""Cold queries of two ellipsoids, a block of rows at a time.

The normal is found by support functions, the witness points by one step of the pair system from
there; the certificate weighs them as it does any others.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import add, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, moved_jet, outward, pair_span
from standoff.kernels.body.jets import affine_at, chart_parameters, mapped_by, sphere_jet
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, reals_on_stack, small
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.frame.answer import swept_point
from standoff.kernels.lanes.layout import (
    N_POSE,
    N_VECTOR,
    ROWS,
    lane,
    pose_of,
    put_vector,
    twelve_of,
    vector_of,
)
from standoff.kernels.lanes.support import (
    Turn,
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
from standoff.kernels.values import ORIGIN, Place

# A side's lanes: parameters, how deep its chart sees the point; then the chart's affine map is
# 12 lanes of their own.
P, Q, DEPTH, OUTWARD = range(4)
N_SIDE = 4 * ROWS
# Newton's method for the normal: the normal, the step from there, the value, the share,
# the count.
STEP, VALUE, SHARE, COUNT = 3, 6, 7, 8
N_TURN = 9 * ROWS
# An answer's lanes: the numbers of a row before its counts, then how many normals were tried.
TRIED = OUT_COUNTS
N_ANSWER = (OUT_COUNTS + 1) * ROWS


class Side(NamedTuple):
    """The lanes of one body's witness points, as pointers."""

    chart: Any  # numbers
    at: Any  # N_SIDE
    affine: Any  # N_POSE: of the charts


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


@small
def put_turn(turn, turns, row):
    put_vector(turn.normal, turns, 0, row)
    put_vector(turn.step, turns, STEP, row)
    turns[lane(VALUE, row)], turns[lane(SHARE, row)] = turn.value, turn.share
    turns[lane(COUNT, row)] = turn.count


@small
def turn_of(turns, row):
    return Turn(
        vector_of(turns, 0, row),
        turns[lane(VALUE, row)],
        vector_of(turns, STEP, row),
        turns[lane(SHARE, row)],
        turns[lane(COUNT, row)],
    )


@small
def towards(a, b, poses, turns):
    """Begin with the directions from centre to centre."""
    for row in range(ROWS):
        pose = pose_of(poses, row)
        put_turn(begun(sub(add(rotate(pose.R, b.centre), pose.p), a.centre)), turns, row)


@small
def turn(a, b, poses, turns):
    """A step of every row."""
    for row in range(ROWS):
        put_turn(turned(a, b, pose_of(poses, row), turn_of(turns, row)), turns, row)


@small
def all_settled(turns):
    moving = 0
    for row in range(ROWS):
        moving += 0 if is_settled(turn_of(turns, row)) else 1
    return moving == 0


@small
def find_normals(a, b, poses, turns):
    """Turn until the next step is the last, or there were too many."""
    towards(a, b, poses, turns)
    for _ in range(LANE_TURNS):
        turn(a, b, poses, turns)
        if all_settled(turns):
            break


@small
def find_points(a, b, poses, turns, points_a, points_b):
    """The farthest points of both along the normals tried last, each in its body's frame."""
    for row in range(ROWS):
        at = farthest(a, b, pose_of(poses, row), ahead(turn_of(turns, row)))
        put_vector(at.x_a, points_a, 0, row)
        put_vector(add(b.centre, at.b.arm), points_b, 0, row)


@small
def see_from(chart, o, reals, points, side):
    """Take a chart, whose reals begin at o, where it sees a point deeper than those before it."""
    at = side.at
    for row in range(ROWS):
        p, q, depth = chart_parameters(reals, o, vector_of(points, 0, row))
        deeper = depth > at[lane(DEPTH, row)]
        at[lane(P, row)] = p if deeper else at[lane(P, row)]
        at[lane(Q, row)] = q if deeper else at[lane(Q, row)]
        at[lane(DEPTH, row)] = max(depth, at[lane(DEPTH, row)])
        side.chart[row] = chart if deeper else side.chart[row]


@small
def choose_charts(ints, reals, points, side):
    """Of every row the chart that sees its point the best, its map and the parameters in it."""
    for row in range(ROWS):
        side.chart[row] = 0
        side.at[lane(DEPTH, row)] = 0.0
    for c in range(ints[L.N_CHARTS]):
        see_from(c, ints[chart_record(ints, c) + L.CHART_REALS], reals, points, side)
    for row in range(ROWS):
        o = ints[chart_record(ints, side.chart[row]) + L.CHART_REALS]
        side.at[lane(OUTWARD, row)] = reals[o + L.OUTWARD]
        for k in range(12):
            side.affine[lane(k, row)] = reals[o + L.AFFINE + k]


@small
def seen(side, row):
    """(jet, normal) of a row's witness point, in its body's frame."""
    jet = sphere_jet(side.at[lane(P, row)], side.at[lane(Q, row)])
    jet = mapped_by(twelve_of(side.affine, row), jet)
    return jet, outward(side.at[lane(OUTWARD, row)], jet)


@small
def correct(poses, a, b, steps):
    """Newton's step of the pair system, of every row."""
    for row in range(ROWS):
        jet_a, jet_b = seen(a, row)[0], moved_jet(pose_of(poses, row), seen(b, row)[0])
        g = gradient(projection_errors(jet_a, jet_b))
        step = ldl_solve(ldl(hessian(jet_a, jet_b)), g)
        for k in range(4):
            steps[lane(k, row)] = step[k]


@small
def take(steps, a, b):
    for row in range(ROWS):
        a.at[lane(P, row)] -= steps[lane(0, row)]
        a.at[lane(Q, row)] -= steps[lane(1, row)]
        b.at[lane(P, row)] -= steps[lane(2, row)]
        b.at[lane(Q, row)] -= steps[lane(3, row)]


@small
def weigh(pair, tolerance, poses, poses_a, a, b, answers, good):
    """The numbers of every row's answer, by `standoff.kernels.state.arrays`; good[row] is 1 where
    it is converged and proven."""
    radius_a, radius_b = pair.reals_a[L.RADIUS], pair.reals_b[L.RADIUS]
    near = POLISHED * contact_scale(pair)
    for row in range(ROWS):
        pose, world = pose_of(poses, row), pose_of(poses_a, row)
        (jet_a, n_a), (own_b, n_b) = seen(a, row), seen(b, row)
        jet_b = moved_jet(pose, own_b)
        cones = Cones(
            NormalCone(SINGLE, n_a, n_a, ORIGIN, 0.0),
            NormalCone(SINGLE, n_b, n_b, ORIGIN, 0.0),
            jet_a[0],
            own_b[0],
            sub(jet_b[0], jet_a[0]),
        )
        p, q, r, s = a.at[lane(P, row)], a.at[lane(Q, row)], b.at[lane(P, row)], b.at[lane(Q, row)]
        place = Place(0, a.chart[row], 0, b.chart[row], p, q, r, s)
        d, lower, n, blur = certify_cones(pair, pose, place, cones, ORIGIN)
        slope = metric_norm(pair_metric(jet_a, jet_b), gradient(projection_errors(jet_a, jet_b)))
        at_rest = slope <= AT_REST * EPS * pair_span(pair, pose.p, d)
        proven = outcome_of(pair, pose, d, lower, blur, tolerance) == CERTIFIED
        apart = lower > radius_a + radius_b and d > near
        good[row] = 1 if at_rest and proven and apart else 0
        answers[lane(DISTANCE, row)] = d - radius_a - radius_b
        answers[lane(LOWER_BOUND, row)] = lower - radius_a - radius_b
        answers[lane(UPPER_BOUND, row)] = d - radius_a - radius_b
        x_a = swept_point(world.R, world.p, jet_a[0], radius_a, n)
        x_b = swept_point(world.R, world.p, jet_b[0], -radius_b, n)
        put_vector(x_a, answers, POINT_A, row)
        put_vector(x_b, answers, POINT_B, row)
        put_vector(rotate(world.R, n), answers, NORMAL, row)
        answers[lane(OUT_MODE, row)], answers[lane(OUT_MODE + 2, row)] = 0.0, 0.0
        answers[lane(OUT_MODE + 1, row)] = float(a.chart[row])
        answers[lane(OUT_MODE + 3, row)] = float(b.chart[row])
        answers[lane(OUT_Q, row)], answers[lane(OUT_Q + 1, row)] = p, q
        answers[lane(OUT_Q + 2, row)], answers[lane(OUT_Q + 3, row)] = r, s
        answers[lane(RESIDUAL, row)] = slope


@kernel
def query_block(pair, tolerance, poses, poses_a, answers, good):
    """Cold queries of a block of ellipsoids.

    poses, poses_a: lanes of B's poses in A's frame, and of A's in world.
    """
    ia, ra, ib, rb = pair
    of_a, of_b = ellipsoid_of(map_of(ia, ra, 0)), ellipsoid_of(map_of(ib, rb, 0))
    turns = reals_on_stack(N_TURN)
    find_normals(of_a, of_b, poses, turns)
    points_a, points_b = reals_on_stack(N_VECTOR), reals_on_stack(N_VECTOR)
    find_points(of_a, of_b, poses, turns, points_a, points_b)
    a = Side(ints_on_stack(ROWS), reals_on_stack(N_SIDE), reals_on_stack(N_POSE))
    b = Side(ints_on_stack(ROWS), reals_on_stack(N_SIDE), reals_on_stack(N_POSE))
    choose_charts(ia, ra, points_a, a)
    choose_charts(ib, rb, points_b, b)
    steps = reals_on_stack(N_SIDE)
    correct(poses, a, b, steps)
    take(steps, a, b)
    weigh(pair, tolerance, poses, poses_a, a, b, answers, good)
    for row in range(ROWS):
        answers[lane(TRIED, row)] = turns[lane(COUNT, row)]
