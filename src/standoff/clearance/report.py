"""The clearance of all pairs of a world: verdicts, what each pair must keep, and what fails."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from standoff.bodies.plain_data import without_roundoff
from standoff.bodies.tolerances import SHOWN_ROUNDOFF
from standoff.clearance.fits import Fit, fit_of
from standoff.clearance.verdicts import Verdict, pair_slack, touching_tolerance, verdict_of
from standoff.tracking.proximity import shown_size
from standoff.tracking.status import Status
from standoff.wording import at_least, at_most, counted
from standoff.world import PairAnswer, SolidPairAnswer, World, WorldAnswer

MOST_BOUNDED = 20_000
"""Pairs beyond the horizon whose own bounds are asked one by one; of more, all are told the
horizon, which is proven of each."""


class LeastGap(NamedTuple):
    """The least of a near pair over one frame or many.

    Attributes
    ----------
    answer : PairAnswer or SolidPairAnswer
        At its least distance.
    time : float
        Of that frame, scene time, s.
    lower_bound : float
        The least of all frames [length].
    uncertified : int
        Frames whose answer is not proven.
    statuses : tuple of Status
        How these ended, each once.
    """

    answer: PairAnswer | SolidPairAnswer
    time: float
    lower_bound: float
    uncertified: int
    statuses: tuple[Status, ...] = ()


class Wanted(NamedTuple):
    """What is asked of the pairs.

    Attributes
    ----------
    least : float or None
        The clearance that every pair must keep [length].
    fits : sequence of Fit or None
        Fits that are meant; if given, no other pair may overlap.
    tolerance : float or None
        By how much what is proven may miss a clearance that is required [length], if the pair is
        proven to be apart; None: by its touching tolerance.
    """

    least: float | None = None
    fits: Sequence[Fit] | None = None
    tolerance: float | None = None

    @property
    def reach(self) -> float:
        """The distance up to which it asks for more than a bound [length]."""
        ends = (abs(end) for fit in self.fits or () for end in fit.gap)
        return max(self.least or 0.0, *(end for end in ends if end < math.inf), 0.0)


class Instants(NamedTuple):
    """When the bodies were looked at.

    Attributes
    ----------
    start, end : float
        The first frame's scene time, and the last one's [s].
    frames : int
    """

    start: float
    end: float
    frames: int


@dataclass(frozen=True)
class PairRow:
    """One near pair of the report.

    Attributes
    ----------
    nearest : LeastGap
    verdict : Verdict
    required : float or None
        The clearance that it must keep: the greater of the one asked for and the pair's margin.
    fit : Fit or None
        What is allowed of it instead.
    failure : str
        Why it does not hold; empty where it does.
    tolerance : float
        By how much what is proven may miss what is required [length].
    common : float or None
        The volume that both have in common [length³], where that was asked of bodies that may
        overlap, by OpenCASCADE's boolean operation: it is not proven. nan: the operation failed.
    """

    nearest: LeastGap
    verdict: Verdict
    required: float | None
    fit: Fit | None
    failure: str
    tolerance: float
    common: float | None = None

    @property
    def answer(self) -> PairAnswer | SolidPairAnswer:
        """At the pair's least distance."""
        return self.nearest.answer

    @property
    def names(self) -> tuple[str, str]:
        """Of the bodies."""
        return self.answer.names

    @property
    def missing(self) -> float:
        """What is missing of what it must keep and holds within the tolerance [length]."""
        if self.failure or self.fit is not None or self.required is None:
            return 0.0
        return max(0.0, self.required - self.nearest.lower_bound)


class Far(NamedTuple):
    """A pair beyond its horizon: its names, a proven bound [length], and why it fails, if it does.

    It fails where it must keep more than is proven.
    """

    names: tuple[str, str]
    bound: float
    failure: str


class FitNote(NamedTuple):
    """What became of an allowed fit."""

    fit: Fit
    note: str
    holds: bool


