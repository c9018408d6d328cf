"""The numbers of an answer as the page's panel shows them."""

from __future__ import annotations

from html import escape

import numpy as np

from standoff.view.shown import Shown

DIGITS = 9
"""Decimal digits that the panel shows."""

COLOURS = ("#0072B2", "#009E73")
"""Of distance and lower bound in the plot."""

MARK = '<span style="color:{}">■</span> '
NAME = "opacity:.65;padding-right:.8em;white-space:nowrap"
ROW = f'<tr><td style="{NAME}">{{}}</td><td data-of="{{}}">{{}}</td></tr>'
TABLE = (
    '<table style="font-size:.875em;margin:.3em .9em;font-variant-numeric:tabular-nums">{}</table>'
)


def length(value: float, unit: str) -> str:
    """Return a length as the panel shows it."""
    return f"{value:.{DIGITS}g} {unit}".rstrip() if np.isfinite(value) else "not known"


def readout(answer: Shown, names: tuple[str, str], unit: str, force: float | None = None) -> str:
    """Return the table of an answer, as HTML.

    Parameters
    ----------
    answer : Shown
    names : (str, str)
        Of A and B.
    unit : str
        Label of lengths.
    force : float, optional
        Of the coupler [N].

    Returns
    -------
    str
    """
    normal = ", ".join(f"{value:+.3f}" for value in answer.normal)
    rows = [
        ("distance", length(answer.distance, unit)),
        ("lower bound", length(answer.lower_bound, unit)),
        ("gap", f"{answer.distance - answer.lower_bound:.2e} {unit}".rstrip()),
        ("status", answer.status.name.lower().replace("_", " ")),
        (names[0], str(answer.features[0])),
        (names[1], str(answer.features[1])),
        ("normal", normal),
    ]
    keys = ["distance", "bound", "gap", "status", "a", "b", "normal"]
    if force is not None:
        rows.append(("force", f"{force:.2f} N"))
        keys.append("force")
    marks = (*(MARK.format(colour) for colour in COLOURS), *[""] * (len(rows) - 2))
    return TABLE.format(
        "".join(
            ROW.format(mark + escape(name), key, escape(text))
            for key, mark, (name, text) in zip(keys, marks, rows, strict=True)
        )
    )
