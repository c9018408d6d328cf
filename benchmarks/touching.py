"""Sliding contact, oscillation through contact and tilts through parallel, against the truth.

Run with ``python -m benchmarks.touching --steps 1000000``; ``--scene NAME``, ``--gap=-1e-02`` pick
some. Frames of 1 ms in the compiled loop. Of every run it prints the frames lost (no depth or
distance certified, or wrong by more than 1e-9 of the size), the greatest errors of distance, normal
and witness point (where that is unique; else how far it left the set) over the size, the greatest
jump of A's witness point in a frame over the frame's motion, and the most evaluations a frame.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.touching_scenes import SCENES, Frames, Gap, Scene, gaps_of
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.tracking import calls

Array = NDArray[np.float64]

DT = 1e-3
"""s"""
BLOCK = 20000
"""Frames that are held at once."""
RIGHT = 1e-9
"""A distance may be wrong by so much of the size, else the frame is lost."""
STATUSES = tuple(float(s.value) for s in so.Status if s.name in ("CONVERGED", "LOCAL", "GLOBAL"))
AT_REST = np.concatenate([np.eye(3).ravel(), np.zeros(3)])
HEADER = (
    f"{'scene':26s} {'gap':>11s} {'frames':>8s} {'lost':>6s} {'distance':>9s} {'normal':>9s} "
    f"{'witness':>9s} {'jump':>8s} {'most eval.':>10s} {'restarts':>8s} {'uncertain':>9s}"
)


@dataclass
class Report:
    """What a run was like. Errors are over the size of the pair, or radians."""

    scene: str
    gap: str
    frames: int = 0
    lost: int = 0
    first_lost: int = -1
    distance: float = 0.0
    normal: float = 0.0
    witness: float = 0.0
    jump: float = 0.0
    flips: int = 0
    evaluations: int = 0
    restarts: int = 0
    bound: float = -np.inf
    """Greatest excess of the lower bound over the truth, over the size: at most roundoff."""
    loose: int = 0
    """Frames whose lower bound is more than RIGHT below the distance."""

    def __str__(self) -> str:
        return (
            f"{self.scene:26s} {self.gap:>11s} {self.frames:8d} {self.lost:6d} "
            f"{self.distance:9.1e} {self.normal:9.1e} {self.witness:9.1e} {self.jump:8.2f} "
            f"{self.evaluations:10d} {self.restarts:8d} {self.loose:9d}"
        )


def run(scene: Scene, name: str, gap: Gap, steps: int, *, twists: bool = True) -> Report:
    """Track a scene from a cold start for some frames; report it."""
    report = Report(scene.name, name)
    tracker = so.Tracker(scene.a, scene.b, DT)
    state = None
    last: tuple[Array, Frames, Array] | None = None
    for first in range(0, steps, BLOCK):
        count = min(BLOCK, steps - first)
        times = DT * (first + np.arange(count))
        frames, xi = scene.motion(times, gap)
        poses = np.hstack([frames.rotations.reshape(-1, 9), frames.positions])
        if state is None:
            pose = so.Pose.from_checked(frames.rotations[0], frames.positions[0])
            state = tracker.start(so.Pose.identity(), pose).data.copy()
        rest = np.tile(AT_REST, (count, 1))
        motions = np.hstack([rest, poses, 0.0 * xi, xi if twists else 0.0 * xi])
        outs, at = calls.run(tracker.table, motions, twists, np.full(count, DT), state)
        if at >= 0:
            raise ValueError(f"{scene.name}: frame {first + at} was refused")
        judge(report, scene, frames, gap(times), outs, first)
        moved(report, scene, frames, outs, last)
        last = outs[-1:], frames, xi
    return report


def judge(
    report: Report, scene: Scene, frames: Frames, gaps: Array, outs: Array, first: int
) -> None:
    """Add a block's errors to a report."""
    size = scene.size
    errors = np.abs(outs[:, K.DISTANCE] - gaps) / size
    lost = ~np.isin(outs[:, K.STATUS], STATUSES) | ~(errors <= RIGHT)
    if lost.any() and report.first_lost < 0:
        report.first_lost = first + int(lost.argmax())
    report.frames += len(outs)
    report.lost += int(lost.sum())
    turn = np.linalg.norm(outs[:, K.NORMAL : K.NORMAL + 3] - frames.normals, axis=1)
    report.distance = max(report.distance, worst(errors))
    report.normal = max(report.normal, worst(turn))
    x = outs[:, K.POINT_A : K.POINT_A + 3]
    if scene.outside is not None:
        report.witness = max(report.witness, worst(scene.outside(frames, x)) / size)
    elif not scene.jumps:
        miss = np.linalg.norm(x - frames.points, axis=1)
        report.witness = max(report.witness, worst(miss) / size)
    report.evaluations = max(report.evaluations, int(outs[:, K.OUT_COUNTS + N.EVALUATIONS].max()))
    report.restarts += int(outs[:, K.OUT_COUNTS + N.RESTARTS].sum())
    over = (outs[:, K.LOWER_BOUND] - gaps) / size
    report.bound = max(report.bound, worst(over))
    report.loose += int((outs[:, K.DISTANCE] - outs[:, K.LOWER_BOUND] > RIGHT * size).sum())


def worst(values: Array) -> float:
    """The greatest; inf where one is no number."""
    return float(np.where(np.isnan(values), np.inf, values).max())


def moved(
    report: Report,
    scene: Scene,
    frames: Frames,
    outs: Array,
    last: tuple[Array, Frames, Array] | None,
) -> None:
    """Add a block's jumps: how far A's witness point moves in a frame, over the frame's motion."""
    x, n = outs[:, K.POINT_A : K.POINT_A + 3], outs[:, K.NORMAL : K.NORMAL + 3]
    positions, rotations = frames.positions, frames.rotations
    if last is not None:
        row, before, _ = last
        x = np.vstack([row[:, K.POINT_A : K.POINT_A + 3], x])
        n = np.vstack([row[:, K.NORMAL : K.NORMAL + 3], n])
        positions = np.vstack([before.positions[-1:], positions])
        rotations = np.vstack([before.rotations[-1:], rotations])
    turn = np.linalg.norm(np.diff(rotations, axis=0), axis=(1, 2)) / np.sqrt(2)
    motion = np.linalg.norm(np.diff(positions, axis=0), axis=1) + turn * scene.b.size
    jumps = np.linalg.norm(np.diff(x, axis=0), axis=1) / motion
    report.jump = max(report.jump, worst(jumps)) if len(jumps) else report.jump
    report.flips += int(((n[1:] * n[:-1]).sum(axis=1) < 0.0).sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10000, help="frames of 1 ms a run")
    parser.add_argument("--scene", default="", help="scenes whose names hold this")
    parser.add_argument("--gap", action="append", help="only this gap, by its name in the table")
    parser.add_argument("--no-twists", action="store_true", help="predict by the secant")
    options = parser.parse_args()
    print(HEADER)
    for scene in SCENES:
        if options.scene not in scene.name:
            continue
        for name, gap in gaps_of(scene):
            if options.gap and name not in options.gap:
                continue
            report = run(scene, name, gap, options.steps, twists=not options.no_twists)
            print(report, flush=True)


if __name__ == "__main__":
    main()
