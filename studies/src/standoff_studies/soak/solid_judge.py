"""Answers of two solids judged by the closed forms and the exhaustive search of `solid_search`."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from standoff.solids.answer import SolidProximity
from standoff.tracking.status import Status
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_poses import Known, relative_poses
from standoff_studies.soak.solid_search import Bounds
from standoff_studies.soak.solid_truth import Hollowed, signed

Ask = Callable[[Any, Any, Array, Array], SolidProximity]
Log = Callable[[str], None]

TOLERANCE = 1.01e-10
"""Of both sizes: how wide a proven interval may be."""
NOISE = 1e-11
"""Of both sizes: what roundings and the last cells of the search may do to a length."""
BESIDE = 1e-10
"""The same for how far a witness point of an overlap may be past the side of its face: the
tolerance to which places are one."""
END = 1e-8
"""Of both sizes: how far the ends of a continuum may be off."""
DEEP = 1e-7
"""Of both sizes: a boundary that is so deep in the other solid does not only touch it."""
KNOWN = 1e-4
"""Of both sizes: how narrow the judge's own interval is where it counts as known."""
SWAPPED = 4
"""One of so many poses is asked again with the solids in turn."""

APART = (Status.CONVERGED, Status.CONTINUUM)
OPEN = (Status.WITHIN, Status.DEADLINE)
BINS = (("1", 0.3), ("0.1", 0.03), ("1e-2", 3e-3), ("1e-3", 3e-4), ("1e-6", 1e-8))


class Case(NamedTuple):
    """A pair at poses, what is true and what was told."""

    a: Known
    b: Known
    pose_a: Array
    pose_b: Array
    true: Bounds
    inside: str
    cavity: bool
    told: SolidProximity

    @property
    def size(self) -> float:
        return self.a.size + self.b.size

    def depths(self, point: Array) -> tuple[float, float]:
        """Signed distances of a world point from A and from B."""
        spots = [(point - p[:3, 3]) @ p[:3, :3] for p in (self.pose_a, self.pose_b)]
        return self.a.depth(spots[0]), self.b.depth(spots[1])

    @property
    def meets(self) -> bool:
        """Do the boundaries surely cross?"""
        return float(self.true.upper) == 0.0

    @property
    def bin(self) -> str:
        """Where it belongs in the table."""
        if self.meets:
            return "overlap"
        if self.inside or self.cavity:
            return "inside"
        gap = 2.0 * float(self.true.upper) / self.size
        return next((name for name, least in BINS if gap >= least), "touching")


@dataclass(frozen=True)
class Verdict:
    """Counts: answers by bin and status, faults by their kind, poses with one, those of them whose
    answer is certified, and poses whose distance the judge itself knows to 1e-4 of the size; the
    greatest excess of a certified distance over the judge's, of the size; seconds."""

    poses: int = 0
    statuses: Counter[tuple[str, str]] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    wrong: int = 0
    silent: int = 0
    known: int = 0
    excess: float = 0.0
    asked: float = 0.0
    judged: float = 0.0

    @property
    def sound(self) -> bool:
        return not self.faults

    def plus(self, other: Verdict) -> Verdict:
        return Verdict(
            self.poses + other.poses,
            self.statuses + other.statuses,
            self.faults + other.faults,
            self.wrong + other.wrong,
            self.silent + other.silent,
            self.known + other.known,
            max(self.excess, other.excess),
            self.asked + other.asked,
            self.judged + other.judged,
        )

    def __str__(self) -> str:
        kinds = "".join(f", {count} {name}" for name, count in sorted(self.faults.items()))
        each = 1e3 / max(self.poses, 1)
        told = {name: 0 for _, name in sorted(self.statuses)}
        for (_, name), count in self.statuses.items():
            told[name] += count
        return (
            f"{self.poses:,} poses; {self.wrong} wrong{kinds}; {self.silent} of them certified; "
            f"{told}; the judge knows {self.known:,} to 1e-4; worst excess {self.excess:.1e} of "
            f"the size; {each * self.asked:.1f} ms a pose, judge {each * self.judged:.1f}"
        )


