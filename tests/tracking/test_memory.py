"""Steps from Python leave memory as it was: a leak of a few bytes a step would show."""

import pytest
from benchmarks.memory import FRAMES, STATM, calls, grown

STEPS = 100 * FRAMES
MOST = 8 * STEPS
"""Bytes: an object of the smallest size left behind by every other step."""


@pytest.mark.skipif(not STATM.exists(), reason="read from Linux's account of the process")
@pytest.mark.parametrize("kind", ["step", "step_into", "run"])
def test_memory_stays_flat(kind):
    assert grown(calls()[kind], STEPS) < MOST
