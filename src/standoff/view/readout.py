"""An answer in the words and numbers of the page."""

from __future__ import annotations

from html import escape
from typing import Protocol

import numpy as np

from standoff.tracking import Status
from standoff.view.nodes import COLOURS as BODY_COLOURS
from standoff.view.shown import ShownPair
from standoff.view.tolerances import SAID_TO_TOUCH
from standoff.wording import at_least, at_most

DIGITS = 9
"""Significant digits of distance and lower bound in the table."""

SHORT = 4
"""Significant digits of a length in a sentence."""

COLOURS = ("#0072B2", "#009E73")
"""Of distance and lower bound in the plot."""

MARK = '<span style="color:{}">■</span> '
BODY = '<span style="color:rgb{}">●</span> '
NAME = "opacity:.65;padding-right:.8em;white-space:nowrap;vertical-align:top"
ROW = f'<tr><td style="{NAME}">{{}}</td><td data-of="{{}}">{{}}</td></tr>'
TABLE = (
    '<div data-of="verdict" style="font-weight:600;margin:.5em .9em .2em">{}</div>'
    '<table style="font-size:.875em;margin:.2em .9em;font-variant-numeric:tabular-nums;'
    'overflow-wrap:anywhere">{}</table>'
)


def length(value: float, unit: str, digits: int = DIGITS) -> str:
    """Return a length as the page writes it."""
    return f"{value:.{digits}g} {unit}".rstrip() if np.isfinite(value) else "not known"


def lower(bound: float, unit: str, digits: int = DIGITS) -> str:
    """Return a lower bound as the page writes it, never more than it is."""
    return f"{at_least(bound, digits)} {unit}".rstrip() if np.isfinite(bound) else "not known"


def upper(bound: float, unit: str, digits: int = DIGITS) -> str:
    """Return an upper bound as the page writes it, never less than it is."""
    return f"{at_most(bound, digits)} {unit}".rstrip() if np.isfinite(bound) else "not known"


class PairFacts(Protocol):
    """What a sentence says of two bodies."""

    @property
    def distance(self) -> float:
        """Length; minus the depth where they overlap."""

    @property
    def lower_bound(self) -> float:
        """Length."""

    @property
    def status(self) -> Status:
        """How far that is proven."""


def verdict(answer: PairFacts, unit: str, size: float) -> str:
    """Return in a sentence how far apart the bodies are, and how far that is proven.

    Parameters
    ----------
    answer : PairFacts
    unit : str
        Label of lengths.
    size : float
        Of the bodies, in that unit.
    """
    distance, bound, status = answer.distance, answer.lower_bound, answer.status
    if status is Status.FAR:
        return f"at least {lower(bound, unit, SHORT)} apart, beyond the horizon"
    if status is Status.OVERLAPPING or not np.isfinite(distance):
        return "overlap, depth not known" if status.penetrating else "distance not known"
    proven = status.certified or status.penetrating
    off = max(abs(distance), abs(bound))
    if proven and off <= SAID_TO_TOUCH * size:
        return f"touching, to within {upper(off, unit, 2)}" if off else "touching"
    if status.penetrating:
        how = "proven least" if status is Status.GLOBAL else "perhaps not the least"
        return f"overlap, depth {length(-distance, unit, SHORT)}, {how}"
    if status.certified:
        return f"apart, distance {length(distance, unit, SHORT)}, proven"
    why = _UNPROVEN[status]
    if distance < 0.0 and np.isfinite(bound):
        return f"depth at most {upper(-bound, unit, SHORT)}: {why}"
    if not np.isfinite(bound):
        return f"distance at most {upper(distance, unit, SHORT)}: {why}"
    low = lower(bound, "", SHORT)
    return f"distance between {low} and {upper(distance, unit, SHORT)}: {why}"


_UNPROVEN = {
    Status.TRACKING: "the law is still on its way",
    Status.NOT_CERTIFIED: "not proven closer",
    Status.DEADLINE: "stopped by the deadline",
    Status.NOT_RESTARTED: "no search was allowed",
}


def beside(answer: PairFacts, unit: str, size: float) -> str:
    """Return what stands beside the witness line: the verdict without its proof.

    Parameters
    ----------
    answer, unit, size
        As of `verdict`.
    """
    said = verdict(answer, unit, size)
    if said.startswith(("apart", "overlap")):
        return said.split(", ")[1].removeprefix("distance ")
    return said.split(",")[0].split(":")[0].removeprefix("distance ")


def readout(
    answer: ShownPair, names: tuple[str, str], unit: str, size: float, force: float | None = None
) -> str:
    """Return the sentence and the table of an answer, as HTML.

    Parameters
    ----------
    answer : ShownPair
    names : (str, str)
        Of A and B.
    unit : str
        Label of lengths.
    size : float
        Of the bodies, in that unit.
    force : float, optional
        Of the coupler [N].

    Returns
    -------
    str
    """
    normal = ", ".join(f"{value:+.3f}" for value in np.round(answer.normal, 3) + 0.0)
    features = [
        f"{feature} of {name}" if feature.kind else ""
        for feature, name in zip(answer.features, names, strict=True)
    ]
    bodies = [BODY.format(strong) for _, strong in BODY_COLOURS]
    rows = [
        (MARK.format(COLOURS[0]) + "distance", "distance", length(answer.distance, unit)),
        (MARK.format(COLOURS[1]) + "lower bound", "bound", _bound(answer, unit, size)),
        ("gap", "gap", length(answer.distance - answer.lower_bound, unit, 2)),
        (bodies[0] + "from", "a", features[0]),
        (bodies[1] + "to", "b", features[1]),
        ("normal", "normal", normal),
    ]
    if force is not None:
        rows.append(("force", "force", f"{force:.2f} N"))
    return TABLE.format(
        escape(verdict(answer, unit, size)),
        "".join(ROW.format(name, key, escape(text)) for name, key, text in rows),
    )


def _bound(answer: ShownPair, unit: str, size: float) -> str:
    """The lower bound; of one that is all but 0 the digits are roundoff."""
    bound = answer.lower_bound
    return lower(bound, unit, DIGITS if abs(bound) > SAID_TO_TOUCH * size else 2)
