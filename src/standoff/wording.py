"""Words that stand in lines of results: numbers with their nouns, names cut to fit."""

from __future__ import annotations

NAME_SHOWN = 20
"""Longest name of a body that the line of an answer or a recording repeats, in characters."""


def short_name(name: str) -> str:
    """Return a body's name as it stands in a line with others."""
    return name if len(name) <= NAME_SHOWN else name[: NAME_SHOWN - 1] + "…"


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun, such as "1 frame" and "2 frames"."""
    return f"{number} {one if number == 1 else many or one + 's'}"
