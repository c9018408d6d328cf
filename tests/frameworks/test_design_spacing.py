"""A lens is spaced by each framework's gradients as examples/design/lens_spacing.py does it."""

from __future__ import annotations

import importlib.util
import runpy
from pathlib import Path
from typing import Any

import casadi
import jax
import numpy as np

import standoff as so
import standoff.casadi
import standoff.jax

jax.config.update("jax_enable_x64", True)

PROGRAM = runpy.run_path(str(Path(__file__).parents[2] / "examples/design/lens_spacing.py"))
WANTED, START, SPACED = PROGRAM["WANTED"], 3.2, 3.217009045  # mm; the last is what it prints
LENS = so.Design(PROGRAM["lens"], curvature=0.05, conic=-0.8, thickness=START).only("thickness")
OTHER = PROGRAM["next_element"]()
POSES = np.eye(4), so.Pose.exp([np.pi, 0.0, 0.0], [1.0, 0.0, 12.6]).matrix


def jax_step(thickness: float) -> float:
    def gap(thickness: Any) -> Any:
        return standoff.jax.design_distance(LENS, OTHER, {"thickness": thickness}, {}, *POSES)

    value, slope = jax.value_and_grad(gap)(thickness)
    return float(thickness - (value - WANTED) / slope)


def torch_step(thickness: float) -> float:
    import torch

    import standoff.torch

    at = torch.tensor(thickness, dtype=torch.float64, requires_grad=True)
    poses = [torch.tensor(pose) for pose in POSES]
    gap = standoff.torch.design_distance(LENS, OTHER, {"thickness": at}, {}, *poses)
    gap.backward()
    return float((at - (gap - WANTED) / at.grad).detach())


def casadi_step(thickness: float) -> float:
    at = casadi.MX.sym("t")
    left = standoff.casadi.design_distance(LENS, OTHER)(at, *POSES) - WANTED
    better = at - left / casadi.jacobian(left, at)
    return float(casadi.Function("step", [at], [better])(thickness))


def test_a_step_of_newton_s_method_ends_at_the_same_spacing() -> None:
    """All in one test: a lens takes long to make, and the frameworks share those that are kept."""
    steps = [jax_step, casadi_step]
    if importlib.util.find_spec("torch"):
        steps.append(torch_step)
    for step in steps:
        assert abs(step(START) - SPACED) <= 1e-8, step
