"""``python -m standoff_studies.soak.solid_motions``: long motions of two solids, judged by samples.

Block k of a seed is a motion of one pair, always the same: twists are drawn one after the other,
each held for up to 500 frames in which no point of B moves by more than nine tenths of the distance
(so that the solids never meet), at 2e-5, 2e-4 or 2e-3 of the size a frame. Near A they lead away
from it, far off towards it. Of each stretch one frame is asked from nothing as well; of one stretch
in twenty it is also judged by `solid_judge`. The first stretches of a motion keep all local minima
below a length, and each that a query from nothing finds must be among them.

With ``--deadline N`` a frame has N evaluations. One that has not converged by then is no fault if
its interval is true; its minima are not sought.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from standoff.solids import SolidAnswers, SolidProximity, SolidTracker, distance
from standoff.solids.spatial.distance import spatial_distance
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_judge import Case, faults_of, truths
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import made
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of
from standoff_studies.soak.tracked_solids import Differs, compare

BLOCK = 50_000
"""Frames of a motion."""
STRETCH = 500
"""Frames of one twist, at most."""
SPEEDS = (2e-5, 2e-4, 2e-3)
"""Of the size a frame: what no point of B moves more than."""
NEAR, FAR = 0.01, 0.5
"""Of the size: nearer than this it is led away, farther off towards A."""
USED = 0.9
"""Of the distance: what a stretch moves together, at most."""
JUDGED = 20
"""Of so many stretches one is judged by the exhaustive search."""
MINIMA_STRETCHES, MINIMA_BELOW = 4, 0.15
"""Stretches that keep all local minima, and up to how much above the distance, of the size."""
SAME = 1e-8
"""Of the size: distances of one minimum differ by less."""
STILL = np.eye(4)


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Counts of frames, of those of each status, of sampled and of judged ones; of samples that
    are wrong, and of those that are so certified; of sampled minima, and those of them that were
    not told; frames asked from nothing; and seconds of all frames."""

    FAULTS = ("wrong", "lost")
    frames: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    sampled: int = 0
    judged: int = 0
    wrong: int = 0
    silent: int = 0
    minima: int = 0
    lost: int = 0
    restarts: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        each = 1e6 * self.seconds / max(self.frames, 1)
        return (
            f"{self.frames:,} frames, {each:.0f} us each; {dict(self.statuses)}, {self.restarts} "
            f"asked from nothing; {self.sampled:,} sampled, {self.judged:,} of them judged: "
            f"{self.wrong} wrong, {self.silent} of them certified; {self.minima:,} minima, "
            f"{self.lost} lost"
        )


class Motion:
    """Stretches of poses of B, one after the other, while A stays."""

    def __init__(self, a: Any, b: Any, rng: np.random.Generator) -> None:
        self.size, self.rng = 0.5 * (a.size + b.size), rng
        self.centre, self.radius = b.ball_round()
        turn = Rotation.random(random_state=rng).as_matrix()
        way = rng.normal(size=3)
        middle = a.ball_round()[0] + 1.2 * self.size * way / np.linalg.norm(way)
        self.pose = STILL.copy()
        self.pose[:3, :3], self.pose[:3, 3] = turn, middle - turn @ self.centre

    def stretch(self, answer: SolidProximity, most: int) -> Array:
        """Poses (n, 4, 4) of the next one, from the answer before it."""
        speed = float(self.rng.choice(SPEEDS)) * self.size
        n = int(min(most, STRETCH, max(1.0, USED * answer.lower_bound / speed)))
        v, w = self.rng.normal(size=(2, 3))
        share = self.rng.random()
        v, w = share * v / np.linalg.norm(v), (1.0 - share) * w / np.linalg.norm(w)
        along = float(v @ answer.normal)
        if answer.distance < NEAR * self.size:
            v = v + (abs(along) - along) * answer.normal
        elif answer.distance > FAR * self.size:
            v = v - (abs(along) + along) * answer.normal
        poses = np.tile(STILL, (n, 1, 1))
        by = Rotation.from_rotvec(speed / self.radius * w).as_matrix()
        turn = self.pose[:3, :3]
        middle = turn @ self.centre + self.pose[:3, 3]
        for pose in poses:
            turn, middle = by @ turn, middle + speed * v
            u, _, vt = np.linalg.svd(turn)
            turn = u @ vt
            pose[:3, :3], pose[:3, 3] = turn, middle - turn @ self.centre
        self.pose = poses[-1]
        return poses