def judged(
    a: Known, b: Known, solids: tuple[Any, Any], poses: tuple[Array, Array], ask: Ask, log: Log
) -> Verdict:
    """Ask for all poses of a pair, and judge each answer."""
    begun = time.perf_counter()
    cases = truths(a, b, *poses)
    verdict = Verdict(judged=time.perf_counter() - begun)
    for k, (pose_a, pose_b, true, inside, cavity) in enumerate(cases):
        begun = time.perf_counter()
        told = ask(*solids, pose_a, pose_b)
        asked = time.perf_counter()
        case = Case(a, b, pose_a, pose_b, true, inside, cavity, told)
        found = faults_of(case)
        judging = time.perf_counter() - asked
        if k % SWAPPED == 0:
            found += _swap_faults(case, ask(*solids[::-1], pose_b, pose_a))
        apart = told.status in (*APART, Status.CONTAINED) and not case.meets
        verdict = verdict.plus(
            Verdict(
                1,
                Counter({(case.bin, told.status.name): 1}),
                Counter({name for name, _ in found}),
                bool(found),
                bool(found) and told.certified,
                bool(true.upper - true.lower <= KNOWN * case.size),
                (told.distance - float(true.upper)) / case.size if apart else 0.0,
                asked - begun,
                judging,
            )
        )
        if found:
            log(described(case, found))
    return verdict


def truths(
    a: Known, b: Known, poses_a: Array, poses_b: Array
) -> list[tuple[Array, Array, Bounds, str, bool]]:
    """Of each pose the bounds of the distance of the boundaries, which solid is inside the other's
    material, and whether one is in the other's cavity."""
    turns, shifts = relative_poses(poses_a, poses_b)
    bounds = a.sampled.least(b.sampled.boundary, turns, shifts)
    # a valley that is narrow and slanted on one of them lies along an edge of the other
    back = np.swapaxes(turns, 1, 2)
    again = b.sampled.least(a.sampled.boundary, back, -np.einsum("nij,nj->ni", back, shifts))
    bounds = bounds._replace(
        lower=np.maximum(bounds.lower, np.minimum(again.lower, bounds.upper)),
        upper=np.minimum(bounds.upper, again.upper),
    )
    found = []
    for k, (pose_a, pose_b) in enumerate(zip(poses_a, poses_b, strict=True)):
        true = Bounds(*(column[k] for column in bounds))
        inside, cavity = "", False
        if true.upper > 0.0:
            x = a.sampled.points[0] @ turns[k].T + shifts[k]
            y = (b.sampled.points[0] - shifts[k]) @ turns[k]
            if true.above < 0.0:
                inside = "A"
            elif a.depth(y) < 0.0:
                inside = "B"
            else:
                cavity = _holds(b, x) or _holds(a, y)
        found.append((pose_a, pose_b, true, inside, cavity))
    return found


def _holds(solid: Known, point: Array) -> bool:
    """Is a point in the solid's cavity?"""
    truth = solid.part.truth
    return isinstance(truth, Hollowed) and float(signed(truth.cavity, point[None])[0]) < 0.0


def faults_of(case: Case) -> list[tuple[str, str]]:
    """(kind, what was expected and told) of each fault."""
    told, noise = case.told, NOISE * case.size
    if not case.meets:
        # the search may miss a narrow valley, so the told points bound the distance too
        off = abs(case.depths(told.point_a)[0]) + abs(case.depths(told.point_b)[1])
        reach = max(float(np.linalg.norm(told.point_b - told.point_a)) + off, 1e-300)
        upper = np.array(min(float(case.true.upper), reach))
        case = case._replace(true=case.true._replace(upper=upper))
    low, high = float(case.true.lower), float(case.true.upper)
    found = _status_faults(case) + _place_faults(case)
    if case.meets or told.status is Status.OVERLAPPING:
        if told.status is not Status.OVERLAPPING and told.lower_bound > noise:
            found.append(("bound", f"lower {told.lower_bound!r}, but the boundaries cross"))
    elif not told.lower_bound <= high + noise:
        found.append(("bound", f"lower {told.lower_bound!r} > {high!r}"))
    elif not told.upper_bound >= low - noise:
        found.append(("bound", f"upper {told.upper_bound!r} < {low!r}"))
    wide = told.upper_bound - told.lower_bound > TOLERANCE * case.size
    if wide and told.status in (*APART, Status.CONTAINED):
        found.append(("width", f"{told.upper_bound - told.lower_bound!r}"))
    if not told.lower_bound <= told.upper_bound:
        found.append(("bound", f"lower {told.lower_bound!r} > upper {told.upper_bound!r}"))
    return found


