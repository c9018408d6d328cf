"""What one core of this machine can do: fused multiply-adds and bytes from memory."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

LANES = 128
"""Sums that grow independently: enough to fill the pipelines of vectors eight wide."""
ROUNDS = 7
PACKAGES = [
    "standoff",
    "numpy",
    "numba",
    "scipy",
    "coal",
    "mujoco",
    "python-fcl",
    "cadquery-ocp-novtk",
]


@njit(fastmath={"contract", "nsz"})
def _multiply_add(sums: Array, factor: float, shift: float, count: int) -> None:
    """Each of 128 sums count times: sum * factor + shift."""
    for block in range(0, 128, 64):
        _block(sums[block : block + 64], factor, shift, count)


@njit(fastmath={"contract", "nsz"}, inline="always")
def _block(sums: Array, factor: float, shift: float, count: int) -> None:
    for _ in range(count):
        for lane in range(64):
            sums[lane] = sums[lane] * factor + shift


def _least(work: Callable[[], object]) -> float:
    work()
    found = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        work()
        found.append(time.perf_counter() - begun)
    return min(found)


def peak() -> float:
    """Fused multiply-adds of one core, operations a second, a multiply-add being two."""
    count = 200_000
    sums = np.ones(LANES)
    taken = _least(lambda: _multiply_add(sums, 0.999, 1e-3, count))
    return 2.0 * LANES * count / taken


def bandwidth() -> float:
    """Bytes a second that one core copies, read and written, of arrays beyond the caches."""
    source = np.ones(32_000_000)
    target = np.empty_like(source)
    return 2.0 * source.nbytes / _least(lambda: np.copyto(target, source))


def processor() -> str:
    """The processor's name and the cores, as the system tells."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.is_file() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.processor()}, {os.cpu_count()} cores"


def versions() -> dict[str, str]:
    """Of Python and of all packages of the table; "not installed" where one is not."""
    found = {"Python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
