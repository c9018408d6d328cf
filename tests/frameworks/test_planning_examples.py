"""The programs in examples/planning do what they say, on less than they take themselves."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "planning"


def program(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_trajectory_is_planned_and_its_clearance_proven(
    capsys: pytest.CaptureFixture[str], rng: np.random.Generator, tmp_path: Path
) -> None:
    plan = program("past_three_obstacles")
    z = rng.normal(size=12)
    asked = plan.Clearances()
    h, unit = 1e-6, np.eye(12)
    differences = [(asked.values(z + h * e) - asked.values(z - h * e)) / (2 * h) for e in unit]
    np.testing.assert_allclose(asked.jacobian(z), np.array(differences).T, atol=1e-7)

    found, _, _ = plan.plan(exact=True)
    path = plan.knots(found)
    assert plan.proven(path, plan.PROVEN)
    assert not plan.proven(path, plan.AT_KNOTS + 1e-6)
    assert "exact gradients: " in capsys.readouterr().out
    plan.draw(path, tmp_path / "path.png")
    assert (tmp_path / "path.png").stat().st_size > 10_000


@pytest.mark.parametrize("hessian", ["exact", "limited-memory"])
def test_a_controller_keeps_its_clearance(hessian: str) -> None:
    pytest.importorskip("casadi")
    mpc = program("mpc_past_a_lens")
    states, kept, iterations, _ = mpc.drive(hessian, steps=6)
    assert kept.min() > mpc.CLEARANCE - 1e-6
    assert kept.min() < mpc.CLEARANCE + 0.1  # the obstacle is in the way
    assert states[-1][0] > 0.5
    assert iterations.max() < 100
