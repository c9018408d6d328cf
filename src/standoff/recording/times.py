"""Times of a run's frames."""

from __future__ import annotations

import math

import numpy as np

from standoff.errors import StandoffError
from standoff.recording.tolerances import WHOLE_STEPS
from standoff.typing import Array

MOST_FRAMES = 10_000_000
"""Most frames of one run. A frame is kept in some 600 bytes, so this many take 6 GB; a greater
number comes from a step or a duration in the wrong unit."""


def even_times(start: float, duration: float, step: float) -> Array:
    """Return ``start + k step`` within the duration [s], shape (n,).

    Raises ValueError if there are fewer than two, or more than `MOST_FRAMES`.
    """
    if not math.isfinite(start):
        raise StandoffError(f"start = {start}: give a finite time in s.", "start", start)
    steps = duration / step + WHOLE_STEPS
    if steps >= MOST_FRAMES:
        raise StandoffError(
            f"{duration:g} s in steps of {step:g} s are {steps:.3g} frames, more than "
            f"{MOST_FRAMES:g}; give a longer step or a shorter duration",
            "duration",
            duration,
        )
    # The last step may end a rounding error beyond the end, where samples refuse to be asked.
    times = np.minimum(start + step * np.arange(math.floor(steps) + 1), start + duration)
    if len(times) < 2 or not (np.diff(times) > 0.0).all():
        raise StandoffError(
            f"from {start:g} s to {start + duration:g} s there are {len(times)} frames {step:g} s "
            "apart: at least 2 at different times are needed; give a longer duration or another "
            "step"
        )
    return np.asarray(times)
