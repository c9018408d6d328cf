"""Units of a simulation's numbers in words, by the label of its lengths."""

from __future__ import annotations

from typing import NamedTuple


class Units(NamedTuple):
    """What stands after the numbers: in metres and kilograms the names that everybody knows."""

    length: str
    force: str
    torque: str
    energy: str

    @classmethod
    def of(cls, length: str) -> Units:
        """Those that go with a unit of length; none of an unknown one."""
        if not length:
            return cls("", "", "", "")
        if length == "m":
            return cls("m", "N", "N m", "J")
        force, energy = f"mass·{length}/s²", f"mass·{length}²/s²"
        return cls(length, force, energy, energy)
