"""Cold queries over random families: every one certified, and proven by support functions.

``STANDOFF_POSES`` caps the poses of each family; a failure prints the family's seed.
"""

import os

import numpy as np
import pytest

from families.cold_queries import run_family
from families.pairs import FAMILIES

POSES = int(os.environ.get("STANDOFF_POSES", "3000"))
SHOWN = 5
"""Failures printed of each family."""


@pytest.mark.parametrize("name", FAMILIES)
def test_no_answer_is_wrong(name):
    seed = int(np.random.default_rng().integers(1 << 31))
    poses = min(POSES, FAMILIES[name].poses)
    for report in run_family(name, poses, seed):
        first = "\n".join(report.failures[:SHOWN])
        assert not report.failures, f"{len(report.failures)} of {poses} wrong:\n{first}"
        assert len(report.independent) >= poses
