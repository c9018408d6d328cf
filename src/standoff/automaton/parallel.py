"""The automata of the local minima of two solids, which run in parallel, listed and drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from standoff.automaton.branch_text import branches_text
from standoff.automaton.branches import LEVELS, BranchAutomaton, BranchEvent, ParallelBranches
from standoff.automaton.graph import body_transitions, features_of
from standoff.bodies.boundary import Boundary
from standoff.bodies.features import Feature

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class SolidAutomaton(ParallelBranches):
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

    def text(self) -> str:
        """Return the branches with their modes and switches, and what happens between them, line by
        line."""
        return branches_text(self, self.names)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw the features that were visited, and under them a lane for each branch over time.

        Raises ModuleNotFoundError if matplotlib is not installed; the message names the extra.
        Raises TypeError if `path` is neither a string nor a Path. Raises ValueError if it is empty,
        or the file has another ending. Raises OSError if the file cannot be written.

        Parameters
        ----------
        path : str or path, optional
            Also write the picture there, whole or not at all: .png, .svg or .pdf.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from standoff.bodies.drawing.files import drawn

        def draw() -> Figure:
            from standoff.automaton.picture import automaton_figure

            return automaton_figure(self, self.names)

        figure: Figure = drawn(path, draw)
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


def _rank(feature: Feature) -> tuple[int, int]:
    return -LEVELS.index(feature.kind), feature.index
