"""Signed distances in JAX, with exact derivatives (docs/differentiable.md, docs/design.md)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.design import Design
from standoff.errors import StandoffError, of_extra
from standoff.frameworks import ambient, designed

with of_extra("JAX", "jax"):
    import jax
    import jax.numpy as jnp

__all__ = ["design_distance", "distance"]

KEPT = 64
"""Pairs of bodies or designs whose functions are kept, so that jit knows them again."""


def distance(a: Body, b: Body, pose_a: Any, pose_b: Any, *, undefined: str = "nan") -> Any:
    """The signed minimum distance of two bodies, as a differentiable function of their poses.

    Works under ``jit``, ``vmap``, ``grad``, ``jvp`` and ``hessian``. The bodies are constants:
    close over them.

    Raises StandoffError if 64-bit numbers are not enabled, or an argument is not a body, not
    float64 or not shaped like poses. At run time, within JAX's own error: a matrix that is not a
    pose; undefined derivatives, if asked.

    Parameters
    ----------
    a, b : Body
    pose_a, pose_b : array, shape (4, 4) or (n, 4, 4)
        World poses, float64; one pose is used for all n of the other body.
    undefined : "nan" or "raise"
        Where a derivative, or a part of it, is not defined: nan with a `DerivativeWarning`, or an
        error.

    Returns
    -------
    array, shape () or (n,)
        Its gradient by a matrix is that of the distance at the nearest pose.
    """
    pair = ambient.AmbientPair.of(a, b, undefined)
    poses = [_float64(pose_a, "pose_a"), _float64(pose_b, "pose_b")]
    lead = ambient.lead_of(*(pose.shape for pose in poses))
    return _function(pair)(*(jnp.broadcast_to(pose, (*lead, 4, 4)) for pose in poses))


def design_distance(
    design_a: Design | Body,
    design_b: Design | Body,
    params_a: Mapping[str, Any],
    params_b: Mapping[str, Any],
    pose_a: Any,
    pose_b: Any,
    *,
    undefined: str = "nan",
) -> Any:
    """The signed minimum distance of two designed bodies, as a differentiable function of their
    parameters and poses (docs/design.md).

    Works under ``jit``, ``vmap``, ``grad`` and ``jvp``, once: it has no second derivatives.

    Raises StandoffError if 64-bit numbers are not enabled, or an argument is not a design, not
    float64, not one of the parameters or not of its shape. At run time, within JAX's own error:
    parameters that make no body; a matrix that is not a pose; undefined derivatives, if asked. A
    second derivative.

    Parameters
    ----------
    design_a, design_b : Design or Body
        A body, with ``{}`` for its parameters, does not change.
    params_a, params_b : dict of str to array
        Float64, each in the shape of the design's parameter, or with n sets in front. Parameters
        that are left out keep the design's values.
    pose_a, pose_b : array, shape (4, 4) or (n, 4, 4)
        World poses, float64; one pose, or one set of parameters, is used for all n rows.
    undefined : "nan" or "raise"
        As in `distance`. In flat and line contact derivatives by parameters are not defined.

    Returns
    -------
    array, shape () or (n,)
    """
    params = params_a, params_b
    designs = designed.Designs.of(design_a, design_b, params, undefined)
    arrays = designs.arrays(params, (pose_a, pose_b))
    given = [_float64(x, label) for x, label in zip(arrays, designs.labels, strict=True)]
    lead = designs.lead([x.shape for x in given])
    rows = zip(given, designs.shapes, strict=True)
    return _design_function(designs)(*(jnp.broadcast_to(x, (*lead, *own)) for x, own in rows))


def _float64(value: Any, name: str) -> Any:
    if not jax.config.jax_enable_x64:
        raise StandoffError(
            "JAX computes in 32 bits: call jax.config.update('jax_enable_x64', True) before "
            "anything else."
        )
    array = jnp.asarray(value)
    if array.dtype != jnp.float64:
        raise StandoffError(
            f"{name} has dtype {array.dtype}: give float64, in which rotations are exact enough.",
            name,
        )
    return array


def _called(of: Any, lead: Any, shapes: Any, *given: Any) -> Any:
    """One call of NumPy's side, with the shapes of its first arrays in one row."""
    told = tuple(jax.ShapeDtypeStruct((*lead, *shape), jnp.float64) for shape in shapes)

    def rows(*given: Any) -> Any:
        return tuple(of(*(np.asarray(x, dtype=float) for x in given)))

    return jax.pure_callback(rows, told, *given, vmap_method="broadcast_all")


def _alone(of: Any) -> Any:
    """The same function, with its array in a tuple."""
    return lambda *given: (of(*given),)


@lru_cache(maxsize=KEPT)
def _function(pair: ambient.AmbientPair) -> Any:
    """The distance of a pair, with its rules of differentiation."""

    def called(of: Any, parts: int, *poses: Any) -> Any:
        """One call of NumPy's side, with the shapes of its first `parts` arrays."""
        shapes = ((), (2, 4, 4), (2, 4, 4, 2, 4, 4))[:parts]
        return _called(partial(of, pair), poses[0].shape[:-2], shapes, *poses)

    @jax.custom_jvp
    def value(pose_a: Any, pose_b: Any) -> Any:
        return called(_alone(ambient.value), 1, pose_a, pose_b)[0]

    @jax.custom_jvp
    def first(pose_a: Any, pose_b: Any) -> Any:
        return called(ambient.first, 2, pose_a, pose_b)

    @jax.custom_jvp
    def second(pose_a: Any, pose_b: Any) -> Any:
        return called(ambient.second, 3, pose_a, pose_b)

    @value.defjvp
    def _(poses: Any, tangents: Any) -> Any:
        found, gradient = first(*poses)
        return found, (gradient * jnp.stack(tangents, axis=-3)).sum((-3, -2, -1))

    @first.defjvp
    def _(poses: Any, tangents: Any) -> Any:
        found, gradient, hessian = second(*poses)
        moved = jnp.stack(tangents, axis=-3)
        bent = (hessian * moved[..., None, None, None, :, :, :]).sum((-3, -2, -1))
        return (found, gradient), ((gradient * moved).sum((-3, -2, -1)), bent)

    @second.defjvp
    def _(poses: Any, tangents: Any) -> Any:
        raise StandoffError(ambient.NO_THIRD)

    return value


@lru_cache(maxsize=KEPT)
def _design_function(designs: designed.Designs) -> Any:
    """The distance of two designs by the arrays of their labels, with its rule of
    differentiation."""
    shapes = designs.shapes

    def lead_of(given: Any) -> Any:
        return given[-1].shape[: -len(designed.POSE)]

    def gradients(*given: Any) -> Any:
        found = designed.first(designs, *given)
        return found.distance, *found.gradients

    @jax.custom_jvp
    def value(*given: Any) -> Any:
        of = _alone(partial(designed.value, designs))
        return _called(of, lead_of(given), ((),), *given)[0]

    @jax.custom_jvp
    def first(*given: Any) -> Any:
        return _called(gradients, lead_of(given), ((), *shapes), *given)

    @value.defjvp
    def _(given: Any, tangents: Any) -> Any:
        found, *slopes = first(*given)
        rows = zip(slopes, tangents, shapes, strict=True)
        moved = [(s * t).sum(tuple(range(-len(own), 0))) for s, t, own in rows]
        return found, sum(moved)

    @first.defjvp
    def _(given: Any, tangents: Any) -> Any:
        raise StandoffError(designed.NO_SECOND)

    return value
