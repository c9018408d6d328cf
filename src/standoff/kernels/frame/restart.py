"""A global start: for a first frame, and for a frame to which the last one does not lead."""

from standoff.kernels.algebra.vectors import dot, sub
from standoff.kernels.body.features import pair_span
from standoff.kernels.compiler.decorators import kernel, shared
from standoff.kernels.depth.overlap import with_overlap
from standoff.kernels.depth.penetration import (
    NOTHING,
    begin_along,
    contact_scale,
    minimum_along,
    plane_normal,
)
from standoff.kernels.depth.search import overlap_shown
from standoff.kernels.frame.contact import COLD, LEAST, bound_along, contact_query, some_direction
from standoff.kernels.pair.certificate import certify_along
from standoff.kernels.pair.certified import CERTIFIED, NOT_APART, PENETRATING
from standoff.kernels.pair.cold_start import FIRST, global_query
from standoff.kernels.pair.descent import pair_jets
from standoff.kernels.pair.events import KEEPING, LIMIT, RESTARTS, exhausted
from standoff.kernels.state.tracked import without_rates
from standoff.kernels.tolerances import PATIENCE, POLISHED, TOUCHING
from standoff.kernels.values import Depth, Found


@shared
def polish_along(pair, pose, found, tolerance, work):
    """What `polished` returns for a pair in need of it."""
    start = Depth(False, found.lower, found.normal, found.place)
    kind, ended, _ = minimum_along(pair, pose, start, tolerance, work)
    if kind == NOTHING:
        return found
    place, n, d = ended.place, ended.normal, ended.distance
    lower, _ = certify_along(pair, pose, place, pair_jets(pair, pose, place), n)
    return Found(found.outcome, place, d, lower, d, n)


@kernel
def in_need_of_polish(pair, found, work):
    """Is a certified pair so near contact that the direction between its witness points has few
    correct digits?"""
    return found.distance <= POLISHED * contact_scale(pair) and not exhausted(work)


@kernel
def polished(pair, pose, found, tolerance, work):
    """A certified pair, refined by Newton's method in the contact-regular form if very near
    contact."""
    if in_need_of_polish(pair, found, work):
        return polish_along(pair, pose, found, tolerance, work)
    return found


@kernel
def anywhere_apart(pair, pose, tolerance, work):
    """(found, inside) of a cold query if the bodies are apart; otherwise the outcome is NOT_APART,
    and `anywhere` finds the answer.
    """
    found = global_query(pair, pose, FIRST, tolerance, work)
    if found.outcome != CERTIFIED:
        nothing = Found(
            NOT_APART, found.place, found.distance, found.lower, found.upper, found.normal
        )
        return nothing, False
    return polished(pair, pose, found, tolerance, work), False


@kernel
def anywhere_from(pair, pose, first, tolerance, work):
    """(found, inside) of a cold query, apart or not; `first` is the start to try first."""
    found = global_query(pair, pose, first, tolerance, work)
    if found.outcome == CERTIFIED:
        return polished(pair, pose, found, tolerance, work), False
    if exhausted(work):
        return found, False
    found = contact_query(pair, pose, found.place, found.normal, COLD, LEAST, tolerance, work)
    return found, found.outcome == PENETRATING


@kernel
def anywhere(pair, pose, tolerance, work):
    """`anywhere_from` the first start, with a proof of overlap if it finds no depth."""
    found, inside = anywhere_from(pair, pose, FIRST, tolerance, work)
    return with_overlap(pair, pose, found, work), inside


@kernel
def start_due(before, work):
    """(is a global start due, which): after consecutive frames that were cut off and together used
    PATIENCE evaluations, continuing from the last one does not lead to an answer.
    """
    if before.cut == 0:
        return False, FIRST
    limit = work.counts[LIMIT]
    turns = (before.cut * limit) // PATIENCE
    return turns > ((before.cut - 1.0) * limit) // PATIENCE, int((turns + 1.0) % 2.0)


@kernel
def height_along(pair, pose, place, n):
    """How far B's witness point is beyond A's along n."""
    jet_a, jet_b = pair_jets(pair, pose, place)
    return dot(n, sub(jet_b[0], jet_a[0]))


@kernel
def cut_off_above(pair, pose, found, n):
    """`cut_off` with a half-space, whose normal n from A to B is the only one that can separate
    them.

    Any point of the other body below the plane shows that they overlap, and at least by how much.
    """
    place = begin_along(pair, pose, n)
    height, last = height_along(pair, pose, place, n), height_along(pair, pose, found.place, n)
    if last < height:
        place, height = found.place, last
    if height > 0.0:
        way = some_direction(found.normal)
        same = found.distance, found.lower, found.upper
        return Found(found.outcome, found.place, *same, way), False
    bound = bound_along(pair, pose, place, n)
    return Found(found.outcome, place, bound, bound, height, n), True


@kernel
def cut_off(pair, pose, found):
    """(found, inside) of a frame that ran out of evaluations outside contact.

    If samples alone show that the bodies overlap, the next frame follows the depth from their least
    direction, and this one answers with the bound along it. The same is done with the last
    direction if both witness points coincide: the bodies are not apart, and a distance of 0 would
    say nothing about the depth.
    """
    plane, square = plane_normal(pair, pose)
    if plane:
        return cut_off_above(pair, pose, found, square)
    n = some_direction(found.normal)
    shown, way, least = overlap_shown(pair, pose)
    if not shown and found.distance <= TOUCHING * pair_span(pair, pose.p, 0.0):
        shown, way, least = True, n, 0.0
    if not shown or found.lower > 0.0:
        return Found(found.outcome, found.place, found.distance, found.lower, found.upper, n), False
    place = begin_along(pair, pose, way)
    last, along = bound_along(pair, pose, place, n), bound_along(pair, pose, place, way)
    if last > along:
        return Found(found.outcome, place, last, last, -least, n), True
    return Found(found.outcome, place, along, along, -least, way), True


@kernel
def restart(pair, pose, first, tolerance, integrated, work):
    """A frame from a global start."""
    work.counts[RESTARTS] += 1
    work.counts[KEEPING] = 0  # what the last frame knew did not help
    found, inside = anywhere_from(pair, pose, first, tolerance, work)
    if exhausted(work) and found.outcome != CERTIFIED and not inside:
        found, inside = cut_off(pair, pose, found)
    return without_rates(pair, pose, found, inside, integrated)
