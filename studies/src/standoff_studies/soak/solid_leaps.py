"""``python -m standoff_studies.soak.solid_leaps``: motions of two solids that leap.

Block k of a seed is a motion of one pair, always the same. Each frame moves B by 0.2 to 3 times the
distance, 5e-2 of the size at most, along A's surface, towards it or away, so that some leap into
overlap, from which the next ones lead out. In three motions of ten all local minima below a length
are kept. Each frame is made by ``step`` and in place, and both must tell the same numbers. Those
that do not converge, and half of the others, are asked from nothing as well: statuses and intervals
must not contradict each other, and each minimum that the query finds must be among those kept.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from standoff.solids import SolidFrameBuffer, SolidProximity, SolidTracker
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.status import Status
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_motions import STILL, budget, missing
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of
from standoff_studies.soak.tracked_solids import Differs, compare

BLOCK = 150
"""Frames of a motion."""
LEAST, MOST = 0.2, 3.0
"""Of the distance: how far a frame leaps."""
NEAREST, FARTHEST = 1e-4, 5e-2
"""Of the size: what the distance counts for at least and at most."""
HELD = 5
"""Frames for which directions are held."""
NEAR, FAR = 2e-3, 5e-2
"""Of the size: nearer than this B is led away, farther off towards A."""
TOWARDS, AWAY = 0.4, 0.5
"""Of the way along the surface: how much leads towards A, or away from it, as a deviation."""
OUT = 0.2
"""In an overlap, of the way out along the normal: the way along the surface."""
KEEPING, MINIMA_BELOW = 0.3, 0.05
"""Share of the motions that keep all local minima, and below what, of the size."""
SAMPLED = 0.5
"""Share of the frames that converge which are asked from nothing too."""


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of frames, of those of each status, of leaps farther than the distance, and of sampled
    frames; of samples that are wrong, and of those that are so certified; of frames that were told
    otherwise in place; of sampled minima, and of those of them that were not told; and seconds of
    all frames."""

    FAULTS = ("wrong", "otherwise", "lost")
    frames: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    leaps: int = 0
    sampled: int = 0
    wrong: int = 0
    silent: int = 0
    otherwise: int = 0
    minima: int = 0
    lost: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        return (
            f"{self.frames:,} frames, {1e6 * self.seconds / max(self.frames, 1):.0f} us each; "
            f"{dict(self.statuses)}, {self.leaps:,} leaps beyond the distance; {self.sampled:,} "
            f"sampled: {self.wrong} wrong, {self.silent} of them certified; {self.otherwise} told "
            f"otherwise in place; {self.minima:,} minima, {self.lost} lost"
        )


class Leaps:
    """Poses of B, one after the other, while A stays."""

    def __init__(self, a: Any, b: Any, rng: np.random.Generator) -> None:
        self.size, self.rng, self.done = 0.5 * (a.size + b.size), rng, 0
        self.centre, self.radius = b.ball_round()
        self.v: Array
        self.w: Array
        self.turn = Rotation.random(random_state=rng).as_matrix()
        way = rng.normal(size=3)
        self.middle = a.ball_round()[0] + 1.1 * self.size * way / np.linalg.norm(way)

    @property
    def pose(self) -> Array:
        pose = STILL.copy()
        pose[:3, :3], pose[:3, 3] = self.turn, self.middle - self.turn @ self.centre
        return pose

    def come_near(self, answer: SolidProximity) -> None:
        """From a first answer to where the motion begins."""
        self.middle = self.middle - (answer.distance - FAR * self.size) * np.asarray(answer.normal)

    def leap(self, answer: SolidProximity) -> float:
        """Go on from the answer before; how far, length."""
        if self.done % HELD == 0:
            self.v, self.w = (w / np.linalg.norm(w) for w in self.rng.normal(size=(2, 3)))
        self.done += 1
        scale = np.clip(answer.distance, NEAREST * self.size, FARTHEST * self.size)
        far = float(np.exp(self.rng.uniform(np.log(LEAST), np.log(MOST))) * scale)
        v, share = self._way(answer), self.rng.random()
        self.middle = self.middle + far * share * v / np.linalg.norm(v)
        turn = Rotation.from_rotvec(far * (1.0 - share) / self.radius * self.w).as_matrix()
        u, _, vt = np.linalg.svd(turn @ self.turn)
        self.turn = u @ vt
        return far

    def _way(self, answer: SolidProximity) -> Array:
        """Along the surface, and towards A or away from it."""
        n, drawn = np.asarray(answer.normal), self.rng.normal()
        if not np.isfinite(n).all():
            return self.v
        along = np.asarray(self.v - float(self.v @ n) * n)
        if answer.status in (Status.OVERLAPPING, Status.CONTAINED):
            return np.asarray(n + OUT * along)
        if 0.0 <= answer.distance <= NEAR * self.size:
            return along + AWAY * abs(drawn) * n
        far = answer.distance > FAR * self.size
        return np.asarray(along - (TOWARDS * drawn + far) * n)


