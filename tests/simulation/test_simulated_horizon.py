"""Simulated bodies whose far pairs are only bounded move as if every distance were found."""

from pathlib import Path

import numpy as np
import pytest

import standoff as so
import standoff.simulation as sim
from standoff.scene import SceneError
from standoff.scene.simulation import load_simulation

PEBBLE = so.shapes.ellipsoid(0.05, 0.05, 0.04)


def run(within: float | None, ticks: int = 400) -> sim.SystemRun:
    """A dozen pebbles that fall on a plane and on each other."""
    rng = np.random.default_rng(4)
    bodies = [sim.RigidBody.fixed(so.shapes.halfspace())]
    for k in range(12):
        at = [0.11 * (k % 4), 0.11 * (k // 4), 0.06 + 0.1 * rng.random()]
        spin = so.Twist(np.zeros(3), 3.0 * rng.normal(size=3))
        bodies.append(sim.RigidBody.free(PEBBLE, mass=0.3, pose=(np.eye(3), at), twist=spin))
    law = so.PredictorCorrector(depth="local", within=within)
    operator = sim.Operator(sim.System(bodies, sim.HuntCrossley(stiffness=1e4)), 1e-3, law=law)
    return operator.run(operator.start(), ticks, every=ticks // 4)


def test_the_motion_is_the_same_with_a_horizon() -> None:
    every, near = run(None), run(0.02)
    paths = [[made.positions(body) for body in range(1, 13)] for made in (every, near)]
    assert every.deepest > 1e-3
    assert near.deepest == pytest.approx(every.deepest, rel=1e-9)
    assert np.array(paths[1]) == pytest.approx(np.array(paths[0]), abs=1e-9)
    assert near.uncertified == every.uncertified == 0


SCENE = """
version = 1
[bodies.floor]
shape = "halfspace"
[bodies.ball]
shape = "sphere"
radius = 0.1
[placements.ball]
position = [0.0, 0.0, 1.0]
[free.ball]
mass = 1.0
[contact]
stiffness = 1e5
[simulate]
step = 1e-3
duration = 0.1
within = 0.2
"""


def test_a_scene_has_a_horizon_too(tmp_path: Path) -> None:
    file = tmp_path / "fall.toml"
    file.write_text(SCENE)
    scene = load_simulation(file)
    assert scene.operator.laws[0].within == 0.2
    made = scene.operator.run(scene.operator.start(), 50)
    assert np.isinf(made.distances).all()
    file.write_text(SCENE + 'tracker = "inside"\n')
    with pytest.raises(SceneError, match="tracker = 'beside'"):
        load_simulation(file)
