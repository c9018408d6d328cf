"""Loops of the studies keep their machine code until their file, or a kernel's, changes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba import config

from standoff.kernels.compiler import modules

pytestmark = pytest.mark.skipif(
    bool(config.DISABLE_JIT) or not modules.AVAILABLE,
    reason="each process compiles them by a Numba for which the library's compiler was not written",
)

LOOP = """
from standoff.kernels.algebra.vectors import dot
from standoff_studies.own_kernels import own_kernel

@own_kernel
def part(x):
    return {factor} * x

@own_kernel
def whole(x):
    return dot((part(x), 0.0, 0.0), (1.0, 0.0, 0.0))
"""

ASK = """
from numba.core import event

class Count(event.Listener):
    compiled = 0
    def on_start(self, _):
        Count.compiled += 1
    def on_end(self, _):
        pass

event.register("numba:compile", Count())
from loop import whole
print(whole(3.0), Count.compiled > 0)
"""


def asked(folder: Path, factor: float) -> list[str]:
    """What a new process answers by such a loop, and whether it compiled anything."""
    (folder / "loop.py").write_text(LOOP.format(factor=factor))
    cache = folder / "cache"
    cache.mkdir(mode=0o700, exist_ok=True)
    paths = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    ended = subprocess.run(
        [sys.executable, "-B", "-c", ASK],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": paths},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


def test_a_loop_is_compiled_once_and_anew_after_an_edit_of_its_file(tmp_path: Path) -> None:
    assert asked(tmp_path, 2.0) == ["6.0", "True"]
    assert asked(tmp_path, 2.0) == ["6.0", "False"]
    # the same length and place, of a kernel below it: nothing but the digest tells
    assert asked(tmp_path, 4.0) == ["12.0", "True"]