def _status_faults(case: Case) -> list[tuple[str, str]]:
    told, status, t = case.told, case.told.status, TOLERANCE * case.size
    if case.meets:
        deep = min(-float(case.true.below), float(case.true.above)) > DEEP * case.size
        right = {Status.OVERLAPPING, *OPEN} | (set() if deep else {Status.TOUCHING})
        known = f"crossing, {float(case.true.below)!r} to {float(case.true.above)!r}"
    elif case.true.upper <= t + NOISE * case.size:
        # which of them it is lies within the tolerance
        right = {Status.TOUCHING, Status.OVERLAPPING, *OPEN, *APART, Status.CONTAINED}
        known = "touching"
    elif case.inside:
        right, known = {Status.CONTAINED, *OPEN}, f"inside {case.inside}"
    else:
        right, known = {*APART, *OPEN}, "in a cavity" if case.cavity else "apart"
    found = []
    if status not in right:
        found.append(("status", f"{status.name}, but {known} by {float(case.true.upper)!r}"))
    elif known not in ("touching",) and status not in OPEN and told.inside != case.inside:
        found.append(("inside", f"{told.inside!r}, not {case.inside!r}"))
    return found


def _place_faults(case: Case) -> list[tuple[str, str]]:
    """Witness points on both boundaries, at the distance; the common ball; a continuum's ends."""
    told, noise = case.told, NOISE * case.size
    found = []
    pairs = [(told.point_a, told.point_b, told.distance, noise)]
    pairs += [(m.point_a, m.point_b, m.distance, noise) for m in told.minima]
    if told.continuum:
        pairs += [(x, y, told.distance, END * case.size) for x, y in told.continuum.ends]
    for k, (x, y, distance, spare) in enumerate(pairs):
        off = max(abs(case.depths(x)[0]), abs(case.depths(y)[1]))
        if told.status is Status.OVERLAPPING:
            spare = max(spare, BESIDE * case.size)
        name = "witness" if k <= len(told.minima) else "continuum"
        if not off <= spare:
            found.append((name, f"{off!r} off a boundary, place {k}"))
        length = float(np.linalg.norm(y - x))
        if told.status is not Status.OVERLAPPING and not abs(length - distance) <= spare:
            found.append((name, f"{length!r} apart, not {distance!r}, place {k}"))
    unproven = told.status is Status.CONVERGED and told.continuum is not None
    if unproven or (told.status is Status.CONTINUUM and told.continuum is None):
        found.append(("continuum", f"{told.continuum!r} with {told.status.name}"))
    if told.status is Status.OVERLAPPING:
        found += _ball_faults(case)
    return found


def _ball_faults(case: Case) -> list[tuple[str, str]]:
    told, noise = case.told, NOISE * case.size
    if told.overlap is None:
        return [("ball", "none")]
    radius = told.overlap.radius
    shallow = max(case.depths(told.overlap.common_point)) + radius
    found = []
    if not (radius >= 0.0 and shallow <= noise):
        found.append(("ball", f"radius {radius!r} reaches out by {shallow!r}"))
    least = told.overlap.depth
    if not (2.0 * radius <= least + noise and abs(told.upper_bound + least) <= noise):
        found.append(("ball", f"radius {radius!r}, depth {least!r}, {told.upper_bound!r}"))
    return found


def _swap_faults(case: Case, other: SolidProximity) -> list[tuple[str, str]]:
    """The same pair with B first."""
    told, noise = case.told, NOISE * case.size
    if Status.OVERLAPPING in (told.status, other.status):
        return []
    gap = max(told.lower_bound, other.lower_bound) - min(told.upper_bound, other.upper_bound)
    return [("swap", f"intervals {gap!r} apart")] if gap > noise else []


def described(case: Case, found: list[tuple[str, str]]) -> str:
    """All that repeats a fault."""
    lines = [f"{case.a.part.name} - {case.b.part.name}: {case.told!r}"]
    lines += [f"  {name}: {what}" for name, what in found]
    lines += [f"  pose_a = {case.pose_a.tolist()!r}", f"  pose_b = {case.pose_b.tolist()!r}"]
    return "\n".join(lines)
