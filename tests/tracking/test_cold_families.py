"""Cold queries over random families: every one certified, and proven by support functions.

A failure prints the family's seed.
"""

import pytest

from draws import draws
from families.cold_queries import run_family
from families.pairs import FAMILIES

SHOWN = 5
"""Failures printed of each family."""


@pytest.mark.parametrize("name", FAMILIES)
def test_no_answer_is_wrong(name, rng):
    seed = int(rng.integers(1 << 31))
    poses = draws(FAMILIES[name].poses)
    for report in run_family(name, poses, seed):
        first = "\n".join(report.failures[:SHOWN])
        assert not report.failures, f"{len(report.failures)} of {poses} wrong:\n{first}"
        assert len(report.independent) >= poses
