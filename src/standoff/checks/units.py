"""Units of length to which those of files are converted, and the words that tell it."""

from __future__ import annotations

from typing import Any

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError

METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0, "inch": 0.0254}
"""Units of length, in metres."""


def known_unit(unit: Any) -> str:
    """The name of a unit as it is.

    Raises StandoffError: none of `METRES`.
    """
    if not isinstance(unit, str) or unit not in METRES:
        raise StandoffError(f"unit = {shown(unit)}: give one of {tuple(METRES)}.", "unit", unit)
    return unit


def conversion(unit: str, file_unit: str) -> str:
    """What became of a file's lengths, "" where they are as in the file."""
    return f"converted from {file_unit}" if file_unit and unit != file_unit else ""


def lengths_told(unit: str, file_unit: str) -> str:
    """The unit of what was read from a file, for the first line of its report."""
    converted = conversion(unit, file_unit)
    return f"lengths in {unit or 'no known unit'}{converted and ', ' + converted}"