def budget(deadline: int | None) -> dict[str, int]:
    """What a tracker is given for a run with so many evaluations a frame; None: as many as there
    are by default."""
    return {} if deadline is None else {"deadline": deadline}


def stretches(
    a: Any, b: Any, frames: int, rng: np.random.Generator, deadline: int | None = None
) -> Iterator[tuple[Array, SolidAnswers, float, float]]:
    """(poses, answers, length below which minima are kept or 0, seconds) of a motion."""
    asked = budget(deadline)
    motion, trackers = Motion(a, b, rng), {0.0: SolidTracker(a, b, **asked)}
    answer = trackers[0.0].start(STILL, motion.pose).proximity
    done, state, last, number = 0, None, -1.0, 0
    below = float(answer.distance + MINIMA_BELOW * motion.size)
    trackers[below] = SolidTracker(a, b, minima=below, **asked)
    while done < frames:
        poses = motion.stretch(answer, frames - done)
        length = below if number < MINIMA_STRETCHES else 0.0
        if state is None or length != last:
            state, last = trackers[length].start(STILL, poses[0]), length
        begun = time.perf_counter()
        state, answers = trackers[length].run(state, STILL, poses)
        yield poses, answers, length, time.perf_counter() - begun
        answer, done, number = state.proximity, done + len(poses), number + 1


def judged_motion(
    number: int,
    seed: int,
    pairs: list[tuple[str, str]],
    frames: int,
    deadline: int | None = None,
) -> tuple[Verdict, list[str]]:
    """A motion of a pair, and its faults' lines."""
    rng = np.random.default_rng([seed, number])
    (one, a), (two, b) = (made(name) for name in pairs[number % len(pairs)])
    verdict, lines = Verdict(), []
    for k, (poses, answers, below, seconds) in enumerate(stretches(a, b, frames, rng, deadline)):
        i = int(rng.integers(len(poses)))
        told, faults, judged, minima, lost = answers[i], [], 0, 0, 0
        cold = spatial_distance(a, b, STILL, poses[i])
        try:
            compare(told, cold)
        except Differs as error:
            faults.append(str(error))
        if k % JUDGED == 0:
            judged = 1
            true = truths(one, two, STILL[None], poses[i : i + 1])[0]
            faults += [kind for kind, _ in faults_of(Case(one, two, *true, told))]
        wrong = bool(faults)
        if below > 0.0 and (deadline is None or told.certified):
            minima, lost = missing(a, b, poses[i], below, told)
            faults += [f"{lost} minima lost"] * (lost > 0)
        names = Counter(status.name for status in answers.status)
        verdict = verdict.plus(
            Verdict(
                len(poses), names, 1, judged, int(wrong), int(wrong and told.certified),
                minima, lost, int(answers.restarts.sum()), seconds,
            )
        )  # fmt: skip
        where = f"seed {seed}, block {number}, {a.name}, {b.name}, pose {poses[i].tolist()}"
        lines += [f"{where}: {fault}" for fault in faults]
    return verdict, lines


def missing(a: Any, b: Any, pose: Array, below: float, told: SolidProximity) -> tuple[int, int]:
    """How many local minima a query from nothing finds, and how many of them a frame has not."""
    cold = distance(a, b, STILL, pose, minima=below)
    known = np.array([each.distance for each in told.minima])
    size = SAME * (a.size + b.size)
    sought = [each.distance for each in cold.minima if each.distance < below - size]
    missing = [d for d in sought if not (np.abs(known - d) <= size).any()]
    return len(sought), len(missing)


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "frames", 10_000_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    parser.add_argument("--deadline", type=int, help="most evaluations of a frame")
    given = parser.parse_args()
    work = partial(
        judged_motion, seed=given.seed, pairs=pairs_of(given.parts), frames=BLOCK,
        deadline=given.deadline,
    )  # fmt: skip
    verdict = blocks.run(given, BLOCK, work)
    return 0 if verdict is None or verdict.sound else 1


if __name__ == "__main__":
    raise SystemExit(main())
