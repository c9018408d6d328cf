"""What a figure of the paper consists of: its picture, its data, and what it should show."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from matplotlib.figure import Figure


HYBRID = "Section on the hybrid system"
"""A section of the paper with many of the statements."""


NOTHING = "-"
"""Replaces the paper's statement if the paper states nothing about a measurement."""


class Statement(NamedTuple):
    """A checkable statement of the paper, and what was measured.

    Attributes
    ----------
    source : str
        Where it is, or what it belongs to: "Fig. 7", "Section II".
    stated : str
        What the paper says, in our words, with its number and unit; "-" if it says nothing.
    measured : str
        What was measured, with its unit.
    holds : bool or None
        Does the measurement confirm the statement? None if it is neither right nor wrong.
    why : str
        The reason if they differ.
    by : str
        The law with which it was measured, its switching, solve, gain and start.
    constructed : bool
        It cannot fail, because it follows from how the program is made; `why` explains it.
    """

    source: str
    stated: str
    measured: str
    holds: bool | None
    why: str = ""
    by: str = ""
    constructed: bool = False


def own_statement(source: str, measured: str, why: str = "", by: str = "") -> Statement:
    """Return a measurement of our own, about which the paper states nothing."""
    return Statement(source, NOTHING, measured, None, why, by)


def measured_by(by: str, statements: Iterable[Statement]) -> tuple[Statement, ...]:
    """Return the statements, with this law for those that do not name one."""
    return tuple(s if s.by else s._replace(by=by) for s in statements)


def missing_words(statement: Statement) -> str:
    """Return what a statement of a report does not say and has to; "" if it says all."""
    if not statement.measured:
        return "what was measured"
    if not statement.by:
        return "the law that it was measured with"
    return "why it cannot fail" if statement.constructed and not statement.why else ""


@dataclass(frozen=True)
class Animation:
    """A moving picture: ``draw(figure, k)`` draws frame k on an empty figure of the given size.

    Attributes
    ----------
    frames : int
    draw : callable
        ``draw(figure, k)``: the figure is cleared before each call.
    seconds : float
        Time of a frame on the screen [s].
    size : (float, float)
        Width and height [inches].
    text : str
        What it shows, for a reader who cannot see it.
    """

    frames: int
    draw: Callable[[Figure, int], None]
    seconds: float = 0.05
    size: tuple[float, float] = (6.0, 6.0)
    text: str = ""


@dataclass(frozen=True)
class Artwork:
    """A figure with its data and statements.

    Attributes
    ----------
    caption : str
        A short paragraph: what is drawn, with units, and what to look for.
    text : str
        What the picture shows, for a reader who cannot see it.
    draw : callable
        Draws the picture on a new figure (``style.new_figure``) and returns it; no pyplot.
    tables : mapping of str to mapping of str to array
        The figure's data: name of the table, then columns of equal length, with units in their
        names (``time_s``, ``u``, ``distance``).
    statements : tuple of Statement
    animation : Animation or None
    shown : tuple of str
        Names of the tables that the report and the pages print in full, below the picture.
    """

    caption: str
    text: str
    draw: Callable[[], Figure]
    tables: Mapping[str, Mapping[str, ArrayLike]] = field(default_factory=dict)
    statements: tuple[Statement, ...] = ()
    animation: Animation | None = None
    shown: tuple[str, ...] = ()


def shown_tables(artwork: Artwork) -> dict[str, dict[str, list[str]]]:
    """Return the tables that are printed in full: name, then heading and column, as text."""
    return {
        name: {
            heading.replace("_", " "): [as_text(value) for value in np.asarray(column).tolist()]
            for heading, column in artwork.tables[name].items()
        }
        for name in artwork.shown
    }


def as_text(value: object) -> str:
    """Return a table's value as printed: numbers with four digits."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


class Entry(NamedTuple):
    """A figure in the catalogue, made by ``module.function()``, which returns an Artwork.

    Attributes
    ----------
    key : str
        Its name on the command line: "7", or a word if it is not a figure of the paper.
    title : str
    chapter : str
        Heading under which it is; the figures of a chapter share a run and a process.
    module, function : str
    """

    key: str
    title: str
    chapter: str
    module: str
    function: str
