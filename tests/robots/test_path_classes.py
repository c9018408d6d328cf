"""Paths are read by their class: what SciPy means by them, or refused; and bases that turn."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.interpolate import BPoly, BSpline, CubicSpline, NdPPoly, PPoly, make_interp_spline

import standoff as so
from robots.arms import arm
from standoff.robots.motions import motions_of
from standoff.robots.paths import FunctionPath, joint_path
from standoff_studies.soak import robot_paths

ARM = arm(np.random.default_rng(0), joints=2, obstacles=2)
KNOTS = [0.0, 0.7, 1.5, 3.0]
POINTS = np.random.default_rng(1).uniform(-1.0, 1.0, (4, 2))
KEPT = CubicSpline(KNOTS, POINTS)


def bspline(degree: int, times: list[float]) -> BSpline:
    """With repeated knots within."""
    knots = [0.0] * (degree + 1) + times + [3.0] * (degree + 1)
    values = np.random.default_rng(degree).uniform(-1.0, 1.0, (len(knots) - degree - 1, 2))
    return BSpline(knots, values, degree)


READ = {
    "CubicSpline": KEPT,
    "axis 1": CubicSpline(KNOTS, POINTS.T, axis=1),
    "B-spline of axis 1": make_interp_spline(KNOTS, POINTS.T, axis=1),
    "as many points as joints": make_interp_spline([0.0, 1.0], POINTS[:2].T, k=1, axis=1),
    "periodic": CubicSpline(KNOTS, [*POINTS[:3], POINTS[0]], bc_type="periodic"),
    "without extrapolation": PPoly(KEPT.c, KEPT.x, extrapolate=False),
    "Bernstein": BPoly.from_derivatives(KNOTS, np.stack([POINTS, POINTS[::-1]], axis=1)),
    "Bernstein of powers": BPoly.from_power_basis(KEPT),
    "double knot": bspline(3, [1.0, 1.0, 2.0]),
    "triple knot": bspline(3, [1.0, 1.0, 1.0]),
    "lines": bspline(1, [1.0, 2.0]),
    "degree 5": bspline(5, [1.0, 1.0, 1.0, 1.0, 1.0, 2.0]),
    "integers": PPoly(np.array([[[1, 0]], [[0, 1]]]), [0, 1]),
}


@pytest.mark.parametrize("name", READ)
def test_splines_are_where_scipy_has_them(name: str) -> None:
    path = joint_path(READ[name], ARM.kinematics)
    times = np.linspace(path.start, path.end, 500)[:-1]
    theirs = np.asarray(READ[name](times))
    theirs = theirs.T if getattr(READ[name], "axis", 0) == 1 else theirs
    assert np.abs(path.at(times) - theirs).max() <= 1e-13
    speeds = np.abs(np.diff(path.at(times), axis=0)).max(axis=0) / (times[1] - times[0])
    assert (path.piece_speeds.max(axis=0) >= speeds * (1.0 - 1e-9)).all()


FALLING = CubicSpline(KNOTS, POINTS)
FALLING.x = FALLING.x[::-1]
REFUSED = {
    "falling": (FALLING, r"times fall, from 3.0 to 1.5: give one whose"),
    "falling by class": (PPoly(KEPT.c, [3.0, 2.0, 1.0, 0.0]), "times fall, from 3.0 to 2.0"),
    "complex": (PPoly(KEPT.c * 1j, KEPT.x), "complex128: give real ones"),
    "a jump": (bspline(3, [1.0] * 4), r"jumps by .* at 1.0 s"),
    "a jump of lines": (bspline(1, [1.0, 1.0]), r"jumps by .* at 1.0 s"),
    "of several variables": (
        NdPPoly(np.zeros((2, 2, 1, 1, 2)), ([0, 1], [0, 1])),
        "greatest speed",
    ),
    "no class": (type("Like", (), {"x": KEPT.x, "c": KEPT.c})(), "not numeric"),
    "a number": (CubicSpline(KNOTS, POINTS[:, 0]), r"shape \(\): give one of \(2,\)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_none_of_them_is_refused(name: str) -> None:
    path, said = REFUSED[name]
    with pytest.raises(so.StandoffError, match=said):
        ARM.certify(path)


def planar(post: tuple[float, float]) -> so.Robot:
    """A ball on a planar joint, beside a post."""
    coal, pin = pytest.importorskip("coal"), pytest.importorskip("pinocchio")
    model, geometry = pin.Model(), pin.GeometryModel()
    base = model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "base")
    for name, joint, at in (("post", 0, (*post, 0.0)), ("ball", base, (0.0, 0.0, 0.0))):
        place = pin.SE3(np.eye(3), np.array(at))
        geometry.addGeometryObject(pin.GeometryObject(name, joint, place, coal.Sphere(0.1)))
    geometry.addCollisionPair(pin.CollisionPair(0, 1))
    return so.Robot.from_pinocchio(model, geometry)


@pytest.mark.parametrize("angle", [0.6, 1.5, 2.7])
def test_a_planar_base_goes_along_pinocchio_s_arc(angle: float) -> None:
    """From (0, 0) to (2, 0), turned left by half a turn: below, on a circle about (1, 0)."""
    start, stop = [0.0, 0.0, 1.0, 0.0], [2.0, 0.0, -1.0, 1e-12]
    for radius in (1.0, 1.26, 0.74):
        for side in (1.0, -1.0):
            at = 1.0 - radius * np.cos(angle), side * radius * np.sin(angle)
            proof = planar(at).certify([start, stop], clearance=0.05)
            wanted = "VIOLATED" if radius == 1.0 and side < 0.0 else "PROVEN"
            assert proof.verdict.name == wanted


def test_a_function_s_speeds_are_those_of_the_package_s_velocity() -> None:
    """A base that drives forward and turns: its x and y are as fast as it drives, its v_y is 0."""
    robot = planar((0.0, 2.0))

    def drives(time: float) -> list[float]:  # along a circle of radius 1, about (0, 1)
        angle = np.sin(time)
        return [np.sin(angle), 1.0 - np.cos(angle), np.cos(angle), np.sin(angle)]

    for acceleration in (None, [1.0, 0.0, 1.0]):
        path = FunctionPath(drives, 3.0, [1.0, 0.0, 1.0], acceleration)
        assert robot.certify(path, clearance=1.5).verdict.name == "PROVEN"
        assert robot.certify(path, clearance=1.6).verdict.name == "VIOLATED"

    def winds(time: float) -> list[float]:  # as fast, and its heading is sin(3 t)
        way = quad_vec(lambda t: np.array([np.cos(np.sin(3 * t)), np.sin(np.sin(3 * t))]), 0, time)
        return [*way[0], np.cos(np.sin(3 * time)), np.sin(np.sin(3 * time))]

    assert robot.certify(FunctionPath(winds, 1.0, [1.0, 0.0, 3.0]), 0.2).verdict.name == "PROVEN"
    slow = FunctionPath(drives, 3.0, [0.9, 0.0, 1.0])
    with pytest.raises(so.StandoffError, match=r"velocity 0 to 1 is .* given as 0.9"):
        robot.certify(slow)
    with pytest.raises(so.StandoffError, match=r"velocity 2 is .* given as 0.5"):
        robot.certify(FunctionPath(drives, 3.0, [1.0, 0.0, 0.5]))


def test_a_base_goes_no_farther_at_least_than_along_the_line() -> None:
    """What drives straight and then turns has gone less than along Pinocchio's arc between both."""
    robot = planar((0.0, 2.0))
    start, stop = np.array([0.0, 0.0, 1.0, 0.0]), np.array([1.0, 0.0, np.cos(2.5), np.sin(2.5)])
    way = robot.kinematics.difference(start, stop)
    assert np.linalg.norm(way[:2]) > 1.3
    ways = motions_of(robot.joints).least_ways(np.array([start, stop]), way[None])
    assert ways[0] == pytest.approx([1.0, 0.0, 2.5])


@pytest.mark.parametrize(
    "count", [pytest.param(30, id="some"), pytest.param(600, marks=pytest.mark.soak)]
)
def test_no_proof_is_contradicted_by_the_package_s_own_interpolation(count: int) -> None:
    pytest.importorskip("pinocchio")
    pytest.importorskip("mujoco")
    found = [case for k in range(count) for case in robot_paths.cases_of(2, k)]
    assert not [case for case in found if case.wrong]
    verdicts = [case.verdict for case in found]
    assert min(verdicts.count("PROVEN"), verdicts.count("VIOLATED")) > count // 2
    assert verdicts.count("UNDECIDED") <= count // 20
