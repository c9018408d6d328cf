"""Answers are judged rightly, and Standoff's are as accurate as the pages say."""

from dataclasses import replace
from math import isnan, nan

import numpy as np
import pytest

from shares import only
from standoff.tracking import Status
from standoff_studies.accuracy.cases import Case, pairs
from standoff_studies.accuracy.measuring import (
    OwnAnswer,
    Verdict,
    errors,
    is_elsewhere,
    judge,
    measure_case,
    own_answer,
)
from standoff_studies.accuracy.peers.answer import PeerAnswer
from standoff_studies.accuracy.solids import KINDS, Solid, named
from standoff_studies.accuracy.summary import TARGETS, misses, summary, three_errors
from standoff_studies.accuracy.truth import Truth

ROUNDOFF = 1e-12
"""A normal's error (rad), times the stiffness over the size: what turns it is the roundoff of a
point, and where little curves and the gap is small that turns it a lot."""


FLAT = 1e-3
"""Stiffness over the size below which the crease of a superellipsoid is near: s(n) has other
minima there that are less than 1e-3 deeper."""


def truth_of_gap(case: Case) -> PeerAnswer:
    truth = case.truth
    return PeerAnswer(truth.distance, truth.point_a, truth.point_b, truth.normal)


def test_errors_are_over_the_size_and_in_radians(cases_of) -> None:
    case = cases_of("sphere", "ellipsoid")[2]
    truth, size = case.truth, case.size
    exact = truth_of_gap(case)
    assert errors(case, exact) == (0, 0, 0)
    across = np.cross(truth.normal, [0.6, 0.8, 0.0])
    across /= np.linalg.norm(across)
    turned = np.cos(0.01) * truth.normal + np.sin(0.01) * across
    moved = replace(
        exact,
        distance=exact.distance + 1e-3 * size,
        point_b=truth.point_b + 2e-3 * size * across,
        normal=turned,
    )
    assert errors(case, moved) == pytest.approx((1e-3, 2e-3, 0.01), rel=1e-9)
    assert errors(case, replace(exact, normal=-truth.normal))[2] == pytest.approx(np.pi)


def test_gaps_are_judged_by_distance(cases_of) -> None:
    case = cases_of("sphere", "ellipsoid")[0]
    exact = truth_of_gap(case)
    assert judge(case, exact) is Verdict.RIGHT
    for factor, verdict in ((0.9, Verdict.RIGHT), (1.1, Verdict.WRONG)):
        off = replace(exact, distance=exact.distance + factor * 1e-6 * case.size)
        assert judge(case, off) is verdict
    # within 1e-6 of the size, but with the wrong sign or silently zero
    assert judge(case, replace(exact, distance=-1e-9 * case.size)) is Verdict.WRONG
    assert judge(case, replace(exact, distance=0.0)) is Verdict.WRONG
    assert judge(case, replace(exact, distance=nan)) is Verdict.NOTHING


def point_in_box(depth: float) -> Case:
    """A point below the face +z of a unit box; the sides are 0.5 away, its bottom 1 - depth."""
    box, point = (
        Solid(named([name])[0], values)
        for name, values in (("box", {"x": 1.0, "y": 1.0, "z": 1.0}), ("point", {}))
    )
    up = np.array([0.0, 0.0, 1.0])
    poses = (np.eye(3), np.zeros(3)), (np.eye(3), (0.5 - depth) * up)
    truth = Truth(*poses, -depth, 0.5 * up, (0.5 - depth) * up, up, "face, point", np.inf)
    return Case(("point", "box"), 0, -depth, 1.0, box, point, truth, min(depth, 0.5, 1 - depth))


def answer(depth: float, normal: list[float]) -> PeerAnswer:
    nothing = np.zeros(3)
    return PeerAnswer(-depth, nothing, nothing, np.array(normal, dtype=float))


@pytest.mark.parametrize(
    ("built", "depth", "normal", "expected"),
    [
        (0.2, 0.2, [0, 0, 1], Verdict.RIGHT),
        (0.2, 0.5, [1, 0, 0], Verdict.DEEPER),
        (0.2, 0.8, [0, 0, -1], Verdict.DEEPER),
        (0.2, 0.3, [0, 0, 1], Verdict.WRONG),  # not the depth of its normal
        (0.2, 0.1, [0, 0, 1], Verdict.WRONG),
        (0.2, 0.1, [nan, nan, nan], Verdict.WRONG),  # less than the least
        (0.2, -0.2, [0, 0, 1], Verdict.WRONG),
        (0.2, 0.0, [0, 0, 1], Verdict.WRONG),
        (0.7, 0.3, [0, 0, -1], Verdict.OTHER),
        (0.7, 0.3, [nan, nan, nan], Verdict.OTHER),
        (0.7, 0.7, [0, 0, 1], Verdict.DEEPER),
        (0.7, 0.5, [0, 1, 0], Verdict.DEEPER),
        (0.7, 0.2, [0, 0, -1], Verdict.WRONG),
    ],
)
def test_depths_are_judged_by_the_least(built, depth, normal, expected) -> None:
    case = point_in_box(built)
    assert judge(case, answer(depth, normal)) is expected
    for certified in (False, True):
        given = answer(depth, normal)
        status = Status.GLOBAL if certified else Status.LOCAL
        own = OwnAnswer(**vars(given), status=status, certified=certified, lower_bound=-depth)
        broken = certified and expected is Verdict.DEEPER
        # a depth below the least is a false lower bound too
        assert judge(case, own) is (Verdict.WRONG if broken else expected)


