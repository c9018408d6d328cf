"""`standoff.torch.design_distance`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from frameworks import designs
from frameworks.cases import STACKED, close
from frameworks.designs import BOX, EGG, LENS, PARAMETERS, POSES
from standoff.errors import DerivativeWarning, StandoffError

torch = pytest.importorskip("torch", reason="PyTorch is not installed: `make torch`")

import standoff.torch  # noqa: E402


def leaf(x: Any) -> Any:
    return torch.tensor(np.asarray(x, dtype=float), requires_grad=True)


def leaves() -> tuple[dict, dict]:
    a, b = ({name: leaf(x) for name, x in side.items()} for side in PARAMETERS)
    return a, b


def tensors(where: str) -> list[Any]:
    return [torch.tensor(pose) for pose in POSES[where]]


@pytest.mark.parametrize("where", POSES)
def test_gradients(where: str) -> None:
    params, poses = leaves(), [leaf(pose) for pose in POSES[where]]
    standoff.torch.design_distance(LENS, EGG, *params, *poses).backward()
    rates, differences = designs.told(where), designs.differences(where)
    for k, name in enumerate(("radius", "offset")):
        close(params[0][name].grad, np.array(rates.a[name]), 1e-15)
        close(params[0][name].grad, differences[k], 1e-9)
    close(params[1]["semi_axes"].grad, np.array(rates.b["semi_axes"]), 1e-15)
    a, b = LENS.changed(**PARAMETERS[0]).body, EGG.changed(**PARAMETERS[1]).body
    alone = [leaf(pose) for pose in POSES[where]]
    standoff.torch.distance(a, b, *alone).backward()
    for mine, theirs in zip(poses, alone, strict=True):
        close(mine.grad, theirs.grad.numpy(), 1e-15)


def test_gradcheck() -> None:
    home = torch.eye(4, dtype=torch.float64)

    def distance(radius: Any, axes: Any, shift: Any) -> Any:
        pose = torch.cat([torch.cat([home[:3, :3], shift[:, None]], 1), home[3:]])
        params = {"radius": radius}, {"semi_axes": axes}
        return standoff.torch.design_distance(LENS, EGG, *params, home, pose)

    assert torch.autograd.gradcheck(distance, (leaf(1.05), leaf([0.5, 0.3, 0.4]), leaf([2, 1, 0])))


def test_many_sets_by_vmap_and_as_tensors() -> None:
    home, poses = tensors("apart")[0], torch.stack([tensors("apart")[1]] * 3)
    poses[:, 0, 3] += torch.tensor([0.0, 0.1, 0.2])
    radii, single = leaf([1.0, 1.1, 1.2]), leaf(1.1)

    def distance(radius: Any, pose: Any) -> Any:
        return standoff.torch.design_distance(LENS, EGG, {"radius": radius}, {}, home, pose)

    slope = torch.func.grad(distance)
    pairs = zip(radii.detach(), poses, strict=True)
    expected = torch.stack([slope(*pair) for pair in pairs]).numpy()
    close(torch.func.vmap(slope)(radii.detach(), poses), expected, 1e-12)
    distance(radii, poses).sum().backward()
    close(radii.grad, expected, 1e-12)
    distance(single, poses).sum().backward()
    close(single.grad, sum(slope(single.detach(), p) for p in poses).numpy(), 1e-12)


def test_a_second_derivative_is_refused() -> None:
    params = leaves()
    found = standoff.torch.design_distance(LENS, EGG, *params, *tensors("apart"))
    (once,) = torch.autograd.grad(found, params[0]["radius"], create_graph=True)
    with pytest.raises(StandoffError, match="not second ones"):
        once.backward()


def test_undefined_derivatives_warn_or_raise() -> None:
    home, there = torch.eye(4, dtype=torch.float64), torch.tensor(STACKED)
    size = leaf(np.ones(3))
    given = BOX, BOX.body, {"size": size}, {}, home, there
    with pytest.warns(DerivativeWarning, match="not unique"):
        standoff.torch.design_distance(*given).backward()
    assert size.grad.isnan().all()
    found = standoff.torch.design_distance(*given, undefined="raise")
    with pytest.raises(StandoffError, match="does not have all derivatives"):
        found.backward()


def test_what_cannot_serve_is_refused() -> None:
    def asked(**params: Any) -> Any:
        return standoff.torch.design_distance(LENS, EGG, params, {}, *tensors("apart"))

    with pytest.raises(StandoffError, match=r"params_a\['radius'\] has dtype torch.float32"):
        asked(radius=torch.tensor(1.0))
    with pytest.raises(TypeError, match=r"params_a\['radius'\] = 1.0 is not a tensor"):
        asked(radius=1.0)
    with pytest.raises(StandoffError, match=r"params_a make no body: with radius = -1\.0"):
        asked(radius=leaf(-1.0))


def test_the_example_of_the_page_runs() -> None:
    page = Path(__file__).parents[2] / "docs" / "design.md"
    fence = re.compile(r"^```\{code-block\} python\n:class: torch\n(.*?)^```$", re.S | re.M)
    (code,) = fence.findall(page.read_text("utf-8"))
    exec(compile(code, page.name, "exec"), {})
