"""A descent with its certificate, polished where contact is very near."""

from standoff.kernels.certificate import certify
from standoff.kernels.compiling import kernel, shared
from standoff.kernels.contact import polish
from standoff.kernels.descent import ORIGIN, pair_jets, release_along, settle
from standoff.kernels.features import dimension, pair_slack, pair_span
from standoff.kernels.tolerances import BLUR, MAX_STALLS, SLOPE, TOUCHING
from standoff.kernels.trimming import on_face

# Outcomes of a query.
CERTIFIED = 0
UNCERTIFIED = 1
TOUCHING_OR_OVERLAPPING = 2
PENETRATING = 3  # solved in contact: a signed distance that is not certainly positive
NOT_APART = 4  # not solved: only the query in contact can tell


@shared
def weigh(pair, R, p, mode, q, jet_a, jet_b, hint, tolerance):
    """(outcome, d, bound, normal) of witness points; d and bound are those of the cores.

    The bodies' own slack lowers the bound but is no fault of the answer, nor is the roundoff of a
    normal beside a collapsed side: the gap beyond both counts.
    """
    d, bound, normal, blur = certify(pair, R, p, mode, q, jet_a[0], jet_b[0], hint)
    span = pair_span(pair, p, d)
    if not on_feature(pair, mode, q):
        return UNCERTIFIED, d, bound, normal
    # a body's own slack may reach over the gap: the points are apart all the same
    slack = pair_slack(pair)
    apart = bound > 0.0 or (slack > 0.0 and d > TOUCHING * span)
    if apart and d - bound <= tolerance * span + slack + min(blur, BLUR * span):
        return CERTIFIED, d, bound, normal
    if bound <= 0.0 and d <= TOUCHING * span:
        return TOUCHING_OR_OVERLAPPING, d, bound, normal
    return UNCERTIFIED, d, bound, normal


@kernel
def on_feature(pair, mode, q):
    """Do both witness points lie on their faces? Ends bound edges; a vertex is a point."""
    ia, ra, ib, rb = pair
    if dimension(ia, mode[0]) == 2 and not on_face(ia, ra, mode[1], q[0], q[1]):
        return False
    return dimension(ib, mode[2]) != 2 or on_face(ib, rb, mode[3], q[2], q[3])


@shared
def settle_and_weigh(pair, R, p, v, w, mode, q, w_ff, least, goal, tolerance, counts, events):
    """(fresh, outcome, d, bound, normal): descend until the slope is below goal |dR|, certify.

    Very near contact an uncertified answer is polished in the contact-regular form, and settled
    once more where that shows a feature to release.
    """
    _, fresh, jet_a, jet_b = settle(pair, R, p, v, w, mode, q, w_ff, least, goal, counts, events)
    outcome, d, bound, normal = weigh(pair, R, p, mode, q, jet_a, jet_b, ORIGIN, tolerance)
    for _ in range(MAX_STALLS):
        if outcome != UNCERTIFIED:
            break
        sharp, n = polish(pair, R, p, mode, q, counts)
        if not sharp:
            break
        fresh = False
        jet_a, jet_b = pair_jets(pair, R, p, mode, q)
        outcome, d, bound, normal = weigh(pair, R, p, mode, q, jet_a, jet_b, n, tolerance)
        if outcome != UNCERTIFIED or not release_along(
            pair, R, mode, q, n, d, SLOPE, counts, events
        ):
            break
        _, fresh, jet_a, jet_b = settle(pair, R, p, v, w, mode, q, w_ff, 0.0, 0.0, counts, events)
        outcome, d, bound, normal = weigh(pair, R, p, mode, q, jet_a, jet_b, n, tolerance)
    return fresh, outcome, d, bound, normal
