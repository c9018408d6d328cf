"""Each method of the field on the same work: what a frame costs, how far off it is, where it fails.

The unit of cost is an evaluation of the pair's system of second order, Ψ and M: the point, the
tangents and the second derivatives of both patches. A point alone is one of these vectors, and so
is a corner or a plane of a polyhedron that is read.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.tolerances import CLOSEST_SAMPLES
from standoff.motion import Fixed
from standoff.tracking import Proximity, Tracker
from standoff.tracking.laws import PaperLaw, PredictorCorrector
from standoff.typing import Array
from standoff_studies.paper.convergence.starts import LEAST_FRAMES, PATIENCE
from standoff_studies.paper.field import algebra, intervals, newton, polyhedra, support
from standoff_studies.paper.field.shells import Spot
from standoff_studies.paper.field.work import STEP, Work, spot_at, spots_of
from standoff_studies.paper.many_starts import begun, motion_along, stepped
from standoff_studies.paper.pair_simulation import REST

WRONG = 1e-2
"""Error of the distance above which a frame has failed, and below which a start has arrived
[length]: a two-hundredth of the bodies, above the sag of the polyhedra."""

CELLS = 20
"""Cells along a side of a patch, of the polyhedra."""

OTHER_CELLS = (40, 80)
"""Those of finer polyhedra, for simulation E's bodies."""

LOW_GAIN = 100.0
"""K of the paper's law where starts are tried [1/s]: "a very low controller gain"."""

SLOWLY = LEAST_FRAMES + round(PATIENCE / (LOW_GAIN * STEP))
"""Frames after which a start has arrived by the paper's law, or will not."""

Spots = tuple[Spot, Spot]
Step = Callable[[Any, Spots], tuple[Spots, Array]]


class Frame(NamedTuple):
    """A frame: its cost, the errors of its witness points and distance [length], whether it failed.

    A frame that gave up has no errors. The cost of the printed guards' foot points is told apart,
    in `guards`: the paper reads them from Voronoi regions that were computed before.
    """

    cost: float
    error: float
    off: float
    failed: bool
    guards: float = 0.0


@dataclass
class Found:
    """What a method did on some work."""

    frames: list[Frame] = field(default_factory=list)
    arrived: int = 0
    tried: int = 0
    corners: int = 0

    def add(self, other: Found) -> None:
        """Add what it did on more work."""
        self.frames += other.frames
        self.arrived += other.arrived
        self.tried += other.tried
        self.corners = max(self.corners, other.corners)


def _judged(cost: float, points: Array | None, due: Proximity) -> Frame:
    if points is None:
        return Frame(cost, np.nan, np.nan, True)
    exact = np.array([due.point_a, due.point_b])
    off = abs(float(np.linalg.norm(points[0] - points[1])) - due.distance)
    error = float(np.linalg.norm(points - exact, axis=1).max())
    return Frame(cost, error, off, off > WRONG)


def on_patches(
    work: Work, step: Step, *, cold: bool = False, starts: bool = True, most: int | None = None
) -> Found:
    """A method on the patches, frame after frame; after one that failed, from the true places.

    `cold`: it keeps nothing from frame to frame, so one frame of each stretch is enough, of `most`
    stretches; and it needs no start.
    """
    found = Found()
    for begin in work.windows[:most]:
        spots = spots_of(work, work.truth(begin))
        for k in range(1, 2 if cold else work.frames + 1):
            time = begin + k * STEP
            due = work.truth(time)
            spots, frame = _stepped(work, step, spots, time, due)
            found.frames.append(frame)
            if frame.failed:
                spots = spots_of(work, due)
    for time, start in work.tried() if starts and not cold else ():
        due = work.truth(time)
        _, frame = _stepped(work, step, (spot_at(start[0]), spot_at(start[1])), time, due)
        found.arrived += not frame.failed
        found.tried += 1
    return found


def _stepped(
    work: Work, step: Step, spots: Spots, time: float, due: Proximity
) -> tuple[Spots, Frame]:
    for shell, pose in zip(work.shells, work.poses(time), strict=True):
        shell.move(pose)
        shell.vectors = 0
    points = None
    with suppress(support.Lost):  # a failure, which the frame tells
        spots, points = step(work.shells, spots)
    cost = sum(s.vectors for s in work.shells) / sum(s.full for s in work.shells)
    return spots, _judged(cost, points, due)


def on_polyhedra(work: Work, cells: int = CELLS) -> Found:
    """V-Clip's walk over tessellations."""
    found, bodies = Found(), polyhedra.tessellated(work.shells, cells)
    full = sum(shell.full for shell in work.shells)
    found.corners = max(len(body.home) for body in bodies)

    def stepped(features: Any, time: float) -> tuple[Any, Frame]:
        for body, pose in zip(bodies, work.poses(time), strict=True):
            body.move(pose)
        points = None
        with suppress(support.Lost):  # a failure, which the frame tells
            features, points = polyhedra.walk(bodies, features)
        read = sum(body.vectors for body in bodies)
        return features, _judged(read / full, points, work.truth(time))

    def at(spots: Spots, time: float) -> Any:
        for body, shell, pose in zip(bodies, work.shells, work.poses(time), strict=True):
            body.move(pose)
            shell.move(pose)
        return polyhedra.begun(bodies, work.shells, spots)

    for begin in work.windows:
        features, _ = stepped(at(spots_of(work, work.truth(begin)), begin), begin)
        for k in range(1, work.frames + 1):
            features, frame = stepped(features, begin + k * STEP)
            found.frames.append(frame)
    for time, start in work.tried():
        _, frame = stepped(at((spot_at(start[0]), spot_at(start[1])), time), time)
        found.arrived += not frame.failed
        found.tried += 1
    return found


