"""Tolerances of sweeps."""

from __future__ import annotations

from typing import Final

SOUND_HOME: Final = 0.5
"""Share of the kernels' ROTATION, dimensionless, that the rotation of a body's home may be off
where the poses made of it are not looked at again: the turns of a row add some 1e-15 to it."""

PLAIN_SUMS: Final = (2.0**-800, 2.0**900)
"""Greatest magnitudes [length] of what is added up between which pieces of numbers neither overflow
nor are rounded as subnormal ones."""
