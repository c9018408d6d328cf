"""Branches: the local minima of two solids, each with the modes that it went through.

Two convex bodies have one minimum, and so one automaton. Two solids have a branch for each local
minimum; each goes through the modes of the pair by itself. On top of that branches begin and end,
and hand the nearest over to each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from standoff.automaton.transitions import Kind, Transition
from standoff.automaton.visits import Course, Mode, Visit
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.tracking.branches import NONE, Birth, End
from standoff.wording import counted, short_name

BranchKind = Literal["birth", "end", "handover"]

LEVELS = ("vertex", "edge", "face")
"""Kinds of features by their dimension: a boundary leads one down, a release one up."""


class BranchEvent(NamedTuple):
    """A transition between branches: one begins or ends, or becomes the nearest.

    Attributes
    ----------
    time : float
        s. Where `located`, the instant itself; else the time of the first frame in which it is so.
    kind : "birth", "end" or "handover"
    key : int
        Of the branch that begins, ends, or is the nearest from now on.
    mode : (Feature, Feature)
        Where that branch is; of one that ends, where it was last.
    distance : float
        Of that branch in the frame, length; of one that ends in the frame before.
    reason : Birth or End, optional
        Of a birth or an end.
    other : int
        Key of the branch that it has MERGED into, or that was the nearest; else -1.
    located : bool
        Was the instant found within the step?
    """

    time: float
    kind: BranchKind
    key: int
    mode: Mode
    distance: float
    reason: Birth | End | None = None
    other: int = NONE
    located: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class BranchAutomaton(Course):
    """The modes that one local minimum went through.

    Attributes
    ----------
    key : int
        That of the minimum in all frames.
    visits : tuple of Visit
        In order of time, without gaps while the branch lives.
    taken : tuple of (float, Transition)
        Its switches with their times [s]: the instant, where the recording has found it, else the
        time of the first frame in the new mode.
    nearest : tuple of (float, float)
        From when to when [s] it was the nearest of all.
    events : tuple of BranchEvent
        Its births, ends, and the handovers to it. A key lives more than once only if its minimum
        was found again.
    """

    key: int
    visits: tuple[Visit, ...]
    taken: tuple[tuple[float, Transition], ...]
    nearest: tuple[tuple[float, float], ...]
    events: tuple[BranchEvent, ...]

    def __repr__(self) -> str:
        modes = counted(len(self.visited), "mode")
        return f"<BranchAutomaton {self.key}: {modes} visited>"


@dataclass(frozen=True, eq=False, repr=False)
class ParallelBranches(Course):
    """What `SolidAutomaton` has, which draws and lists it."""

    names: tuple[str, str]
    a: Boundary | None
    b: Boundary | None
    features_a: tuple[Feature, ...]
    features_b: tuple[Feature, ...]
    transitions: tuple[Transition, ...]
    branches: tuple[BranchAutomaton, ...] = ()
    events: tuple[BranchEvent, ...] = ()
    visits: tuple[Visit, ...] = ()
    taken: tuple[tuple[float, Transition], ...] = ()

    def __repr__(self) -> str:
        names = " and ".join(map(short_name, self.names))
        branches = counted(len(self.branches), "branch", "branches")
        modes = counted(len(self.visited), "mode")
        return f"<{type(self).__name__} of {names}: {branches}, {modes} visited>"

    @property
    def listed(self) -> bool:
        """Are all features and transitions of both solids listed?"""
        return self.a is not None and self.b is not None

    @property
    def modes(self) -> int:
        """How many modes a branch of the pair has; of solids that are not at hand, how many were
        visited."""
        return len(self.features_a) * len(self.features_b) if self.listed else len(self.visited)

    def of(self, body: str) -> tuple[Transition, ...]:
        """The transitions of body "A" or "B"."""
        return tuple(t for t in self.transitions if t.body == body)

    def branch(self, key: int) -> BranchAutomaton:
        """The branch of a key.

        Raises LookupError if none has it.
        """
        for each in self.branches:
            if each.key == key:
                return each
        known = ", ".join(str(each.key) for each in self.branches)
        raise LookupError(f"No branch has the key {key}; there are {known or 'none'}.")


def unlisted(body: str, source: Feature, target: Feature) -> Transition:
    """A switch of a solid that is not at hand: what it is shows only in the kinds of features."""
    return Transition(body, source, target, _kind(source, target), "", "")


def several(body: str, source: Feature, target: Feature) -> Transition:
    """A switch that no transition allows: several boundaries were crossed between two frames."""
    return Transition(body, source, target, None, "", "")


def _kind(source: Feature, target: Feature) -> Kind | None:
    rise = LEVELS.index(target.kind) - LEVELS.index(source.kind)
    return {-1: "boundary", 1: "release"}.get(rise)  # type: ignore[return-value]
