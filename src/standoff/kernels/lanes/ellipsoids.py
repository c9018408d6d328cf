"""Cold queries of two ellipsoids, a block of rows at a time: `rows`, for all of a block, each row
with bodies of its own."""

from standoff.kernels.algebra.vectors import add, rotate, sub
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record
from standoff.kernels.body.jets import gnomonic
from standoff.kernels.compiler.decorators import kernel, small
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.lanes.cold_layout import (
    COUNT,
    MAP,
    OUTWARD,
    SEEN,
    P,
    Q,
    body_of,
    pair_of,
    put_body,
    put_turn,
    turn_of,
)
from standoff.kernels.lanes.layout import ROWS, lane, pose_of, put_vector, twelve_at, vector_of
from standoff.kernels.lanes.rows import (
    NONE_SEES,
    TRIED,
    Best,
    Witness,
    correction,
    deeper_of,
    deepest,
    map_of,
    put_answer,
    seen_by,
    weighed,
)
from standoff.kernels.lanes.support import ahead, begun, ellipsoid_of, farthest, is_settled, turned
from standoff.kernels.tolerances import LANE_TURNS, POLISHED


@small
def put_bodies(pair_at, given, which, alike, block):
    """Put what a query reads of the bodies into lanes."""
    if alike:
        pair = pair_at(given, which[0])
        a = ellipsoid_of(map_of(pair.ints_a, pair.reals_a, 0))
        b = ellipsoid_of(map_of(pair.ints_b, pair.reals_b, 0))
        for row in range(ROWS):
            put_body(a, pair.reals_a, block.a, row)
            put_body(b, pair.reals_b, block.b, row)
        return
    for row in range(ROWS):
        pair = pair_at(given, which[row])
        a = ellipsoid_of(map_of(pair.ints_a, pair.reals_a, 0))
        b = ellipsoid_of(map_of(pair.ints_b, pair.reals_b, 0))
        put_body(a, pair.reals_a, block.a, row)
        put_body(b, pair.reals_b, block.b, row)


@small
def towards(block):
    """Begin with the directions from centre to centre."""
    for row in range(ROWS):
        pose, a, b = pose_of(block.poses, row), body_of(block.a, row), body_of(block.b, row)
        way = sub(add(rotate(pose.R, b.centre), pose.p), a.centre)
        put_turn(begun(way), block.turns, row)


@small
def turn(block):
    """A step of every row."""
    for row in range(ROWS):
        pose, a, b = pose_of(block.poses, row), body_of(block.a, row), body_of(block.b, row)
        put_turn(turned(a, b, pose, turn_of(block.turns, row)), block.turns, row)


@small
def all_settled(turns):
    moving = 0
    for row in range(ROWS):
        moving += 0 if is_settled(turn_of(turns, row)) else 1
    return moving == 0


@small
def find_normals(block):
    """Turn until the next step is the last, or there were too many."""
    towards(block)
    for _ in range(LANE_TURNS):
        turn(block)
        if all_settled(block.turns):
            break


@small
def find_points(block):
    """The farthest points of both along the normals tried last, each in its body's frame."""
    for row in range(ROWS):
        pose, a, b = pose_of(block.poses, row), body_of(block.a, row), body_of(block.b, row)
        at = farthest(a, b, pose, ahead(turn_of(block.turns, row)))
        put_vector(at.x_a, block.a.points, 0, row)
        put_vector(add(b.centre, at.b.arm), block.b.points, 0, row)


@small
def best_of(side, row):
    return Best(side.chart[row], vector_of(side.at, SEEN, row))


@small
def put_best(best, side, row):
    side.chart[row] = best.chart
    put_vector(best.y, side.at, SEEN, row)


@small
def choose_charts(ints, reals, side):
    """`deepest` of all rows, which are of one body."""
    for row in range(ROWS):
        put_best(NONE_SEES, side, row)
    for c in range(ints[L.N_CHARTS]):
        o = ints[chart_record(ints, c) + L.CHART_REALS]
        for row in range(ROWS):
            y = seen_by(reals, o, vector_of(side.points, 0, row))
            put_best(deeper_of(best_of(side, row), c, y), side, row)


