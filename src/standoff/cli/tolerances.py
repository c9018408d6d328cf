"""Tolerances of the command line's pictures, each with its unit and reason."""

from __future__ import annotations

from typing import Final

FLAT_CLOUD: Final = 1e-9
"""Points within this part of the body's size of a common plane span no volume: their hull is not
drawn."""
