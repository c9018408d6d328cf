"""A recorded, jittery motion carries an ellipsoidal tool past a lens and a rounded box at rest.

Run with ``python -m benchmarks.real_motion FILE``. It prints how many frames were certified, how
far the tracked answers are from cold queries, and what they took. The motion is not part of the
project: FILE is the ``groundtruth.txt`` of sequence freiburg1_xyz of the TUM RGB-D benchmark (CC BY
4.0), a hand-held camera at about 100 Hz with uneven time stamps.
"""

from __future__ import annotations

import argparse
import itertools
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import standoff as so
from standoff.motion import Offset, PoseSamples, read_pose_samples

RECORDING = Path(__file__).parents[1] / "../shared/data/freiburg1_xyz_groundtruth.tum"

TOOL = so.shapes.ellipsoid(0.06, 0.03, 0.02)
TOOL_IN_HAND = so.Pose.exp([0.3, -0.2, 0.5], [0.02, -0.05, 0.12])
"""The tool's place in the recorded body's frame, m."""
OBSTACLES = {
    "lens": (so.shapes.lens(0.15, 0.0675), so.Pose.exp([0.43, 0.62, 2.22], [0.889, 0.536, 1.192])),
    "rounded box": (
        so.shapes.box(0.16, 0.10, 0.12, rounding=0.02),
        so.Pose.exp([1.32, 0.30, 0.42], [1.198, 0.737, 1.358]),
    ),
}
"""Bodies at rest, m, where the tool comes close from many sides and never touches."""

RUNS: dict[str, dict[str, str]] = {
    "twists, PC2": so.PredictorCorrector(),
    "twists, PC": so.PredictorCorrector(predictor="feedforward"),
    "no twists, secant": so.PredictorCorrector(predictor="secant"),
}


@dataclass
class Record:
    """A tracked recording against cold queries. Errors are relative to the pair's size."""

    frames: int = 0
    certified: int = 0
    cold_certified: int = 0
    nearest: float = np.inf
    distance_error: float = 0.0
    witness_error: float = 0.0
    certificate: float = 0.0
    same_features: int = 0
    counts: so.tracking.Counts = field(
        default_factory=lambda: so.tracking.Counts(*[0] * len(so.tracking.Counts._fields))
    )
    corrected_again: int = 0
    features: Counter[str] = field(default_factory=Counter)


def recorded_motion(file: Path = RECORDING) -> PoseSamples:
    """Return the recorded motion, from time 0."""
    return read_pose_samples(file).starting_at(0.0)


def compare(record: Record, answer: so.Proximity, cold: so.Proximity, size: float) -> None:
    """Add one frame's tracked answer and cold query to a record."""
    record.frames += 1
    record.certified += answer.certified
    record.cold_certified += cold.certified
    record.nearest = min(record.nearest, answer.lower_bound)
    error = abs(answer.distance - cold.distance) / size
    record.distance_error = max(record.distance_error, error)
    for tracked, queried in ((answer.point_a, cold.point_a), (answer.point_b, cold.point_b)):
        apart = float(np.linalg.norm(tracked - queried)) / size
        record.witness_error = max(record.witness_error, apart)
    record.certificate = max(record.certificate, (answer.distance - answer.lower_bound) / size)
    record.same_features += answer.feature_a == cold.feature_a
    record.corrected_again += answer.counts.evaluations > 1
    record.counts = so.tracking.Counts(*map(sum, zip(record.counts, answer.counts, strict=True)))
    record.features[str(answer.feature_a)] += 1


def track(name: str, law: so.PredictorCorrector, motion: PoseSamples) -> Record:
    """Track the tool past one obstacle over all samples and compare each with a cold query."""
    body, rest = OBSTACLES[name]
    path = Offset(motion, TOOL_IN_HAND)
    tracker = so.Tracker(body, TOOL, law=law)
    size = body.size + TOOL.size
    record = Record()
    with_twists = law.predictor != "secant"
    twist = path.twist(motion.start) if with_twists else None
    state = tracker.start(rest, path.pose(motion.start), None, twist)
    for before, t in itertools.pairwise(map(float, motion.times)):
        pose = path.pose(t)
        twist = path.twist(t) if with_twists else None
        state, answer = tracker.step(state, rest, pose, None, twist, dt=t - before)
        compare(record, answer, so.distance(body, TOOL, rest, pose), size)
    return record


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("file", nargs="?", type=Path, default=RECORDING, help="poses, .tum or .txt")
    file = parser.parse_args().file
    if not file.exists():
        raise SystemExit(
            f"There is no recording at {file}: give the path of groundtruth.txt of the sequence "
            "freiburg1_xyz (TUM RGB-D benchmark)"
        )
    motion = recorded_motion(file)
    steps = np.diff(motion.times)
    print(
        f"{len(motion.times)} samples, {motion.end:.1f} s, "
        f"steps {1e3 * steps.min():.1f} to {1e3 * steps.max():.1f} ms"
    )
    for name, (body, _) in OBSTACLES.items():
        for run, law in RUNS.items():
            r = track(name, law, motion)
            print(f"\n{name} ({body.size + TOOL.size:.3f} m with the tool), {run}")
            print(f"  certified            {r.certified} of {r.frames} frames")
            print(f"  nearest              {1e3 * r.nearest:.3f} mm")
            print(
                f"  against cold queries distance {r.distance_error:.1e}, witnesses "
                f"{r.witness_error:.1e} of the size; same feature {r.same_features}"
            )
            print(f"  worst certificate    {r.certificate:.1e} of the size")
            print("  " + ", ".join(f"{k} {v}" for k, v in r.counts._asdict().items()))
            print(f"  frames with more than one evaluation: {r.corrected_again}")
            print("  " + ", ".join(f"{k}: {v}" for k, v in sorted(r.features.items())))


if __name__ == "__main__":
    main()