@dataclass(frozen=True)
class Report:
    """The clearance of a world.

    Attributes
    ----------
    world : World
    rows : tuple of PairRow
        The near pairs, those that fail first, then by their lower bounds.
    far : tuple of Far
        The other pairs that count, by their bounds.
    fits : tuple of FitNote
    least : float or None
        The clearance that was asked of every pair.
    clearance : float
        A proven lower bound for all pairs [length].
    """

    world: World
    rows: tuple[PairRow, ...]
    far: tuple[Far, ...]
    fits: tuple[FitNote, ...]
    least: float | None
    clearance: float

    @property
    def certified(self) -> bool:
        """Are the answers of all near pairs proven, in all frames?"""
        return not any(row.nearest.uncertified for row in self.rows)

    @property
    def statuses(self) -> tuple[Status, ...]:
        """How the answers ended that are not proven, each once."""
        found = (status for row in self.rows for status in row.nearest.statuses)
        return tuple(dict.fromkeys(found))

    @property
    def failures(self) -> tuple[tuple[tuple[str, str], str], ...]:
        """The pairs that do not hold, and why."""
        found = [(row.names, row.failure) for row in self.rows if row.failure]
        return (*found, *((far.names, far.failure) for far in self.far if far.failure))

    @property
    def missing(self) -> float:
        """What is missing at most of a clearance that holds within its tolerance [length]."""
        return max((row.missing for row in self.rows), default=0.0)

    @property
    def least_far(self) -> float:
        """The least bound of the far pairs [length]; inf where there are none."""
        return min((far.bound for far in self.far), default=math.inf)

    def tally(self) -> dict[Verdict, int]:
        """Return how many pairs have each verdict, the far ones among them."""
        found = dict.fromkeys(Verdict, 0)
        for row in self.rows:
            found[row.verdict] += 1
        found[Verdict.APART] += len(self.far)
        return found


def uncertified_in(status: Status) -> tuple[int, tuple[Status, ...]]:
    """Return in how many frames an answer is not proven, of one frame, and with which statuses."""
    return (0, ()) if status.certified else (1, (status,))


def nearest_of(answer: WorldAnswer, time: float) -> dict[tuple[str, str], LeastGap]:
    """Return the near pairs of one frame."""
    return {
        pair.names: LeastGap(pair, time, pair.lower_bound, *uncertified_in(pair.status))
        for pair in answer.pairs
    }


def bounds_of(
    world: World, answer: WorldAnswer, near: Iterable[tuple[str, str]]
) -> dict[tuple[str, str], float]:
    """Return the proven bounds of all other pairs that count, in one frame."""
    known = set(near)
    others = [names for names in world.pairs() if names not in known]
    if len(others) > MOST_BOUNDED:
        return {names: horizon(world, names) for names in others}
    return {names: answer.lower_bound(names) for names in others}


def horizon(world: World, names: tuple[str, str]) -> float:
    """Return the distance beyond which a pair is not asked: it is at least that far apart."""
    return max(world.within, _margin(world, names))


def report_on(
    world: World,
    near: Mapping[tuple[str, str], LeastGap],
    bounds: Mapping[tuple[str, str], float],
    wanted: Wanted,
) -> Report:
    """Return the report.

    Parameters
    ----------
    world : World
    near : mapping of names to Nearest
        The pairs within the horizon, in the order of the world's bodies.
    bounds : mapping of names to float
        Of all other pairs that count: each is at least so far apart [length].
    wanted : Wanted
    """
    fit = fit_of(wanted.fits or (), world.bodies)
    rows = [_row(world, nearest, wanted, fit(names)) for names, nearest in near.items()]
    rows.sort(key=lambda row: (not row.failure, row.nearest.lower_bound))
    of_far = {names: fit(names) for names in bounds} if wanted.fits else {}
    far = [
        Far(names, bound, _far_failure(world, names, bound, wanted, of_far.get(names)))
        for names, bound in bounds.items()
    ]
    far.sort(key=lambda each: (not each.failure, each.bound))
    # a part inside another's material keeps no clearance, however thick the wall
    lowest = [
        -math.inf if row.verdict is Verdict.CONTAINED else row.nearest.lower_bound for row in rows
    ]
    lowest += [each.bound for each in far]
    notes = tuple(_note(world, each, rows, far, of_far) for each in wanted.fits or ())
    clearance = min(lowest, default=math.inf)
    return Report(world, tuple(rows), tuple(far), notes, wanted.least, clearance)


