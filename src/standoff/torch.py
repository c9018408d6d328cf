"""Signed distances in PyTorch, with exact derivatives (docs/differentiable.md, docs/design.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.design import Design
from standoff.errors import StandoffError, StandoffTypeError, of_extra
from standoff.frameworks import ambient, designed

with of_extra("PyTorch", "torch"):
    import torch

__all__ = ["design_distance", "distance"]


def distance(a: Body, b: Body, pose_a: Any, pose_b: Any, *, undefined: str = "nan") -> Any:
    """The signed minimum distance of two bodies, as a differentiable function of their poses.

    Works with ``backward``, ``autograd.grad(..., create_graph=True)``, and ``torch.func``'s
    ``grad``, ``jacrev`` and ``vmap``; in forward mode (``jvp``, ``jacfwd``) it does not.

    Raises TypeError: no bodies, or no tensors. Raises StandoffError: tensors of another type,
    device or shape; a matrix that is not a pose. In ``backward``: undefined derivatives, if asked;
    a third derivative.

    Parameters
    ----------
    a, b : Body
    pose_a, pose_b : Tensor, shape (4, 4) or (n, 4, 4)
        World poses, float64 on the CPU; one pose is used for all n of the other body.
    undefined : "nan" or "raise"
        Where a derivative, or a part of it, is not defined: nan with a `DerivativeWarning`, or an
        error.

    Returns
    -------
    Tensor, shape () or (n,)
        Its gradient by a matrix is that of the distance at the nearest pose.
    """
    pair = ambient.AmbientPair.of(a, b, undefined)
    _check(pose_a, "pose_a")
    _check(pose_b, "pose_b")
    lead = ambient.lead_of(tuple(pose_a.shape), tuple(pose_b.shape))
    return _Value.apply(*(pose.expand(*lead, 4, 4) for pose in (pose_a, pose_b)), pair)


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

    Works with ``backward``, and ``torch.func``'s ``grad``, ``jacrev`` and ``vmap``, once: it has no
    second derivatives.

    Raises TypeError: no designs, or no tensors. Raises StandoffError: an unknown parameter; tensors
    of another type, device or shape; parameters that make no body; a matrix that is not a pose. In
    ``backward``: undefined derivatives, if asked; a second derivative.

    Parameters
    ----------
    design_a, design_b : Design or Body
        A body, with ``{}`` for its parameters, does not change.
    params_a, params_b : dict of str to Tensor
        Float64 on the CPU, each in the shape of the design's parameter, or with n sets in front.
        Parameters that are left out keep the design's values.
    pose_a, pose_b : Tensor, shape (4, 4) or (n, 4, 4)
        World poses, float64; one pose, or one set of parameters, is used for all n rows.
    undefined : "nan" or "raise"
        As in `distance`. In flat and line contact derivatives by parameters are not defined.

    Returns
    -------
    Tensor, shape () or (n,)
    """
    params = params_a, params_b
    designs = designed.Designs.of(design_a, design_b, params, undefined)
    given = designs.arrays(params, (pose_a, pose_b))
    for tensor, label in zip(given, designs.labels, strict=True):
        _check(tensor, label)
    lead = designs.lead([tuple(x.shape) for x in given])
    rows = zip(given, designs.shapes, strict=True)
    return _DesignValue.apply(designs, *(x.expand((*lead, *own)) for x, own in rows))


def _check(value: Any, name: str) -> None:
    if not isinstance(value, torch.Tensor):
        raise StandoffTypeError(
            f"{name} = {shown(value)} is not a tensor: give torch.as_tensor(...).", name, value
        )
    if value.dtype != torch.float64:
        raise StandoffError(
            f"{name} has dtype {value.dtype}: give torch.float64, in which rotations are exact "
            "enough.",
            name,
        )
    if value.device.type != "cpu":
        raise StandoffError(
            f"{name} is on {value.device}: distances are computed on the CPU; give {name}.cpu().",
            name,
        )


