"""Answers of two solids judged by the closed forms and the exhaustive search of `solid_search`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from standoff.solids.answer import SolidProximity
from standoff.tracking.status import Status
from standoff_studies.soak.solid_outlines import Array
from standoff_studies.soak.solid_poses import Known, relative_poses
from standoff_studies.soak.solid_search import Bounds
from standoff_studies.soak.solid_truth import Hollowed

Ask = Callable[[Any, Any, Array, Array], SolidProximity]
Log = Callable[[str], None]

TOLERANCE = 1.01e-10
"""Of both sizes: how wide a proven interval may be."""
NOISE = 1e-11
"""Of both sizes: what roundings and the last cells of the search may do to a length."""
END = 1e-8
"""Of both sizes: how far the ends of a continuum may be off."""
DEEP = 1e-7
"""Of both sizes: a boundary that is so deep in the other solid does not only touch it."""
SWAPPED = 4
"""One of so many poses is asked again with the solids in turn."""
HEAVY = ("vase", "egg")
"""Parts whose closed form takes long: they are sampled, where only one of a pair is."""

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
        truths = self.a.part.truth, self.b.part.truth
        first, second = (float(t.signed(s[None])[0]) for t, s in zip(truths, spots, strict=True))
        return first, second

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


class Verdict(NamedTuple):
    """Counts: answers by bin and status, faults by their kind."""

    poses: int
    statuses: Counter[tuple[str, str]]
    faults: Counter[str]
    silent: int

    @property
    def sound(self) -> bool:
        return not self.faults

    def plus(self, other: Verdict) -> Verdict:
        return Verdict(
            self.poses + other.poses,
            self.statuses + other.statuses,
            self.faults + other.faults,
            self.silent + other.silent,
        )

    def __str__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in sorted(self.faults.items()))
        return f"{self.poses:,} poses; {told or 'none'} wrong; {self.silent} of them certified"


def nothing() -> Verdict:
    return Verdict(0, Counter(), Counter(), 0)


def judged(
    a: Known, b: Known, solids: tuple[Any, Any], poses: tuple[Array, Array], ask: Ask, log: Log
) -> Verdict:
    """Ask for all poses of a pair, and judge each answer."""
    cases = truths(a, b, *poses)
    statuses: Counter[tuple[str, str]] = Counter()
    faults: Counter[str] = Counter()
    silent = 0
    for k, (pose_a, pose_b, true, inside, cavity) in enumerate(cases):
        told = ask(*solids, pose_a, pose_b)
        case = Case(a, b, pose_a, pose_b, true, inside, cavity, told)
        found = faults_of(case)
        if k % SWAPPED == 0:
            found += _swap_faults(case, ask(*solids[::-1], pose_b, pose_a))
        statuses[case.bin, told.status.name] += 1
        faults.update({name for name, _ in found})
        silent += bool(found) and told.certified
        if found:
            log(described(case, found))
    return Verdict(len(cases), statuses, faults, silent)


def truths(
    a: Known, b: Known, poses_a: Array, poses_b: Array
) -> list[tuple[Array, Array, Bounds, str, bool]]:
    """Of each pose the bounds of the distance of the boundaries, which solid is inside the other's
    material, and whether one is in the other's cavity."""
    turned = b.part.name in HEAVY and a.part.name not in HEAVY
    own, other = (b, a) if turned else (a, b)
    poses = (poses_b, poses_a) if turned else (poses_a, poses_b)
    turns, shifts = relative_poses(*poses)
    bounds = own.sampled.least(other.part.truth, turns, shifts)
    if own.part.name not in HEAVY:
        # a valley that is narrow and slanted on one of them lies along an edge of the other
        back = np.swapaxes(turns, 1, 2)
        again = other.sampled.least(own.part.truth, back, -np.einsum("nij,nj->ni", back, shifts))
        bounds = bounds._replace(
            lower=np.maximum(bounds.lower, np.minimum(again.lower, bounds.upper)),
            upper=np.minimum(bounds.upper, again.upper),
        )
    found = []
    for k, (pose_a, pose_b) in enumerate(zip(poses_a, poses_b, strict=True)):
        true = Bounds(*(column[k] for column in bounds))
        inside, cavity = "", False
        if true.upper > 0.0:
            x = own.sampled.start.point[0] @ turns[k].T + shifts[k]
            y = (other.sampled.start.point[0] - shifts[k]) @ turns[k]
            names = ("B", "A") if turned else ("A", "B")
            if true.above < 0.0:
                inside = names[0]
            elif float(own.part.truth.signed(y[None])[0]) < 0.0:
                inside = names[1]
            else:
                cavity = _holds(other, x) or _holds(own, y)
        found.append((pose_a, pose_b, true, inside, cavity))
    return found


def _holds(solid: Known, point: Array) -> bool:
    """Is a point in the solid's cavity?"""
    truth = solid.part.truth
    return isinstance(truth, Hollowed) and float(truth.cavity.signed(point[None])[0]) < 0.0


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
    elif case.inside or case.cavity:
        right, known = {Status.CONTAINED, *OPEN}, f"inside {case.inside or 'a cavity'}"
    else:
        right, known = {*APART, *OPEN}, "apart"
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
    if not (radius > 0.0 and shallow <= noise):
        found.append(("ball", f"radius {radius!r} reaches out by {shallow!r}"))
    if not abs(told.distance + 2.0 * radius) <= noise:
        found.append(("ball", f"radius {radius!r}, distance {told.distance!r}"))
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
