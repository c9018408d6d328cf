"""`standoff.jax.design_distance`."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import standoff.jax
from frameworks import designs
from frameworks.cases import STACKED, close
from frameworks.designs import BOX, EGG, LENS, PARAMETERS, POSES
from standoff.errors import DerivativeWarning, StandoffError

jax.config.update("jax_enable_x64", True)


def distance(params: Any, poses: Any = POSES["apart"]) -> Any:
    return standoff.jax.design_distance(LENS, EGG, *params, *poses)


@pytest.mark.parametrize("where", POSES)
def test_gradients_in_reverse_and_in_forward_mode(where: str) -> None:
    rates, differences = designs.told(where), designs.differences(where)
    reverse, by_poses = jax.jit(jax.grad(distance, (0, 1)))(PARAMETERS, POSES[where])
    forward = jax.jit(jax.jacfwd(distance))(PARAMETERS, POSES[where])
    for a, b in (reverse, forward):
        for k, name in enumerate(("radius", "offset")):
            close(a[name], np.array(rates.a[name]), 1e-15)
            close(a[name], differences[k], 1e-9)
        close(b["semi_axes"], np.array(rates.b["semi_axes"]), 1e-15)
        close(b["semi_axes"], differences[2], 1e-9)
    a, b = LENS.changed(**PARAMETERS[0]).body, EGG.changed(**PARAMETERS[1]).body
    alone = jax.grad(lambda p: standoff.jax.distance(a, b, *p))(POSES[where])
    for mine, theirs in zip(by_poses, alone, strict=True):
        close(mine, np.asarray(theirs), 1e-15)


def test_many_sets_by_vmap_and_as_arrays() -> None:
    radii, shifts = np.array([1.0, 1.1, 1.2]), np.array([0.0, 0.1, 0.2])

    def one(radius: Any, shift: Any) -> Any:
        pose = jnp.array(POSES["apart"][1]).at[0, 3].add(shift)
        return distance(({"radius": radius}, {}), (POSES["apart"][0], pose))

    def total(radii: Any, shifts: Any) -> Any:
        poses = jnp.tile(jnp.array(POSES["apart"][1]), (3, 1, 1)).at[:, 0, 3].add(shifts)
        found = distance(({"radius": radii}, {}), (POSES["apart"][0], poses))
        assert found.shape == (3,)
        return found.sum()

    slopes = jax.jit(jax.grad(one, (0, 1)))
    expected = np.array([slopes(*given) for given in zip(radii, shifts, strict=True)]).T
    close(jax.jit(jax.vmap(slopes))(radii, shifts), expected, 1e-12)
    close(jax.jit(jax.grad(total, (0, 1)))(radii, shifts), expected, 1e-12)
    # one set for all poses: the derivative is the sum of those of the rows
    same = jax.grad(lambda r: total(r, shifts))(1.1)
    close(same, sum(np.asarray(jax.grad(one)(1.1, shift)) for shift in shifts), 1e-12)


def test_a_second_derivative_is_refused() -> None:
    for order in (jax.hessian, lambda f: jax.jacfwd(jax.jacfwd(f))):
        with pytest.raises(StandoffError, match="not second ones"):
            jax.jit(order(distance))(PARAMETERS)
    with pytest.raises(StandoffError, match="not second ones"):
        jax.jacrev(jax.grad(distance, 1), 0)(PARAMETERS, POSES["apart"])


def test_undefined_derivatives_warn_or_raise() -> None:
    def stacked(size: Any, undefined: str) -> Any:
        params = {"size": size}, {}
        return standoff.jax.design_distance(
            BOX, BOX.body, *params, np.eye(4), STACKED, undefined=undefined
        )

    with pytest.warns(DerivativeWarning, match="not unique"):
        assert np.isnan(jax.grad(stacked)(np.ones(3), "nan")).all()
    with pytest.raises(Exception, match="does not have all derivatives"):
        jax.grad(stacked)(np.ones(3), "raise")
    close(stacked(np.ones(3), "raise"), 0.5, 1e-12)


def test_what_cannot_serve_is_refused() -> None:
    with pytest.raises(StandoffError, match=r"params_a\['radius'\] has dtype float32"):
        distance(({"radius": np.float32(1.0)}, {}))
    with pytest.raises(StandoffError, match="Did you mean 'radius'"):
        distance(({"radios": 1.0}, {}))
    with pytest.raises(Exception, match=r"params_a make no body: with radius = -1\.0"):
        distance(({"radius": -1.0}, {})).block_until_ready()
