"""Checked indices: that they are seen, and that the kernels, as plain Python, have none at fault.

The long run, compiled, is ``python -m benchmarks.bounds_check``; see docs/fuzzing.md.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

AT_FAULT = """
import numpy as np
from standoff.kernels.compiler.decorators import kernel, pointer, stack_reals

@kernel
def get(array, offset, index):
    return pointer(array, offset)[index]

@kernel
def put(array, index):
    pointer(array, 0)[index] = 7.0
    block = stack_reals()
    block[0] = 1.0
    return block[0] + block[1]

@kernel
def beyond(array, index):
    return array[index]

numbers = np.arange(5.0)
assert get(numbers, 1, 3) == 4.0
assert np.isnan(put(numbers, 4)), "what was never set must be NaN"
assert numbers[4] == 7.0
for call in (
    lambda: get(numbers, 1, 4),
    lambda: get(numbers, 1, -1),
    lambda: put(numbers, 5),
    lambda: put(numbers, -1),
    lambda: beyond(numbers, 5),
):
    try:
        call()
    except IndexError:
        continue
    raise SystemExit("an index out of range went unseen")
"""


def run(*command: str, compiled: bool) -> subprocess.CompletedProcess[str]:
    """Run Python with the library of this checkout and every index checked, without a cache."""
    settings = {
        "STANDOFF_BOUNDS_CHECK": "1",
        "NUMBA_DISABLE_JIT": "0" if compiled else "1",
        "NUMBA_CACHE_DIR": "",
        "PYTHONPATH": str(ROOT / "src"),
    }
    return subprocess.run(
        [sys.executable, *command],
        cwd=ROOT,
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("compiled", [True, False])
def test_an_index_out_of_range_is_seen(compiled: bool) -> None:
    done = run("-c", AT_FAULT, compiled=compiled)
    assert done.returncode == 0, done.stderr + done.stdout


SEED = pytest.param(("--seed", "1"), id="the same pairs")
# As plain Python a pair that is hard to answer takes minutes.
FRESH = pytest.param((), id="fresh pairs", marks=[pytest.mark.soak])


@pytest.mark.parametrize("seed", [SEED, FRESH])
def test_no_kernel_leaves_its_arrays(seed: tuple[str, ...]) -> None:
    short = ("--python", "--poses", "1", "--frames", "2", *seed)
    families = ("NURBS-box", "planar-point", "solids")
    done = run("-m", "benchmarks.bounds_check", *short, *families, compiled=False)
    assert done.returncode == 0, done.stderr + done.stdout