def test_a_lower_bound_above_the_truth_is_wrong(cases_of) -> None:
    gap = cases_of("sphere", "ellipsoid")[0]
    exact = truth_of_gap(gap)
    shown = [(gap, exact), (point_in_box(0.2), answer(0.2, [0, 0, 1]))]
    shown += [(point_in_box(0.7), answer(0.3, [0, 0, -1]))]
    for case, right in shown:
        for off, wrong in ((-1e-3, False), (0.0, False), (2e-7 * case.size, True)):
            bound = right.distance + off
            own = OwnAnswer(
                **vars(right), status=Status.CONVERGED, certified=True, lower_bound=bound
            )
            assert (judge(case, own) is Verdict.WRONG) is wrong


def test_rows_of_other_minima_have_no_errors() -> None:
    from standoff_studies.accuracy.measuring import _row

    case = point_in_box(0.7)
    row = _row(case, "peer", answer(0.3, [0, 0, -1]))
    assert row.verdict == "other minimum"
    assert all(map(isnan, three_errors(row)))
    # a wrong normal within the slack of depths is an error, no minimum of its own
    shallow = point_in_box(1e-7)
    row = _row(shallow, "peer", answer(1e-7, [1, 0, 0]))
    assert row.normal_error == pytest.approx(np.pi / 2)


def test_a_lesser_depth_close_by_is_another_minimum() -> None:
    """A point in a box with a corner cut a little: the constructed face is not the nearest."""
    tilt = np.array([np.sin(0.02), 0.0, np.cos(0.02)])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    # the upper face a little lower towards +x, so that its normal is tilt
    corners[:, 2] -= np.where(corners[:, 2] > 0, np.tan(0.02) * corners[:, 0], 0)
    base = point_in_box(0.2)
    cut = Solid(named(["polytope"])[0], {"vertices": corners})
    depth = float(cut.support.heights(tilt[None])[0] - base.truth.point_b @ tilt)
    built = float(cut.support.heights(np.array([[0, 0, 1.0]]))[0] - base.truth.point_b[2])
    case = replace(
        base, a=cut, truth=replace(base.truth, distance=-built, normal=np.array([0, 0, 1.0]))
    )
    assert depth < built - 1e-3
    assert is_elsewhere(case, answer(depth, list(tilt)))
    assert not is_elsewhere(case, answer(depth - 1e-7, list(tilt)))  # not the depth of its normal
    assert not is_elsewhere(case, answer(built, [0, 0, 1]))
    assert judge(replace(case, least=built), answer(depth, list(tilt))) is Verdict.OTHER


def test_summary_counts_and_leaves_out_what_is_missing(cases_of) -> None:
    rows = [measure_case(case) for case in cases_of("sphere", "box") if case.level > 0]
    good, off, silent = rows
    off = replace(off, distance_error=1e-3, verdict="wrong", certified=False)
    silent = replace(
        silent, distance_error=nan, witness_error=nan, normal_error=nan, verdict="no answer"
    )
    found = summary([good, off, silent])
    assert (found.cases, found.certified, found.wrong, found.nothing) == (3, 2, 1, 1)
    assert found.worst[0] == 1e-3
    assert found.median[0] == pytest.approx((1e-3 + good.distance_error) / 2)
    assert misses([good, off, silent]) == [off]


def some_cases(cases_of, rng: np.random.Generator) -> list[Case]:
    """One case at every gap and depth of twenty pairs."""
    drawn = rng.choice(len(pairs(KINDS)), 20, replace=False)
    chosen = [pairs(KINDS)[number] for number in drawn]
    return [case for pair in chosen for case in cases_of(pair[0].name, pair[1].name)]


@pytest.mark.parametrize("part", only([0, 1], range(4)))
def test_gaps_reach_the_targets(part, cases_of, rng: np.random.Generator) -> None:
    """Distance 1e-12 and witness points 1e-9; the normal 1e-9 but where roundoff turns it."""
    for case in some_cases(cases_of, rng):
        if case.level < 0:
            continue
        found = own_answer(case)
        distance, witness, normal = errors(case, found)
        told = f"{case.kinds} {case.level} {case.truth}"
        assert found.certified, told
        assert judge(case, found) is Verdict.RIGHT, told
        assert distance <= TARGETS[0], told
        assert witness <= TARGETS[1], told
        stiffness = case.truth.stiffness / case.size
        assert normal <= max(TARGETS[2], ROUNDOFF / stiffness), told


@pytest.mark.parametrize("part", only([0, 1], range(4)))
def test_depths_reach_the_targets(part, cases_of, rng: np.random.Generator) -> None:
    """Up to half the focal depth: the least depth, as accurate as gaps, and no false bound."""
    for case in some_cases(cases_of, rng):
        found = own_answer(case)
        if case.level > 0 or case.truth.stiffness < -case.truth.distance:
            continue
        if "creased superellipsoid" in case.kinds and case.truth.stiffness < FLAT * case.size:
            continue
        told = f"{case.kinds} {case.level} {found} {case.truth}"
        assert found.status in (Status.LOCAL, Status.GLOBAL), told
        assert judge(case, found) in (Verdict.RIGHT, Verdict.OTHER), told
        if not case.constructed or is_elsewhere(case, found):
            continue
        distance, witness, normal = errors(case, found)
        stiffness = case.truth.stiffness / case.size
        assert distance <= TARGETS[0], told
        assert witness <= TARGETS[1], told
        assert normal <= max(TARGETS[2], ROUNDOFF / stiffness), told
