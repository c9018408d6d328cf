"""``python -m standoff_studies.soak.solid_overlaps``: motions through contact, judged by samples.

Block k of a seed is a motion of one pair, always the same. Of each stretch of 40 frames a signed
distance is drawn, from 1e-5 to 1e-2 of the size, in overlap or apart, and B slides along A towards
it, at 1e-4 or 1e-3 of the size a frame. Frames keep all minima of the signed distance up to a
fiftieth of the size. Of each stretch one frame is asked from nothing as well: its status is the
same, it has the same minima, both intervals have a depth in common, and no translation that is
proven to part the solids is shorter than what a frame tells that none is. Points of one boundary
that are inside the other solid prove an overlap by themselves.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from standoff.solids import SolidProximity, SolidTracker, distance
from standoff.solids.spatial.points import signed_distances
from standoff.tracking.status import Status
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_motions import SAME, STILL
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of

BLOCK, STRETCH = 1_000, 40
"""Frames of a motion, and of one drawn distance."""
SPEEDS = (1e-4, 1e-3)
"""Of the size a frame."""
DEEPEST, SHALLOWEST = 1e-2, 1e-5
"""Of the size: signed distances that are drawn."""
MINIMA = 0.02
"""Of the size: up to how far on either side of 0 minima are kept."""
PRESSES = 0.5
"""Of what is missing to the drawn distance: how much of it a frame makes up for, at most."""
SPOTS = 40
"""Points of each boundary that are asked, near a sample's deepest place."""
INSIDE = 1e-7
"""Of the size: points that are deeper than this are inside."""


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of frames, of those of each status, of sampled ones, and of those of them that are
    wrong; of minima of samples, of those that a frame did not tell, and of those it told besides;
    of samples in overlap that a shift is proven to part; of frames asked from nothing; and seconds
    of all frames."""

    frames: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    sampled: int = 0
    wrong: int = 0
    minima: int = 0
    lost: int = 0
    besides: int = 0
    overlaps: int = 0
    parted: int = 0
    restarts: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        each = 1e6 * self.seconds / max(self.frames, 1)
        return (
            f"{self.frames:,} frames, {each:.0f} us each; {dict(self.statuses)}, {self.restarts} "
            f"asked from nothing; {self.sampled:,} sampled: {self.wrong} wrong; {self.minima:,} "
            f"minima, {self.lost} lost, {self.besides} besides; {self.overlaps:,} in overlap, "
            f"{self.parted:,} of them proven to be parted by a shift"
        )


class Press:
    """B slides along A, and into it."""

    def __init__(self, a: Any, b: Any, rng: np.random.Generator) -> None:
        self.size, self.rng = 0.5 * (a.size + b.size), rng
        self.tracker = SolidTracker(a, b, minima=MINIMA * self.size)
        way = rng.normal(size=3)
        turn = Rotation.random(random_state=rng).as_matrix()
        self.pose = STILL.copy()
        self.pose[:3, :3] = turn
        far = 2.0 * (a.size + b.size) * way / np.linalg.norm(way)
        self.pose[:3, 3] = a.ball_round()[0] + far - turn @ b.ball_round()[0]
        near = distance(a, b, STILL, self.pose)
        self.pose[:3, 3] -= near.normal * (near.distance - SHALLOWEST * self.size)
        self.state = self.tracker.start(STILL, self.pose)

    def stretch(self, most: int) -> tuple[list[Array], list[SolidProximity], float]:
        """(poses, answers, seconds) of some frames towards a drawn distance; fewer where no place
        is told."""
        rng, size = self.rng, self.size
        share = np.exp(rng.uniform(np.log(SHALLOWEST), np.log(DEEPEST)))
        target = float(rng.choice([-1.0, 1.0]) * share * size)
        speed = float(rng.choice(SPEEDS)) * size
        drift, spin = rng.normal(size=(2, 3))
        poses, answers, seconds = [], [], 0.0
        for _ in range(min(most, STRETCH)):
            found = self.state.proximity
            if not np.isfinite(found.normal).all():
                break
            n, middle = found.normal, found.point_b
            along = drift - n * (drift @ n)
            into = np.clip(PRESSES * (target - found.distance), -speed, speed)
            move = speed * along / np.linalg.norm(along) + into * n
            turn = Rotation.from_rotvec(speed / size * spin / np.linalg.norm(spin)).as_matrix()
            pose = STILL.copy()
            pose[:3, :3] = Rotation.from_matrix(turn @ self.pose[:3, :3]).as_matrix()
            pose[:3, 3] = middle + turn @ (self.pose[:3, 3] - middle) + move
            begun = time.perf_counter()
            self.state, answer = self.tracker.step(self.state, STILL, pose)
            seconds += time.perf_counter() - begun
            self.pose = pose
            poses.append(pose)
            answers.append(answer)
        return poses, answers, seconds


def judged_motion(
    number: int, seed: int, pairs: list[tuple[str, str]], frames: int
) -> tuple[Verdict, list[str]]:
    """A motion of a pair, and its faults' lines."""
    rng = np.random.default_rng([seed, number, 7])
    a, b = (made(name)[1] for name in pairs[number % len(pairs)])
    press, verdict, lines, done = Press(a, b, rng), Verdict(), [], 0
    while done < frames:
        poses, answers, seconds = press.stretch(frames - done)
        if not poses:
            break
        i = int(rng.integers(len(poses)))
        sample, faults = judged(a, b, poses[i], answers[i], MINIMA * press.size, rng)
        names = Counter(answer.status.name for answer in answers)
        restarts = sum(answer.counts.restarts for answer in answers)
        rest = Verdict(len(poses), names, restarts=restarts, seconds=seconds)
        verdict, done = verdict.plus(sample).plus(rest), done + len(poses)
        where = f"seed {seed}, block {number}, {a.name}, {b.name}, pose {poses[i].tolist()}"
        lines += [f"{where}: {fault}" for fault in faults]
    return verdict, lines


