"""Cold queries of two ellipsoids, a block of rows at a time: `rows`, for all of a block."""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import add, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, reals_on_stack, small
from standoff.kernels.depth.penetration import contact_scale
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
from standoff.kernels.lanes.rows import (
    TRIED,
    Best,
    Witness,
    better_of,
    correction,
    map_of,
    put_answer,
    weighed,
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
from standoff.kernels.tolerances import LANE_TURNS, POLISHED

# A side's lanes: parameters, how deep its chart sees the point; then the chart's affine map is
# 12 lanes of their own.
P, Q, DEPTH, OUTWARD = range(4)
N_SIDE = 4 * ROWS
# Newton's method for the normal: the normal, the step from there, the value, the share,
# the count.
STEP, VALUE, SHARE, COUNT = 3, 6, 7, 8
N_TURN = 9 * ROWS
N_ANSWER = (TRIED + 1) * ROWS  # an answer's lanes


class Side(NamedTuple):
    """The lanes of one body's witness points, as pointers."""

    chart: Any  # numbers
    at: Any  # N_SIDE
    affine: Any  # N_POSE: of the charts


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
        last = Best(side.chart[row], at[lane(P, row)], at[lane(Q, row)], at[lane(DEPTH, row)])
        best = better_of(last, chart, o, reals, vector_of(points, 0, row))
        at[lane(P, row)], at[lane(Q, row)] = best.p, best.q
        at[lane(DEPTH, row)] = best.depth
        side.chart[row] = best.chart


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
def witness_of(side, row):
    """A row's witness point."""
    at = side.at
    return Witness(
        side.chart[row],
        at[lane(P, row)],
        at[lane(Q, row)],
        at[lane(OUTWARD, row)],
        twelve_of(side.affine, row),
    )


@small
def correct(poses, a, b, steps):
    """Newton's step of the pair system, of every row."""
    for row in range(ROWS):
        step = correction(pose_of(poses, row), witness_of(a, row), witness_of(b, row))
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
    near = POLISHED * contact_scale(pair)
    for row in range(ROWS):
        of_a, of_b = witness_of(a, row), witness_of(b, row)
        found = weighed(pair, tolerance, near, pose_of(poses, row), of_a, of_b)
        good[row] = 1 if found.good else 0
        put_answer(answers, ROWS, row, pair, pose_of(poses_a, row), (of_a, of_b), found)


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