def _margin(world: World, names: tuple[str, str]) -> float:
    return world.margin(*names)


def _required(world: World, names: tuple[str, str], wanted: Wanted) -> float | None:
    margin = _margin(world, names)
    if wanted.least is None:
        return margin or None
    return max(margin, wanted.least)


def _row(world: World, nearest: LeastGap, wanted: Wanted, fit: Fit | None) -> PairRow:
    names, answer, lower = nearest.answer.names, nearest.answer, nearest.lower_bound
    verdict, required = verdict_of(answer), _required(world, names, wanted)
    tolerance = touching_tolerance(answer) if wanted.tolerance is None else wanted.tolerance
    failure = ""
    if verdict is Verdict.CONTAINED:
        if fit is not None or required is not None or wanted.fits is not None:
            failure = f"inside the other's material, the wall at least {at_least(lower)} thick"
    elif fit is not None:
        failure = _not_allowed(fit, nearest)
    elif required is not None and not _keeps(lower, required, tolerance):
        failure = not_kept(required, lower) + _nearly_kept(required, nearest)
    elif wanted.fits is not None and verdict in (Verdict.OVERLAPPING, Verdict.UNDECIDED):
        failure = f"{verdict.name.lower()}, and not among the fits that are allowed"
    return PairRow(nearest, verdict, required, fit, failure, tolerance)


def _keeps(lower: float, required: float, tolerance: float) -> bool:
    """Is a clearance proven? A tolerance is for bodies that are proven to be apart."""
    return lower >= required or (lower > 0.0 and lower >= required - tolerance)


def _not_allowed(fit: Fit, nearest: LeastGap) -> str:
    """Why a pair is not the fit that is meant; empty where it is proven to be."""
    lower, upper = nearest.lower_bound, nearest.answer.upper_bound
    (low, high), tolerance = fit.gap, touching_tolerance(nearest.answer)
    if low - tolerance <= lower and upper <= high + tolerance:
        return ""
    why = reason_of(nearest.answer)
    if fit.contact:
        return f"up to {at_most(-lower)} deep, and {-low:g} is allowed{why and f' ({why})'}"
    if upper < low - tolerance:
        told = f"less than is allowed: at most {at_most(upper)}"
    elif lower > high + tolerance:
        told = f"more than is allowed: at least {at_least(lower)}"
    else:
        told = f"not proven to be what is allowed: {at_least(lower)} to {at_most(upper)}"
    return f"a gap {told}, and {fit.allowance()} is meant{why and f' ({why})'}"


def reason_of(answer: PairAnswer | SolidPairAnswer) -> str:
    """Return why the bounds of an overlap are far from each other, in words, or nothing."""
    overlap = getattr(answer, "overlap", None)
    return overlap.reason if overlap is not None else ""


def gap_text(answer: PairAnswer | SolidPairAnswer, digits: int = 6) -> str:
    """Return the gap of a pair as found: rounded down, as its bounds, but for its own roundoff."""
    size = shown_size(answer)
    (gap,) = without_roundoff([answer.distance], size).tolist()
    return at_least(gap + SHOWN_ROUNDOFF * size if gap else gap, digits)


def bound_texts(row: PairRow) -> tuple[str, str]:
    """Return the lower and the upper bound of a row, each rounded to its safe side."""
    return at_least(row.nearest.lower_bound), at_most(row.answer.upper_bound)


COMMON = "volumes in common are by OpenCASCADE's boolean operation, not proven"


def common_text(row: PairRow) -> str:
    """Return the volume that both bodies of a row have in common, as far as it is known."""
    if row.common is None:
        return ""
    return "failed" if math.isnan(row.common) else f"{row.common:.6g}"


