"""``python -m benchmarks.lanes``: ellipsoids in lanes, cold rows and frames, beside scalar code.

Times a row of the compiled loops, in turn, medians; the share of the peak of fused multiply-adds
that was measured in the same run; two threads; and the vector instructions of the machine code.
Operations are counted by numbers that count, run through the same functions without the compiler.
Then frames of many states, and of a world of different ellipsoids.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from statistics import median
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

import standoff as so
from benchmarks import many_frames
from benchmarks.many_frames import drawn
from standoff.kernels.entries import batch
from standoff.kernels.state import arrays as K
from standoff.tracking.reached import cold_tables
from standoff.tracking.row_pairs import row_pairs
from standoff.tracking.threads import in_parts

Array = NDArray[np.float64]
SHAPES = {
    "0.5, 0.8, 0.9 and 0.15, 0.3, 0.2": ((0.5, 0.8, 0.9), (0.15, 0.3, 0.2)),
    "1, 0.2, 0.2 and 0.2, 0.2, 1": ((1.0, 0.2, 0.2), (0.2, 0.2, 1.0)),
    "1, 0.02, 1 and 1, 1, 0.02": ((1.0, 0.02, 1.0), (1.0, 1.0, 0.02)),
}
ROUNDS = 5
BEYOND_ALL = 1e6
"""A horizon, length, that no row is beyond: it takes the general code."""
REST = np.eye(4)[None]


Bodies = so.Body | list[so.Body]


class Rows:
    """The compiled loop over rows, with what it writes to."""

    def __init__(self, a: Bodies, b: Bodies, poses: Array, within: float | None) -> None:
        self.tables, self.poses = cold_tables(row_pairs(a, b), within), poses
        self.rows, self.done = np.empty((len(poses), K.N_OUT)), np.zeros(len(poses), dtype=np.int64)

    def run(self, workers: int = 1) -> float:
        """Seconds."""

        given = self.tables.numbers, self.tables.which, REST, self.poses

        def part(first: int, end: int) -> None:
            batch.starts(*given, first, end, self.rows, self.done)

        begun = time.perf_counter()
        in_parts(part, len(self.poses), workers)
        return time.perf_counter() - begun


CHAIN = 32


@njit(fastmath={"contract"}, error_model="numpy")  # type: ignore[misc]
def _chains(values: Array, times: int) -> None:
    for _ in range(times):
        for k in range(len(values)):
            x = values[k]
            for _ in range(CHAIN):
                x = x * 0.999 + 1e-3
            values[k] = x


def peak() -> float:
    """Fused multiply-adds a second of one core, measured: independent chains in vectors."""
    values, times = np.ones(128), 20_000
    _chains(values, 1)
    taken = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        _chains(values, times)
        taken.append(time.perf_counter() - begun)
    return CHAIN * len(values) * times / min(taken)


def operations(axes: Any) -> dict[str, float]:
    """Of a row, by kind, and how many normals were tried."""
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.lane_operations", *(str(x) for x in np.ravel(axes))],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "STANDOFF_QUIET": "1"},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    counted: dict[str, float] = json.loads(done.stdout)
    return counted


ASSEMBLY = r"""
from standoff.kernels.entries.{} import {} as entry
entry.prepare()
print(entry.overloads[entry.signature].library.get_asm_str())
"""


def instructions(module: str, entry: str) -> Counter[str]:
    """Floating-point instructions of an entry's machine code, compiled anew: by width."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": folder, "STANDOFF_QUIET": "1"}
        done = subprocess.run(
            [sys.executable, "-c", ASSEMBLY.format(module, entry)],
            env=environment, capture_output=True, text=True, check=True,
        )  # fmt: skip
    found: Counter[str] = Counter()
    for line in done.stdout.splitlines():
        name = re.match(r"\s+v?(\w+)\s", line)
        if name is None or not re.search(r"(add|sub|mul|div|sqrt|max|min)\w*[ps]d$", name[1]):
            continue
        widest = next((w for w in ("zmm", "ymm") if w in line), "xmm")
        fused = "fused " if re.match(r"fn?m(add|sub)", name[1]) else ""
        found[f"{fused}{widest} {'packed' if name[1].endswith('pd') else 'scalar'}"] += 1
    return found


