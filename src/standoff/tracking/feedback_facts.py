"""A feedback as plain data, such as ``{"kind": "pi", "gain": 400.0, "integral": 4e4}``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.tracking.feedback import PI, Feedback, FiniteTime, GainMatrix, Linear, MotionGain

KINDS: Mapping[str, Callable[..., Feedback]] = {
    "linear": Linear,
    "matrix": GainMatrix,
    "pi": PI,
    "finite-time": FiniteTime,
    "motion": MotionGain,
}


def feedback_facts(feedback: Feedback) -> dict[str, Any]:
    """Return the feedback's kind and its numbers, named as in a scene."""
    for name, kind in KINDS.items():
        if type(feedback) is kind:
            return {"kind": name} | _numbers(feedback)
    return {"kind": str(feedback)}  # a program's own, which no scene can name


def feedback_of_facts(facts: Any) -> Feedback:
    """Return the feedback that `feedback_facts` turned into data.

    Raises ValueError if it is not such data, such as that of a program's own feedback.
    """
    if not isinstance(facts, Mapping) or facts.get("kind") not in KINDS:
        raise StandoffError(
            f"feedback = {shown(facts)} is not one of standoff's: {sorted(KINDS)}.",
            "feedback",
            facts,
        )
    return KINDS[facts["kind"]](**{name: x for name, x in facts.items() if name != "kind"})


def feedback_text(facts: Mapping[str, Any]) -> str:
    """Return what `feedback_facts` made of a feedback in words, for a summary."""
    kind = facts["kind"]
    facts = {name: value for name, value in facts.items() if name != "kind"}
    told = ", ".join(f"{name} {_told(value)}" for name, value in facts.items())
    return f"{kind} ({told})" if told else str(kind)


def _numbers(feedback: Any) -> dict[str, Any]:
    if not is_dataclass(feedback):
        return {"gains": feedback.matrix.tolist()}
    found = asdict(feedback)  # type: ignore[arg-type]
    return {name: value for name, value in found.items() if value is not None}


def _told(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_told(item) for item in value) + "]"
    return f"{value:.6g}"
