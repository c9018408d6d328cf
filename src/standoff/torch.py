"""Signed distances in PyTorch, with exact first and second derivatives (docs/differentiable.md)."""

from __future__ import annotations

from typing import Any

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError, not_installed
from standoff.frameworks import ambient

try:
    import torch
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(not_installed("PyTorch", "torch"), name=error.name) from error

__all__ = ["distance"]


def distance(a: Body, b: Body, pose_a: Any, pose_b: Any, *, undefined: str = "nan") -> Any:
    """The signed minimum distance of two bodies, as a differentiable function of their poses.

    Works with ``backward``, ``autograd.grad(..., create_graph=True)``, and ``torch.func``'s
    ``grad``, ``jacrev`` and ``vmap``; in forward mode (``jvp``, ``jacfwd``) it does not.

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

    Raises
    ------
    TypeError
        No bodies, or no tensors.
    StandoffError
        Tensors of another type, device or shape; a matrix that is not a pose. In ``backward``:
        undefined derivatives, if asked; a third derivative.
    """
    pair = ambient.Pair.of(a, b, undefined)
    _check(pose_a, "pose_a")
    _check(pose_b, "pose_b")
    lead = ambient.lead_of(tuple(pose_a.shape), tuple(pose_b.shape))
    return _Value.apply(*(pose.expand(*lead, 4, 4) for pose in (pose_a, pose_b)), pair)


def _check(pose: Any, name: str) -> None:
    if not isinstance(pose, torch.Tensor):
        raise StandoffTypeError(
            f"{name} = {shown(pose)} is not a tensor: give torch.as_tensor(pose).", name, pose
        )
    if pose.dtype != torch.float64:
        raise StandoffError(
            f"{name} has dtype {pose.dtype}: give torch.float64, in which rotations are exact "
            "enough.",
            name,
        )
    if pose.device.type != "cpu":
        raise StandoffError(
            f"{name} is on {pose.device}: distances are computed on the CPU; give {name}.cpu().",
            name,
        )


def _numbers(of: Any, poses: Any, pair: ambient.Pair) -> Any:
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
    def batched(cls, size: int, in_dims: Any, poses: Any, pair: ambient.Pair) -> Any:
        fronts = [
            pose.expand(size, *pose.shape) if at is None else pose.movedim(at, 0)
            for pose, at in zip(poses, in_dims, strict=False)
        ]
        return cls.apply(*fronts, pair), 0


class _Value(_Rule):
    """(...) distances."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _numbers(ambient.value, (pose_a, pose_b), pair)

    @staticmethod
    def backward(ctx: Any, by_value: Any) -> Any:
        gradient = _Gradient.apply(*ctx.saved_tensors, ctx.pair)
        moved = by_value[..., None, None, None] * gradient
        return moved[..., 0, :, :], moved[..., 1, :, :], None

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _Value.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)


class _Gradient(_Rule):
    """(..., 2, 4, 4) gradients."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _numbers(ambient.first, (pose_a, pose_b), pair)[1]

    @staticmethod
    def backward(ctx: Any, by_gradient: Any) -> Any:
        hessian = _Hessian.apply(*ctx.saved_tensors, ctx.pair)
        moved = (hessian * by_gradient[..., None, None, None]).sum((-6, -5, -4))
        return moved[..., 0, :, :], moved[..., 1, :, :], None

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _Gradient.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)


class _Hessian(_Rule):
    """(..., 2, 4, 4, 2, 4, 4) Hessians, and no derivative of theirs."""

    @staticmethod
    def forward(pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _numbers(ambient.second, (pose_a, pose_b), pair)[2]

    @staticmethod
    def backward(ctx: Any, by_hessian: Any) -> Any:
        raise StandoffError(ambient.NO_THIRD)

    @staticmethod
    def vmap(info: Any, in_dims: Any, pose_a: Any, pose_b: Any, pair: ambient.Pair) -> Any:
        return _Hessian.batched(info.batch_size, in_dims, (pose_a, pose_b), pair)