def within_tolerance(report: Report, unit: str) -> str:
    """What is said of pairs that keep what is asked within the tolerance; empty without one."""
    count = sum(row.missing > 0.0 for row in report.rows)
    if not count:
        return ""
    most = f"{at_most(report.missing, 3)} {unit}".rstrip()
    return f"{counted(count, 'pair')} within the tolerance, less at most {most}"


MET = "solids overlap, or one is inside another's material"
MOST_NAMED = 3
"""Pairs that a sentence names."""


def no_clearance(report: Report) -> str:
    """Why there is no clearance of all pairs with a bound."""
    told = undecided(report)
    deep = (Verdict.OVERLAPPING, Verdict.CONTAINED)
    met = not told or any(row.verdict in deep for row in report.rows)
    return "; ".join([MET] * met + [told] * bool(told))


def undecided(report: Report) -> str:
    """Which pairs are undecided, in words; empty where none is."""
    rows = [row for row in report.rows if row.verdict is Verdict.UNDECIDED]
    if not rows:
        return ""
    named = ", ".join(" - ".join(row.names) for row in rows[:MOST_NAMED])
    more = f" and {len(rows) - MOST_NAMED} more" if len(rows) > MOST_NAMED else ""
    return f"it is not decided whether these meet: {named}{more}"


def not_kept(required: float, lower: float) -> str:
    """Return the sentence on a clearance that is not proven."""
    known, missing = at_least(lower), at_most(required - lower, 3)
    if lower < 0.0:
        return f"not proven to keep {required:.15g}: the lower bound is {known}"
    return f"not proven to keep {required:.15g}: at least {known} apart, {missing} too little"


def _nearly_kept(required: float, nearest: LeastGap) -> str:
    """Said of a pair made for the very clearance that is asked: why it fails, and what to ask."""
    tolerance = touching_tolerance(nearest.answer)
    if not required - nearest.lower_bound <= tolerance < required:
        return ""
    slack, nominal = pair_slack(nearest.answer), at_least(required - tolerance, 9)
    return (
        f", within the touching tolerance of these parts, {at_most(tolerance, 3)} "
        f"(their slack {at_most(slack, 3)}): ask for {nominal}, and the nominal gap passes"
    )


def _far_failure(
    world: World, names: tuple[str, str], bound: float, wanted: Wanted, fit: Fit | None
) -> str:
    if fit is not None:
        if bound <= fit.gap[1]:
            return ""
        told = f"more than is allowed: at least {at_least(bound)}"
        return f"a gap {told}, and {fit.allowance()} is meant"
    required = _required(world, names, wanted)
    return "" if required is None or bound >= required else not_kept(required, bound)


def _note(
    world: World,
    fit: Fit,
    rows: Sequence[PairRow],
    far: Sequence[Far],
    of_far: Mapping[tuple[str, str], Fit | None],
) -> FitNote:
    """What became of a fit: in contact as deep as allowed, too deep, apart, or of no pair."""
    found: list[tuple[tuple[str, str], str]] = []
    for row in rows:
        if row.fit is fit:
            loose = fit.contact and row.verdict is Verdict.APART
            told = f"not in contact: {gap_text(row.answer)} apart" if loose else row.failure
            found.append((row.names, told))
    for each in far:
        if of_far.get(each.names) is fit:
            told = f"not in contact: at least {at_least(each.bound)} apart"
            found.append((each.names, told if fit.contact else each.failure))
    if not found:
        alone = fit_of([fit], world.bodies)
        taken = any(map(alone, [row.names for row in rows] + [each.names for each in far]))
        other = (
            f"the pair {'is that of an earlier fit' if taken else 'does not count in this world'}"
        )
        return FitNote(fit, fit.unknown(world.bodies) or other, False)
    bad = [(names, told) for names, told in found if told]
    if len(found) == 1 or not bad:
        return FitNote(fit, bad[0][1] if bad else "", not bad)
    names, told = bad[0]
    note = f"{len(bad)} of {len(found)} pairs: {' - '.join(names)} {told}"
    return FitNote(fit, note + (", ..." if len(bad) > 1 else ""), False)
