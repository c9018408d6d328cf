"""The benchmark of robots in small: its tables are made of what it says."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

from benchmarks import robot_speed, robots

COAL = 1e-5
"""How far Coal's distances may be off, m: some times its tolerance of 1e-6."""
ROW = 1e-2
"""How far their rows may be off, relative to 1: Coal's points are to the root of its tolerance."""
MUJOCO = 1e-5
"""MuJoCo's, m."""


def test_a_row_of_the_models_counts_geometries() -> None:
    row = robots.model_row("quadruped")
    assert (row.nv, row.became, row.pairs, row.refused) == (8, {"exact": 13}, 66, "")
    assert row.kinds == {"box": 1, "cylinder": 8, "sphere": 4}
    refused = robots.model_row("mujoco/testdata/model.xml")
    assert "height field" in refused.refused
    assert set(robots.TESTDATA) < set(robots.names_of_models())
    assert len(robots.names_of_models()) >= 20
    last = robots.model_lines([row, refused])[-1]
    assert "1 of 2 load: 13 exact geometries, 0 hulls, 66 pairs" in last


def test_distances_beside_others() -> None:
    row = robots.compared("quadruped", 3)
    assert row.configurations == 3
    assert 0 < row.distances <= 3 * 66
    assert row.uncertified == 0
    assert row.gap <= 1e-9
    assert 0.0 < row.worst["Coal"] <= COAL
    assert row.worst["MuJoCo"] <= MUJOCO


def test_rows_beside_differences() -> None:
    row = robots.differentiated("quadruped", 3)
    assert row.entries >= 100
    assert 0.0 < row.worst <= robots.ALLOWED
    assert row.beyond == 0


def test_all_contenders_answer_the_same_pairs() -> None:
    rng = np.random.default_rng(3)
    geoms = robot_speed.geoms_of(rng)
    path, ask = robot_speed.motion(rng, 5), robot_speed.contenders(geoms)
    times = robot_speed.timed(ask, path)
    assert {len(seconds) for seconds in times.values()} == {5}
    pairs = sorted(robot_speed.pairs_of(geoms))
    every = [name for name in ask if "within" not in name]
    answers = {name: ask[name](path[-1]) for name in every}
    for name, answer in answers.items():
        assert [tuple(pair) for pair in answer.pairs.tolist()] == pairs, name
    errors = robot_speed.judged(ask, ask["Standoff, distances"].robot, path[-1:])
    assert set(errors) == set(ask)
    for name, found in errors.items():
        assert found.distance <= COAL, name
        assert found.row <= (robots.ALLOWED if "Standoff" in name else ROW), name
