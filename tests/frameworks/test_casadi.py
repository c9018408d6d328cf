"""`standoff.casadi`: a function with exact Jacobian and Hessian."""

from __future__ import annotations

import gc
from typing import Any

import casadi as ca
import numpy as np
import pytest

import standoff.casadi
from frameworks import cases
from frameworks.cases import APART, BOX, ELLIPSOID, INSIDE, LENS, LOST, STACKED, close, differences
from standoff.errors import DerivativeWarning, StandoffError

DISTANCE = standoff.casadi.distance(LENS, ELLIPSOID)


def pose(q: Any) -> Any:
    """The matrix of a rotation vector (not zero) and a position."""
    angle = ca.norm_2(q[:3])
    k = ca.skew(q[:3] / angle)
    turn = ca.MX.eye(3) + ca.sin(angle) * k + (1 - ca.cos(angle)) * ca.mtimes(k, k)
    return ca.vertcat(ca.horzcat(turn, q[3:]), ca.DM([[0, 0, 0, 1]]))


def derived(function: Any, size: int) -> Any:
    """CasADi's own Hessian and gradient of a function of a vector."""
    q = ca.MX.sym("q", size)
    return ca.Function("derived", [q], ca.hessian(function(q), q))


@pytest.mark.parametrize("q", [APART, INSIDE], ids=["apart", "overlap"])
def test_gradient_and_hessian_through_a_formula_of_the_poses(q: np.ndarray) -> None:
    gradient, hessian = differences(q)
    found = derived(lambda q: DISTANCE(pose(q[:6]), pose(q[6:])), 12)(q)
    close(found[1].full().ravel(), gradient, 1e-8)
    close(found[0].full(), hessian, 1e-5)


def test_entries_stand_in_casadi_s_order() -> None:
    """By columns; a Jacobian's forward and reverse products are those of the whole."""
    matrix = ca.MX.sym("m", 4, 4)
    value = DISTANCE(ca.DM.eye(4), matrix)
    place = cases.pose(APART[6:])
    row = ca.Function("j", [matrix], [ca.jacobian(value, matrix)])(place).full()
    by_entry = ca.Function("g", [matrix], [ca.gradient(value, matrix)])(place).full()
    close(row.reshape(4, 4).T, by_entry, 1e-15)
    seed = np.zeros((4, 4))
    seed[0, 3] = 1.0
    push = ca.Function("f", [matrix], [ca.jtimes(value, matrix, ca.DM(seed))])(place)
    close(float(push), by_entry[0, 3], 1e-15)
    assert by_entry[3].tolist() == [0.0] * 4


def test_map_gives_many_poses(rng: np.random.Generator) -> None:
    q = APART[6:] + 0.1 * rng.normal(size=(3, 6))

    def total(q: Any) -> Any:
        many = DISTANCE.map("many", "serial", 3, [0], [])
        poses = ca.horzcat(*(pose(q[6 * k : 6 * k + 6]) for k in range(3)))
        return ca.sum2(many(pose(ca.MX(APART[:6])), poses))

    hessian, gradient = derived(total, 18)(q.ravel())
    one = derived(lambda x: DISTANCE(pose(ca.MX(APART[:6])), pose(x)), 6)
    for k in range(3):
        here = slice(6 * k, 6 * k + 6)
        close(hessian.full()[here, here], one(q[k])[0].full(), 1e-13)
        close(gradient.full().ravel()[here], one(q[k])[1].full().ravel(), 1e-13)


def test_undefined_derivatives_warn_or_raise() -> None:
    matrix = ca.MX.sym("m", 4, 4)
    for undefined in ("nan", "raise"):
        function = standoff.casadi.distance(BOX, BOX, undefined=undefined)
        value = function(ca.DM.eye(4), matrix)
        close(float(ca.Function("v", [matrix], [value])(STACKED)), 0.5, 1e-12)
        slope = ca.Function("g", [matrix], [ca.gradient(value, matrix)])
        if undefined == "nan":
            with pytest.warns(DerivativeWarning, match="not unique"):
                found = slope(STACKED).full()
            np.testing.assert_array_equal(np.isnan(found), LOST)
        else:
            with pytest.raises(RuntimeError, match="does not have all derivatives"):
                slope(STACKED)
    shift = ca.MX.sym("p", 3)
    moved = ca.vertcat(ca.horzcat(ca.MX.eye(3), shift), ca.DM([[0, 0, 0, 1]]))
    value = standoff.casadi.distance(BOX, BOX)(ca.DM.eye(4), moved)
    slope = ca.Function("g", [shift], [ca.gradient(value, shift)])
    with pytest.warns(DerivativeWarning, match="not unique"):
        close(slope([0.0, 0.0, 1.5]).full().ravel(), np.array([0.0, 0.0, 1.0]), 1e-15)


def test_a_third_derivative_is_refused() -> None:
    q = ca.MX.sym("q", 6)
    hessian, _ = ca.hessian(DISTANCE(ca.DM.eye(4), pose(q)), q)
    with pytest.raises(Exception, match="not third ones"):
        ca.Function("t", [q], [ca.jacobian(hessian, q)])(APART[6:])


def test_an_expression_outlives_the_name_of_its_function() -> None:
    matrix = ca.MX.sym("m", 4, 4)
    value = standoff.casadi.distance(LENS, ELLIPSOID, name="kept")(ca.DM.eye(4), matrix)
    gc.collect()
    slope = ca.Function("g", [matrix], [value, ca.gradient(value, matrix)])
    gc.collect()
    assert np.isfinite(slope(STACKED)[1].full()).all()


def test_what_cannot_serve_is_refused() -> None:
    with pytest.raises(StandoffError, match="name = 'a b': give a letter"):
        standoff.casadi.distance(LENS, ELLIPSOID, name="a b")
    with pytest.raises(TypeError, match="a = 1 is not a body"):
        standoff.casadi.distance(1, ELLIPSOID)  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="the last row of a homogeneous matrix"):
        DISTANCE(np.eye(4), 2.0 * np.eye(4))
