"""Whether anything other than the printed law moved the witness points, from the runs' counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from standoff.recording import Recording
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw
from standoff.tracking.rows import Counts
from standoff_studies.paper.figure import HYBRID, Statement
from standoff_studies.paper.law_words import law_of


class Aid(NamedTuple):
    """Counts of what is not part of the law, over some runs: all are 0 in the printed system.

    Attributes
    ----------
    restarts, searches : int
    solved_parameters : int
        Parameters that a switch took from a solve.
    regularised : int
        Solves that did not use M as it is.
    """

    restarts: int
    searches: int
    solved_parameters: int
    regularised: int


class Part(NamedTuple):
    """What one tracker did: the law in its record, its total counts, and its frames."""

    law: Law
    counts: Counts
    frames: int

    @classmethod
    def of(cls, recording: Recording) -> Part:
        """Return what a recording says about its tracker."""
        return cls(law_of(recording), recording.total_counts(), len(recording))


def aid_of(parts: Sequence[Part]) -> Aid:
    """Count what helped the law."""
    return Aid(*(sum(int(getattr(p.counts, name)) for p in parts) for name in Aid._fields))


def foot_points(parts: Sequence[Part]) -> int:
    """Return how many foot points the guards computed, without moving the witness points."""
    return sum(part.counts.foot_points for part in parts)


def allowed(law: Law) -> tuple[str, ...]:
    """Return the options of a law that permit something else, whether or not it happened.

    Parameters
    ----------
    law : Law
        As in the record of a run.
    """
    if not isinstance(law, PaperLaw):
        return (f"law={law.name!r}",)
    barred = {
        "solve": law.solve != "plain",
        "reset": law.switching == "voronoi" and law.reset != "nearest",
        "restarts": law.restarts,
    }
    return tuple(f"{name}={getattr(law, name)!r}" for name, is_so in barred.items() if is_so)


def unaided(parts: Sequence[Part], by: str, *, runs: int | None = None) -> Statement:
    """Return whether only the printed law took part in some runs.

    It does not hold if the runs count anything in `Aid`, or if the law in their record permits it.

    Parameters
    ----------
    parts : sequence of Part
    by : str
    runs : int, optional
        To which these parts belong; as many as there are parts by default.
    """
    aid, feet = aid_of(parts), foot_points(parts)
    options = sorted({option for part in parts for option in allowed(part.law)})
    told = f"; the law on record has {', '.join(options)}" if options else ""
    wrote = "wrote none" if aid.solved_parameters == 0 else "wrote some"
    guards = f"; the guards sought {feet} foot points, and {wrote}" if feet else ""
    number = len(parts) if runs is None else runs
    return Statement(
        HYBRID,
        "no search, restart or exact solution is part of the tracking",
        f"in {number} {'run' if number == 1 else 'runs'} with {sum(p.frames for p in parts)} "
        f"frames{'' if runs is None else ' of all trackers'} {aid.restarts} restarts, "
        f"{aid.searches} searches, {aid.solved_parameters} parameters taken from a solve and "
        f"{aid.regularised} regularised solves{told}{guards}",
        not any(aid) and not options,
        by=by,
    )
