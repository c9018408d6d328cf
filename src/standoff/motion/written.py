"""Vectors as a repr writes them."""

import numpy as np

from standoff.checks.arrays import FloatArray
from standoff.motion.tolerances import SHOWN_DIGITS


def written(values: FloatArray, scale: float = 0.0) -> str:
    """Return numbers as a list with six digits each; what is roundoff compared with the greatest of
    them, or with `scale` in their unit, as 0."""
    size = max(scale, float(np.abs(values).max(initial=0.0)))
    return f"[{', '.join(f'{x:.6g}' if abs(x) > SHOWN_DIGITS * size else '0' for x in values)}]"
