"""Smooth frames of many pairs, a block of rows at a time: those of `frame.smooth` between patches
of ellipsoids, each row with bodies of its own.

A row that leaves its chart, that is not proven, or that would be refused is left as it was, to be
answered by itself: inside the lanes nothing exits, a phase says what has come of each row.
"""

from math import inf

from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record, has_collapsed, moved_jet
from standoff.kernels.compiler.decorators import ints_on_stack, kernel, small
from standoff.kernels.frame.answer import judge
from standoff.kernels.frame.inputs import moving, refused
from standoff.kernels.frame.prediction import predict
from standoff.kernels.frame.record import called_in_block
from standoff.kernels.frame.smooth import (
    FACES,
    Looked,
    finish,
    inside_features,
    may_be_smooth,
    proven_apart,
)
from standoff.kernels.frame.smooth_steps import (
    Fall,
    at_rest,
    is_enough,
    newton_at,
    rates_at,
    slope_at,
)
from standoff.kernels.lanes.frame_layout import (
    HEADER,
    INNER,
    JETS,
    LOWER,
    MAP,
    NORMAL,
    OUTWARD,
    PHASE,
    D,
    Descent,
    block_on_stack,
    clear_row,
    descent_of,
    four_of,
    motion_of,
    pair_of,
    put_descent,
    put_jets,
    put_motion,
    tangents_of,
)
from standoff.kernels.lanes.layout import ROWS, lane, put_header, put_vector, twelve_of, vector_of
from standoff.kernels.lanes.rows import Witness, cones_between, seen
from standoff.kernels.pair.certified import CERTIFIED
from standoff.kernels.state.arrays import (
    BLOCK_TIME_STEP,
    FINE,
)
from standoff.kernels.state.state import read_state
from standoff.kernels.state.tracked import Shown
from standoff.kernels.tolerances import SMOOTH_CORRECTIONS
from standoff.kernels.values import NO_RATES, ORIGIN, Found, Place, moved

LEFT, GOING, RESTS = 0.0, 1.0, 2.0
"""What a row has come to: it is left to be answered by itself, descends, or is at rest. A row that
is none is LEFT."""

ANYWHERE = Place(0, 0, 0, 0, 0.0, 0.0, 0.0, 0.0)


@small
def may_lane(pair, place):
    """Are both points on patches of ellipsoids?"""
    a = pair.ints_a[chart_record(pair.ints_a, place.chart_a) + L.CHART_KIND]
    b = pair.ints_b[chart_record(pair.ints_b, place.chart_b) + L.CHART_KIND]
    return a == L.SPHERE and b == L.SPHERE


@small
def put_side(ints, reals, chart, side, row):
    """Put what a frame reads of a body into lanes."""
    o = ints[chart_record(ints, chart) + L.CHART_REALS]
    for k in range(12):
        side[lane(MAP + k, row)] = reals[o + L.AFFINE + k]
    side[lane(OUTWARD, row)] = reals[o + L.OUTWARD]
    for k in range(4):
        side[lane(INNER + k, row)] = reals[o + L.INNER + k]
    put_header(reals, side, HEADER, row)


@kernel
def put_row(pair, options, block, lanes, row):
    """Begin a row's frame in lanes; False where the frame of smooth faces cannot be tried."""
    call = called_in_block(pair, options, block)
    before = read_state(call.state)
    tried = options.smooth != 0 and options.within == inf and not options.paper
    if not (tried and may_be_smooth(FACES, pair, before) and may_lane(pair, before.place)):
        return False
    if refused(pair, call.inputs) != FINE:
        return False
    h = block[BLOCK_TIME_STEP]
    place = moved(before.place, 1.0, predict(before, options.predictor, h))
    if not inside_features(FACES, pair, place):
        return False
    put_side(pair.ints_a, pair.reals_a, place.chart_a, lanes.a, row)
    put_side(pair.ints_b, pair.reals_b, place.chart_b, lanes.b, row)
    put_motion(moving(call.inputs, before, h), lanes, row)
    at = (place.u, place.v, place.r, place.s)
    most = min(options.deadline, SMOOTH_CORRECTIONS)
    begun = Descent(at, GOING, 0.0, inf, 0.0, NO_RATES, options.tolerance, float(most))
    put_descent(begun, lanes, row)
    return True


@small
def witness_of(side, p, q, row):
    return Witness(0, p, q, side[lane(OUTWARD, row)], twelve_of(side, row))


@small
def is_inside(side, p, q, row):
    """`well_inside` of a row's chart."""
    u0, u1, v0, v1 = four_of(side, INNER, row)
    return (u0 <= p) & (p <= u1) & (v0 <= q) & (q <= v1)


@small
def looked_at(lanes, place, row):
    """(both features at a row's place, as `smooth.look` sees them; B's jet in its own frame)."""
    pose = motion_of(lanes, row).pose
    jet_a, n_a = seen(witness_of(lanes.a, place[0], place[1], row))
    own_b, n_b = seen(witness_of(lanes.b, place[2], place[3], row))
    jet_b = moved_jet(pose, own_b)
    cones = cones_between(jet_a, n_a, jet_b, own_b, n_b)
    return Looked(True, (jet_a, jet_b), cones, ((ORIGIN, ORIGIN), (ORIGIN, ORIGIN))), own_b


