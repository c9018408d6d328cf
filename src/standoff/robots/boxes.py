"""A box of configurations proven to keep a clearance, by subdivision, the worst part first.

In each box the distance of every pair is taken in the middle, and the greatest motion from there
subtracted. Pairs that this proves are not looked at again in the parts of that box.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from standoff.best_first import SearchOutcome, SearchPart, best_first
from standoff.checks.arrays import finite, numbers
from standoff.checks.numbers import not_negative, whole_number, yes_or_no
from standoff.errors import StandoffError
from standoff.robots.certify_tolerances import ASKED_CLEARANCE, SMALLEST_SIDE
from standoff.robots.joints import JointKind
from standoff.robots.limits import check_limits, joint_of
from standoff.robots.motion_bounds import Reaches
from standoff.robots.motions import Motions
from standoff.robots.proof import BoxCounts, BoxProof, JointBoxes, Verdict, Witness
from standoff.robots.robot_model import RobotModel
from standoff.robots.sight import Separations, Sight, closing, some_of
from standoff.typing import Array, Ints

BATCH = 64
"""Boxes that are split together."""


class JointBox(NamedTuple):
    """A part of a box of configurations.

    Attributes
    ----------
    lower, upper : (nq,) arrays
    share : float
        Of the whole box's volume.
    pairs : (n,) array of int
        The pairs that are not proven in it.
    split : int
        The number of q along which it is halved next.
    bound : float
        A lower bound of those pairs' distances in it, less roundoff [length].
    violated : bool
        Is a pair proven to be nearer than the clearance everywhere in it?
    least : Separations or None
        In its middle, of the pair that is nearest by its upper bound.
    nearest : int
        That pair; -1 if no pair was asked.
    """

    lower: Array
    upper: Array
    share: float
    pairs: Ints
    split: int = -1
    bound: float = math.inf
    violated: bool = False
    least: Separations | None = None
    nearest: int = -1


def certify_box(
    robot: RobotModel,
    lower: Any,
    upper: Any,
    clearance: float = ASKED_CLEARANCE,
    *,
    max_boxes: int = 20_000,
    whole: bool = False,
    workers: int = 1,
) -> BoxProof:
    """Prove that a robot keeps a clearance at all configurations in a box.

    Raises TypeError, ValueError: bounds of another size, with NaN, infinite, in the wrong order or
    outside the joints' limits; a ball or a free joint that is not held fixed; a negative clearance.

    Parameters
    ----------
    robot : Robot
    lower, upper : (nq,) arrays
        The box. A number that is the same in both stays as it is; those of ball joints, of free
        joints and of hinges that read (cos, sin) must be.
    clearance : float
        That all pairs must keep [length].
    max_boxes : int
        Most parts to look at.
    whole : bool
        Go on after a configuration was found that does not keep the clearance, until all of the box
        is decided or the budget is spent: how much of it is free.
    workers : int
        Threads that share the distances.

    Returns
    -------
    BoxProof
    """
    clearance = not_negative(clearance, "clearance")
    whole_number(max_boxes, "max_boxes")
    whole_number(workers, "workers")
    low, high = _checked(robot, lower, upper)
    search = _JointBoxSearch(Sight(robot, workers), low, high, clearance)
    return search.run(max_boxes, yes_or_no(whole, "whole"))


def _checked(robot: RobotModel, lower: Any, upper: Any) -> tuple[Array, Array]:
    """The corners of a box.

    Raises StandoffError.
    """
    nq, joints = robot.nq, robot.joints
    both = []
    for given, name in ((lower, "lower"), (upper, "upper")):
        read = numbers(given, name, (nq,))
        endless = np.flatnonzero(np.isinf(read))
        if len(endless):
            raise StandoffError(
                f"{name}: {joint_of(robot, int(endless[0]))} is {read[endless[0]]}: it has no "
                "limit; give a finite range, such as a turn from -π to π.",
                name,
                given,
            )
        both.append(np.array(finite(read, name, (nq,))))
    low, high = both
    for i in np.flatnonzero(low > high).tolist()[:1]:
        raise StandoffError(
            f"lower: {joint_of(robot, i)} goes from {float(low[i])!r} down to {float(high[i])!r}: "
            "swap the two.",
            "lower",
            lower,
        )
    width = {JointKind.BALL: 4, JointKind.FREE: 7, JointKind.CONTINUOUS: 2}
    for j, number in enumerate(joints.kinds.tolist()):
        at, kind = int(joints.q_at[j]), JointKind(number)
        part = slice(at, at + width.get(kind, 0))
        if (low[part] != high[part]).any():
            reads = "(cos, sin)" if kind is JointKind.CONTINUOUS else "a unit quaternion"
            what = {JointKind.FREE: "a floating base", JointKind.BALL: "a ball joint"}
            raise StandoffError(
                f"Joint {joints.names[j]!r} is {what.get(kind, 'an endless hinge')}, which reads "
                f"{reads}: no box of such numbers is a range of the joint. Give the same numbers "
                "in lower and upper, which hold it where it is.",
                "lower",
                lower,
            )
    robot.kinematics.check(0.5 * (low + high))
    check_limits(robot, np.stack([low, high]), "lower, upper")
    return low, high


class _JointBoxSearch:
    def __init__(self, sight: Sight, lower: Array, upper: Array, clearance: float) -> None:
        self.sight, self.clearance = sight, clearance
        self.lower, self.upper = lower, upper
        ways = _ways(sight.watched.motions, 0.5 * (upper - lower)[None])[0]
        self.doubt = sight.roundoff(0.5 * (lower + upper), ways)
        self.least = SMALLEST_SIDE * (upper - lower)
        corners = np.stack([lower, 0.5 * (lower + upper), upper])
        frames = sight.frames(corners)
        for k, q in enumerate(corners):  # the joints as read against the package
            sight.placed(q, frames, k)
        self.boxes = 0
        self.proven = math.inf

    def run(self, most: int, whole: bool) -> BoxProof:
        splits = (most - 1) // 2
        batch = max(1, min(BATCH, splits // 4))
        every = JointBox(self.lower, self.upper, 1.0, np.arange(self.sight.pairs))
        found = best_first(
            self.looked_at([every]),
            lambda parts: self.looked_at([half for part in parts for half in _halves(part.body)]),
            goal=lambda seen: -math.inf if seen < 0.0 and not whole else 0.0,
            most=lambda _: splits - batch + 1,
            batch=batch,
        )
        return self._answer(found)

    def looked_at(self, boxes: list[JointBox]) -> list[SearchPart[JointBox]]:
        """Bound the distances of all pairs in some boxes."""
        self.boxes += len(boxes)
        at = np.repeat(np.arange(len(boxes)), [len(box.pairs) for box in boxes])
        pairs = np.concatenate([box.pairs for box in boxes])
        lower = np.stack([box.lower for box in boxes])
        upper = np.stack([box.upper for box in boxes])
        q = 0.5 * (lower + upper)
        half = np.maximum(upper - q, q - lower)
        frames = self.sight.frames(q)
        ways = _ways(self.sight.watched.motions, half)[at]
        middle = self.sight.middle(pairs, frames, at, ways)
        boxed = self.sight.by_boxes(pairs, frames, at, middle)
        bound = boxed.lower - closing(middle, boxed)
        ask = np.flatnonzero(bound - self.clearance < self.doubt)
        apart = self.sight.ask(pairs[ask], q, frames, at[ask])
        some = some_of(middle, ask)
        bound[ask] = np.maximum(bound[ask], apart.lower - closing(some, apart))
        bound -= self.doubt
        nearer = apart.upper + some.way + self.doubt < self.clearance
        found = []
        for k, box in enumerate(boxes):
            mine, asked = np.flatnonzero(at == k), np.flatnonzero(at[ask] == k)
            own = box._replace(
                bound=float(bound[mine].min(initial=math.inf)),
                violated=bool(nearer[asked].any()),
            )
            if len(asked):
                best = int(asked[np.argmin(apart.upper[asked])])
                own = own._replace(
                    least=Separations._make(each[best : best + 1] for each in apart),
                    nearest=int(pairs[ask[best]]),
                )
            found.append(self._part(own, pairs[mine], bound[mine], middle.reaches, mine))
        return found

    def _part(
        self, box: JointBox, pairs: Ints, bound: Array, reaches: Reaches, rows: Ints
    ) -> SearchPart[JointBox]:
        """A box as the search takes it."""
        open_ = bound < self.clearance
        self.proven = min(self.proven, float(bound[~open_].min(initial=math.inf)))
        seen = math.inf
        if box.least is not None:
            seen = float(box.least.upper[0]) + self.doubt - self.clearance
        if open_.any() and not box.violated:
            worst = int(rows[int(np.argmin(bound))])
            box = box._replace(pairs=pairs[open_], split=self._longest(box, reaches, worst))
        closed = not open_.any() or box.violated or box.split < 0
        return SearchPart(box.bound - self.clearance, box, seen, closed)

    def _longest(self, box: JointBox, reaches: Reaches, row: int) -> int:
        """The number of q that moves a pair most in a box; -1 where none can be halved."""
        watched = self.sight.watched
        pair_ways = reaches.h[row] * np.minimum(reaches.r_a[row], reaches.r_b[row])
        moved = np.zeros(len(self.lower))
        for motion, way in zip(reaches.chain[row].tolist(), pair_ways.tolist(), strict=True):
            if motion >= 0:
                moved[watched.motions.q_at[motion]] += way
        moved[~(box.upper - box.lower > self.least)] = 0.0
        return int(np.argmax(moved)) if moved.any() else -1

    def _answer(self, found: SearchOutcome[JointBox]) -> BoxProof:
        every = [*found.open, *found.closed]
        free = [part.body for part in every if part.bound >= 0.0]
        bad = [part.body for part in every if part.bound < 0.0 and part.body.violated]
        rest = [part.body for part in every if part.bound < 0.0 and not part.body.violated]
        met = found.place if found.found < 0.0 else None
        verdict = Verdict.VIOLATED if met is not None else Verdict.UNDECIDED
        shown = met
        if shown is None and rest:
            shown = min(rest, key=lambda box: box.bound)
        if not bad and not rest:
            verdict, shown = Verdict.PROVEN, None
        for array in (self.lower, self.upper):
            array.flags.writeable = False
        shares = [math.fsum(box.share for box in some) for some in (free, bad, rest)]
        sight = self.sight
        return BoxProof(
            verdict=verdict,
            clearance=self.clearance,
            lower=self.lower,
            upper=self.upper,
            free=shares[0],
            violated=shares[1],
            open=shares[2],
            witness=self._witness(shown),
            proven=min([self.proven, *(box.bound for box in (*rest, *bad))]),
            counts=BoxCounts(sight.pairs, self.boxes, sight.configurations, sight.queries),
            free_boxes=_stacked(free),
            violated_boxes=_stacked(bad),
            open_boxes=_stacked(rest),
        )

    def _witness(self, box: JointBox | None) -> Witness | None:
        """The nearest pair in the middle of a box."""
        if box is None or box.least is None:
            return None
        return self.sight.witness(box.nearest, 0.5 * (box.lower + box.upper), box.least)


def _ways(motions: Motions, half: Array) -> Array:
    """(m, nm + 1): how far each motion goes from the middle of boxes with these half sides."""
    found = np.zeros((len(half), motions.size + 1))
    scalar = np.flatnonzero(motions.q_count == 1)
    found[:, scalar] = np.abs(motions.ratios[scalar]) * half[:, motions.q_at[scalar]]
    return found


def _halves(box: JointBox) -> list[JointBox]:
    middle = 0.5 * (box.lower[box.split] + box.upper[box.split])
    upper, lower = box.upper.copy(), box.lower.copy()
    upper[box.split] = lower[box.split] = middle
    share = 0.5 * box.share
    return [
        JointBox(box.lower, upper, share, box.pairs),
        JointBox(lower, box.upper, share, box.pairs),
    ]


def _stacked(boxes: list[JointBox]) -> JointBoxes:
    nothing = np.zeros((0, 0))
    if not boxes:
        return JointBoxes(nothing, nothing)
    found = JointBoxes(
        np.stack([box.lower for box in boxes]), np.stack([box.upper for box in boxes])
    )
    for array in found:
        array.flags.writeable = False
    return found
