"""A frame whose witness points stay well inside faces of kinds that are known when it is compiled,
or one of them on a straight edge between planes.

It is the general frame of the predictor-corrector without anything that such a frame never meets:
no boundary, no other chart, no switch, no flat direction, no contact. It calls the same functions
in the same order, with fewer cases. It is tried first and writes nothing unless it answers.
"""

from typing import Any, NamedTuple

from standoff.kernels.algebra.vectors import dot, rotate_back, scale, sub, unit
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import (
    chart_record,
    coedge_record,
    dimension,
    edge_record,
    has_collapsed,
    moved_jet,
    normal_of_kind,
    plane_conormal,
)
from standoff.kernels.body.jets import curve_jet, mapped_jet, sphere_jet, surface_jet
from standoff.kernels.body.nurbs import net_at, net_jet_of, unrolled_basis
from standoff.kernels.body.trimming import well_inside
from standoff.kernels.compiler.decorators import small
from standoff.kernels.depth.penetration import contact_scale
from standoff.kernels.frame.answer import judge, write_answer
from standoff.kernels.frame.inputs import moving
from standoff.kernels.frame.prediction import feeds, kept_state, predict
from standoff.kernels.frame.smooth_steps import (
    NO_FALL,
    at_rest,
    is_enough,
    newton_at,
    rates_at,
    slope_at,
)
from standoff.kernels.pair.certificate import ARC, SINGLE, Cones, NormalCone, certify_cones
from standoff.kernels.pair.certified import CERTIFIED, outcome_of
from standoff.kernels.pair.events import CORRECTIONS, EVALUATIONS, N_COUNTS
from standoff.kernels.state.arrays import OUT_COUNTS
from standoff.kernels.state.state import read_state, write_state
from standoff.kernels.state.tracked import Shown, Tracked
from standoff.kernels.tolerances import (
    EPS,
    POLISHED,
    SHIFTED_GAP,
    SLOPE,
    SLOPE_NOISE,
    SMOOTH_CORRECTIONS,
)
from standoff.kernels.values import (
    NO_RATES,
    ORIGIN,
    Found,
    Vector,
    moved,
    side_of,
)

NO_JET = (ORIGIN, ORIGIN, ORIGIN, ORIGIN, ORIGIN, ORIGIN)
NO_CONE = NormalCone(SINGLE, ORIGIN, ORIGIN, ORIGIN, 0.0)

# What the witness points are on: dimensions of A's feature and of B's.
FACES, EDGE_AND_FACE, FACE_AND_EDGE = (2, 2), (1, 2), (2, 1)


class Seen(NamedTuple):
    """A chart or an edge at its parameters, in its body's frame."""

    fits: bool  # is it of the kind, with its tangents nonzero?
    jet: Any
    cone: NormalCone
    ways: tuple[Vector, Vector]  # off an edge: unit conormals of its faces


class Looked(NamedTuple):
    """Both features at a place."""

    fits: bool
    jets: Any  # in A's frame
    cones: Any  # input of the certificate
    ways: Any  # of both, in their bodies' frames


NOT_SEEN = Seen(False, NO_JET, NO_CONE, (ORIGIN, ORIGIN))


@small
def seen_as(kind, ints, reals, chart, u, v):
    """A chart, assumed to be of a kind, any except a NURBS."""
    c = chart_record(ints, chart)
    o = ints[c + L.CHART_REALS]
    if ints[c + L.CHART_KIND] != kind:
        return NOT_SEEN
    return seen_by(kind, reals, o, surface_jet(reals, kind, o, u, v))


@small
def seen_as_sphere(ints, reals, chart, u, v):
    """`seen_as` of patches of ellipsoids, without the jets of all the other kinds."""
    c = chart_record(ints, chart)
    o = ints[c + L.CHART_REALS]
    if ints[c + L.CHART_KIND] != L.SPHERE:
        return NOT_SEEN
    return seen_by(L.SPHERE, reals, o, mapped_jet(reals, o, sphere_jet(u, v)))


@small
def seen_by(kind, reals, o, jet):
    """A chart whose reals begin at o, from its jet."""
    normal, noise = normal_of_kind(kind, reals, o, jet)
    collapsed = has_collapsed(reals, jet[1]) or has_collapsed(reals, jet[2])
    cone = NormalCone(SINGLE, normal, normal, ORIGIN, noise)
    return Seen(not collapsed, jet, cone, (ORIGIN, ORIGIN))


