"""The example of two hands that meet, as Pink's `yumi_self_collision`, on a Baxter."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pink
import pinocchio as pin
import pytest

from standoff.robots import PinkBarrier

pytest.importorskip("coal")

FILE = Path(__file__).parents[2] / "examples" / "robots" / "two_arms_pink.py"
MET = {"begin": 4.0, "end": 5.5}
"""About when the targets meet, s."""


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("two_arms_pink", FILE)
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    found.STEP = 0.01
    return found


def test_balls_on_the_hands_are_pinks_spherical_barrier(example: ModuleType) -> None:
    model = example.baxter().kinematics.model
    ours = PinkBarrier(example.balls(model), 0.0, gain=20.0)
    other = pink.barriers.BodySphericalBarrier(example.HANDS, 2.0 * example.BALL, gain=20.0)
    rng, at = np.random.default_rng(3), example.ready(model)
    for _ in range(5):
        at = pin.integrate(model, at, rng.uniform(-0.2, 0.2, model.nv))
        state = pink.Configuration(model, model.createData(), at)
        apart = ours.compute_barrier(state)[0] + 2.0 * example.BALL
        # theirs is |p1 - p2|^2 - d^2
        squared = other.compute_barrier(state)[0] + 4.0 * example.BALL**2
        assert squared == pytest.approx(apart**2, abs=1e-12)
        row = np.ravel(other.compute_jacobian(state))
        wanted = 2.0 * apart * ours.compute_jacobian(state)[0]
        np.testing.assert_allclose(row, wanted, atol=1e-9)


def test_hands_stop_before_each_other(example: ModuleType) -> None:
    robot = example.baxter()
    model = robot.kinematics.model
    barrier = PinkBarrier(example.balls(model), 0.0, gain=20.0)
    path = example.meet(model, [barrier], **MET)
    assert example.hands_apart(model, path).min() > 2.0 * example.BALL - 5e-3
    exact = PinkBarrier(robot, example.CLEARANCE, gain=20.0, n_pairs=20)
    path = example.meet(model, [exact], **MET)
    least = min(robot.clearance(q).distance for q in path)
    assert example.CLEARANCE - 6e-3 < least < example.CLEARANCE + 1e-3
    assert example.hands_apart(model, path).min() < 0.1
    without = example.meet(model, [], **MET)
    assert min(robot.clearance(q).distance for q in without[::5]) < 0.0
