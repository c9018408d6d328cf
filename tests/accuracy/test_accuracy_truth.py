"""The constructed truth is proven by supports: attained by the witnesses, and separating."""

from dataclasses import replace

import numpy as np
import pytest

from oracles import depth as depth_oracle
from standoff_studies.accuracy.cases import DEPTHS, GAPS, LEVELS, pairs
from standoff_studies.accuracy.least_depth import least_bounds, least_depth, sampled
from standoff_studies.accuracy.solids import KINDS, Solid, named
from standoff_studies.accuracy.truth import Truth, random_rotation, support_sum
from standoff_studies.oracles import Placed, Vertices, unit

EVERY_THIRD = pairs(KINDS)[::3]
UNKNOWN_DEPTH = {"point", "segment", "torus hull", "halfspace"}
"""They have no depth, or not one that the tests' search takes."""


def pair_id(pair) -> str:
    return f"{pair[0].name}-{pair[1].name}"


@pytest.mark.parametrize("pair", EVERY_THIRD, ids=pair_id)
def test_truth_is_attained_and_separates(pair, cases_of) -> None:
    """n.(y - x) is the distance along n, both points are farthest along it, y - x is along it."""
    cases = cases_of(pair[0].name, pair[1].name)
    levels = GAPS if pair[0].flat and pair[1].flat else LEVELS
    assert [case.level for case in cases] == list(levels)
    for case in cases:
        truth, size = case.truth, case.size
        step = truth.point_b - truth.point_a
        assert truth.distance == pytest.approx(case.level * size, abs=1e-14 * size)
        np.testing.assert_allclose(step, truth.distance * truth.normal, atol=4e-15 * size)
        for solid, pose, point, n in (
            (case.a, truth.pose_a, truth.point_a, truth.normal),
            (case.b, truth.pose_b, truth.point_b, -truth.normal),
        ):
            if solid.bounded:
                local = (point - pose[1]) @ pose[0]
                height = solid.support.heights((n @ pose[0])[None])[0]
                assert local @ (n @ pose[0]) == pytest.approx(height, abs=4e-15 * size)
            else:
                np.testing.assert_allclose(n, pose[0][:, 2], atol=1e-15)
        assert case.truth.stiffness > 0


@pytest.mark.parametrize("names", [("box", "polytope"), ("cylinder", "cone"), ("gore", "segment")])
def test_all_kinds_of_contact_are_drawn(names, cases_of) -> None:
    seen = {case.truth.contact for case in cases_of(*names, count=12)}
    assert {"point, point", "line, line"} <= seen
    assert seen & {"face, point", "point, face", "line, point", "point, line"}
    assert not seen & {"face, face", "face, line", "line, face"}


def test_truth_is_stationary_beyond_the_rounding_of_poses(cases_of) -> None:
    """At a gap of 1e-6 two vertices turn n by 1e-10 when a position is rounded: it is followed."""
    for case in cases_of("point", "polytope", 6):
        if case.level == GAPS[0] and case.truth.contact == "point, point":
            step = case.truth.point_b.astype(np.longdouble) - case.truth.point_a
            vertex = case.a if case.b.kind.name == "point" else case.b
            assert isinstance(vertex.support, Vertices)
            # the vertex itself, placed in extended precision
            pose = case.truth.pose_a if vertex is case.a else case.truth.pose_b
            spots = pose[0].astype(np.longdouble) @ vertex.support.vertices.T + pose[1][:, None]
            other = case.truth.pose_b[1] if vertex is case.a else case.truth.pose_a[1]
            steps = (other[:, None] - spots).T
            step = steps[np.sqrt((steps**2).sum(axis=1)).argmin()]
            n = unit(step) if vertex is case.a else -unit(step)
            np.testing.assert_allclose(case.truth.normal, n.astype(float), atol=3e-16)


def placed(a: Solid, b: Solid, shift: list[float], rotation=None) -> Truth:
    turn = np.eye(3) if rotation is None else rotation
    shift_b = np.array(shift)
    nothing = np.full(3, np.nan)
    return Truth((turn, np.zeros(3)), (turn, turn @ shift_b), 0.0, nothing, nothing, nothing, "", 0)


def solid(name: str, **values) -> Solid:
    (kind,) = named([name])
    return Solid(kind, values)


@pytest.mark.parametrize(
    ("a", "b", "shift", "expected"),
    [
        (solid("box", x=2.0, y=3.0, z=4.0), solid("point"), [0.2, 0.4, 0.1], 0.8),
        (solid("box", x=2.0, y=3.0, z=4.0), solid("box", x=1.0, y=1.0, z=1.0), [0.2, 1, 0], 1.0),
        (solid("sphere", r=1.0), solid("sphere", r=0.5), [0.3, 0.4, 0.0], 1.0),
        (solid("ellipsoid", a=1.0, b=0.5, c=0.7), solid("sphere", r=0.2), [0.0, 0.0, 0.0], 0.7),
        (solid("cylinder", r=0.5, length=3.0), solid("point"), [0.0, 0.1, 0.0], 0.4),
    ],
)
def test_least_depth_is_that_of_closed_forms(
    a, b, shift, expected, rng: np.random.Generator
) -> None:
    truth = placed(a, b, shift, random_rotation(rng))
    lower, upper = least_depth(a, b, truth, 1.0)
    assert lower <= expected + 1e-12
    assert upper == pytest.approx(expected, abs=1e-7)
    assert lower == pytest.approx(expected, abs=2e-5)
    assert expected - 1e-12 <= sampled(a, b, truth)[1].min() <= expected + 0.1


def test_a_deeper_minimum_is_not_taken_for_the_least() -> None:
    """A ball through a slab: its other side is nearer from the middle on."""
    a, b = solid("box", x=2.0, y=2.0, z=1.0), solid("sphere", r=0.1)
    for depth, expected in ((0.3, True), (0.7, False)):
        truth = placed(a, b, [0.0, 0.0, 0.5 + 0.1 - depth])
        truth = replace(truth, distance=-depth, normal=np.array([0.0, 0.0, 1.0]))
        assert float(support_sum(a, b, truth, truth.normal[None])[0]) == pytest.approx(depth)
        lower, upper = least_bounds(a, b, truth, 2.0, 1e-9)
        assert (upper == depth) is expected
        assert lower <= upper == pytest.approx(min(depth, 1.2 - depth), abs=1e-7)


@pytest.mark.parametrize("number", range(8))
def test_least_depth_is_that_of_the_oracle(number, cases_of, rng: np.random.Generator) -> None:
    """Whether it is the constructed one or another: a bracket on the sphere proves it."""
    known = [kind.name for kind in KINDS if kind.name not in UNKNOWN_DEPTH]
    first, second = rng.choice(known, 2)
    (case,) = (case for case in cases_of(first, second) if case.level == -DEPTHS[-1])
    bodies = [
        Placed(solid.support, *pose)
        for solid, pose in ((case.a, case.truth.pose_a), (case.b, case.truth.pose_b))
    ]
    _, value, lower = depth_oracle.least_depth(*bodies)
    assert case.least == pytest.approx(value, abs=2e-8 * case.size)
    assert case.least >= lower - 1e-12 * case.size


def test_every_depth_is_an_overlap(cases_of) -> None:
    for case in cases_of("point", "polytope", 8):
        if case.level == -DEPTHS[-1]:
            assert sampled(case.a, case.b, case.truth)[1].min() > 0
            assert 0 < case.least <= -case.truth.distance
