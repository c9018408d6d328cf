"""Proofs along paths of real arms, judged by Pinocchio with Coal, and by MuJoCo."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")
pytest.importorskip("coal")

from real_arms import MUJOCO, arm, sampled, wrong_in

from draws import draws
from standoff.robots.proof import Verdict

SAMPLES = 300
"""Of a path here; benchmarks.certify takes 10^4 and more."""


@pytest.mark.parametrize("name", ["ur5", "kinova", "panda", MUJOCO])
def test_no_proof_is_wrong(name: str) -> None:
    judged, rng = arm(name), np.random.default_rng(28)
    verdicts: list[Verdict] = []
    while len(verdicts) < 2 * draws(3):
        points = judged.path(rng)
        samples = sampled(judged, points, SAMPLES)
        if samples.least.min() < 5e-3:
            continue
        for margin in (1e-3, -1e-3):
            proof = judged.robot.certify(points, samples.least.min() - margin)
            assert wrong_in(proof, judged, points, samples) == ""
            verdicts.append(proof.verdict)
    assert verdicts.count(Verdict.UNDECIDED) == 0
    assert min(verdicts.count(Verdict.PROVEN), verdicts.count(Verdict.VIOLATED)) > 0