def law_of(key: str, gain: float = 1.0 / STEP) -> Any:
    """Return the paper's law as printed, or the library's own."""
    return PaperLaw.as_printed(gain=gain) if key == "paper" else PredictorCorrector()


def on_trackers(work: Work, key: str) -> Found:
    """A law of the library: the printed one (K h = 1), or its own."""
    found, full = Found(), sum(shell.full for shell in work.shells)
    tracker = Tracker(work.pair.a, work.pair.b, STEP, law=law_of(key))
    printed = isinstance(tracker.resolved_law, PaperLaw)
    for begin in work.windows:
        twist_a, twist_b = work.twists(begin)
        state = tracker.start(*work.poses(begin), twist_a, twist_b)
        for k in range(1, work.frames + 1):
            time = begin + k * STEP
            twist_a, twist_b = work.twists(time)
            state, answer = tracker.step(state, *work.poses(time), twist_a, twist_b)
            # as in the verdict, the rates at the answer are not the law's; each guard's foot point
            # takes its samples and at least one step of Newton's iteration along the edge
            cost = answer.counts.evaluations - printed
            feet = answer.counts.foot_points * (CLOSEST_SAMPLES + 1 + 3) / full
            points = np.array([answer.point_a, answer.point_b])
            frame = _judged(cost, points, work.truth(time))
            found.frames.append(frame._replace(guards=feet))
    slow = Tracker(work.pair.a, work.pair.b, STEP, law=law_of(key, LOW_GAIN))
    frames = SLOWLY if printed else LEAST_FRAMES
    for time, start in work.tried():
        paths = REST, Fixed(work.pair.path.pose(time))
        at_rest = np.repeat(motion_along(*paths, np.array([0.0, STEP])), frames, axis=0)
        *_, buffer = stepped(slow, begun(slow, paths, *start), at_rest)
        last = buffer.proximity()
        found.arrived += abs(last.distance - work.truth(time).distance) <= WRONG
        found.tried += 1
    return found


class Method(NamedTuple):
    """A method of the field.

    Attributes
    ----------
    name : str
    run : callable
        Of a work: what it did, or None where it can't be run.
    """

    name: str
    run: Callable[[Work], Found | None]


COLD_STRETCHES = {"A": 12, "B": 12, "C": 6, "D": 8, "E": 2, "drawn": 1}
"""Stretches of which a frame is given to interval Newton: of two faces it takes seconds."""

SOLVED = 12
"""Stretches of which a frame is given to the resultants."""

TO_A_POINT = ("A", "B", "D")
"""The work in which B is a point."""


def _planes(work: Work) -> Found | None:
    """Thompson's steps: from a start as many as the paper's law takes at its low gain."""
    if work.name not in TO_A_POINT:
        return None
    found = on_patches(work, newton.tangent_plane, starts=False)
    for time, start in work.tried():
        spots: Spots = (spot_at(start[0]), spot_at(start[1]))
        due = work.truth(time)
        for _ in range(SLOWLY):
            before = spots
            spots, frame = _stepped(work, newton.tangent_plane, spots, time, due)
            if all(
                now.patch == last.patch and (now.q == last.q).all()
                for now, last in zip(spots, before, strict=True)
            ):
                break
        found.arrived += not frame.failed
        found.tried += 1
    return found


def _of_two_lenses(cells: int, work: Work) -> Found | None:
    """V-Clip on finer polyhedra of simulation E's bodies."""
    return on_polyhedra(work, cells) if work.name == "E" else None


METHODS: dict[str, Method] = {
    "vclip": Method("V-Clip on polyhedra (Lin, Canny; Mirtich)", on_polyhedra),
    **{
        f"vclip {cells}": Method(f"V-Clip, {cells} cells a side", partial(_of_two_lenses, cells))
        for cells in OTHER_CELLS
    },
    "gjk": Method("GJK on patches (Turnbull, Cameron)", lambda w: on_patches(w, support.gjk)),
    "algebra": Method(
        "resultants (Lin, Manocha)",
        lambda w: (
            None
            if w.name in ("E", "drawn")
            else on_patches(w, algebra.solve, cold=True, most=SOLVED)
        ),
    ),
    "boxes": Method(
        "interval Newton (Snyder)",
        lambda w: on_patches(w, intervals.minimise, cold=True, most=COLD_STRETCHES[w.name]),
    ),
    "planes": Method("tangent planes (Thompson)", _planes),
    "newton": Method("Newton (Nelson, Cohen)", lambda w: on_patches(w, newton.newton)),
    "blind": Method(
        "two Newton steps, no test", lambda w: on_patches(w, newton.blind, starts=False)
    ),
    "paper": Method("the paper's law, as printed", lambda w: on_trackers(w, "paper")),
    "own": Method("the library's tracked frame", lambda w: on_trackers(w, "own")),
}
"""The methods, by key."""
