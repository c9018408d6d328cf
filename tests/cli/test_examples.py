"""Every example runs, is certified, and shows what it is there to show."""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from standoff.motion import read_pose_samples
from standoff.scene import load_scene, query, record
from standoff.sweep.proof.proof import Proof
from standoff.sweep.reading import load_job

Standoff = Callable[..., Any]

EXAMPLES = Path(__file__).parents[2] / "examples"
WORLDS = ("fits", "shelves")
FITS = "fits-allowed"
SWEEP, WORKSPACE, TOLERANCES = "sweep", "workspace", "tolerances"
JOBS = (SWEEP, WORKSPACE, TOLERANCES)
SCENES = [
    file for file in sorted(EXAMPLES.glob("*.toml")) if file.stem not in (*WORLDS, FITS, *JOBS)
]


def test_there_are_examples() -> None:
    assert {file.stem for file in SCENES} >= {"demo", "twist", "helix", "planar"}


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_example_is_certified_throughout(standoff: Standoff, file: Path) -> None:
    ended = standoff("track", file)
    assert ended.code == 0
    assert ", 100 %" in ended.out
    assert standoff("distance", file).code == 0


@pytest.mark.parametrize("name", WORLDS)
def test_example_of_a_world_is_certified(standoff: Standoff, name: str) -> None:
    ended = standoff("clearance", EXAMPLES / f"{name}.toml")
    assert ended.code == 0
    assert "proven for all pairs" in ended.out


def test_the_gripper_keeps_its_margins_and_ends_beside_the_bottle(standoff: Standoff) -> None:
    file = EXAMPLES / "shelves.toml"
    ended = standoff("clearance", file, "--motion", "--json")
    assert ended.code == 0
    first = json.loads(ended.out)["pairs"][0]
    assert (first["names"], first["pieces"]) == (["gripper", "bottle"], ["right_finger", ""])
    assert (first["time"], first["required"]) == (1.0, 0.01)
    assert standoff("clearance", file, "--motion", "--min", 0.02).code == 3
    ended = standoff("track", file)
    assert ended.code == 0
    assert "201 of 201 frames, 100 %" in ended.out
    assert "1 s, gripper right_finger - bottle" in ended.out


def test_the_fits_that_are_meant_leave_one_overlap(standoff: Standoff) -> None:
    ended = standoff(
        *("clearance", EXAMPLES / "fits.toml", "--json"), *("--allow", EXAMPLES / f"{FITS}.toml")
    )
    assert ended.code == 3
    facts = json.loads(ended.out)
    failing = {tuple(pair["names"]): pair["distance"] for pair in facts["pairs"] if pair["failure"]}
    assert failing == {("hub", "bracket"): pytest.approx(-0.8, abs=1e-9)}
    depth = next(pair["distance"] for pair in facts["pairs"] if pair["names"] == ["hub", "pin"])
    assert depth == pytest.approx(-0.02, abs=1e-9)


def test_demo_visits_faces_edges_and_a_vertex_and_equals_cold_queries() -> None:
    scene = load_scene(EXAMPLES / "demo.toml")
    recording = record(scene)
    assert {feature.kind for feature in recording.feature_b} == {"face", "edge", "vertex"}
    assert len(recording.events) > 10
    size = max(body.size for body in scene.pair_bodies)
    for frame in range(0, len(recording.time), 20):
        cold = query(scene, float(recording.time[frame]))[1].distance
        assert abs(cold - recording.distance[frame]) <= 1e-10 * size


def test_demo_motion_is_uneven_and_jittery() -> None:
    samples = read_pose_samples(EXAMPLES / "hand_motion.tum")
    steps = np.diff(samples.times)
    assert samples.end == pytest.approx(10.0, abs=0.1)
    assert np.median(steps) == pytest.approx(0.01, rel=0.05)
    assert steps.std() > 3e-4
    assert steps.max() > 0.015
    positions = np.array([pose.translation for pose in samples.poses])
    even = np.linspace(samples.start, samples.end, len(samples.times))
    path = np.column_stack([np.interp(even, samples.times, column) for column in positions.T])
    power = (np.abs(np.fft.rfft(np.diff(path, axis=0), axis=0)) ** 2).sum(axis=1)
    hertz = np.fft.rfftfreq(len(path) - 1, even[1] - even[0])
    tremor = power[(hertz > 7.5) & (hertz < 12.5)].mean()
    assert tremor > 50.0 * power[(hertz > 20.0) & (hertz < 40.0)].mean()


def test_demo_motion_is_what_its_script_writes(tmp_path: Path) -> None:
    script = runpy.run_path(str(EXAMPLES / "make_hand_motion.py"))
    script["main"](tmp_path / "again.tum")
    again = np.loadtxt(tmp_path / "again.tum")
    # To the last decimal that is written: libm differs between machines by a rounding unit.
    np.testing.assert_allclose(np.loadtxt(EXAMPLES / "hand_motion.tum"), again, atol=2e-6)


def test_the_sweep_finds_rows_that_are_too_near(standoff: Standoff, tmp_path: Path) -> None:
    ended = standoff("sweep", EXAMPLES / f"{SWEEP}.toml", "-o", tmp_path / "out")
    assert ended.code == 3
    assert "100 000 of 100 000 rows, 100 %" in ended.out
    assert "100 rows are not proven to be 0.001 m apart" in ended.out


def test_the_tolerances_are_proven(standoff: Standoff, tmp_path: Path) -> None:
    """The least gap is that of a roller which is too large and too low, above the cam's axis."""
    file, least = EXAMPLES / f"{TOLERANCES}.toml", 0.0002 - 0.00006 - 0.00002
    ended = standoff("sweep", file, "--prove", "clearance=0.0001", "-o", tmp_path / "out", "--json")
    assert ended.code == 0
    assert 0.0001 <= json.loads(ended.out)["bound"] <= least
    job = load_job(file)
    few = replace(job, effort=job.effort._replace(queries=500, shards=1))
    nearest = Proof(few, 1.1 * least).computed(0).nearest.places
    assert least <= nearest.distance[0] <= 1.2 * least
    assert nearest.numbers[0, 0] == 0.00006


def test_some_of_the_workspace_is_proven(standoff: Standoff, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    file, fewer = EXAMPLES / f"{WORKSPACE}.toml", tmp_path / "fewer.toml"
    told = file.read_text(encoding="utf-8").replace('"robots/', f'"{EXAMPLES.as_posix()}/robots/')
    fewer.write_text(told.replace('[parameters.twist]\njoint = "j3"\n', ""), encoding="utf-8")
    proven = []
    for job in (file, fewer):
        ended = standoff("sweep", job, "--prove", "clearance=0.02", "--estimate", "--json")
        assert ended.code == 0
        proven.append(json.loads(ended.out)["proven"])
    assert 0.05 < proven[0] < 0.3  # of four joints, by the few queries of an estimate
    assert 0.3 < proven[1] < 0.8  # of three