def judged_leaps(
    number: int, seed: int, pairs: list[tuple[str, str]], deadline: int | None = None
) -> tuple[Verdict, list[str]]:
    """A motion of a pair, and its faults' lines."""
    rng = np.random.default_rng([seed, number])
    a, b = (made(name)[1] for name in pairs[number % len(pairs)])
    leaps, verdict, lines = Leaps(a, b, rng), Verdict(), []
    below = MINIMA_BELOW * leaps.size if rng.random() < KEEPING else None
    tracker = SolidTracker(a, b, minima=below, **budget(deadline))
    leaps.come_near(tracker.start(STILL, leaps.pose).proximity)
    state = tracker.start(STILL, leaps.pose)
    buffer = tracker.buffer(state)
    for _ in range(BLOCK):
        before = state.proximity.distance
        far, pose = leaps.leap(state.proximity), leaps.pose
        begun = time.perf_counter()
        state, told = tracker.step(state, STILL, pose)
        seconds = time.perf_counter() - begun
        tracker.step_into(buffer, STILL, pose)
        counts, faults = judged(tracker, pose, told, rng.random() < SAMPLED)
        if not is_same(buffer, told):
            counts = counts.plus(Verdict(otherwise=1))
            faults.append(f"in place {buffer.proximity()!r}, by a step {told!r}")
        leaped = Verdict(1, Counter([told.status.name]), int(far > before), seconds=seconds)
        verdict = verdict.plus(leaped).plus(counts)
        where = f"seed {seed}, block {number}, {a.name}, {b.name}, pose {pose.tolist()}"
        lines += [f"{where}: {fault}" for fault in faults]
    return verdict, lines


def judged(
    tracker: SolidTracker, pose: Array, told: SolidProximity, drawn: bool
) -> tuple[Verdict, list[str]]:
    """Counts of a frame, which is asked from nothing if it is drawn or did not converge."""
    if not drawn and told.status is Status.CONVERGED:
        return Verdict(), []
    a, b, faults = tracker.a, tracker.b, list[str]()
    try:
        compare(told, spatial_distance(a, b, STILL, pose))
    except Differs as error:
        faults.append(str(error))
    wrong, minima, lost = len(faults), 0, 0
    if tracker.minima is not None and told.status is Status.CONVERGED:
        minima, lost = missing(a, b, pose, tracker.minima, told)
        faults += [f"{lost} minima lost"] * (lost > 0)
    silent = int(wrong and told.certified)
    return Verdict(sampled=1, wrong=wrong, silent=silent, minima=minima, lost=lost), faults


def is_same(buffer: SolidFrameBuffer, told: SolidProximity) -> bool:
    """Does a frame in place tell the numbers of a step, to the last bit?"""
    numbers = buffer.distance, buffer.lower_bound, buffer.upper_bound
    same = numbers == (told.distance, told.lower_bound, told.upper_bound)
    return same and buffer.status is told.status


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "frames", 1_000_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    parser.add_argument("--deadline", type=int, help="most evaluations of a frame")
    given = parser.parse_args()
    pairs = pairs_of(given.parts)
    work = partial(judged_leaps, seed=given.seed, pairs=pairs, deadline=given.deadline)
    verdict = blocks.run(given, BLOCK, work)
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