def judged(
    a: Any, b: Any, pose: Array, told: SolidProximity, below: float, rng: np.random.Generator
) -> tuple[Verdict, list[str]]:
    """A frame beside a query from nothing at its pose."""
    cold = distance(a, b, STILL, pose, minima=below)
    spare = SAME * (a.size + b.size)
    faults = []
    if told.status is not cold.status:
        faults.append(f"{told.status.name}, and {cold.status.name} from nothing")
    gap = max(told.lower_bound, cold.lower_bound) - min(told.upper_bound, cold.upper_bound)
    if gap > spare:
        faults.append(f"intervals {gap!r} apart")
    if told.status is not Status.OVERLAPPING and is_inside(a, b, pose, told, rng):
        faults.append(f"{told.status.name}, and a point of one is inside the other")
    known = np.array([each.distance for each in told.minima])
    met = cold.status is Status.OVERLAPPING
    placed = not met or cold.minima[0].distance < 0.0  # else the query knows a ball alone
    sought = np.array([m.distance for m in cold.minima if placed and m.distance < below - spare])
    lost = [d for d in sought if not (np.abs(known - d) <= spare).any()]
    besides = [d for d in known if d < below - spare and not (np.abs(sought - d) <= spare).any()]
    parted = met and cold.overlap is not None and cold.overlap.parting is not None
    return (
        Verdict(
            sampled=1, wrong=int(bool(faults)), minima=len(sought), lost=len(lost),
            besides=len(besides), overlaps=int(met), parted=int(parted),
        ),
        faults + [f"minima at {lost!r} lost"] * bool(lost),
    )  # fmt: skip


def is_inside(a: Any, b: Any, pose: Array, told: SolidProximity, rng: np.random.Generator) -> bool:
    """Is a point near the told places inside both solids, or one of those inside the other one?"""
    size = a.size + b.size
    spots = told.point_a + DEEPEST * size * rng.normal(size=(SPOTS, 3))

    def inside(solid: Any, points: Array) -> Any:
        return signed_distances(solid, points).upper_bound < -INSIDE * size

    def in_b(points: Array) -> Array:
        return np.asarray((points - pose[:3, 3]) @ pose[:3, :3])

    if inside(a, told.point_b[None])[0] or inside(b, in_b(told.point_a)[None])[0]:
        return True
    return bool((inside(a, spots) & inside(b, in_b(spots))).any())


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "frames", 1_000_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    given = parser.parse_args()
    work = partial(judged_motion, seed=given.seed, pairs=pairs_of(given.parts), frames=BLOCK)
    verdict = blocks.run(given, BLOCK, work)
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
