"""Tolerances of volumes and moments, each with its unit and reason."""

from __future__ import annotations

from typing import Final

LEVEL_CURVE: Final = 1e-14
"""A trimming curve has constant u or v, or is on an axis, to within this (parameter units)."""

NORMALS_RESOLVED: Final = 1e-13
"""Relative size below which the last coefficients of the polynomials for the normals along a
collapsed side must be: the roundoff of a normal."""

LEAST_SHARE: Final = 1e-3
"""A cell's estimated error is at least this fraction of the last difference, whatever the last two
differences predict."""

ANGLE_TOLERANCE: Final = 1e-10
"""Error of an ellipsoidal face's solid angle in steradians (1 rad by 1 rad): only its sign is
needed."""
