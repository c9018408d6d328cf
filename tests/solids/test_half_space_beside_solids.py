"""Half-spaces and points beside solids: closed forms from support heights."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import standoff as so
from families.solid_shapes import bolt, bracket, tube
from standoff.bodies.features import Feature
from standoff.solids.spatial.half_space import TOP, HalfSpaceBeside, size_together
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.pair import PlacedPair

STILL = so.Pose.identity()
DISCS = [(1.0, 0.0), (1.0, 3.0), (2.0, 3.0), (2.0, 4.0)]
"""Radii and heights of the bolt's edges."""
COORDINATES = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
TURNS = COORDINATES.map(lambda vector: Rotation.from_rotvec(vector).as_matrix())
NORMALS = COORDINATES.filter(lambda n: np.linalg.norm(n) > 0.1)


def heights(normal: np.ndarray) -> tuple[float, float]:
    """(least, greatest) height of the bolt along a unit vector of its own frame."""
    across = float(np.hypot(normal[0], normal[1]))
    return (
        min(z * float(normal[2]) - r * across for r, z in DISCS),
        max(z * float(normal[2]) + r * across for r, z in DISCS),
    )


@given(
    TURNS,
    TURNS,
    NORMALS,
    st.floats(-2.0, 2.0),
    st.sampled_from([0.0, 0.3]),
    st.sampled_from([1e-6, 0.01, 0.5, 30.0, 4000.0]),
    st.booleans(),
    st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0)),
    st.booleans(),
)
def test_above_and_below_a_plane(
    turn: np.ndarray,
    other: np.ndarray,
    normal: tuple[float, float, float],
    offset: float,
    rounding: float,
    gap: float,
    above: bool,
    slide: tuple[float, float],
    first: bool,
) -> None:
    """Apart by the gap, or inside with that wall: however deep, and wherever along the plane."""
    solid, plane = bolt(), so.shapes.halfspace(normal, offset, rounding=rounding)
    n = other @ normal / np.linalg.norm(normal)
    origin = np.array([0.3, -0.7, 0.2])
    level = float(n @ origin) + offset + rounding
    low, high = heights(turn.T @ n)
    side = np.cross(n, np.eye(3)[int(np.abs(n).argmin())])
    along = slide[0] * side + slide[1] * np.cross(n, side)
    shift = n * (level + gap - low if above else level - gap - high) + along
    poses = so.Pose(turn, shift), so.Pose(other, origin)
    asked = (solid, plane, *poses) if first else (plane, solid, *poses[::-1])
    found = so.solids.distance(*asked)
    tolerance = 3e-10 * 6.0 * solid.size + 1e-13 * (gap + 100.0)
    assert found.certified
    assert found.status in (
        (so.Status.CONVERGED, so.Status.CONTINUUM) if above else (so.Status.CONTAINED,)
    )
    assert found.inside == ("" if above else "A" if first else "B")
    assert found.distance == pytest.approx(gap, abs=tolerance)
    assert found.lower_bound - 1e-12 * (gap + 100.0) <= gap
    assert gap - found.lower_bound <= tolerance
    feature, parameters, point = (
        (found.feature_b, found.parameters_b, found.point_b)
        if first
        else (found.feature_a, found.parameters_a, found.point_a)
    )
    assert feature == Feature("face", 0)
    own = plane.face_parts[0].charts[0].jet(*parameters)[0]
    unit = np.array(normal) / np.linalg.norm(normal)
    world = other @ (own + rounding * unit) + origin
    np.testing.assert_allclose(world, point, atol=1e-11 * (gap + 100.0))


@pytest.mark.parametrize("side", [1.0, 1.15, 1.3, 1.5, 1.75, 1.99])
def test_the_square_reaches_the_corners_of_the_ball(side: float) -> None:
    """The nearest corner of a tilted plate is as far from its middle as any point."""
    plate = so.solids.Solid(so.shapes.box((side, side, 1e-3)))
    turn = Rotation.from_rotvec([0.0, 0.0, 0.25 * np.pi])  # a corner along an axis of the square
    tilted = (Rotation.from_rotvec([0.02, -0.03, 0.0]) * turn).as_matrix()
    corners = np.array(plate.boundary.vertex_points) @ tilted.T
    at = so.Pose(tilted, [3.0, 4.0, 0.5 - corners[:, 2].min()])
    found = so.solids.distance(plate, so.shapes.halfspace(), at, STILL)
    assert found.distance == pytest.approx(0.5, abs=1e-9)
    foot = corners[corners[:, 2].argmin()] + [3.0, 4.0, 0.0]
    np.testing.assert_allclose(found.point_b, [*foot[:2], 0.0], atol=1e-7)


