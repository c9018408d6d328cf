"""``feedback = { kind = "pi", ... }`` of a ``[track]`` table: one of `standoff.feedback`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, is_dataclass
from typing import Any, NamedTuple

from standoff.scene.reader import Table
from standoff.tracking.feedback import PI, Feedback, FiniteTime, GainMatrix, Linear, MotionGain

ERRORS = 4
"""Projection errors of two faces, and so gains of a matrix's diagonal: of (u, v) and (r, s)."""


class _Kind(NamedTuple):
    """What a kind builds, and the numbers it takes: those that must be there, and the others."""

    construct: Callable[..., Feedback]
    required: tuple[str, ...]
    optional: tuple[str, ...] = ()


KINDS = {
    "linear": _Kind(Linear, ("gain",)),
    "matrix": _Kind(GainMatrix, ("gains",)),
    "pi": _Kind(PI, ("gain", "integral")),
    "finite-time": _Kind(FiniteTime, ("gain", "power", "reference"), ("most",)),
    "motion": _Kind(MotionGain, ("error",), ("least", "most")),
}


def read_feedback(table: Table) -> Feedback:
    """Return the feedback that a table describes: its ``kind``, and its class's fields as keys.

    Raises
    ------
    SceneError
        At an unknown kind or key, a number that is missing or not above zero, and what the
        feedback refuses.
    """
    kind = KINDS[table.choice("kind", list(KINDS))]
    table.expect("kind", *kind.required, *kind.optional)
    if kind.construct is GainMatrix:
        gains = _gains(table)
        return table.build(lambda: GainMatrix(gains), "gains")
    names = [*kind.required, *(name for name in kind.optional if name in table)]
    numbers = {name: table.positive(name) for name in names}
    return table.build_named(lambda: kind.construct(**numbers))


def feedback_facts(feedback: Feedback) -> dict[str, Any]:
    """Return the table that `read_feedback` would read, as plain data."""
    for name, kind in KINDS.items():
        if type(feedback) is kind.construct:
            return {"kind": name} | _numbers(feedback)
    return {"kind": str(feedback)}  # a program's own, which no scene can name


def feedback_text(feedback: Feedback) -> str:
    """Return the feedback in a scene's words, for a summary."""
    facts = feedback_facts(feedback)
    kind = facts.pop("kind")
    told = ", ".join(f"{name} {_told(value)}" for name, value in facts.items())
    return f"{kind} ({told})" if told else str(kind)


def _gains(table: Table) -> Any:
    value = table.required("gains", "gains = [100.0, 100.0, 100.0, 100.0]")
    if isinstance(value, list) and any(isinstance(row, list) for row in value):
        return table.matrix("gains", [(ERRORS, ERRORS)])
    return table.vector("gains", ERRORS)


def _numbers(feedback: Any) -> dict[str, Any]:
    if not is_dataclass(feedback):
        return {"gains": feedback.matrix.tolist()}
    found = asdict(feedback)  # type: ignore[arg-type]
    return {name: value for name, value in found.items() if value is not None}


def _told(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_told(item) for item in value) + "]"
    return f"{value:.6g}"
