"""`standoff.jax`: every order and mode of JAX's differentiation."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import standoff as so
import standoff.jax
from frameworks import cases
from frameworks.cases import (
    APART,
    AXES,
    BOX,
    ELLIPSOID,
    INSIDE,
    LENS,
    LOST,
    STACKED,
    close,
    differences,
)
from standoff.errors import DerivativeWarning, StandoffError

jax.config.update("jax_enable_x64", True)


def pose(q: Any) -> Any:
    """The matrix of a rotation vector (not zero) and a position."""
    angle = jnp.sqrt(q[:3] @ q[:3])
    x, y, z = q[:3] / angle
    k = jnp.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = jnp.eye(3) + jnp.sin(angle) * k + (1 - jnp.cos(angle)) * k @ k
    return jnp.block([[turn, q[3:, None]], [jnp.zeros((1, 3)), jnp.ones((1, 1))]])


def distance(q: Any) -> Any:
    return standoff.jax.distance(LENS, ELLIPSOID, pose(q[:6]), pose(q[6:]))


DERIVED = jax.jit(lambda q: (jax.grad(distance)(q), jax.hessian(distance)(q)))


@pytest.mark.parametrize("q", [APART, INSIDE], ids=["apart", "overlap"])
def test_gradient_and_hessian_through_a_formula_of_the_poses(q: np.ndarray) -> None:
    gradient, hessian = differences(q)
    found = DERIVED(q)
    close(found[0], gradient, 1e-8)
    close(found[1], hessian, 1e-5)


def test_a_closed_formula_has_the_same_derivatives() -> None:
    """Over a plane: height of the centre less the ellipsoid's reach."""
    ground = so.shapes.halfspace()
    first = cases.pose(APART[6:])

    def turned(q: Any) -> Any:
        (c, d), (s, t) = jnp.cos(q), jnp.sin(q)
        way = [[c, -s * d, s * t, 2 * s], [s, c * d, -c * t, d], [0, t, d, c * d], [0, 0, 0, 1]]
        return jnp.array(way) @ first

    def formula(q: Any) -> Any:
        body = turned(q)
        return body[2, 3] - jnp.sqrt(((AXES * body[2, :3]) ** 2).sum())

    def orders(f: Any) -> Any:
        q = np.array([0.3, 0.5])
        return jax.jit(lambda q: (f(q), jax.grad(f)(q), jax.hessian(f)(q)))(q)

    found = orders(lambda q: standoff.jax.distance(ground, ELLIPSOID, np.eye(4), turned(q)))
    for mine, theirs in zip(found, orders(formula), strict=True):
        close(mine, theirs, 1e-13)


def test_every_order_of_forward_and_reverse_gives_one_hessian() -> None:
    modes = (jax.jacfwd, jax.jacrev)

    def entries(matrix: Any) -> Any:
        return standoff.jax.distance(LENS, ELLIPSOID, np.eye(4), matrix)

    at = STACKED + 0.0
    found = [jax.jit(outer(inner(entries)))(at) for outer in modes for inner in modes]
    assert np.abs(found[0]).max() > 0.1
    for hessian in found[1:]:
        close(hessian, found[0], 1e-14)


def test_many_poses_by_vmap_and_as_an_array(rng: np.random.Generator) -> None:
    q = APART + 0.1 * rng.normal(size=(5, 12))
    gradient = jax.jit(jax.grad(distance))
    one_by_one = np.array([gradient(row) for row in q])
    close(jax.jit(jax.vmap(jax.grad(distance)))(q), one_by_one, 1e-13)

    def total(q: Any) -> Any:
        poses = jax.vmap(pose)(q[:, 6:])
        found = standoff.jax.distance(LENS, ELLIPSOID, pose(APART[:6]), poses)
        assert found.shape == (5,)
        return found.sum()

    fixed = np.hstack([np.tile(APART[:6], (5, 1)), q[:, 6:]])
    expected = np.array([gradient(row)[6:] for row in fixed])
    close(jax.jit(jax.grad(total))(fixed)[:, 6:], expected, 1e-13)


def test_undefined_derivatives_warn_or_raise() -> None:
    def stacked(p: Any, undefined: str) -> Any:
        return standoff.jax.distance(BOX, BOX, np.eye(4), p, undefined=undefined)

    def shifted(p: Any) -> Any:
        return stacked(jnp.eye(4).at[:3, 3].set(p), "nan")

    found = []
    for order in (jax.grad, jax.hessian):
        asked = jax.jit(order(stacked), static_argnums=1)
        with pytest.warns(DerivativeWarning, match="not unique"):
            found.append(np.array(asked(STACKED, "nan")))
    np.testing.assert_array_equal(np.isnan(found[0]), LOST)
    assert np.isnan(found[1][..., :3, :]).all()
    with pytest.warns(DerivativeWarning, match="not unique"):
        close(jax.grad(shifted)(jnp.array([0.0, 0.0, 1.5])), np.array([0.0, 0.0, 1.0]), 1e-15)
    with pytest.raises(Exception, match="does not have all derivatives: the witness points"):
        jax.grad(stacked)(STACKED, "raise")
    close(stacked(STACKED, "raise"), 0.5, 1e-12)


def test_a_third_derivative_is_refused() -> None:
    def entries(matrix: Any) -> Any:
        return standoff.jax.distance(LENS, ELLIPSOID, np.eye(4), matrix)

    with pytest.raises(StandoffError, match="not third ones"):
        jax.jit(jax.jacfwd(jax.hessian(entries)))(STACKED)


def test_single_precision_is_refused() -> None:
    with pytest.raises(StandoffError, match=r"pose_b has dtype float32: give float64"):
        standoff.jax.distance(LENS, ELLIPSOID, np.eye(4), np.eye(4, dtype=np.float32))
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(StandoffError, match="jax_enable_x64"):
            standoff.jax.distance(LENS, ELLIPSOID, np.eye(4), np.eye(4))
    finally:
        jax.config.update("jax_enable_x64", True)


def test_a_matrix_that_is_no_pose_is_named() -> None:
    with pytest.raises(Exception, match="the last row of a homogeneous matrix"):
        standoff.jax.distance(LENS, ELLIPSOID, np.eye(4), 2.0 * np.eye(4)).block_until_ready()


@pytest.mark.parametrize(
    ("module", "extra"), [("jax", "jax"), ("torch", "torch"), ("casadi", "casadi")]
)
def test_a_framework_that_is_missing_is_named_with_its_extra(module: str, extra: str) -> None:
    code = f"import sys; sys.modules[{module!r}] = None; import standoff.{module}"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert f"pip install 'standoff[{extra}]'" in ended.stderr
