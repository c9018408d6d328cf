"""``feedback = { kind = "pi", ... }`` of a ``[track]`` table: one of `standoff.feedback`."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

from standoff.scene.reader import Table
from standoff.tracking.feedback import Feedback, GainMatrix
from standoff.tracking.feedback_facts import KINDS

ERRORS = 4
"""Projection errors of two faces, and so gains of a matrix's diagonal: of (u, v) and (r, s)."""


def read_feedback(table: Table) -> Feedback:
    """Return the feedback that a table describes: its ``kind``, and its class's fields as keys.

    Raises SceneError: at an unknown kind or key, a number that is missing or not above zero, and
    what the feedback refuses.
    """
    kind = KINDS[table.choice("kind", list(KINDS))]
    if kind is GainMatrix:
        table.expect("kind", "gains")
        gains = _gains(table)
        return table.build(lambda: GainMatrix(gains), "gains")
    takes: Any = kind
    every = fields(takes)
    table.expect("kind", *(each.name for each in every))
    names = [each.name for each in every if each.default is MISSING or each.name in table]
    numbers = {name: table.positive(name) for name in names}
    return table.build(lambda: kind(**numbers))


def _gains(table: Table) -> Any:
    value = table.required("gains", "gains = [100.0, 100.0, 100.0, 100.0]")
    if isinstance(value, list) and any(isinstance(row, list) for row in value):
        return table.matrix("gains", [(ERRORS, ERRORS)])
    return table.vector("gains", ERRORS)