@small
def seen_on_line(ints, reals, edge, t, _):
    """An edge of a spatial body taken for a straight one between two planes."""
    e = edge_record(ints, edge)
    first, second = ints[e + L.EDGE_COEDGE_0], ints[e + L.EDGE_COEDGE_1]
    if ints[e + L.EDGE_KIND] != L.LINE or min(first, second) < 0:
        return NOT_SEEN
    if not (on_plane(ints, first) and on_plane(ints, second)):
        return NOT_SEEN
    x, xt, xtt = curve_jet(reals, L.LINE, ints[e + L.EDGE_REALS] + L.CURVE_DATA, t)
    tangent = unit(xt)
    way_a, a = plane_conormal(ints, reals, first, tangent)
    way_b, b = plane_conormal(ints, reals, second, tangent)
    cone = NormalCone(ARC, a, b, tangent, 0.0)
    return Seen(True, (x, xt, ORIGIN, xtt, ORIGIN, ORIGIN), cone, (way_a, way_b))


@small
def on_plane(ints, coedge):
    """Is the face at a coedge a plane?"""
    c = coedge_record(ints, coedge)
    return ints[chart_record(ints, ints[c + L.COEDGE_CHART]) + L.CHART_KIND] == L.PLANE


@small
def seen_as_nurbs(degree, ints, reals, chart, u, v):
    """A chart, assumed to be a NURBS of the same degree along u and v."""
    c = chart_record(ints, chart)
    o = ints[c + L.CHART_REALS]
    data = o + L.SURFACE_DATA
    fits = ints[c + L.CHART_KIND] == L.NURBS
    if not (fits and reals[data] == degree and reals[data + 1] == degree):
        return NOT_SEEN
    net, at, rates = net_at(reals, data, u, v)
    jet = net_jet_of(unrolled_basis, reals, net, (degree, degree), at, rates)
    return seen_by(L.NURBS, reals, o, mapped_jet(reals, o, jet))


@small
def look(look_a, look_b, pair, pose, place):
    """Both features at a place, by the functions that know their kinds."""
    a = look_a(pair.ints_a, pair.reals_a, number(side_of(place, 0)), place.u, place.v)
    b = look_b(pair.ints_b, pair.reals_b, number(side_of(place, 1)), place.r, place.s)
    jet_b = moved_jet(pose, b.jet)
    cones = Cones(a.cone, b.cone, a.jet[0], b.jet[0], sub(jet_b[0], a.jet[0]))
    return Looked(a.fits and b.fits, (a.jet, jet_b), cones, (a.ways, b.ways))


@small
def number(side):
    """Of a face its chart's, of an edge its own."""
    return side.chart if side.chart >= 0 else side.feature


@small
def inside_feature(dimension, ints, reals, side):
    """Does a point lie well inside its face, centrally in its chart, or between its edge's ends?"""
    if dimension == 1:
        o = ints[edge_record(ints, side.feature) + L.EDGE_REALS]
        return reals[o + L.EDGE_T0] < side.p < reals[o + L.EDGE_T1]
    o = ints[chart_record(ints, side.chart) + L.CHART_REALS]
    return well_inside(reals, o, side.p, side.q)


@small
def inside_features(dims, pair, place):
    """`inside_feature` of both points."""
    ia, ra, ib, rb = pair
    a = inside_feature(dims[0], ia, ra, side_of(place, 0))
    return a and inside_feature(dims[1], ib, rb, side_of(place, 1))


@small
def may_be_smooth(dims, pair, before):
    """Were the points on features of these dimensions, and the bodies far enough apart for the law
    alone?"""
    place = before.place
    return (
        not before.lost
        and not before.inside
        and before.cut == 0
        and dimension(pair.ints_a, place.feature_a) == dims[0]
        and dimension(pair.ints_b, place.feature_b) == dims[1]
        and before.distance >= SHIFTED_GAP * contact_scale(pair)
    )


@small
def held(ways, n, least):
    """Does the distance fall along neither way off an edge, by a slope of `least`? n is the unit
    vector towards the other body, in the edge's own frame."""
    return dot(n, ways[0]) <= least and dot(n, ways[1]) <= least


@small
def both_held(dims, pose, looked, d, span, slope):
    """Is no feature released, by the switching functions of `settle`?"""
    if dims[0] == 2 and dims[1] == 2:
        return True
    least = max(SLOPE, max(SLOPE_NOISE * EPS * span, slope) / d)
    n = scale(1.0 / d, looked.cones.gap)
    if dims[0] == 1:
        return held(looked.ways[0], n, least)
    return held(looked.ways[1], scale(-1.0, rotate_back(pose.R, n)), least)


