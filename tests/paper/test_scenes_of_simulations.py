"""The paper's simulations as scenes, for `standoff view` and `standoff track`: the same motions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from standoff.scene import load_scene
from standoff_studies.paper.bodies import leaf, planar_body
from standoff_studies.paper.simulation_b.run import motion
from standoff_studies.paper.simulation_c.run import MOTION
from standoff_studies.paper.simulation_d.runs import HELIX, SIMULATION
from standoff_studies.paper.simulation_e.runs import PATH_B

SCENES = Path(__file__).parents[2] / "examples" / "paper"
MOTIONS = {"b": motion(planar_body()), "c": MOTION, "d": HELIX, "e": PATH_B}


@pytest.mark.parametrize("name", MOTIONS)
def test_they_move_as_in_the_studies(name: str) -> None:
    path = load_scene(SCENES / f"simulation-{name}.toml").pair_motions[1].path
    for time in np.linspace(0.0, 4.0, 9):
        ours, theirs = path.pose(time), MOTIONS[name].pose(time)
        np.testing.assert_allclose(ours.matrix, theirs.matrix, atol=1e-14)


def test_planar_bodies_are_those_of_the_studies() -> None:
    scene = load_scene(SCENES / "simulation-c.toml")
    for body, theirs in zip(scene.pair_bodies, (planar_body(), leaf()), strict=True):
        np.testing.assert_allclose(body.reals, theirs.reals, atol=1e-14)


def test_all_are_there() -> None:
    assert sorted(file.stem[-1] for file in SCENES.glob("*.toml")) == list("bcde")
    assert load_scene(SCENES / "simulation-d.toml").settings.duration == SIMULATION.duration
