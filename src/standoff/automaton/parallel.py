"""The automata of the local minima of two solids, which run in parallel, and how they take turns.

Two convex bodies have one minimum, and so one automaton. Two solids have a branch for each local
minimum; each goes through the modes of the pair by itself. On top of that branches begin and end,
and hand the nearest over to each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from standoff.automaton.graph import Kind, Transition, body_transitions, features_of
from standoff.automaton.visits import Course, Mode, Visit
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature
from standoff.tracking.branches import NONE, Birth, End
from standoff.wording import counted, short_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
class SolidAutomaton(Course):
    """The automata of all local minima of two solids, in parallel.

    Attributes
    ----------
    names : (str, str)
        Of A and B.
    a, b : Boundary or None
        What the features are numbered in; None if a recording from a file does not hold them.
    features_a, features_b : tuple of Feature
        All of each solid; where it is not at hand, those that were visited.
    transitions : tuple of Transition
        All that the solids allow, those of A, then those of B; where they are not at hand, those
        that were taken.
    branches : tuple of BranchAutomaton
        By key.
    events : tuple of BranchEvent
        What happens between branches, in order of time.
    visits : tuple of Visit
    taken : tuple of (float, Transition)
        Those of all branches, one branch after the other.
    """

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
        return (
            f"<SolidAutomaton of {names}: {branches}, {counted(len(self.visited), 'mode')} visited>"
        )

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

        Raises
        ------
        LookupError
            If none has it.
        """
        for each in self.branches:
            if each.key == key:
                return each
        known = ", ".join(str(each.key) for each in self.branches)
        raise LookupError(f"No branch has the key {key}; there are {known or 'none'}.")

    def text(self) -> str:
        """Return the branches with their modes and switches, and what happens between them, line by
        line."""
        from standoff.automaton.branch_text import branches_text

        return branches_text(self, self.names)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw the features that were visited, and under them a lane for each branch over time.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ModuleNotFoundError
            If matplotlib is not installed; the message names the extra.
        TypeError
            If `path` is neither a string nor a Path.
        ValueError
            If it is empty, or the file has another ending.
        OSError
            If the file cannot be written.
        """
        from standoff.bodies.drawing.files import checked_file, write_picture

        target = None if path is None else checked_file(path)
        from standoff.automaton.picture import automaton_figure

        figure = automaton_figure(self, self.names)
        if target is not None:
            write_picture(figure, target)
        return figure


def solid_automaton(a: Boundary, b: Boundary) -> SolidAutomaton:
    """List what the boundaries of two solids allow each branch: nothing is visited yet."""
    transitions = (*body_transitions(a, "A"), *body_transitions(b, "B"))
    names = (a.name, b.name)
    return SolidAutomaton(names, a, b, features_of(a), features_of(b), transitions)


def automaton_of_branches(
    listed: SolidAutomaton | None,
    names: tuple[str, str],
    branches: Sequence[BranchAutomaton],
    events: Sequence[BranchEvent],
) -> SolidAutomaton:
    """Return the automaton of branches that ran in parallel.

    Parameters
    ----------
    listed : SolidAutomaton, optional
        What `solid_automaton` lists of the solids, if they are at hand.
    names : (str, str)
    branches : sequence of BranchAutomaton
        By key.
    events : sequence of BranchEvent
        In order of time.
    """
    visits = [visit for each in branches for visit in each.visits]
    taken = [switch for each in branches for switch in each.taken]
    if listed is None:
        listed = SolidAutomaton(
            names,
            None,
            None,
            tuple(sorted({visit.feature_a for visit in visits}, key=_rank)),
            tuple(sorted({visit.feature_b for visit in visits}, key=_rank)),
            tuple(dict.fromkeys(transition for _, transition in taken)),
        )
    return SolidAutomaton(
        names,
        listed.a,
        listed.b,
        listed.features_a,
        listed.features_b,
        listed.transitions,
        tuple(branches),
        tuple(events),
        tuple(visits),
        tuple(taken),
    )


def unlisted(body: str, source: Feature, target: Feature) -> Transition:
    """A switch of a solid that is not at hand: what it is shows only in the kinds of features."""
    return Transition(body, source, target, _kind(source, target), "", "")


def several(body: str, source: Feature, target: Feature) -> Transition:
    """A switch that no transition allows: several boundaries were crossed between two frames."""
    return Transition(body, source, target, None, "", "")


def _kind(source: Feature, target: Feature) -> Kind | None:
    rise = LEVELS.index(target.kind) - LEVELS.index(source.kind)
    return {-1: "boundary", 1: "release"}.get(rise)  # type: ignore[return-value]


def _rank(feature: Feature) -> tuple[int, int]:
    return -LEVELS.index(feature.kind), feature.index
