"""What was proven of a joint path or of a box of configurations: immutable, with its steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from standoff.bodies.plain_data import PlainData, plain
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array, Ints
from standoff.wording import at_least, counted

Names = tuple[str, str]


class Verdict(Enum):
    """What came of a proof."""

    PROVEN = 0
    VIOLATED = 1
    UNDECIDED = 2

    @property
    def advice(self) -> str:
        """What it means and what to do."""
        return _ADVICE[self]


_ADVICE = {
    Verdict.PROVEN: "All pairs keep the clearance everywhere; proven.",
    Verdict.VIOLATED: (
        "A pair is proven to be nearer than the clearance at `q`: change the path there, or ask "
        "for less."
    ),
    Verdict.UNDECIDED: (
        "Neither is proven. Either the budget ran out: raise max_steps or max_boxes. Or a pair is "
        "within roundoff of the clearance, as in a touch without crossing: ask for a little less."
    ),
}


class How(Enum):
    """What proved a step."""

    FAR = 0
    REACH = 1
    CHORD = 2
    STILL = 3


class Steps(NamedTuple):
    """The steps of a proof along a path: rows of arrays, in order of time.

    Attributes
    ----------
    start, end : (n,) arrays
        The interval [s].
    pair : (n,) array of int
        The pair of pieces, a row of ``names``.
    bound : (n,) array
        Proven for the whole interval: a lower bound of the pair's distance [length].
    how : (n,) array of int
        `How`, by its value: FAR by bounding boxes, REACH from the distance in the middle, CHORD
        from the distances at both ends, STILL where nothing moves the two.
    names : list of (str, str)
        Of each pair of pieces.
    """

    start: Array
    end: Array
    pair: Ints
    bound: Array
    how: Ints
    names: tuple[Names, ...]

    def clearance(self, times: Any) -> Array:
        """(m,) the proven clearance of all pairs at times; nan where it is not proven for all."""
        times = np.asarray(times, dtype=float)
        found = np.full(times.shape, math.inf)
        covered = np.zeros(times.shape, dtype=np.int64)
        for pair in range(len(self.names)):
            own = np.flatnonzero(self.pair == pair)
            if not len(own):
                continue
            order = own[np.argsort(self.start[own], kind="stable")]
            at = np.searchsorted(self.start[order], times, side="right") - 1
            rows = order[np.maximum(at, 0)]
            known = (at >= 0) & (times <= self.end[rows])
            covered += known
            found = np.where(known, np.minimum(found, self.bound[rows]), found)
        return np.where(covered == len(self.names), found, np.nan)


class Witness(NamedTuple):
    """A pair at a configuration.

    Attributes
    ----------
    names : (str, str)
        Of the two bodies.
    links : (str, str)
        That carry them; of an obstacle its own name.
    q : (nq,) array
    distance, lower_bound, upper_bound : float
        There [length].
    """

    names: Names
    links: Names
    q: Array
    distance: float
    lower_bound: float
    upper_bound: float

    def __str__(self) -> str:
        return f"{self.names[0]} and {self.names[1]}, {self.distance:.6g} apart"


class Span(NamedTuple):
    """Of a path, for one pair.

    Attributes
    ----------
    start, end : float
        [s].
    names : (str, str)
        Of the two bodies.
    """

    start: float
    end: float
    names: Names

    def __str__(self) -> str:
        return f"{self.names[0]} and {self.names[1]} from {self.start:.9g} to {self.end:.9g} s"


class PathCounts(NamedTuple):
    """What a proof took.

    Attributes
    ----------
    pairs : int
        Pairs of pieces that count.
    steps : int
        Intervals of pairs that were proven.
    tried : int
        Intervals that were looked at.
    configurations : int
        At which the package's kinematics were evaluated.
    queries : int
        Certified distances.
    """

    pairs: int
    steps: int
    tried: int
    configurations: int
    queries: int


@dataclass(frozen=True, eq=False)
class PathProof(KeepsReadOnly, PlainData):
    """What is proven of a joint path.

    Attributes
    ----------
    verdict : Verdict
    clearance : float
        That was asked for [length].
    start, end : float
        Of the path [s].
    time : float
        Up to here every pair is proven to keep the clearance [s]; the end if PROVEN.
    latest : float
        VIOLATED: an instant at which a pair is proven to be nearer [s]; else nan.
    witness : Witness or None
        The pair that is nearer at ``latest``, or that is not decided at ``time``; None if PROVEN.
    undecided : tuple of Span
        Where a pair is neither proven to keep the clearance nor to be nearer, in order of time; if
        VIOLATED, before ``latest``.
    proven : float
        PROVEN: no pair is nearer than this at any instant [length]; else nan.
    counts : PathCounts
    steps : Steps
    """

    verdict: Verdict
    clearance: float
    start: float
    end: float
    time: float
    latest: float
    witness: Witness | None
    undecided: tuple[Span, ...]
    proven: float
    counts: PathCounts
    steps: Steps

    def __bool__(self) -> bool:
        return self.verdict is Verdict.PROVEN

    def as_dict(self) -> dict[str, Any]:
        """Return the proof as plain data, without its steps."""
        left_out = ("steps",)
        found = {part.name: getattr(self, part.name) for part in fields(self)}
        return {name: plain(value) for name, value in found.items() if name not in left_out}

    def __str__(self) -> str:
        counts = self.counts
        took = (
            f"{counted(counts.pairs, 'pair')}, {counted(counts.steps, 'step')}, "
            f"{counted(counts.configurations, 'configuration')}, "
            f"{counted(counts.queries, 'distance')}"
        )
        span = f"{self.start:.6g} to {self.end:.6g} s"
        if self.verdict is Verdict.PROVEN:
            return (
                f"PROVEN: every pair keeps {at_least(self.clearance)} at every instant from "
                f"{span}; none comes nearer than {at_least(self.proven)} ({took})"
            )
        if self.verdict is Verdict.VIOLATED:
            return (
                f"VIOLATED: {self.witness} at {self.latest:.9g} s, less than "
                f"{self.clearance:.6g}; proven until {self.time:.9g} s of {span}{self._open} "
                f"({took})"
            )
        return (
            f"UNDECIDED: {self.witness} at {self.time:.9g} s; proven until there, of {span}"
            f"{self._open} ({took})"
        )

    @property
    def _open(self) -> str:
        """What is undecided, for the text."""
        if not self.undecided:
            return ""
        more = len(self.undecided) - 1
        return f"; undecided: {self.undecided[0]}" + (f" and {more} more" if more else "")

    def __repr__(self) -> str:
        return f"PathProof({self.verdict.name}, proven until {self.time:.9g} of {self.end:.9g} s)"


class BoxCounts(NamedTuple):
    """What a proof over a box took.

    Attributes
    ----------
    pairs : int
        Pairs of pieces that count.
    boxes : int
        That were looked at.
    configurations : int
        At which the package's kinematics were evaluated.
    queries : int
        Certified distances.
    """

    pairs: int
    boxes: int
    configurations: int
    queries: int


class JointBoxes(NamedTuple):
    """Boxes of configurations.

    Attributes
    ----------
    lower, upper : (n, nq) arrays
    """

    lower: Array
    upper: Array

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.lower)


@dataclass(frozen=True, eq=False)
class BoxProof(KeepsReadOnly, PlainData):
    """What is proven of a box of configurations.

    Attributes
    ----------
    verdict : Verdict
    clearance : float
        That was asked for [length].
    lower, upper : (nq,) arrays
        The box.
    free, violated, open : float
        Shares of its volume: proven to keep the clearance, proven not to, and neither.
    witness : Witness or None
        A pair at a configuration: nearer than the clearance if VIOLATED, the nearest in the open
        part of the least bound if UNDECIDED, None if PROVEN.
    proven : float
        A lower bound of all pairs' distances in the whole box [length].
    counts : BoxCounts
    free_boxes, violated_boxes, open_boxes : JointBoxes
        The boxes themselves.
    """

    verdict: Verdict
    clearance: float
    lower: Array
    upper: Array
    free: float
    violated: float
    open: float
    witness: Witness | None
    proven: float
    counts: BoxCounts
    free_boxes: JointBoxes
    violated_boxes: JointBoxes
    open_boxes: JointBoxes

    def __bool__(self) -> bool:
        return self.verdict is Verdict.PROVEN

    def as_dict(self) -> dict[str, Any]:
        """Return the proof as plain data, without its boxes."""
        left_out = ("free_boxes", "violated_boxes", "open_boxes")
        found = {part.name: getattr(self, part.name) for part in fields(self)}
        return {name: plain(value) for name, value in found.items() if name not in left_out}

    def __str__(self) -> str:
        counts = self.counts
        took = (
            f"{counted(counts.pairs, 'pair')}, {counted(counts.boxes, 'box', 'boxes')}, "
            f"{counted(counts.queries, 'distance')}"
        )
        if self.verdict is Verdict.PROVEN:
            return (
                f"PROVEN: every pair keeps {at_least(self.clearance)} in the whole box; none comes "
                f"nearer than {at_least(self.proven)} ({took})"
            )
        shares = (
            f"{self.free:.4%} of the box proven free, {self.violated:.4%} proven not to be, "
            f"{self.open:.4%} open"
        )
        if self.verdict is Verdict.VIOLATED:
            q = () if self.witness is None else self.witness.q
            return (
                f"VIOLATED: {self.witness}, less than {self.clearance:.6g}, at q = "
                f"{np.array2string(np.asarray(q), precision=6)}; {shares} ({took})"
            )
        return f"UNDECIDED: {shares} ({took})"

    def __repr__(self) -> str:
        return f"BoxProof({self.verdict.name}, {self.free:.4%} free)"
