"""Stored traces of the operator replay: bit for bit on one build, to 1e-12 elsewhere."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import golden_scenes as golden
import numpy as np
import pytest

from standoff.kernels.dynamics import arrays as K

ELSEWHERE = 1e-12
"""Relative to the largest vector of a kind: another machine's roundoff. A change of the start by
1e-15 of itself moves no scene by more than 1.4e-13."""

STORED = np.load(golden.FILE)
SAME_BUILD = str(STORED["build"]) == golden.build()


def off(found: np.ndarray, stored: np.ndarray) -> float:
    """The greatest difference, over the greatest number stored (or one, if that is less)."""
    return float(np.abs(found - stored).max() / max(1.0, np.abs(stored).max()))


@pytest.mark.parametrize("name", golden.SCENES)
def test_a_stored_trace_replays(name: str) -> None:
    found = golden.trace(name)
    bodies = STORED[f"{name} bodies"]
    for o in range(K.STATE_HEADER, bodies.shape[1], K.N_BODY):
        for part, size in ((K.X_ROTATION, 9), (K.X_CENTRE, 3), (K.X_VELOCITY, 3), (K.X_SPIN, 3)):
            columns = slice(o + part, o + part + size)
            assert off(found.bodies[:, columns], bodies[:, columns]) < ELSEWHERE
    assert off(found.bodies[:, : K.STATE_HEADER], bodies[:, : K.STATE_HEADER]) < ELSEWHERE
    assert off(found.energies, STORED[f"{name} energies"]) < ELSEWHERE
    assert off(found.forces, STORED[f"{name} forces"]) < ELSEWHERE
    assert np.array_equal(found.spots, STORED[f"{name} spots"])
    if SAME_BUILD:
        assert found.digest == str(STORED[f"{name} digest"])


def test_traces_replay_bit_for_bit_in_another_process() -> None:
    command = [sys.executable, Path(golden.__file__), "digests"]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    here = {name: golden.trace(name).digest for name in golden.SCENES}
    assert dict(line.split() for line in told.splitlines()) == here


def test_traces_touch_and_let_go() -> None:
    """What is stored is worth it: contacts begin and end, bodies turn, energy is lost."""
    for name in golden.SCENES:
        touches = STORED[f"{name} spots"][:, 0] > 0
        assert touches.any()
        assert touches.all() == name.startswith(("pressed", "sliding"))
        assert STORED[f"{name} bodies"][-1, K.S_LOST] > 1e-4
