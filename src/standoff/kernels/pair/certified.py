"""A descent with its certificate, polished where contact is very near."""

from math import inf
from typing import Any, NamedTuple

from standoff.kernels.body.features import dimension, pair_slack, pair_span
from standoff.kernels.body.trimming import on_face
from standoff.kernels.compiler.decorators import kernel, shared, small
from standoff.kernels.pair.certificate import certify
from standoff.kernels.pair.contact_newton import polish
from standoff.kernels.pair.descent import pair_jets, release_along, settle
from standoff.kernels.tolerances import BLUR, MAX_STALLS, SLOPE, TOUCHING
from standoff.kernels.values import ORIGIN, Found, Vector

# Outcomes of a query.
CERTIFIED = 0
UNCERTIFIED = 1
TOUCHING_OR_OVERLAPPING = 2
PENETRATING = 3  # solved in contact: a signed distance that is not certainly positive
NOT_APART = 4  # not solved: only the query in contact can tell
OVERLAP = 5  # uncertified, but the bodies are proven to overlap
STAYED = 6  # a global start was due, and is not to be made


class Weighed(NamedTuple):
    """What is proven of witness points; lengths are those of the cores."""

    outcome: int
    distance: float
    lower: float
    normal: Vector


class Followed(NamedTuple):
    """A frame's descent, and the rates of the parameters by its last evaluation."""

    found: Found
    jets: Any  # both, of the place found, in A's frame
    fresh: bool  # do the rates belong to the place's features and charts?
    rates: tuple[float, ...]  # feedforward, 1/s


@shared
def weigh(pair, pose, place, jets, hint, tolerance):
    """Certify witness points by their jets, in A's frame.

    The bodies' own slack lowers the bound but is no fault of the answer, nor is the roundoff of a
    normal beside a collapsed side: the gap beyond both counts.
    """
    d, lower, normal, blur = certify(pair, pose, place, jets, hint)
    if not on_feature(pair, place):
        # a surface continued past its face bounds nothing
        return Weighed(UNCERTIFIED, d, -inf, normal)
    return Weighed(outcome_of(pair, pose, d, lower, blur, tolerance), d, lower, normal)


@small
def outcome_of(pair, pose, d, lower, blur, tolerance):
    """What a bound proves of witness points that lie on their features."""
    span = pair_span(pair, pose.p, d)
    # a body's own slack may reach over the gap: the points are apart all the same
    slack = pair_slack(pair)
    apart = lower > 0.0 or (slack > 0.0 and d > TOUCHING * span)
    if apart and d - lower <= tolerance * span + slack + min(blur, BLUR * span):
        return CERTIFIED
    if lower <= 0.0 and d <= TOUCHING * span:
        return TOUCHING_OR_OVERLAPPING
    return UNCERTIFIED


@kernel
def on_feature(pair, place):
    """Do both witness points lie on their faces? Ends bound edges; a vertex is a point."""
    if dimension(pair.ints_a, place.feature_a) == 2 and not on_face(
        pair.ints_a, pair.reals_a, place.chart_a, place.u, place.v
    ):
        return False
    return dimension(pair.ints_b, place.feature_b) != 2 or on_face(
        pair.ints_b, pair.reals_b, place.chart_b, place.r, place.s
    )


@shared
def settle_and_weigh(pair, motion, place, least, goal, tolerance, work):
    """Descend until the slope is below goal |dR|, certify.

    Very near contact an uncertified answer is polished in the contact-regular form, and settled
    once more where that shows a feature to release.
    """
    pose = motion.pose
    _, place, jets, fresh, rates = settle(pair, motion, place, least, goal, work)
    answer = weigh(pair, pose, place, jets, ORIGIN, tolerance)
    for _ in range(MAX_STALLS):
        if answer.outcome != UNCERTIFIED:
            break
        sharp, n, place = polish(pair, pose, place, work)
        if not sharp:
            break
        fresh, jets = False, pair_jets(pair, pose, place)
        answer = weigh(pair, pose, place, jets, n, tolerance)
        if answer.outcome != UNCERTIFIED:
            break
        released, place = release_along(pair, pose, place, n, answer.distance, SLOPE, work)
        if not released:
            break
        _, place, jets, fresh, rates = settle(pair, motion, place, 0.0, 0.0, work)
        answer = weigh(pair, pose, place, jets, n, tolerance)
    outcome, d, lower, normal = answer
    return Followed(Found(outcome, place, d, lower, d, normal), jets, fresh, rates)