@small
def fits(pair, jet_a, own_b, lanes, place, row):
    """Are the points well inside their faces, and the tangents long enough?"""
    ra, rb = pair.reals_a, pair.reals_b
    short_a = has_collapsed(ra, jet_a[1]) | has_collapsed(ra, jet_a[2])
    short_b = has_collapsed(rb, own_b[1]) | has_collapsed(rb, own_b[2])
    a, b = is_inside(lanes.a, place[0], place[1], row), is_inside(lanes.b, place[2], place[3], row)
    return a & b & (not short_a) & (not short_b)


@small
def chosen(first, x, y):
    """Four numbers, or four others."""
    return (
        x[0] if first else y[0],
        x[1] if first else y[1],
        x[2] if first else y[2],
        x[3] if first else y[3],
    )


@small
def followed(lanes, row):
    """A round of `smooth.descended`: the points as they are, and the next correction."""
    last, pair, motion = descent_of(lanes, row), pair_of(lanes, row), motion_of(lanes, row)
    place = last.place
    looked, own_b = looked_at(lanes, place, row)
    at = slope_at(pair, motion.pose, looked)
    low = is_enough(Fall(NO_RATES, last.energy, last.fall), 1.0, looked)
    on = (last.phase == GOING) & fits(pair, looked.jets[0], own_b, lanes, place, row) & low
    rests = on & (last.corrections > 0.0) & at_rest(at, last.tolerance)
    newton = newton_at(looked, at)
    onward = on & (not rests) & newton.safe & (last.corrections < last.most)
    fall, step, phase = newton.fall, newton.fall.step, GOING if onward else LEFT
    there = (place[0] + step[0], place[1] + step[1], place[2] + step[2], place[3] + step[3])
    return Descent(
        chosen(onward, there, place),
        RESTS if rests | (last.phase == RESTS) else phase,
        last.corrections + 1.0 if onward else last.corrections,
        fall.energy if onward else last.energy,
        fall.descent if onward else last.fall,
        chosen(onward, rates_at(motion, looked.jets, newton), last.rates),
        last.tolerance,
        last.most,
    )


@small
def follow(lanes):
    for row in range(ROWS):
        put_descent(followed(lanes, row), lanes, row)


@small
def any_going(lanes):
    going = 0
    for row in range(ROWS):
        going += 1 if lanes.descent[lane(PHASE, row)] == GOING else 0
    return going > 0


@small
def weigh(lanes):
    """The certificate of every row: those that are not proven are left."""
    for row in range(ROWS):
        last, pair, pose = descent_of(lanes, row), pair_of(lanes, row), motion_of(lanes, row).pose
        looked, _ = looked_at(lanes, last.place, row)
        good, found = proven_apart(FACES, pair, pose, ANYWHERE, looked, last.tolerance)
        at = lanes.found
        at[lane(D, row)], at[lane(LOWER, row)] = found.distance, found.lower
        put_vector(found.normal, at, NORMAL, row)
        put_jets(looked.jets[0], looked.jets[1], lanes, row)
        lanes.descent[lane(PHASE, row)] = last.phase if good else LEFT


@kernel
def write_row(pair, options, block, lanes, row):
    """Write the answer and the next state of a row that rests and is proven."""
    call, descent, at = called_in_block(pair, options, block), descent_of(lanes, row), lanes.found
    before = read_state(call.state)
    u, v, r, s = descent.place
    old = before.place
    place = Place(old.feature_a, old.chart_a, old.feature_b, old.chart_b, u, v, r, s)
    d, lower = at[lane(D, row)], at[lane(LOWER, row)]
    found = Found(CERTIFIED, place, d, lower, d, vector_of(at, NORMAL, row))
    jets = tangents_of(lanes, JETS, row), tangents_of(lanes, JETS + 9, row)
    shown = Shown(found, jets, False, True, descent.rates)
    h, motion = block[BLOCK_TIME_STEP], motion_of(lanes, row)
    status = judge(pair, motion.pose.p, found, False, descent.tolerance, False)
    finish(call, h, before, motion, shown, status, int(descent.corrections))


@kernel
def finish_block(frame_at, ended, given, lanes, which, n):
    """Answer the first n rows of a block, and leave it empty."""
    if n == 0:
        return
    for row in range(n, ROWS):
        clear_row(lanes, row)
    for _ in range(SMOOTH_CORRECTIONS + 1):
        follow(lanes)
        if not any_going(lanes):
            break
    weigh(lanes)
    for row in range(n):
        good = lanes.descent[lane(PHASE, row)] == RESTS
        if good:
            pair, options, block = frame_at(given, which[row])
            write_row(pair, options, block, lanes, row)
        ended(given, which[row], good)


@kernel
def frames_in_lanes(begun, frame_at, ended, given, first, end):
    """Frames of rows `first` to `end` - 1, those that can be in lanes, all others by themselves.

    begun(given, k) makes the block of row k ready, and says whether the smooth frame is to be
    tried; frame_at(given, k) is (pair, options, block). ended(given, k, good) is called once for
    each row: where `good` its answer and next state are written, else it is to be answered. A row's
    numbers do not depend on which others there are, however few.
    """
    lanes, which, n = block_on_stack(), ints_on_stack(ROWS), 0
    for k in range(first, end):
        held = False
        if begun(given, k):
            pair, options, block = frame_at(given, k)
            held = put_row(pair, options, block, lanes, n)
        if held:
            which[n] = k
            n += 1
        else:
            ended(given, k, False)
        if n == ROWS:
            finish_block(frame_at, ended, given, lanes, which, n)
            n = 0
    finish_block(frame_at, ended, given, lanes, which, n)
