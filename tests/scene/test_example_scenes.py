"""The example scenes as tests: pinned numbers, and distances on ground of their own.

The support function of each body is written a second time in the oracles; it brackets the distance
of any frame without the library. The follower's clearance is the number that its lift was made for.
"""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow.parquet as pq
import pytest

import standoff as so
from oracles.bounds import maximise_separation
from oracles.loops import ConicArc, PlanarLoop, line
from oracles.patches import BezierBody
from standoff.scene import Scene, load_scene, record
from standoff_studies.oracles import Affine, Box, Ellipsoid, Lens, Placed, Point, Polytope, Shape

EXAMPLES = Path(__file__).parents[2] / "examples"

CHECKED = 25
"""Frames of each run whose distance is bracketed, beside the closest."""

SLACK = 1e-11
"""How far a distance may lie outside the bracket, over the pair's size: the bracket's own width."""

ROCK = [
    *([0.110, 0.020, -0.050], [0.060, 0.100, -0.050], [-0.050, 0.095, -0.050]),
    *([-0.115, 0.010, -0.050], [-0.060, -0.090, -0.050], [0.070, -0.085, -0.050]),
    *([0.080, 0.030, 0.025], [0.020, 0.075, 0.030], [-0.070, 0.045, 0.020]),
    *([-0.055, -0.050, 0.035], [0.045, -0.060, 0.030], [0.005, 0.005, 0.060]),
]


def tangent_cam() -> Shape:
    """The cam's outline again: circles of 20 mm and 8 mm, 24 mm apart, and their tangents."""
    angle = np.arccos((0.020 - 0.008) / 0.024)
    normals = [np.array([np.cos(t), np.sin(t)]) for t in (-angle, angle)]
    low, high = ([0.020 * n, [0.024, 0.0] + 0.008 * n] for n in normals)
    return PlanarLoop(
        [
            line(*low),
            ConicArc([0.024, 0.0], [0.008, 0.0], [0.0, 0.008], -angle, angle),
            line(*reversed(high)),
            ConicArc([0.0, 0.0], [0.02, 0.0], [0.0, 0.02], angle, 2 * np.pi - angle),
        ]
    )


def roller() -> Shape:
    return PlanarLoop([ConicArc([0.0, 0.0], [0.006, 0.0], [0.0, 0.006], 0.0, 2 * np.pi)])


class Pinned(NamedTuple):
    """What a scene shows: frames, least distance [m] and its time [s], switches, features.

    The time is None where the distance is one and the same all along.
    """

    shapes: tuple[Shape, Shape]
    frames: int
    least: float
    at: float | None
    switches: int
    features_a: set[str]
    features_b: set[str]


def pebble() -> Shape:
    """The pebble's patches, read from the file without the library."""
    content = json.loads((EXAMPLES / "pebble.json").read_text())
    patches = []
    for patch in content["patches"]:
        weights = np.array(patch["weights"])[..., None]
        points = np.array(patch["control_points"])
        patches.append(np.concatenate([points * weights, weights], axis=2))
    return BezierBody(patches)


def numbered(kind: str, *indices: int) -> set[str]:
    return {f"{kind} {index}" for index in indices}


LENS = numbered("face", 0, 1, 2) | numbered("edge", 0, 1, 2)

PINNED = {
    "probe": Pinned(
        (Point(), Lens(0.10, 0.045)),
        frames=1676,
        least=0.015525305893342662,
        at=8.03,
        switches=48,
        features_a={"vertex 0"},
        features_b=LENS,
    ),
    "lenses": Pinned(
        (Affine(Lens(0.05, 0.0225), np.diag([0.8, 0.6, 0.7])), Lens(0.10, 0.045)),
        frames=1572,
        least=0.027853857191326808,
        at=5.23,
        switches=65,
        features_a=LENS | {"vertex 0"},
        features_b=LENS,
    ),
    "cam": Pinned(
        (tangent_cam(), roller()),
        frames=801,
        least=0.0002,
        at=None,
        switches=8,
        features_a=numbered("edge", 0, 1, 2, 3),
        features_b={"edge 0"},
    ),
    "pebble": Pinned(
        (pebble(), Ellipsoid(0.008, 0.007, 0.011)),
        frames=801,
        least=0.00131905160972,
        at=1.895,
        switches=28,
        features_a=numbered("face", 0, 1, 4, 5) | numbered("edge", 0, 2, 4, 6),
        features_b={"face 0"},
    ),
    "tumbling": Pinned(
        (Box(0.10, 0.06, 0.04, 0.005), Polytope(ROCK)),
        frames=1001,
        least=0.01643533246153387,
        at=1.268,
        switches=37,
        features_a=numbered("face", 0, 2, 5)
        | numbered("edge", 0, 1, 3, 4, 8, 10)
        | numbered("vertex", 1, 2, 3, 4, 5),
        features_b=numbered("face", 1, 2, 11, 12)
        | numbered("edge", 3, 4, 5, 12, 22, 23)
        | numbered("vertex", 6, 8, 11),
    ),
}


