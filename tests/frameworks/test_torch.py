"""`standoff.torch`: gradients and gradients of them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from frameworks.cases import APART, BOX, ELLIPSOID, INSIDE, LENS, LOST, STACKED, close, differences
from standoff.errors import DerivativeWarning, StandoffError

torch = pytest.importorskip("torch", reason="PyTorch is not installed: `make torch`")

import standoff.torch  # noqa: E402

BOTTOM = torch.tensor([[0.0, 0.0, 0.0, 1.0]], dtype=torch.float64)


def pose(q: Any) -> Any:
    x, y, z = q[:3]
    none = torch.zeros_like(x)
    skew = torch.stack([none, -z, y, z, none, -x, -y, x, none]).reshape(3, 3)
    return torch.cat([torch.cat([torch.matrix_exp(skew), q[3:, None]], 1), BOTTOM])


def distance(q: Any) -> Any:
    return standoff.torch.distance(LENS, ELLIPSOID, pose(q[:6]), pose(q[6:]))


def leaf(q: np.ndarray) -> Any:
    return torch.tensor(q, requires_grad=True)


@pytest.mark.parametrize("q", [APART, INSIDE], ids=["apart", "overlap"])
def test_gradient_and_hessian_through_a_formula_of_the_poses(q: np.ndarray) -> None:
    gradient, hessian = differences(q)
    at = leaf(q)
    distance(at).backward()
    close(at.grad, gradient, 1e-8)
    close(torch.autograd.functional.hessian(distance, at), hessian, 1e-5)
    assert torch.autograd.gradcheck(distance, at)
    assert torch.autograd.gradgradcheck(distance, at)


def test_transforms_of_torch_func(rng: np.random.Generator) -> None:
    q = torch.tensor(APART + 0.1 * rng.normal(size=(4, 12)))
    one_by_one = torch.stack([torch.func.grad(distance)(row) for row in q])
    close(torch.func.vmap(torch.func.grad(distance))(q), one_by_one.numpy(), 1e-13)
    poses = torch.stack([pose(row[6:]) for row in q], 1)  # the batch in the middle
    home = pose(q[0, :6])
    many = torch.func.vmap(lambda p: standoff.torch.distance(LENS, ELLIPSOID, home, p), in_dims=1)
    close(many(poses), standoff.torch.distance(LENS, ELLIPSOID, home, poses.movedim(1, 0)), 1e-13)
    twice = torch.func.jacrev(torch.func.jacrev(distance))(q[0])
    close(twice, torch.autograd.functional.hessian(distance, q[0]).numpy(), 1e-13)


def test_one_pose_goes_with_many(rng: np.random.Generator) -> None:
    q = APART[6:] + 0.1 * rng.normal(size=(4, 6))
    fixed, moving = leaf(APART[:6]), leaf(q)
    poses = torch.stack([pose(row) for row in moving])
    found = standoff.torch.distance(LENS, ELLIPSOID, pose(fixed), poses)
    assert found.shape == (4,)
    found.sum().backward()
    rows = []
    for row in q:
        at = leaf(np.concatenate([APART[:6], row]))
        distance(at).backward()
        rows.append(at.grad.numpy())
    close(moving.grad, np.array(rows)[:, 6:], 1e-13)
    close(fixed.grad, np.array(rows)[:, :6].sum(0), 1e-13)


def test_undefined_derivatives_warn_or_raise() -> None:
    home, there = torch.eye(4, dtype=torch.float64), leaf(STACKED)
    with pytest.warns(DerivativeWarning, match="not unique"):
        standoff.torch.distance(BOX, BOX, home, there).backward()
    np.testing.assert_array_equal(np.isnan(there.grad.numpy()), LOST)
    shift = leaf(np.array([0.0, 0.0, 1.5]))
    moved = torch.cat([torch.cat([home[:3, :3], shift[:, None]], 1), home[3:]])
    with pytest.warns(DerivativeWarning, match="not unique"):
        standoff.torch.distance(BOX, BOX, home, moved).backward()
    close(shift.grad, np.array([0.0, 0.0, 1.0]), 1e-15)
    found = standoff.torch.distance(BOX, BOX, home, there, undefined="raise")
    close(found.detach(), 0.5, 1e-12)
    with pytest.raises(StandoffError, match="does not have all derivatives: the witness points"):
        found.backward()


def test_a_third_derivative_is_refused() -> None:
    at = leaf(APART)
    (once,) = torch.autograd.grad(distance(at), at, create_graph=True)
    (twice,) = torch.autograd.grad(once[0], at, create_graph=True)
    with pytest.raises(StandoffError, match="not third ones"):
        twice[3].backward()


def test_what_cannot_serve_is_refused() -> None:
    home = torch.eye(4, dtype=torch.float64)
    with pytest.raises(StandoffError, match=r"pose_b has dtype torch\.float32"):
        standoff.torch.distance(LENS, ELLIPSOID, home, home.float())
    with pytest.raises(TypeError, match=r"(?s)pose_a = .* is not a tensor"):
        standoff.torch.distance(LENS, ELLIPSOID, np.eye(4), home)
    with pytest.raises(StandoffError, match="pose_b is on meta"):
        standoff.torch.distance(LENS, ELLIPSOID, home, home.to("meta"))
    with pytest.raises(StandoffError, match="the last row of a homogeneous matrix"):
        standoff.torch.distance(LENS, ELLIPSOID, home, 2.0 * home)


def test_the_example_of_the_page_runs() -> None:
    page = Path(__file__).parents[2] / "docs" / "differentiable.md"
    fence = re.compile(r"^```\{code-block\} python\n:class: torch\n(.*?)^```$", re.S | re.M)
    (code,) = fence.findall(page.read_text("utf-8"))
    exec(compile(code, page.name, "exec"), {})
