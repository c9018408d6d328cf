"""Derivatives by design of solids that need not be convex, and of half-spaces."""

import makers
import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.interpolate import BSpline

import standoff as so
from shares import only
from standoff.errors import StandoffError
from standoff.geometry import BezierPatch, NurbsSurface

REST = np.eye(4)


def at(*place):
    pose = np.eye(4)
    pose[:3, 3] = place
    return pose


def test_a_ball_in_the_hole_of_a_ring():
    ring = so.Design(makers.ring, major=0.9, minor=0.25)
    ball = so.Design(so.shapes.sphere, radius=0.1)
    answer = so.solids.distance(ring.body, ball.body, REST, at(0.12, 0.16, 0.3))
    way = np.array([0.9 - 0.2, -0.3])
    assert abs(answer.distance - (np.linalg.norm(way) - 0.35)) <= 1e-9
    found = so.shape_gradient(answer, a=ring, b=ball)
    assert abs(found.a["major"] - way[0] / np.linalg.norm(way)) <= 1e-9
    assert abs(found.a["minor"] + 1.0) <= 1e-9
    assert abs(found.b["radius"] + 1.0) <= 1e-9


@pytest.mark.parametrize("side", ["a", "b"])
def test_charts_of_solids(side):
    """A solid's answer does not tell which chart of a face of several the witness point is in."""
    ball, poses = so.shapes.sphere(0.2), (REST, at(1.1, 0.9, 0.8))
    turn = slice(None) if side == "a" else slice(None, None, -1)
    design = so.Design(so.shapes.ellipsoid, semi_axes=[0.5, 0.8, 0.6])
    found = []
    for body in (design.body, so.Solid(design.body)):
        answer = so.distance(*(body, ball)[turn], *poses[turn])
        found.append(getattr(so.shape_gradient(answer, **{side: design}), side)["semi_axes"])
    np.testing.assert_allclose(found[1], found[0], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("swapped", [False, True])
def test_the_wall_round_a_solid_inside_another(swapped):
    """The outer one is rounded: its normal at the wall points away from the inner one."""
    ball = so.Design(so.shapes.sphere, radius=0.2)
    cover = so.Design(lambda half, r: so.shapes.box([2 * half] * 3, r), half=1.0, r=0.1)
    pair, poses = (ball.body, so.Solid(cover.body)), (at(0.5, 0.1, 0.05), REST)
    designs = {"a": ball, "b": cover}
    if swapped:
        pair, poses, designs = pair[::-1], poses[::-1], {"a": cover, "b": ball}
    answer = so.distance(*pair, *poses)
    assert answer.inside == ("B" if swapped else "A")
    assert abs(answer.distance - 0.3) <= 1e-9
    told = so.shape_gradient(answer, **designs)
    first, second = (told.b, told.a) if swapped else (told.a, told.b)
    assert abs(first["radius"] + 1.0) <= 1e-9
    assert abs(second["half"] - 1.0) <= 1e-9
    assert abs(second["r"]) <= 1e-9


SPLINES = {
    2: [[-1.0, 0.0], [-0.5, 0.5], [0.4, 0.2], [1.0, 0.4]],
    3: [[-1.0, 0.0], [-0.6, 0.6], [0.1, 0.1], [0.5, 0.7], [1.0, 0.2]],
}


@pytest.mark.parametrize("degree", only([2], SPLINES))
def test_control_points_of_a_spline_move_the_gap_by_their_basis_functions(degree):
    """A bent beam, whose upper side is a spline of two spans: the oracle is SciPy's basis."""
    ends = [0.0] * (degree + 1), [1.0] * (degree + 1)
    knots, points = [*ends[0], 0.5, *ends[1]], np.array(SPLINES[degree])

    def beam(control):
        low = np.insert(np.asarray(control), 1, 0.0, axis=1)
        high = np.insert(
            np.column_stack([points[:, 0], np.full(len(points), -0.5)]), 1, 0.0, axis=1
        )
        y = np.array([0.0, 0.4, 0.0])
        ends = [0.0, 0.0, 1.0, 1.0]
        sides = [
            NurbsSurface(np.stack([curve - y, curve + y], axis=1), knots, ends)
            for curve in (low, high)
        ]
        caps = [
            NurbsSurface(np.stack([low + side, high + side], axis=1), knots, ends)
            for side in (y, -y)
        ]
        closing = [
            BezierPatch([[low[k] - y, low[k] + y], [high[k] - y, high[k] + y]]) for k in (0, -1)
        ]
        return so.bodies.Boundary.from_patches([*sides, *caps, *closing])

    design, ball = so.Design(beam, control=points), so.shapes.sphere(0.1)
    for place in ((-0.5, 0.1, 0.9), (0.6, 0.1, 1.1)):
        answer = so.solids.distance(design.body, ball, REST, at(*place))
        found = so.shape_gradient(answer, a=design)
        curve = BSpline(knots, points, degree)
        grid = np.linspace(0.0, 1.0, 10001)
        t = grid[np.linalg.norm(curve(grid) - answer.point_a[[0, 2]], axis=1).argmin()]
        for _ in range(20):  # Newton's method: the foot of the witness point
            off, speed = curve(t) - answer.point_a[[0, 2]], curve(t, 1)
            t -= off @ speed / (speed @ speed + off @ curve(t, 2))
        assert np.linalg.norm(off) <= 1e-9
        basis = BSpline.design_matrix([t], np.array(knots), degree).toarray()[0]
        true = -np.outer(basis, answer.normal[[0, 2]])
        np.testing.assert_allclose(found.a["control"], true, rtol=0.0, atol=1e-8)


def test_a_half_space_turns_and_rises():
    """Its normal, of which one number is 0, and its offset; both have no size to compare with."""
    given = {"normal": [0.3, 0.0, 1.0], "offset": 0.2}
    wall, centre = so.Design(so.shapes.halfspace, **given), [0.4, -0.2, 2.0]
    answer = so.distance(wall.body, so.shapes.sphere(0.1), REST, at(*centre))
    found = so.shape_gradient(answer, a=wall)
    assert abs(found.a["offset"] + 1.0) <= 1e-9
    with mp.workdps(50):
        for k in range(3):

            def gap(x, k=k):
                n = [mpf(v) for v in given["normal"]]
                n[k] = x
                size = mp.sqrt(sum(v * v for v in n))
                return sum(mpf(c) * v for c, v in zip(centre, n, strict=True)) / size

            true = float(mp.diff(gap, mpf(given["normal"][k])))
            assert abs(found.a["normal"][k] - true) <= 1e-9


def test_numbers_that_are_nothing_but_roundoff_are_no_scale():
    turned = np.array([np.cos(np.pi / 2), np.sin(np.pi / 2), 0.3])  # 6e-17, 1, 0.3
    design = so.Design(so.shapes.segment, start=turned, end=[0.0, 0.0, -0.5])
    answer = so.distance(design.body, so.shapes.sphere(0.1), REST, at(0.6, 2.0, 1.0))
    found = so.shape_gradient(answer, a=design)
    np.testing.assert_allclose(found.a["start"], -answer.normal, rtol=0.0, atol=1e-9)


def test_an_answer_of_other_solids_or_of_a_compound_is_refused():
    block, ball = so.Design(so.shapes.box, size=[1.0, 1.0, 1.0]), so.shapes.sphere(0.1)
    longer = so.shapes.box(1.0, 1.0, 1.2)
    other = so.solids.distance(so.Solid(longer), ball, REST, at(0.1, 0.2, 0.9))
    with pytest.raises(StandoffError, match="not the body of the design"):
        so.shape_gradient(other, a=block)
    pieces = so.compound({"block": so.Solid(block.body), "ball": (ball, at(3.0, 0.0, 0.0))})
    answer = so.distance(pieces, ball, REST, at(0.1, 0.2, 0.9))
    with pytest.raises(StandoffError, match="compound"):
        so.shape_gradient(answer, a=block)
    box = so.distance(so.Solid(so.shapes.box(1.0, 1.0, 1.0)), ball, REST, at(0.9, 0.1, 2.0))
    with pytest.raises(StandoffError, match="has no edge"):
        so.shape_gradient(box, a=so.Design(so.shapes.sphere, radius=1.0))
