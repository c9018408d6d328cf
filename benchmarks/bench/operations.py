"""What a frame of two ellipsoids computes: floating-point operations and bytes, counted.

The frame's own kernels run in plain Python on numbers that count what is done with them, so a
process with NUMBA_DISABLE_JIT=1 is needed (``counted`` starts one). A sum, a product, a comparison,
a division, a root are one operation each; a read or written element of an array 8 bytes.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from typing import Any, NamedTuple

import numpy as np

FRAMES = 8
"""Of which the last is counted: the first go through the general frame."""

done: Counter[str] = Counter()


class Cost(NamedTuple):
    """Of one frame."""

    sums: int  # and differences, comparisons, signs
    products: int
    divisions: int  # and roots
    bytes_read: int
    bytes_written: int

    @property
    def operations(self) -> int:
        return self.sums + self.products + self.divisions


class Counted(float):
    """A number that counts what is done with it."""

    def _told(self, kind: str, result: Any) -> Any:
        done[kind] += 1
        return Counted(result) if isinstance(result, float) else result


def _operation(name: str, kind: str) -> None:
    plain = getattr(float, name)

    def operate(self: Counted, *others: Any) -> Any:
        return self._told(kind, plain(self, *(float(x) for x in others)))

    setattr(Counted, name, operate)


for _name in ("add", "radd", "sub", "rsub", "neg", "abs", "lt", "le", "gt", "ge"):
    _operation(f"__{_name}__", "sums")
for _name in ("mul", "rmul"):
    _operation(f"__{_name}__", "products")
for _name in ("truediv", "rtruediv"):
    _operation(f"__{_name}__", "divisions")


class Numbers:
    """An array, or a pointer into one, whose reads and writes are counted."""

    def __init__(self, values: list[Any], first: int = 0) -> None:
        self.values, self.first = values, first

    def view(self, *_: Any) -> Numbers:
        return self

    def reshape(self, *_: Any) -> Numbers:
        return self

    def __len__(self) -> int:
        return len(self.values) - self.first

    def __getitem__(self, at: Any) -> Any:
        if isinstance(at, slice):
            return Numbers(self.values, self.first + int(at.start or 0))
        done["reads"] += 1
        return self.values[self.first + int(at)]

    def __setitem__(self, at: int, value: Any) -> None:
        done["writes"] += 1
        self.values[self.first + int(at)] = value


def _numbers(array: Any) -> Numbers:
    kind = int if array.dtype.kind == "i" else Counted
    return Numbers([kind(x) for x in array])


def count() -> Cost:
    """The cost of a smooth frame; in plain Python."""
    import standoff as so
    from standoff.kernels.algebra import roots
    from standoff.kernels.entries.smooth import on_sphere
    from standoff.kernels.frame import smooth
    from standoff.kernels.frame.inputs import N_CHANGE, Inputs
    from standoff.kernels.frame.record import Called
    from standoff.kernels.state import arrays as K
    from standoff.kernels.state.options import read_options
    from standoff.kernels.values import Pair

    def root(x: Any) -> Any:
        done["divisions"] += 1
        return Counted(float(x) ** 0.5)

    for module in [m for name, m in sys.modules.items() if name.startswith("standoff.kernels")]:
        if getattr(module, "sqrt", None) is roots.sqrt:
            module.sqrt = root  # type: ignore[attr-defined]
    a, b = so.shapes.ellipsoid(0.52, 1.04, 0.89), so.shapes.ellipsoid(0.15, 0.30, 0.20)
    tracker = so.Tracker(a, b)
    turn = so.Twist([0.0, 2.0, 0.0], [0.0, 0.0, 2.0])
    frames = [so.Pose.exp([0.0, 0.0, 2e-3 * k], [1.7, 2e-3 * k, 0.0]) for k in range(FRAMES + 1)]
    rest, still = so.Pose.identity(), so.Twist([0.0] * 3, [0.0] * 3)
    state = tracker.start(rest, frames[0], still, turn)
    for pose in frames[1:FRAMES]:
        state, _ = tracker.step(state, rest, pose, still, turn)
    buffer = tracker.buffer(state)
    flat = [np.r_[p.rotation.ravel(), p.translation] for p in (rest, frames[FRAMES])]
    twists = [np.r_[x.v, x.omega] for x in (still, turn)]
    unused = np.zeros(N_CHANGE)
    inputs = Inputs(*(_numbers(x) for x in (*flat, *twists, unused)), True)
    pair = Pair(*(_numbers(x) for x in (a.ints, a.reals, b.ints, b.reals)))
    options, kept = read_options(_numbers(tracker.options)), _numbers(buffer.state.copy())
    out = _numbers(np.zeros(K.N_OUT))
    done.clear()
    call = Called(pair, inputs, options, kept, out, None)
    answered = smooth.smooth_frame(on_sphere, on_sphere, smooth.FACES, call, Counted(tracker.dt))
    if answered != 1:
        raise RuntimeError("the smooth frame did not answer")
    return Cost(
        done["sums"], done["products"], done["divisions"], 8 * done["reads"], 8 * done["writes"]
    )


def counted() -> Cost:
    """`count`, in a process of its own."""
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks.bench.operations"],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    return Cost(*json.loads(run.stdout))


if __name__ == "__main__":
    print(json.dumps(count()))
