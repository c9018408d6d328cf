"""Depths of bodies whose facets are nearly flush: a few blocks of the soak, and its judge."""

from types import SimpleNamespace

import numpy as np
import pytest

import standoff as so
from standoff_studies.soak import flush_depths as F

BLOCKS = 8


@pytest.mark.parametrize("number", range(BLOCKS))
def test_no_depth_exceeds_the_least(number, monkeypatch):
    monkeypatch.setattr(F, "BLOCK", 250)
    verdict, lines = F.judge_block(number, 1)
    assert not lines
    assert verdict.sound
    assert verdict.overlaps > 100
    assert verdict.unproven == 0


BOX = F._polytope(
    "box", np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2.0, 0.0,
    so.shapes.box(1.0, 1.0, 1.0),
)  # fmt: skip
UP = F.Poses(np.eye(3)[None], np.array([[0.0, 0.0, 1.0 - 1e-3]]))
RIGHT = {"distance": -1e-3, "lower_bound": -1e-3, "upper_bound": -1e-3, "normal": (0.0, 0.0, 1.0)}


@pytest.mark.parametrize(
    ("told", "status", "fault"),
    [
        ({}, so.Status.GLOBAL, ""),
        ({}, so.Status.LOCAL, "unproven"),
        ({"distance": -1.999, "normal": (0.0, 0.0, -1.0)}, so.Status.LOCAL, "deeper"),
        ({"distance": -1e-3 + 1e-5}, so.Status.GLOBAL, "not_own"),
        ({"distance": 0.1}, so.Status.CONVERGED, "apart"),
        ({"lower_bound": -1e-3 + 1e-9}, so.Status.GLOBAL, "bound"),
        ({"upper_bound": -1e-3 - 1e-9}, so.Status.GLOBAL, "bound"),
    ],
)
def test_the_judge_notices_a_wrong_depth(told, status, fault):
    """Of a unit box on another one, 1e-3 deep."""
    row = {name: np.array([value]) for name, value in (RIGHT | told).items()}
    counts = F.judged(BOX, BOX, UP, SimpleNamespace(**row, status=[status]))
    verdict = F.DepthVerdict(*counts[0].tolist())
    assert verdict.sound == (fault in ("", "unproven"))
    if fault:
        assert getattr(verdict, fault) == 1