@small
def put_chart(ints, reals, side, row):
    """Put the map of a row's chart into lanes."""
    o = ints[chart_record(ints, side.chart[row]) + L.CHART_REALS]
    for k in range(12):
        side.at[lane(MAP + k, row)] = reals[o + L.AFFINE + k]
    side.at[lane(OUTWARD, row)] = reals[o + L.OUTWARD]


@small
def find_charts(pair_at, given, which, alike, block):
    """The charts that see the points the deepest."""
    if alike:
        pair = pair_at(given, which[0])
        choose_charts(pair.ints_a, pair.reals_a, block.a)
        choose_charts(pair.ints_b, pair.reals_b, block.b)
        for row in range(ROWS):
            put_chart(pair.ints_a, pair.reals_a, block.a, row)
            put_chart(pair.ints_b, pair.reals_b, block.b, row)
        return
    for row in range(ROWS):
        pair = pair_at(given, which[row])
        x_a, x_b = vector_of(block.a.points, 0, row), vector_of(block.b.points, 0, row)
        put_best(deepest(pair.ints_a, pair.reals_a, x_a), block.a, row)
        put_best(deepest(pair.ints_b, pair.reals_b, x_b), block.b, row)
        put_chart(pair.ints_a, pair.reals_a, block.a, row)
        put_chart(pair.ints_b, pair.reals_b, block.b, row)


@small
def find_parameters(side):
    """The parameters of every row's point in its chart."""
    for row in range(ROWS):
        p, q, _ = gnomonic(vector_of(side.at, SEEN, row))
        side.at[lane(P, row)], side.at[lane(Q, row)] = p, q


@small
def witness_of(side, row):
    """A row's witness point."""
    at = side.at
    return Witness(
        side.chart[row],
        at[lane(P, row)],
        at[lane(Q, row)],
        at[lane(OUTWARD, row)],
        twelve_at(at, MAP, row),
    )


@small
def correct(block):
    """Newton's step of the pair system, of every row."""
    for row in range(ROWS):
        a, b = witness_of(block.a, row), witness_of(block.b, row)
        step = correction(pose_of(block.poses, row), a, b)
        for k in range(4):
            block.steps[lane(k, row)] = step[k]


@small
def take(steps, a, b):
    for row in range(ROWS):
        a[lane(P, row)] -= steps[lane(0, row)]
        a[lane(Q, row)] -= steps[lane(1, row)]
        b[lane(P, row)] -= steps[lane(2, row)]
        b[lane(Q, row)] -= steps[lane(3, row)]


@small
def weigh(block):
    """The numbers of every row's answer, by `standoff.kernels.state.arrays`; good[row] is 1 where
    it is converged and proven."""
    for row in range(ROWS):
        pair, pose, goal = pair_of(block, row), pose_of(block.poses, row), block.goals[row]
        of_a, of_b = witness_of(block.a, row), witness_of(block.b, row)
        found = weighed(pair, goal, POLISHED * contact_scale(pair), pose, of_a, of_b)
        block.good[row] = 1 if found.good else 0
        world = pose_of(block.poses_a, row)
        put_answer(block.answers, ROWS, row, pair, world, (of_a, of_b), found)


@kernel
def query_block(pair_at, given, which, alike, block):
    """Cold queries of a block of ellipsoids, whose poses and goals are in lanes.

    pair_at(given, which[row]) are the bodies of a row; `alike` says that they are the same in all.
    """
    put_bodies(pair_at, given, which, alike, block)
    find_normals(block)
    find_points(block)
    find_charts(pair_at, given, which, alike, block)
    find_parameters(block.a)
    find_parameters(block.b)
    correct(block)
    take(block.steps, block.a.at, block.b.at)
    weigh(block)
    for row in range(ROWS):
        block.answers[lane(TRIED, row)] = block.turns[lane(COUNT, row)]
