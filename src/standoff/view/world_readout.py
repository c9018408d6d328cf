"""A world's answer in the words and numbers of the page."""

from __future__ import annotations

from html import escape

import numpy as np

from standoff.view.readout import COLOURS, MARK, ROW, TABLE, length, lower, verdict
from standoff.view.solid_readout import solid_verdict
from standoff.wording import at_least, counted, printable, short_name
from standoff.world import PairAnswer, WorldAnswer
from standoff.world.solid_answer import SolidPairAnswer


def named(pair: PairAnswer | SolidPairAnswer) -> str:
    """Return the names of a pair and of its nearest pieces."""
    each = zip(pair.names, pair.pieces, strict=True)
    return " – ".join(": ".join(printable(word) for word in words if word) for words in each)


def closest_text(pair: PairAnswer | SolidPairAnswer) -> str:
    """Return the names of a pair's bodies, short enough to stand in the scene."""
    return " – ".join(short_name(name) for name in pair.names)


def world_readout(answer: WorldAnswer, unit: str, size: float, pairs: int | None) -> str:
    """Return the sentences and the table of a world's answer, as HTML.

    Parameters
    ----------
    answer : WorldAnswer
    unit : str
        Label of lengths.
    size : float
        Of the bodies, in that unit.
    pairs : int or None
        How many count; None where they are too many to be counted.
    """
    closest, near, counts = answer.closest, answer.pairs, answer.counts
    overlapping = int(np.count_nonzero(near.distance < 0.0))
    if closest is None:
        said = _far_text(answer, unit)
        rows = [
            ("closest", "closest", "none within the horizon"),
            (MARK.format(COLOURS[0]) + "distance", "distance", "not known"),
        ]
    else:
        told = (
            verdict(closest, unit, size)
            if isinstance(closest, PairAnswer)
            else solid_verdict(closest, closest.names, unit, size)
        )
        said = f"{closest_text(closest)}: {told}"
        rows = [
            ("closest", "closest", named(closest)),
            (MARK.format(COLOURS[0]) + "distance", "distance", length(closest.distance, unit)),
            ("lower bound", "bound", lower(closest.lower_bound, unit)),
        ]
    clearance = f"{at_least(answer.clearance)} {unit}".rstrip()
    rows.append((MARK.format(COLOURS[1]) + "clearance", "clearance", f"{clearance}, all pairs"))
    of_all = "" if pairs is None else f" of {counted(pairs, 'pair')}"
    rows.append(("near", "near", f"{len(near)}{of_all}"))
    if overlapping:
        rows.append(("overlapping", "overlapping", counted(overlapping, "pair")))
    works = ("tracked", "started", "resting", "bounded", "sought")
    work = [f"{getattr(counts, name)} {name}" for name in works if getattr(counts, name)]
    if counts.uncertified:
        work.append(f"{counts.uncertified} not proven")
    rows.append(("work", "work", ", ".join(work) or "none"))
    table = "".join(ROW.format(name, key, escape(text)) for name, key, text in rows)
    return TABLE.format(escape(said), table)


def _far_text(answer: WorldAnswer, unit: str) -> str:
    if not np.isfinite(answer.clearance):
        return "no pair of bodies counts"
    least = f"{at_least(answer.clearance, 4)} {unit}".rstrip()
    return f"all pairs are at least {least} apart, beyond the horizon"
