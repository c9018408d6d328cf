"""``python -m standoff_studies.soak.tracked_solids``: frames of two solids that move, judged.

The poses and the judge are those of `solid_pairs`. Each pose is come to by a tracker in some frames
(``--frames``): the first leaps to near it, from the pose before; the others close in, by from 1e-4
to 3e-2 of the size together. The last frame is judged, and one that is drawn from those before it
is asked from nothing: two answers whose intervals or statuses differ end the run.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from standoff.motion import Pose, Poses
from standoff.solids import SolidProximity, SolidState, SolidTracker
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.status import Status
from standoff_studies.soak import blocks
from standoff_studies.soak.solid_judge import Verdict
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_pairs import BLOCK, judge_block, run_and_tell
from standoff_studies.soak.solid_parts import MAKERS
from standoff_studies.soak.solid_poses import pairs_of

FARTHEST, NEAREST = 3e-2, 1e-4
"""Of the size: what the frames but the first move together."""
SAME = (Status.TOUCHING, Status.OVERLAPPING, Status.CONTAINED)
"""Statuses that are told by both or by none."""


class Differs(RuntimeError):
    """A frame tells something else than a query from nothing."""


class Follower:
    """Answers by trackers, one of each ordered pair of solids."""

    def __init__(self, frames: int, rng: np.random.Generator) -> None:
        self.frames, self.rng = frames, rng
        self.states: dict[tuple[int, int], tuple[SolidTracker, SolidState]] = {}

    def __call__(self, a: Any, b: Any, pose_a: Array, pose_b: Array) -> SolidProximity:
        way = self.way_to(np.asarray(pose_b), a.size + b.size)
        known = self.states.get((id(a), id(b)))
        if known is None:
            tracker = SolidTracker(a, b)
            state = tracker.start(pose_a, way[0])
        else:
            tracker, state = known
        state, answers = tracker.run(state, pose_a, way)
        self.states[id(a), id(b)] = tracker, state
        k = int(self.rng.integers(self.frames))
        compare(answers[k], spatial_distance(a, b, pose_a, way[k]))
        return answers[self.frames - 1]

    def way_to(self, pose: Array, size: float) -> Array:
        """Poses (n, 4, 4), the last the one that is asked."""
        twist = self.rng.normal(size=6)
        twist[:3] *= size
        far = NEAREST * (FARTHEST / NEAREST) ** self.rng.random() / np.linalg.norm(twist)
        last = Pose.of(pose)
        parts = far * (1.0 - (1.0 + np.arange(self.frames)) / self.frames)
        steps = [last @ Pose.exp(part * twist[3:], part * twist[:3]) for part in parts]
        return np.asarray(Poses.of(steps).matrices)


def compare(frame: SolidProximity, cold: SolidProximity) -> None:
    """Raise `Differs` unless both can be true."""
    met = frame.lower_bound <= cold.upper_bound and cold.lower_bound <= frame.upper_bound
    proven = frame.certified and cold.certified
    same = frame.status is cold.status or not {frame.status, cold.status} & {*SAME}
    if not (met and (same or not proven)):
        raise Differs(f"{frame!r} and {cold!r} at {cold.poses!r}")


def judged_frames(
    number: int, seed: int, pairs: list[tuple[str, str]], frames: int
) -> tuple[Verdict, list[str]]:
    """A block of poses of a pair."""
    follower = Follower(frames, np.random.default_rng([seed, number, 1]))
    return judge_block(number, seed, pairs, ask=follower)


def main() -> int:
    """Read the options, run, and tell; 1 if anything was wrong."""
    parser = blocks.options(__doc__, "poses", 100_000, BLOCK)
    parser.add_argument("--parts", nargs="+", default=list(MAKERS), choices=list(MAKERS))
    parser.add_argument("--frames", type=int, default=10, help="of each pose")
    given = parser.parse_args()
    work = partial(judged_frames, seed=given.seed, pairs=pairs_of(given.parts), frames=given.frames)
    return run_and_tell(given, work)


if __name__ == "__main__":
    raise SystemExit(main())
