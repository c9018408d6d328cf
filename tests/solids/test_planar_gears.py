"""The examples of planar solids: gears through ten teeth, a cam and its roller."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from planar_drawn import between_samples, moved, samples

import standoff as so
from standoff.solids import distance

EXAMPLES = Path(__file__).parents[2] / "examples" / "planar"


@pytest.fixture(scope="module")
def gears() -> Any:
    return runpy.run_path(str(EXAMPLES / "gears.py"))


@pytest.fixture(scope="module")
def pair(gears: Any) -> Any:
    return (*gears["involute_gear"](18, 1.0, thinning=1e-3), *gears["involute_gear"](25, 1.0))


def test_flanks_are_apart_on_the_line_of_action(gears: Any, pair: Any) -> None:
    a, base_a, b, _ = pair
    for angle in np.linspace(0.0, 10 * 2 * np.pi / 18, 31):
        pose_a, pose_b = gears["in_mesh"](angle, 18, 25, 21.5)
        # as far as the teeth of A alone were thinned, on its base circle
        answer = distance(a, b, pose_a, pose_b)
        assert answer.status is so.Status.CONVERGED
        assert answer.distance == pytest.approx(1e-3 * base_a, abs=1e-12)
        for flanks in answer.minima:
            off = min(abs(_off(flanks.point_a, base_a, side)) for side in (1, -1))
            assert off <= 1e-7


def _off(point: np.ndarray, base: float, side: int) -> float:
    """How far a point is from one of both common tangents of the base circles."""
    pressure = np.radians(20.0)
    normal = np.array([np.cos(pressure), side * np.sin(pressure)])
    return float(normal @ point[:2] - base)


def test_turned_from_the_middle_one_flank_is_nearer(gears: Any, pair: Any) -> None:
    a, base_a, b, base_b = pair
    for turned in (2e-5, -1e-4, 3e-4):
        pose_a, pose_b = gears["in_mesh"](0.3, 18, 25, 21.5)
        c, s = np.cos(turned), np.sin(turned)
        spin = so.Pose([[c, -s, 0], [s, c, 0], [0, 0, 1]], (0, 0, 0))
        answer = distance(a, b, pose_a, pose_b @ spin)
        expected = 1e-3 * base_a - base_b * abs(turned)
        assert answer.distance == pytest.approx(expected, abs=1e-12)
    touching = distance(b, b, *gears["in_mesh"](0.1, 25, 25, 25.0))
    assert touching.status is so.Status.TOUCHING


def test_the_examples_run(gears: Any, capsys: pytest.CaptureFixture[str]) -> None:
    gears["main"]()
    assert "4 pairs" in capsys.readouterr().out
    cam = runpy.run_path(str(EXAMPLES / "cam.py"))
    solid, follower = cam["cam"](), cam["roller"]()
    points, reach = samples(solid, 20_000)
    for degrees in (0, 70, 100, 200):
        height, answer = cam["lift"](solid, follower, np.radians(degrees))
        assert answer.certified
        at = moved(points, cam["turned"](np.radians(degrees)))
        seen = between_samples(at, np.array([[0.0, height]])) - cam["ROLLER"]
        assert cam["GAP"] - 1e-8 <= seen <= cam["GAP"] + reach