@pytest.fixture(scope="module", params=PINNED)
def run(request: pytest.FixtureRequest) -> tuple[Scene, so.Recording, Pinned]:
    scene = load_scene(EXAMPLES / f"{request.param}.toml")
    return scene, record(scene), PINNED[request.param]


Run = tuple[Scene, so.Recording, Pinned]


def test_pinned_numbers(run: Run) -> None:
    _, recording, pinned = run
    assert len(recording) == pinned.frames
    assert recording.certified.all()
    assert recording.total_counts().restarts == 0
    closest = recording.closest()
    assert closest is not None
    assert recording.distance[closest] == pytest.approx(pinned.least, rel=0, abs=2e-12)
    if pinned.at is not None:
        assert recording.time[closest] == pytest.approx(pinned.at, abs=1e-9)
    assert len(recording.events) == pinned.switches
    assert {str(feature) for feature in recording.feature_a} == pinned.features_a
    assert {str(feature) for feature in recording.feature_b} == pinned.features_b


def test_distances_are_those_of_the_support_functions(run: Run) -> None:
    scene, recording, pinned = run
    closest = recording.closest()
    assert closest is not None
    paths = [motion.path for motion in scene.pair_motions]
    size = max(body.size for body in scene.pair_bodies)
    for frame in {*range(0, len(recording), len(recording) // CHECKED), closest}:
        poses = [path.pose(float(recording.time[frame])) for path in paths]
        a, b = (
            Placed(shape, pose.rotation, pose.translation)
            for shape, pose in zip(pinned.shapes, poses, strict=True)
        )
        truth = maximise_separation(a, b)
        assert truth.upper - truth.value < SLACK * size
        assert truth.value - SLACK * size <= recording.distance[frame]
        assert recording.distance[frame] <= truth.upper + SLACK * size
        assert recording.lower_bound[frame] <= truth.upper + SLACK * size


def test_the_follower_keeps_its_clearance() -> None:
    recording = record(load_scene(EXAMPLES / "cam.toml"))
    # The file has 12 decimals of a metre, the flank leans by up to 60° from the follower's line.
    np.testing.assert_allclose(recording.distance, 0.0002, rtol=0, atol=2e-12)


def test_the_follower_s_motion_is_what_its_script_writes(tmp_path: Path) -> None:
    script = runpy.run_path(str(EXAMPLES / "make_follower_motion.py"))
    script["main"](tmp_path / "again.csv")
    again, kept = (
        np.loadtxt(file, delimiter=",", skiprows=2)
        for file in (tmp_path / "again.csv", EXAMPLES / "follower_motion.csv")
    )
    # To the last decimal that is written: libm differs between machines by a rounding unit.
    np.testing.assert_allclose(kept, again, rtol=0, atol=2e-12)
    assert script["height"](0.0) - script["height"](np.pi) == pytest.approx(0.012, abs=1e-15)


def test_the_pebble_is_what_its_script_writes(tmp_path: Path) -> None:
    script = runpy.run_path(str(EXAMPLES / "make_pebble.py"))
    script["main"](tmp_path)
    again, kept = (json.loads((f / "pebble.json").read_text()) for f in (tmp_path, EXAMPLES))
    assert again == kept
    again, kept = (pq.read_table(f / "pebble_motion.parquet") for f in (tmp_path, EXAMPLES))
    assert again.column_names == kept.column_names
    for name in kept.column_names:
        # libm differs between machines by a rounding unit.
        np.testing.assert_allclose(again[name], kept[name], rtol=0, atol=1e-13)


def test_the_pebble_is_proven_convex() -> None:
    body = load_scene(EXAMPLES / "pebble.toml").bodies["pebble"]
    report = body.check()
    assert (report.faces, report.edges, report.vertices, report.smooth_edges) == (6, 12, 8, 0)
    assert report.convexity_defect < 1e-15
    assert [patch.method for patch in report.patches] == ["bernstein"] * 6
    assert report.flattest is not None
    assert report.flattest.angle < np.pi
