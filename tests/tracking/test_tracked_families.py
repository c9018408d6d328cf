"""Tracked motions over random families: every frame certified, and proven by support functions.

Seeds as in ``test_cold_families``.
"""

import pytest

from draws import draws
from families.tracked_motions import run_tracked, tracked_families

POSES = draws(120)
SHOWN = 5
"""Failures printed of each family."""


@pytest.mark.parametrize("name", tracked_families())
def test_no_frame_is_wrong(name, rng):
    report = run_tracked(name, POSES, int(rng.integers(1 << 31)))
    first = "\n".join(report.failures[:SHOWN])
    assert not report.failures, f"{len(report.failures)} of {POSES} wrong:\n{first}"
    assert len(report.independent) >= POSES
