"""An answer about two solids in the words and numbers of the page."""

from __future__ import annotations

from html import escape

import numpy as np

from standoff.solids.answer import NearestPair, SolidProximity
from standoff.tracking import Status
from standoff.view.live_solids import known_of
from standoff.view.nodes import COLOURS as BODY_COLOURS
from standoff.view.readout import (
    BODY,
    COLOURS,
    MARK,
    ROW,
    SHORT,
    TABLE,
    length,
    lower,
    upper,
    verdict,
)
from standoff.view.solid_nodes import OVERLAP_COLOUR
from standoff.view.tolerances import SAID_TO_TOUCH
from standoff.wording import counted

MOST_KEYS = 12
"""Minima whose keys the table tells; the list has more."""

MOST_LISTED = 60
"""Minima of the list."""

LIST = (
    '<table style="font-size:.8em;margin:.3em .9em;border-spacing:.6em 0;'
    'font-variant-numeric:tabular-nums" data-of="minima-list">{}</table>'
)
LISTED = '<tr data-key="{}"><td>#{}</td><td style="white-space:nowrap">{}</td><td>{} – {}</td></tr>'
NONE = '<div style="font-size:.8em;margin:.5em .9em;opacity:.65">{}</div>'
IN_OVERLAP = f'<span style="color:rgb{OVERLAP_COLOUR}">{{}}</span>'

ANOTHER = ", another way out"


def places_of(answer: SolidProximity) -> tuple[NearestPair, ...]:
    """Return the places of an overlap that have come from above 0: others are other ways out."""
    return tuple(m for m in answer.minima if m.distance < 0.0 and m.felt)


def solid_verdict(answer: SolidProximity, names: tuple[str, str], unit: str, size: float) -> str:
    """Return in a sentence how far apart the solids are, and how far that is proven.

    Parameters
    ----------
    answer : SolidProximity
    names : (str, str)
        Of A and B.
    unit : str
        Label of lengths.
    size : float
        Of the solids, in that unit.
    """
    status, distance = answer.status, answer.distance
    if status is Status.OVERLAPPING:
        return _overlap(answer, unit)
    if status is Status.TOUCHING:
        off = max(abs(distance), abs(answer.lower_bound))
        told = f", to within {upper(off, unit, 2)}" if np.isfinite(off) and off else ""
        return f"touching{told}"
    inner, outer = names if "A" in (answer.inside, answer.cavity) else names[::-1]
    where = f", {inner} in a cavity of {outer}" if answer.cavity else ""
    if status is Status.CONTAINED:
        return f"{inner} inside {outer}, wall {length(distance, unit, SHORT)}, proven"
    if status is Status.CONTINUUM:
        along = f"all along {_KINDS[answer.continuum.kind]}, " if answer.continuum else ""
        return f"apart, distance {length(distance, unit, SHORT)} {along}proven{where}"
    if status is Status.WITHIN:
        if not np.isfinite(distance):
            return "distance not known"
        if not np.isfinite(answer.lower_bound):
            return f"distance at most {upper(distance, unit, SHORT)}: not proven closer"
        low = lower(answer.lower_bound, "", SHORT)
        return f"distance between {low} and {upper(distance, unit, SHORT)}: not proven closer"
    return verdict(answer, unit, size) + where


_KINDS = {"line": "a line", "arc": "an arc", "surface": "a surface"}


def _overlap(answer: SolidProximity, unit: str) -> str:
    places = places_of(answer)
    if places:
        deepest = length(-places[0].distance, unit, SHORT)
        if len(places) == 1:
            return f"overlap in one place, depth {deepest}"
        return f"overlap in {len(places)} places, the deepest {deepest}"
    if answer.overlap is None or not answer.overlap.depth > 0.0:
        return "overlap, depth not known"
    return f"overlap, no shift shorter than {lower(answer.overlap.depth, unit, SHORT)} parts them"