@small
def descended(look_a, look_b, dims, pair, motion, place, tolerance, most):
    """(done, corrections, place, looked, rates): `settle` of a pair that no boundary concerns."""
    pose, corrections, rates = motion.pose, 0, NO_RATES
    fall = NO_FALL
    while True:
        # looked at in one place, which is half the code
        place = moved(place, 1.0, fall.step)
        looked = look(look_a, look_b, pair, pose, place)
        done = looked.fits and inside_features(dims, pair, place)
        done = done and is_enough(fall, 1.0, looked)
        if not done:
            break
        at = slope_at(pair, pose, looked)
        if corrections > 0 and at_rest(at, tolerance):
            done = both_held(dims, pose, looked, at.distance, at.span, at.slope)
            break
        newton = newton_at(looked, at)
        done = newton.safe and corrections < most
        if not done:
            break
        rates = rates_at(motion, looked.jets, newton)
        fall = newton.fall
        corrections += 1
    return done, corrections, place, looked, rates


@small
def known(dimension, cone):
    """A cone, its kind as it follows from the dimension of what was looked at."""
    kind = SINGLE if dimension == 2 else ARC
    return NormalCone(kind, cone.first, cone.last, cone.tangent, cone.noise)


@small
def known_cones(dims, cones):
    """`known` of both. A compiler that must find the kinds out itself may not, and then keeps the
    certificate's cases for edges at faces too."""
    return Cones(known(dims[0], cones.a), known(dims[1], cones.b), cones.x_a, cones.y_b, cones.gap)


@small
def proven_apart(dims, pair, pose, place, looked, tolerance):
    """(good, found): what the certificate proves of witness points at rest; good where it proves
    them apart, and not so near contact that they need the form that is regular there."""
    cones = known_cones(dims, looked.cones)
    d, lower, normal, blur = certify_cones(pair, pose, place, cones, ORIGIN)
    outcome = outcome_of(pair, pose, d, lower, blur, tolerance)
    good = (outcome == CERTIFIED) & (d > POLISHED * contact_scale(pair))
    return good, Found(outcome, place, d, lower, d, normal)


@small
def proven(dims, pair, pose, place, looked, tolerance):
    """`proven_apart`, and the status."""
    good, found = proven_apart(dims, pair, pose, place, looked, tolerance)
    return good, found, judge(pair, pose.p, found, False, tolerance, False)


@small
def write_counts(corrections, out):
    """Write how many corrections an answer took, each with an evaluation, and that it took no more
    than that."""
    for k in range(N_COUNTS):
        out[OUT_COUNTS + k] = 0.0
    out[OUT_COUNTS + EVALUATIONS] = corrections
    out[OUT_COUNTS + CORRECTIONS] = corrections


@small
def smooth_frame(look_a, look_b, dims, call, h):
    """Make the answer and the next state of a frame: 1; or write nothing: 0.

    look_a and look_b see A's charts and B's as of one kind, or edges where `dims` says so. `call`
    is what a frame is called with, its work not asked.
    """
    pair, inputs, options, state, _, _ = call
    before = read_state(state)
    if not may_be_smooth(dims, pair, before):
        return 0
    motion = moving(inputs, before, h)
    pose = motion.pose
    place = moved(before.place, 1.0, predict(before, options.predictor, h))
    if not inside_features(dims, pair, place):
        return 0
    most = min(options.deadline, SMOOTH_CORRECTIONS)
    done, corrections, place, looked, rates = descended(
        look_a, look_b, dims, pair, motion, place, options.tolerance, most
    )
    if not done:
        return 0
    good, found, status = proven(dims, pair, pose, place, looked, options.tolerance)
    if not good:
        return 0
    shown = Shown(found, looked.jets, False, True, rates)
    finish(call, h, before, motion, shown, status, corrections)
    return 1


@small
def finish(call, h, before, motion, shown, status, corrections):
    """Write the answer and the next state of a frame that is proven; of the jets no more is read
    than points and tangents."""
    pair, inputs, options, state, out, _ = call
    write_answer(pair, inputs, motion, shown, ORIGIN, status, out)
    feed, known = feeds(options.predictor, inputs.has_twist), Tracked(shown, before.integrated)
    carried = True, before.place, before.rates
    write_state(kept_state(carried, before, motion, h, known, feed, status), state)
    write_counts(corrections, out)
