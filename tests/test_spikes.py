"""The switching spike still runs on the kernels, and still finds what its page says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SPIKES = Path(__file__).parents[1] / "docs" / "spikes"


@pytest.mark.soak
def test_switching_spike_finds_no_cycle_and_no_wrong_answer() -> None:
    # In plain Python: nothing to compile, and the kernels are read as they are written.
    run = subprocess.run(
        [sys.executable, str(SPIKES / "switching.py"), "--starts", "60", "--rule-starts", "1"],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in run.stdout.splitlines()]
    titles, total = rows[0], next(row for row in rows if row and row[0] == "all")
    found = dict(zip(titles, total, strict=True))
    assert int(found["starts"]) >= 60
    for column in ("exhausted", "stalled", "wrong else", "false proof", "wrong at last", "differs"):
        assert int(found[column]) == 0, column