def _numbers(of: Any, poses: Any, pair: ambient.AmbientPair) -> Any:
    found = of(pair, *(pose.detach().numpy() for pose in poses))
    # Copies: answers are read-only arrays, which PyTorch does not know.
    if isinstance(found, tuple):
        return tuple(torch.tensor(part) for part in found)
    return torch.tensor(found)


class _Rule(torch.autograd.Function):  # type: ignore[misc]
    """What the three orders have in common: inputs kept, and a batch moved to the front."""

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        pose_a, pose_b, ctx.pair = inputs
        ctx.save_for_backward(pose_a, pose_b)

    @classmethod
    def batched(cls, size: int, in_dims: Any, poses: Any, pair: ambient.AmbientPair) -> Any:
        return cls.apply(*_fronts(size, in_dims, poses), pair), 0


def _fronts(size: int, in_dims: Any, given: Any) -> list[Any]:
    """Tensors with the batch in front."""
    return [
        x.expand(size, *x.shape) if at is None else x.movedim(at, 0)
        for x, at in zip(given, in_dims, strict=False)
    ]


class _Value(_Rule):
    """(...) distances."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _numbers(ambient.value, (pose_a, pose_b), pair)

    @staticmethod
    def backward(ctx: Any, by_value: Any) -> Any:
        gradient = _Gradient.apply(*ctx.saved_tensors, ctx.pair)
        moved = by_value[..., None, None, None] * gradient
        return moved[..., 0, :, :], moved[..., 1, :, :], None

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _Value.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)


class _Gradient(_Rule):
    """(..., 2, 4, 4) gradients."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _numbers(ambient.first, (pose_a, pose_b), pair)[1]

    @staticmethod
    def backward(ctx: Any, by_gradient: Any) -> Any:
        hessian = _Hessian.apply(*ctx.saved_tensors, ctx.pair)
        moved = (hessian * by_gradient[..., None, None, None]).sum((-6, -5, -4))
        return moved[..., 0, :, :], moved[..., 1, :, :], None

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _Gradient.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)


class _Hessian(_Rule):
    """(..., 2, 4, 4, 2, 4, 4) Hessians, and no derivative of theirs."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _numbers(ambient.second, (pose_a, pose_b), pair)[2]

    @staticmethod
    def backward(ctx: Any, by_hessian: Any) -> Any:
        raise StandoffError(ambient.NO_THIRD)

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.AmbientPair) -> Any:
        return _Hessian.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)


class _DesignRule(torch.autograd.Function):  # type: ignore[misc]
    """What the distance of two designs and its gradients have in common."""

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.designs, *given = inputs
        ctx.save_for_backward(*given)


class _DesignValue(_DesignRule):
    """(...) distances."""

    @staticmethod
    def forward(designs: designed.Designs, *given: Any) -> Any:
        return torch.tensor(designed.value(designs, *_arrays(given)))

    @staticmethod
    def backward(ctx: Any, by_value: Any) -> Any:
        gradients = _DesignGradients.apply(ctx.designs, *ctx.saved_tensors)
        rows = zip(gradients, ctx.designs.shapes, strict=True)
        return None, *(x * by_value[(..., *(None,) * len(own))] for x, own in rows)

    @staticmethod
    def vmap(info: Any, in_dims: Any, designs: designed.Designs, *given: Any) -> Any:
        return _DesignValue.apply(designs, *_fronts(info.batch_size, in_dims[1:], given)), 0


class _DesignGradients(_DesignRule):
    """Gradients by all that was given, in its shapes, and no derivatives of theirs."""

    @staticmethod
    def forward(designs: designed.Designs, *given: Any) -> Any:
        found = designed.first(designs, *_arrays(given))
        return tuple(torch.tensor(x) for x in found.gradients)

    @staticmethod
    def backward(ctx: Any, *by_gradients: Any) -> Any:
        raise StandoffError(designed.NO_SECOND)

    @staticmethod
    def vmap(info: Any, in_dims: Any, designs: designed.Designs, *given: Any) -> Any:
        found = _DesignGradients.apply(designs, *_fronts(info.batch_size, in_dims[1:], given))
        return found, (0,) * len(found)


def _arrays(given: Any) -> list[Any]:
    return [x.detach().numpy() for x in given]