def test_its_square_is_just_large_enough() -> None:
    solid, plane = as_model(bolt()), so.shapes.halfspace()
    for deep in (-1e4, 0.0, 1e4):
        pair = PlacedPair(as_model(plane), solid, STILL, so.Pose(np.eye(3), [0.0, 0.0, deep]))
        assert isinstance(pair.a, HalfSpaceBeside)
        assert pair.size <= size_together(as_model(plane), solid)
        assert pair.size <= 6.0 * solid.size
        charts = pair.a.boundary.face_parts[TOP].charts
        np.testing.assert_allclose(np.cross(*charts[0].linear[:, :2].T)[:2], 0.0, atol=0.0)
        assert {(leaf.dim, leaf.feature) for leaf in pair.a.leaves} == {(2, TOP)}
        assert max(np.abs(leaf.centre[2]) for leaf in pair.a.leaves) == 0.0
    # the square is made once
    assert pair.a.leaves is PlacedPair(as_model(plane), solid, STILL, STILL).a.leaves


def test_standing_on_a_plane_and_sunk_into_it() -> None:
    plane, solid = so.shapes.halfspace(), bolt()
    found = so.solids.distance(plane, solid, STILL, STILL)
    assert found.status is so.Status.TOUCHING
    assert found.distance == pytest.approx(0.0, abs=1e-12)
    found = so.solids.distance(plane, bracket(), STILL, so.Pose(np.eye(3), [0.0, 0.0, 0.2]))
    assert found.status is so.Status.CONTINUUM
    assert found.continuum is not None
    assert found.continuum.kind == "surface"
    found = so.solids.distance(plane, solid, STILL, so.Pose(np.eye(3), [0.0, 0.0, -0.4]))
    assert found.status is so.Status.OVERLAPPING
    assert 0.35 <= found.depth <= 0.4 + 1e-12
    # no minimum is at the sides of the square
    deep = so.Pose(np.eye(3), [0.0, 0.0, -9.0])
    found = so.solids.distance(plane, solid, STILL, deep, minima=50.0)
    assert found.status is so.Status.CONTAINED
    assert found.distance == pytest.approx(5.0, abs=1e-12)
    assert max(pair.distance for pair in found.minima) <= 9.0 + 1e-9


def test_its_gradient_is_of_its_own_frame() -> None:
    plane, solid = so.shapes.halfspace((0.2, 0.3, 1.0), 0.4), bracket()
    poses = (
        so.Pose(np.eye(3), [5.0, -3.0, 0.0]),
        so.Pose(Rotation.from_rotvec([0.5, 0.4, 0.3]).as_matrix(), [1.0, 2.0, 6.0]),
    )
    found = so.solids.distance(plane, solid, *poses)
    step = 1e-5
    for k in range(12):
        ends = []
        for sign in (1.0, -1.0):
            twist = np.zeros(12)
            twist[k] = sign * step
            moved = [
                so.Pose(
                    Rotation.from_rotvec(twist[o + 3 : o + 6]).as_matrix() @ pose.rotation,
                    pose.translation + twist[o : o + 3],
                )
                for o, pose in zip((0, 6), poses, strict=True)
            ]
            ends.append(so.solids.distance(plane, solid, *moved).distance)
        assert (ends[0] - ends[1]) / (2.0 * step) == pytest.approx(found.gradient[k], abs=1e-6)
    given = tuple(np.concatenate([p.rotation.ravel(), p.translation]) for p in poses)
    np.testing.assert_array_equal(found.poses, given)


def test_two_half_spaces_are_refused() -> None:
    plane = so.shapes.halfspace()
    with pytest.raises(ValueError, match="Two half-spaces"):
        so.solids.distance(plane, plane, STILL, STILL)


def test_a_picture_of_a_half_space() -> None:
    plane, solid = so.shapes.halfspace(), bolt()
    at = so.Pose(np.eye(3), [30.0, 0.0, 1.0])
    figure = so.plot(plane, solid, so.solids.distance(plane, solid, STILL, at))
    assert any("face 0" in text.get_text() for text in figure.legends[0].get_texts())


def test_a_point_beside_a_solid() -> None:
    point, bush = so.shapes.point(), tube(0.5, 1.0, -1.0, 1.0)

    def asked(x: float, y: float, z: float) -> so.solids.SolidProximity:
        return so.solids.distance(bush, point, STILL, so.Pose(np.eye(3), [x, y, z]))

    found = asked(0.0, 0.0, 0.0)
    assert found.status is so.Status.CONTINUUM
    assert found.distance == pytest.approx(0.5, abs=1e-14)
    found = asked(0.1, 0.0, 0.3)
    assert found.status is so.Status.CONVERGED
    assert found.distance == pytest.approx(0.4, abs=1e-13)
    assert found.feature_b == Feature("vertex", 0)
    np.testing.assert_allclose(found.point_b, [0.1, 0.0, 0.3], atol=1e-15)
    found = asked(0.7, 0.0, 0.1)
    assert (found.status, found.inside) == (so.Status.CONTAINED, "B")
    assert found.distance == pytest.approx(0.2, abs=1e-13)
    found = asked(1.0, 0.0, 0.1)
    assert found.status is so.Status.TOUCHING
    moved = point.transformed((np.eye(3), [0.0, 0.3, 0.0]))
    found = so.solids.distance(moved, bush, so.Pose(np.eye(3), [0.0, 0.0, 1.5]), STILL)
    assert found.distance == pytest.approx(np.hypot(0.2, 0.5), abs=1e-13)
    np.testing.assert_allclose(found.point_a, [0.0, 0.3, 1.5], atol=1e-15)
