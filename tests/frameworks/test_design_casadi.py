"""`standoff.casadi.design_distance`."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import standoff as so
import standoff.casadi
from frameworks import designs
from frameworks.cases import STACKED, close
from frameworks.designs import BOX, EGG, LENS, PARAMETERS, POSES
from standoff.errors import DerivativeWarning, StandoffError

DISTANCE = standoff.casadi.design_distance(LENS, EGG)
NUMBERS = {"a_radius": 1.05, "a_offset": 0.4, "b_semi_axes": PARAMETERS[1]["semi_axes"]}


def test_inputs_are_named() -> None:
    names = ["a_offset", "a_radius", "b_semi_axes", "pose_a", "pose_b"]
    assert [DISTANCE.name_in(k) for k in range(5)] == names
    assert DISTANCE.size_in("b_semi_axes") == (3, 1)


@pytest.mark.parametrize("where", POSES)
def test_jacobian(where: str) -> None:
    at = NUMBERS | dict(zip(("pose_a", "pose_b"), POSES[where], strict=True))
    close(float(DISTANCE(**at)["distance"]), designs.answer_of(where)[0].distance, 0.0)
    rates, differences = designs.told(where), designs.differences(where)
    found = DISTANCE.jacobian()(**at)
    by = [found[f"jac_distance_{name}"].full().ravel() for name in NUMBERS]
    expected = [rates.a["radius"], rates.a["offset"], rates.b["semi_axes"]]
    for part, rate, difference in zip(by, expected, differences, strict=True):
        close(part, np.ravel(rate), 1e-15)
        close(part, np.ravel(difference), 1e-9)
    a, b = LENS.changed(**PARAMETERS[0]).body, EGG.changed(**PARAMETERS[1]).body
    alone = standoff.casadi.distance(a, b).jacobian()(*POSES[where], 0.0)
    for pose, row in zip(("pose_a", "pose_b"), alone, strict=True):
        close(found[f"jac_distance_{pose}"].full(), row.full(), 1e-15)


def test_matrices_stand_in_casadi_s_order_and_longer_ones_in_numpy_s() -> None:
    corners = np.array([[1.0, 0.1, 0.0], [-0.2, 0.9, 0.1], [-0.6, -0.5, 0.2], [0.1, 0.0, 1.2]])
    ball, pose = so.shapes.sphere(0.2), so.Pose.exp([0, 0, 0], [1.5, 1.4, 1.3]).matrix
    flat = so.Design(so.shapes.polytope, vertices=corners)
    deep = so.Design(lambda v: so.shapes.polytope(v.reshape(4, 3)), v=corners.reshape(2, 2, 3))
    true = so.shape_gradient(so.distance(flat.body, ball, np.eye(4), pose), a=flat).a["vertices"]
    assert np.abs(true).max() > 0.1
    for design, given, order in ((flat, corners, "F"), (deep, corners.ravel(), "C")):
        function = standoff.casadi.design_distance(design, ball)
        x = ca.MX.sym("x", *function.size_in(0))
        row = ca.jacobian(function(x, np.eye(4), pose), x)
        found = ca.Function("j", [x], [row])(given).full().ravel()
        close(found, np.ravel(true, order=order), 1e-12)


def test_a_second_derivative_is_refused() -> None:
    radius = ca.MX.sym("r")
    value = DISTANCE(0.4, radius, PARAMETERS[1]["semi_axes"], *POSES["apart"])
    with pytest.raises(Exception, match="not second ones"):
        ca.Function("h", [radius], [ca.hessian(value, radius)[0]])(1.0)


def test_undefined_derivatives_warn_or_raise() -> None:
    size = ca.MX.sym("s", 3)
    for undefined in ("nan", "raise"):
        function = standoff.casadi.design_distance(BOX, BOX.body, undefined=undefined)
        slope = ca.Function("g", [size], [ca.gradient(function(size, np.eye(4), STACKED), size)])
        if undefined == "nan":
            with pytest.warns(DerivativeWarning, match="not unique"):
                assert np.isnan(slope(np.ones(3)).full()).all()
        else:
            with pytest.raises(RuntimeError, match="does not have all derivatives"):
                slope(np.ones(3))


def test_what_cannot_serve_is_refused() -> None:
    odd = so.Design(lambda a__b: so.shapes.sphere(a__b), a__b=1.0)
    with pytest.raises(StandoffError, match="name = 'a_a__b'"):
        standoff.casadi.design_distance(odd, EGG)
    with pytest.raises(TypeError, match="design_a = 1"):
        standoff.casadi.design_distance(1, EGG)  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="params_a make no body"):
        DISTANCE(0.4, -1.0, np.ones(3), *POSES["apart"])
