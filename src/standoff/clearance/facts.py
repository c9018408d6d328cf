"""A report as plain data, for JSON."""

from __future__ import annotations

from typing import Any

from standoff.clearance.report import PairRow, Report, reason_of
from standoff.clearance.verdicts import touching_tolerance
from standoff.wording import printable

ANSWERED = (
    *("distance", "lower_bound", "upper_bound", "point_a", "point_b", "normal"),
    *("feature_a", "feature_b", "status"),
)
"""Attributes of an answer that are told, in their order."""


def report_facts(report: Report) -> dict[str, Any]:
    """Return a report as mappings, lists, texts and numbers, but for arrays and enumerations."""
    return {
        "bodies": len(report.world.bodies),
        "within": report.world.within,
        "min": report.least,
        "min_missed_by": report.missing,
        "clearance": report.clearance,
        "holds": not report.failures,
        "certified": report.certified,
        "advice": {status.name: status.advice for status in report.statuses},
        "verdicts": {verdict.name: n for verdict, n in report.tally().items()},
        "pairs": [row_facts(row) for row in report.rows],
        "far": {
            "count": len(report.far),
            "at_least": report.least_far,
            "pairs": [
                {"names": far.names, "at_least": far.bound, "failure": far.failure or None}
                for far in report.far
            ],
        },
        "fits": [
            {
                "a": note.fit.a,
                "b": note.fit.b,
                "gap": note.fit.gap,
                "reason": note.fit.reason,
                "holds": note.holds,
                "note": note.note or None,
            }
            for note in report.fits
        ],
    }


def in_cavity(row: PairRow) -> str | None:
    """Return the name of the body that is in a closed cavity of the other, if one is."""
    which = getattr(row.answer, "cavity", "")
    return str(row.answer.names["AB".index(which)]) if which else None


def body_text(row: PairRow) -> list[str]:
    """Return the names of the two bodies, each with that of its piece, and which is in a cavity."""
    answer, within = row.answer, in_cavity(row)
    return [
        printable(" ".join(filter(None, each))) + (", in a cavity" if each[0] == within else "")
        for each in zip(answer.names, answer.pieces, strict=True)
    ]


def row_facts(row: PairRow) -> dict[str, Any]:
    """Return one near pair."""
    answer, fit = row.answer, row.fit
    return {
        "names": answer.names,
        "pieces": answer.pieces,
        "verdict": row.verdict.name,
        **{name: getattr(answer, name) for name in ANSWERED},
        "in_cavity": in_cavity(row),
        "bounds_reason": reason_of(answer) or None,
        "certified": not row.nearest.uncertified,
        "uncertified_frames": row.nearest.uncertified,
        "uncertified_as": [status.name for status in row.nearest.statuses],
        "time": row.nearest.time,
        "least_lower_bound": row.nearest.lower_bound,
        "touching_within": touching_tolerance(answer),
        "required": row.required,
        "tolerance": row.tolerance,
        "allowed": None if fit is None else {"gap": fit.gap, "reason": fit.reason},
        "failure": row.failure or None,
        **({} if row.common is None else {"common_volume": row.common}),
    }
