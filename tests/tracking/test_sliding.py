"""Sliding at a signed distance that stays: apart, in touch and in penetration, every frame."""

import numpy as np
import pytest
from benchmarks.sliding import run

from families.sliding import GAPS, PAIRS, constant, frames, make, oscillating
from oracles.bounds import separation_many
from oracles.depth import least_depth
from shares import only
from standoff_studies.oracles import Placed

ROUND, ROLLING = 8000, 2000
"""Frames of 1 ms: once round boxes and cylinders, over all their features; two seconds else."""
WITNESS = 1e-7
"""Greatest error of the points, a length: the tracker's own tolerance allows it."""


@pytest.fixture(scope="module", params=[name for name in PAIRS if "NURBS" not in name])
def slide(request):
    return make(request.param)


def count(slide):
    flat = slide.path.__qualname__.startswith(("around_box", "around_cylinder", "around_capsule"))
    return ROUND if flat else ROLLING


def test_the_gap_is_the_distance(slide):
    """The truth itself: apart the supports prove it, in penetration the reference."""
    for gap in (1e-2, -1e-2):
        truth = frames(slide, constant(gap), np.linspace(0, 8, 5))
        rows = zip(truth.poses_a, truth.poses_b, truth.normals, strict=True)
        for pose_a, pose_b, normal in rows:
            a = Placed(slide.a.shape, pose_a[:9].reshape(3, 3), pose_a[9:])
            b = Placed(slide.b.shape, pose_b[:9].reshape(3, 3), pose_b[9:])
            assert separation_many(a, b, normal)[0] == pytest.approx(gap, abs=1e-14)
            if gap < 0:
                assert least_depth(a, b)[1] == pytest.approx(-gap, abs=1e-11)


@pytest.mark.parametrize("gap", only([1e-2, 1e-6, 0.0, -1e-4], GAPS))
def test_no_frame_is_lost(slide, gap):
    found = run(slide, constant(gap), count(slide))
    assert not found.lost, found.row("", f"{gap:g}")
    assert found.distance <= 1e-9
    assert found.point <= WITNESS


@pytest.mark.parametrize("swing", [1e-2, 1e-4])
def test_swinging_through_contact(slide, swing):
    found = run(slide, oscillating(swing), count(slide))
    assert not found.lost, found.row("", f"{swing:g}")
