"""Table of errors on ellipsoid pairs known by construction: Standoff, Coal and MuJoCo.

Run from the repository's root: ``python -m benchmarks.exact_ellipsoids --poses 1000``. The pairs
are those of ``tests/tracking/test_exact_pairs.py``: gaps of 1e-3 to 1 of the size. Distances and
witness points are relative to the size (the greater diameter).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import standoff as so
from benchmarks.peers import PEERS, Array, PeerAnswer, Query

TESTS = Path(__file__).resolve().parents[1] / "tests"
HEADER = (
    f"{'axes ratio':>10s}  {'package':18s}{'distance':>20s}{'witness points':>20s}{'normal':>20s}"
    f"{'no answer':>11s}"
)


def standoff_ellipsoids(axes_a: Array, axes_b: Array) -> Query:
    """Return the library's own query in the form of the peers'."""
    a, b = so.shapes.ellipsoid(*axes_a), so.shapes.ellipsoid(*axes_b)

    def query(pose_a: tuple[Array, Array], pose_b: tuple[Array, Array]) -> PeerAnswer:
        found = so.distance(a, b, pose_a, pose_b)
        return PeerAnswer(found.distance, found.point_a, found.point_b, found.normal)

    return query


MAKERS: dict[str, Callable[[Array, Array], Query]] = {"Standoff": standoff_ellipsoids, **PEERS}


def main() -> int:
    """Print the table."""
    # The exact pairs live beside the tests, which are not installed.
    sys.path.insert(0, str(TESTS))
    from families.exact_ellipsoids import RATIOS, SIZE, draw_pairs

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--poses", type=int, default=1000, help="poses of each axes ratio")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    print(f"{arguments.poses} poses a ratio, seed {arguments.seed}; errors median/max")
    print(HEADER)
    for ratio in RATIOS:
        errors: dict[str, list[tuple[float, float, float]]] = {name: [] for name in MAKERS}
        missing = dict.fromkeys(MAKERS, 0)
        for pair in draw_pairs(ratio, arguments.poses, np.random.default_rng(arguments.seed)):
            queries = {name: make(pair.axes_a, pair.axes_b) for name, make in MAKERS.items()}
            for truth in pair.poses:
                for name, query in queries.items():
                    found = query(truth.pose_a, truth.pose_b)
                    witness = max(
                        float(np.linalg.norm(found.point_a - truth.point_a)),
                        float(np.linalg.norm(found.point_b - truth.point_b)),
                    )
                    if not (found.distance > 0.0 and np.isfinite(witness)):
                        missing[name] += 1
                        continue
                    distance = abs(found.distance - truth.distance) / SIZE
                    turn = float(np.linalg.norm(found.normal - truth.normal))
                    errors[name].append((distance, witness / SIZE, turn))
        for name, rows in errors.items():
            middle, worst = np.median(rows, axis=0), np.max(rows, axis=0)
            cells = [f"{m:.1e}/{w:.1e}" for m, w in zip(middle, worst, strict=True)]
            print(
                f"{ratio:10g}  {name:18s}{cells[0]:>20s}{cells[1]:>20s}{cells[2]:>20s}"
                f"{missing[name]:11d}",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
