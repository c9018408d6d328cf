"""Tolerances of volumes and moments, each with its unit and reason."""

from __future__ import annotations

from typing import Final

LEVEL_CURVE: Final = 1e-14
"""Parameter units: a trimming curve is level, or on an axis, where it is within this of it."""

NORMALS_RESOLVED: Final = 1e-13
"""Relative: what the last coefficients of the polynomials that follow the normals along a collapsed
side must have fallen to: the roundoff of a normal."""

LEAST_SHARE: Final = 1e-3
"""Share of the last difference that a cell's remainder is never trusted below, whatever the last
two differences foretell."""

ANGLE_TOLERANCE: Final = 1e-10
"""Steradians, of the area of an ellipsoidal face's directions (1 rad by 1 rad): only its sign is
asked."""
