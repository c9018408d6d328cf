"""Paths of robots that packages bring, judged by Pinocchio's kinematics and Coal's distances."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pinocchio")
pytest.importorskip("coal")

from benchmarks.certify import REAL, real_paths


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if name == "panda" else [pytest.mark.soak]) for name in REAL],
)
def test_no_proof_is_wrong(name: str, rng: np.random.Generator) -> None:
    found = real_paths(name, 6, 400, rng)
    assert found.wrong == []
    assert found.verdicts["PROVEN"] >= 1
    assert found.verdicts["VIOLATED"] >= 1