def compared(axes: tuple[Any, Any], n: int) -> tuple[float, float, float, float]:
    """(seconds a row in lanes, by two threads, in the general code; largest difference of distances
    over the size)."""
    a, b = so.shapes.ellipsoid(*axes[0]), so.shapes.ellipsoid(*axes[1])
    poses = drawn(n, (1.02 * (max(axes[0]) + max(axes[1])), 4.0))
    lanes, general = Rows(a, b, poses, None), Rows(a, b, poses[: max(n // 10, 1000)], BEYOND_ALL)
    taken: dict[str, list[float]] = {"lanes": [], "two": [], "general": []}
    lanes.run(), general.run()
    for _ in range(ROUNDS):
        taken["lanes"].append(lanes.run() / n)
        taken["two"].append(lanes.run(2) / n)
        taken["general"].append(general.run() / len(general.poses))
    miss = abs(lanes.rows[: len(general.rows), K.DISTANCE] - general.rows[:, K.DISTANCE]).max()
    one, two, other = (median(taken[name]) for name in ("lanes", "two", "general"))
    return one, two, other, float(miss / (a.size + b.size))


KINDS, MIXED = (2, 10, 40), 100_000
"""Ellipsoids of different axes, each of which may stand on either side of a row; rows of them."""


def of_different_bodies(count: int) -> str:
    """Rows whose bodies are drawn from `count` ellipsoids, beside rows of two of these."""
    rng = np.random.default_rng(1)
    kinds = [so.shapes.ellipsoid(*axes) for axes in rng.uniform(0.2, 1.0, size=(count, 3))]
    poses = drawn(MIXED, (2.1, 4.0))
    a, b = ([kinds[k] for k in rng.integers(0, count, MIXED)] for _ in range(2))
    every = {"mixed": Rows(a, b, poses, None), "alike": Rows(kinds[0], kinds[1], poses, None)}
    taken: dict[str, list[float]] = {name: [] for name in every}
    for each in every.values():
        each.run()
    for _ in range(ROUNDS):
        for name, each in every.items():
            taken[name].append(each.run() / MIXED)
    mixed, alike = median(taken["mixed"]), median(taken["alike"])
    return (
        f"rows of {len(every['mixed'].tables.tables)} pairs: {1e9 * mixed:.0f} ns, of one "
        f"pair {1e9 * alike:.0f} ns ({mixed / alike:.2f} times)"
    )


def main() -> None:
    """Print times, ratios, the share of the peak and the counts of instructions."""
    fused = peak()
    print(f"peak of one core: {fused / 1e9:.1f} e9 fused multiply-adds a second")
    for name, axes in SHAPES.items():
        counted = operations(axes)
        for n in (1_000, 10_000, 100_000, 1_000_000):
            one, two, other, miss = compared(axes, n)
            print(
                f"{name}, {n:,} rows: {1e9 * one:.0f} ns in lanes, {1e9 * other:.0f} ns in the "
                f"general code ({other / one:.1f} times), two threads {one / two:.2f} times, "
                f"distances differ by {miss:.1e} of the size"
            )
        kinds = ("add", "multiply", "divide", "root")
        flops = sum(counted[kind] for kind in kinds)
        print(
            f"  {counted['tried']:.1f} normals a row: {flops:.0f} operations "
            f"({counted['divide']:.0f} divisions, {counted['root']:.0f} roots), "
            f"{flops / one / (2.0 * fused):.1%} of the peak"
        )
    for count in KINDS:
        print(of_different_bodies(count))
    print("machine code:", dict(sorted(instructions("batch", "starts").items())))
    for line in many_frames.told(SHAPES):
        print(line)
    print("machine code:", dict(sorted(instructions("tracker", "value_of_each").items())))


if __name__ == "__main__":
    main()
