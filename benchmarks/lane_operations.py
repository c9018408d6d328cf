"""``python -m benchmarks.lane_operations A B C D E F``: operations a row of ellipsoids in lanes.

Prints, as JSON, how often a row adds, multiplies, divides and takes a root, by numbers that count,
run through the compiled functions' own source. Run by `benchmarks.lanes`, with NUMBA_DISABLE_JIT=1.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.algebra import roots
from standoff.kernels.lanes import cold_layout, ellipsoids
from standoff.kernels.lanes.layout import ROWS
from standoff.kernels.values import Pair

counts: Counter[str] = Counter()
METHODS = {
    "add": ("__add__", "__radd__", "__sub__", "__rsub__"),
    "multiply": ("__mul__", "__rmul__"),
    "divide": ("__truediv__", "__rtruediv__"),
}
GOAL = 1e-6
"""How narrow the gap of a proof must be, in spans."""
APART = 2.6
"""Between the origins, length."""


class Counted(float):
    """A number that counts what is done with it."""

    def __neg__(self) -> Counted:
        return Counted(-float(self))

    def __abs__(self) -> Counted:
        return Counted(abs(float(self)))


def count(name: str, method: str) -> None:
    """Let a method of `Counted` count itself under a name."""
    plain = getattr(float, method)

    def operate(self: float, other: float) -> Counted:
        counts[name] += 1
        return Counted(plain(float(self), float(other)))

    setattr(Counted, method, operate)


def root(x: float) -> Counted:
    counts["root"] += 1
    return Counted(math.sqrt(x))


def counted(values: Any) -> NDArray[np.object_]:
    return np.array([Counted(x) for x in np.ravel(values)], dtype=object)


def drawn() -> NDArray[np.float64]:
    """Poses in lanes."""
    rng, poses = np.random.default_rng(1), np.empty((12, ROWS))
    for row in range(ROWS):
        q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        way = rng.normal(size=3)
        poses[:9, row] = (q * np.linalg.det(q)).ravel()
        poses[9:, row] = APART * way / np.linalg.norm(way)
    return poses


def main() -> None:
    """Print the counts of a row, and how many normals it tried."""
    axes = [float(x) for x in sys.argv[1:7]]
    a, b = so.shapes.ellipsoid(*axes[:3]), so.shapes.ellipsoid(*axes[3:])
    for name, methods in METHODS.items():
        for method in methods:
            count(name, method)
    roots._root = root
    cold_layout.reals_on_stack = lambda size: counted(np.zeros(size))
    pair = Pair(a.ints, counted(a.reals), b.ints, counted(b.reals))
    still = np.zeros((12, ROWS))
    still[[0, 4, 8]] = 1.0
    block, which = cold_layout.block_on_stack(), np.zeros(ROWS, dtype=np.int64)
    for lanes, poses in ((block.poses, drawn()), (block.poses_a, still)):
        lanes[:] = counted(poses)
    block.goals[:] = counted(np.full(ROWS, GOAL))
    counts.clear()
    ellipsoids.query_block(lambda *_: pair, None, which, True, block)
    tried = block.answers[ellipsoids.TRIED * ROWS :].astype(float)
    told = {name: number / ROWS for name, number in counts.items()}
    print(json.dumps(told | {"tried": float(tried.mean()), "proven": int(block.good.sum())}))


if __name__ == "__main__":
    main()
