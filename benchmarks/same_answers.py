"""Do two source trees answer alike, bit for bit: ``python -m benchmarks.same_answers A B``.

A and B are folders with a ``src`` of Standoff. Each answers the same drawn pairs in a process of
its own: pairs of all kinds of shape of the soak, apart, touching, passing and inside each other,
and polygons, tracked over the soak's motions, with cold queries in between. The answers are
written to ``a.npz`` and ``b.npz`` and compared. ``--write FILE`` does the first half for the tree
that PYTHONPATH names.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

import standoff as so
from standoff.geometry.curves import Line
from standoff_studies.soak import cases
from standoff_studies.soak.motions import stream

FRAMES = 100
"""Frames of a pair."""
EVERY = 10
"""Frames from one cold query to the next."""
FLAT_EVERY = 8
"""Pairs from one of polygons to the next."""
FLAT = 7
"""Stream of a seed's random numbers, different from those of the soak's pairs."""
STUDIES = Path(__file__).parents[1] / "studies" / "src"
REST = np.append(np.eye(3).ravel(), np.zeros(3))
"""The pose of a body at rest: R row-major, p."""
TOLD = 20
"""Differences that are told one by one."""
NUMBERS = "distance", "lower_bound", "upper_bound", "normal", "point_a", "point_b"
STATUSES = list(so.Status.__members__)


def rows_of(answers: Any) -> np.ndarray:
    """(n, 13): all numbers of answers, and their statuses."""
    statuses = [STATUSES.index(status.name) for status in answers.status]
    return np.column_stack([*(getattr(answers, name) for name in NUMBERS), statuses])


def matrix(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(R, p) of twelve numbers."""
    return pose[:9].reshape(3, 3), pose[9:]


def polygon(rng: np.random.Generator) -> so.Body:
    """The planar hull of three to nine points around the origin, some of them rounded."""
    points = rng.normal(size=(int(rng.integers(3, 10)), 2)) * rng.uniform(0.1, 1.0, 2)
    corners = np.pad(points[ConvexHull(points).vertices], ((0, 0), (0, 1)))
    sides = [Line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    radius = 0.05 * float(rng.integers(0, 2)) * float(np.ptp(points, axis=0).min())
    return so.shapes.planar_loop(sides, rounding=radius)


def flat_pair(seed: int, number: int) -> tuple[str, so.Body, so.Body, np.ndarray, np.ndarray]:
    """Two polygons; in small steps one is moved and turned through the other."""
    rng = stream(seed, FLAT, number)
    a, b = polygon(rng), polygon(rng)
    k = np.linspace(-1.0, 1.0, FRAMES)
    angle = rng.uniform(0.0, 6.0) + rng.uniform(-1.0, 1.0) * k
    rest = np.tile(REST, (FRAMES, 1))
    poses = rest.copy()
    poses[:, 0] = poses[:, 4] = np.cos(angle)
    poses[:, 3], poses[:, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 9:11] = k[:, None] * rng.normal(size=2) + rng.normal(size=2) * 0.3
    return "polygons", a, b, rest, poses


def solid_pair(seed: int, number: int) -> tuple[str, Any, Any, np.ndarray, np.ndarray]:
    """A pair of the soak and its poses (n, 12)."""
    case, a, b, moves = cases.draw_case(seed, number, FRAMES)
    name = f"{case.family}: {case.a.kind}, {case.b.kind}"
    return name, a.body, b.body, moves.poses_a, moves.poses_b


def answered(seed: int, number: int) -> tuple[str, np.ndarray, np.ndarray]:
    """(name, cold rows, tracked rows) of a pair."""
    draw = flat_pair if number % FLAT_EVERY == 0 else solid_pair
    name, a, b, poses_a, poses_b = draw(seed, number)
    cold = rows_of(so.distances(a, b, poses_a[::EVERY], poses_b[::EVERY]))
    tracker = so.Tracker(a, b, 1e-3)
    state = tracker.start(matrix(poses_a[0]), matrix(poses_b[0]))
    _, tracked = tracker.run(state, poses_a[1:], poses_b[1:])
    return name, cold, rows_of(tracked)


def write(seed: int, pairs: int, file: Path) -> None:
    found = [answered(seed, number) for number in range(pairs)]
    np.savez_compressed(
        file,
        names=np.array([name for name, _, _ in found]),
        cold=np.array([cold for _, cold, _ in found]),
        tracked=np.array([tracked for _, _, tracked in found]),
    )


def written_by(tree: Path, seed: int, pairs: int, file: Path) -> None:
    """Let a tree answer, in a process of its own."""
    settings = os.environ | {"PYTHONPATH": os.pathsep.join([str(tree / "src"), str(STUDIES)])}
    command = [sys.executable, str(Path(__file__).resolve()), "--write", str(file)]
    command += ["--seed", str(seed), "--pairs", str(pairs)]
    subprocess.run(command, env=settings, check=True, cwd=file.parent)


def changes(before: Any, after: Any) -> list[str]:
    """A line for each pair and sort of answer with a number that differs in any bit."""
    told = []
    for sort in ("cold", "tracked"):
        one, other = before[sort], after[sort]
        # the bits, as a not-a-number equals none
        differs = (one.view(np.int64) != other.view(np.int64)).any(axis=2)
        for pair in np.flatnonzero(differs.any(axis=1)):
            rows = np.flatnonzero(differs[pair])
            most = np.nanmax(np.abs(one[pair, rows] - other[pair, rows])[:, 0])
            told.append(
                f"{sort}, pair {pair} ({before['names'][pair]}): {len(rows)} rows, first "
                f"{rows[0]}, distances by up to {most:.3g}, statuses "
                f"{STATUSES[int(one[pair, rows[0], -1])]} and "
                f"{STATUSES[int(other[pair, rows[0], -1])]}"
            )
    return told


def main() -> None:
    reader = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    reader.add_argument("trees", nargs="*", type=Path, help="two folders with a src each")
    reader.add_argument("--pairs", type=int, default=1100)
    reader.add_argument("--seed", type=int, default=1)
    reader.add_argument("--write", type=Path, metavar="FILE", help="answer alone, and write them")
    asked = reader.parse_args()
    if asked.write:
        write(asked.seed, asked.pairs, asked.write)
        return
    if len(asked.trees) != 2:
        reader.error("name two trees, or a file to write.")
    with tempfile.TemporaryDirectory() as scratch:
        files = [Path(scratch) / "a.npz", Path(scratch) / "b.npz"]
        for tree, file in zip(asked.trees, files, strict=True):
            written_by(tree.resolve(), asked.seed, asked.pairs, file)
        before, after = (np.load(file) for file in files)
        told = changes(before, after)
        counts = [before[sort].shape[0] * before[sort].shape[1] for sort in ("cold", "tracked")]
    print("\n".join(told[:TOLD]))
    print(
        f"{counts[0]:,} cold queries and {counts[1]:,} frames of {asked.pairs:,} pairs: "
        f"{len(told)} differ"
    )
    sys.exit(bool(told))


if __name__ == "__main__":
    main()
