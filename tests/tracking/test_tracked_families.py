"""Tracked motions over random families: every frame certified, and proven by support functions.

Poses and seeds as in ``test_cold_families``.
"""

import os

import numpy as np
import pytest

from families.tracked_motions import run_tracked, tracked_families

POSES = int(os.environ.get("STANDOFF_POSES", "120"))
SHOWN = 5
"""Failures printed of each family."""


@pytest.mark.parametrize("name", tracked_families())
def test_no_frame_is_wrong(name):
    report = run_tracked(name, POSES, int(np.random.default_rng().integers(1 << 31)))
    first = "\n".join(report.failures[:SHOWN])
    assert not report.failures, f"{len(report.failures)} of {POSES} wrong:\n{first}"
    assert len(report.independent) >= POSES
