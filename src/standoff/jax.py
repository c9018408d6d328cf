"""Signed distances in JAX, with exact first and second derivatives (docs/differentiable.md)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError, not_installed
from standoff.frameworks import ambient

try:
    import jax
    import jax.numpy as jnp
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("JAX", "jax"), name=error.name) from error

__all__ = ["distance"]

KEPT = 64
"""Pairs of bodies whose functions are kept, so that jit knows them again."""


def distance(a: Body, b: Body, pose_a: Any, pose_b: Any, *, undefined: str = "nan") -> Any:
    """The signed minimum distance of two bodies, as a differentiable function of their poses.

    Works under ``jit``, ``vmap``, ``grad``, ``jvp`` and ``hessian``. The bodies are constants:
    close over them.

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

    Raises
    ------
    StandoffError
        If 64-bit numbers are not enabled, or an argument is not a body, not float64 or not shaped
        like poses. At run time, within JAX's own error: a matrix that is not a pose; undefined
        derivatives, if asked.
    """
    pair = ambient.Pair.of(a, b, undefined)
    if not jax.config.jax_enable_x64:
        raise StandoffError(
            "JAX computes in 32 bits: call jax.config.update('jax_enable_x64', True) before "
            "anything else."
        )
    poses = [_matrix(pose_a, "pose_a"), _matrix(pose_b, "pose_b")]
    lead = ambient.lead_of(*(pose.shape for pose in poses))
    return _function(pair)(*(jnp.broadcast_to(pose, (*lead, 4, 4)) for pose in poses))


def _matrix(pose: Any, name: str) -> Any:
    array = jnp.asarray(pose)
    if array.dtype != jnp.float64:
        raise StandoffError(
            f"{name} has dtype {array.dtype}: give float64, in which rotations are exact enough.",
            name,
        )
    return array


@lru_cache(maxsize=KEPT)
def _function(pair: ambient.Pair) -> Any:
    """The distance of a pair, with its rules of differentiation."""

    def called(of: Any, parts: int, *poses: Any) -> Any:
        """One call of NumPy's side, with the shapes of its first `parts` arrays."""
        lead = poses[0].shape[:-2]
        shapes = ((), (2, 4, 4), (2, 4, 4, 2, 4, 4))[:parts]
        told = tuple(jax.ShapeDtypeStruct((*lead, *shape), jnp.float64) for shape in shapes)

        def rows(*given: Any) -> Any:
            found = of(pair, *(np.asarray(x, dtype=float) for x in given))
            return tuple(found) if isinstance(found, tuple) else (found,)

        return jax.pure_callback(rows, told, *poses, vmap_method="broadcast_all")

    @jax.custom_jvp
    def value(pose_a: Any, pose_b: Any) -> Any:
        return called(ambient.value, 1, pose_a, pose_b)[0]

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