def solid_beside(answer: SolidProximity, unit: str, size: float) -> str:
    """Return what stands beside the nearest minimum: its key, and its distance or depth."""
    if not answer.minima or not np.isfinite(answer.distance):
        return ""
    nearest = answer.minima[0]
    key = f"#{nearest.key}: " if nearest.key >= 0 else ""
    if nearest.distance < 0.0:
        return f"{key}depth {length(-nearest.distance, unit, SHORT)}"
    if abs(nearest.distance) <= SAID_TO_TOUCH * size:
        return f"{key}touching"
    return f"{key}{length(nearest.distance, unit, SHORT)}"


def solid_readout(answer: SolidProximity, names: tuple[str, str], unit: str, size: float) -> str:
    """Return the sentence and the table of an answer, as HTML.

    Parameters
    ----------
    answer, names, unit, size
        As of `solid_verdict`.
    """
    features = [
        f"{feature} of {name}" if feature.kind else ""
        for feature, name in zip((answer.feature_a, answer.feature_b), names, strict=True)
    ]
    bodies = [BODY.format(strong) for _, strong in BODY_COLOURS]
    rows = [
        ("status", "status", answer.status.name),
        (MARK.format(COLOURS[0]) + "distance", "distance", length(answer.distance, unit)),
        (MARK.format(COLOURS[1]) + "lower bound", "bound", _bound(answer, unit)),
    ]
    if answer.overlap is not None:
        rows.append(("depth", "depth", _depth(answer, unit)))
    rows += [
        ("minima", "minima", minima_text(answer)),
        (bodies[0] + "from", "a", features[0]),
        (bodies[1] + "to", "b", features[1]),
        ("normal", "normal", _vector(answer)),
    ]
    return TABLE.format(
        escape(solid_verdict(answer, names, unit, size)),
        "".join(ROW.format(name, key, escape(text)) for name, key, text in rows),
    )


def minima_text(answer: SolidProximity) -> str:
    """Return how many minima there are, how many of them are places, and their keys."""
    keys = [m.key for m in answer.minima if m.key >= 0]
    text = str(len(answer.minima))
    if places := places_of(answer):
        text += f", {len(places)} in overlap"
    if keys:
        more = ", …" if len(keys) > MOST_KEYS else ""
        text += ": " + ", ".join(f"#{key}" for key in keys[:MOST_KEYS]) + more
    return text


def minima_list(answer: SolidProximity, unit: str) -> str:
    """Return the list of all minima, as HTML: key, distance, and what they are on."""
    if not answer.minima:
        return NONE.format("none is told here")
    rows = []
    for m in answer.minima[:MOST_LISTED]:
        told = escape(length(m.distance, unit, 6))
        shown = IN_OVERLAP.format(told) if m.distance < 0.0 else told
        key = m.key if m.key >= 0 else "–"
        shown += "" if m.felt else ANOTHER
        rows.append(LISTED.format(m.key, key, shown, m.feature_a, m.feature_b))
    more = len(answer.minima) - MOST_LISTED
    left = NONE.format(f"and {counted(more, 'more', 'more')}") if more > 0 else ""
    return LIST.format("".join(rows)) + left


def _depth(answer: SolidProximity, unit: str) -> str:
    places = places_of(answer)
    if places:
        return length(-places[0].distance, unit)
    assert answer.overlap is not None
    return f"at least {lower(answer.overlap.depth, unit)}"


def _bound(answer: SolidProximity, unit: str) -> str:
    """The lower bound; of an overlap that has none that of its deepest place."""
    bound = known_of(answer).lower_bound
    own = np.isfinite(answer.lower_bound) or not np.isfinite(bound)
    return lower(bound, unit) if own else f"{lower(bound, unit)}, of this place"


def _vector(answer: SolidProximity) -> str:
    if not np.isfinite(answer.normal).all():
        return "not known"
    return ", ".join(f"{value:+.3f}" for value in np.round(answer.normal, 3) + 0.0)
