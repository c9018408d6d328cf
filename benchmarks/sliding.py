"""Sliding at a constant signed distance, apart and in penetration, and swinging through contact.

Run from the repository's root: ``python -m benchmarks.sliding --steps 1000000 [PAIR ...]``. The
bodies, 1 ms a frame, are those of ``tests/families/sliding.py``, whose signed distance, points and
normal are known in every frame by construction; they are tracked in the compiled loop. A frame
is lost where its distance is more than 1e-9 off or its status says that it is not certified.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.pair import events as logs
from standoff.kernels.state import arrays as rows
from standoff.tracking import calls

Array = NDArray[np.float64]

TESTS = Path(__file__).resolve().parents[1] / "tests"
BLOCK = 20_000
"""Frames of one call of the compiled loop."""
LOST = 1e-9
"""Greatest error of a distance, a length."""
SWINGS = (1e-2, 1e-4)
"""Amplitudes of the oscillation through contact, lengths."""
CERTAIN = ("CONVERGED", "LOCAL", "GLOBAL")
"""Names of the statuses of a frame that is not lost."""
CHECKED = 10
"""Frames of each run compared with the reference: is the constructed depth the least?"""


@dataclass
class Slid:
    """What one run found. Errors are lengths and radians."""

    frames: int = 0
    lost: list[int] = field(default_factory=list)
    statuses: dict[int, int] = field(default_factory=dict)
    distance: float = 0.0
    point: float = 0.0
    normal: float = 0.0
    evaluations: float = 0.0
    most: int = 0
    restarts: int = 0
    seconds: float = 0.0
    deeper: float = 0.0

    def add(self, truth: Any, outs: Array, first: int) -> None:
        error = np.abs(outs[:, rows.DISTANCE] - truth.gaps)
        error = np.where(np.isnan(error), np.inf, error)
        status = outs[:, rows.STATUS].astype(int)
        good = [known.value for known in so.Status if known.name in CERTAIN]
        bad = (error > LOST) | ~np.isin(status, good)
        self.lost += [int(k) + first for k in np.flatnonzero(bad)]
        for value, count in zip(*np.unique(status, return_counts=True), strict=True):
            self.statuses[int(value)] = self.statuses.get(int(value), 0) + int(count)
        points = [
            np.linalg.norm(outs[:, at : at + 3] - known, axis=1).max()
            for at, known in ((rows.POINT_A, truth.points_a), (rows.POINT_B, truth.points_b))
        ]
        turned = np.linalg.norm(outs[:, rows.NORMAL : rows.NORMAL + 3] - truth.normals, axis=1)
        self.distance = max(self.distance, float(error.max()))
        self.point, self.normal = max(self.point, *points), max(self.normal, float(turned.max()))
        counts = outs[:, rows.OUT_COUNTS :]
        spent = counts[:, logs.EVALUATIONS]
        self.evaluations += float(spent.sum())
        self.most = max(self.most, int(spent.max()))
        self.restarts += int(counts[:, logs.RESTARTS].sum())
        self.frames += len(outs)

    def row(self, name: str, gap: str) -> str:
        told = " ".join(f"{n} {so.Status(k).name.lower()}" for k, n in self.statuses.items())
        return (
            f"{name:20s} {gap:>9s} {self.frames:8d} {len(self.lost):6d} {self.distance:9.1e} "
            f"{self.point:9.1e} {self.normal:9.1e} {self.evaluations / self.frames:6.2f}/"
            f"{self.most:<5d} {self.restarts:6d} {1e6 * self.seconds / self.frames:6.2f} "
            f"{self.deeper:9.1e} {told}"
        )


HEADER = (
    f"{'pair':20s} {'gap':>9s} {'frames':>8s} {'lost':>6s} {'distance':>9s} {'point':>9s} "
    f"{'normal':>9s} {'evaluations':>11s} {'starts':>6s} {'µs':>6s} {'deeper':>9s} status"
)


def lesser_depth(slide: Any, truth: Any) -> float:
    """Return how much less than constructed the least depth is, at most, in some frames."""
    from oracles.depth import least_depth
    from standoff_studies.oracles import Placed

    worst = 0.0
    for k in np.linspace(0, len(truth.gaps) - 1, CHECKED).astype(int):
        bodies = [
            Placed(twin.shape, pose[:9].reshape(3, 3), pose[9:])
            for twin, pose in ((slide.a, truth.poses_a[k]), (slide.b, truth.poses_b[k]))
        ]
        if truth.gaps[k] < 0:
            worst = max(worst, -truth.gaps[k] - least_depth(*bodies)[1])
    return worst


def run(slide: Any, gap: Any, steps: int, law: Any = None) -> Slid:
    """Track ``steps`` frames and compare each with the truth."""
    from families.sliding import STEP, frames

    tracker = so.Tracker(slide.a.body, slide.b.body, dt=STEP, law=law or so.PredictorCorrector())
    found = Slid()
    data = None
    for first in range(0, steps, BLOCK):
        count = min(BLOCK, steps - first)
        truth = frames(slide, gap, STEP * (first + np.arange(count)))
        if data is None:
            places = [(p[0, :9].reshape(3, 3), p[0, 9:]) for p in (truth.poses_a, truth.poses_b)]
            data = tracker.start(*places).data.copy()
            found.deeper = lesser_depth(slide, truth)
        begun = time.perf_counter()
        motions = np.hstack([truth.poses_a, truth.poses_b, truth.twists_a, truth.twists_b])
        outs, refused = calls.run(tracker.table, motions, True, np.full(count, STEP), data)
        found.seconds += time.perf_counter() - begun
        if refused >= 0:
            raise RuntimeError(f"frame {first + refused} was refused")
        found.add(truth, outs, first)
    return found


def main() -> int:
    """Print the table; the exit code is 1 if a frame was lost."""
    # The families live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    from families.sliding import GAPS, PAIRS, constant, make, oscillating

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("pairs", nargs="*", help=f"default: all of {', '.join(PAIRS)}")
    parser.add_argument("--steps", type=int, default=1_000_000, help="frames of each run")
    parser.add_argument("--depth", choices=("global", "local"), default="global")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.pairs) - set(PAIRS))
    if unknown:
        parser.error(f"unknown pairs {unknown}: choose from {PAIRS}")
    print("errors: the greatest, lengths and radians; evaluations: mean/most of a step")
    print(HEADER)
    lost = 0
    for name in arguments.pairs or PAIRS:
        gaps = [(f"{gap:+.0e}", constant(gap)) for gap in GAPS]
        gaps += [(f"±{swing:.0e}", oscillating(swing)) for swing in SWINGS]
        slide = make(name)
        for label, gap in gaps:
            found = run(slide, gap, arguments.steps, so.PredictorCorrector(depth=arguments.depth))
            print(found.row(name, label), flush=True)
            if found.lost:
                print(f"    lost: frames {found.lost[:8]}")
            lost += len(found.lost)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
