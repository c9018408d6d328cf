"""Tracked motions over random families: every frame certified, and proven by support functions.

Seeds as in ``test_cold_families``.
"""

import pytest

from draws import draws
from families.pairs import FAMILIES
from families.tracked_motions import run_tracked, tracked_families
from shares import only

POSES = draws(80)
SHOWN = 5
"""Failures printed of each family."""


# Every other family; the others are asked about from nothing in every run (`test_cold_families`).
KEPT = [name for name in list(FAMILIES)[1::2] if name in tracked_families()]


@pytest.mark.parametrize("name", only(KEPT, tracked_families()))
def test_no_frame_is_wrong(name, rng):
    report = run_tracked(name, POSES, int(rng.integers(1 << 31)))
    first = "\n".join(report.failures[:SHOWN])
    assert not report.failures, f"{len(report.failures)} of {POSES} wrong:\n{first}"
    assert len(report.independent) >= POSES
