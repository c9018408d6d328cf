"""How fast the projection errors of a wrong start fall, beside the gain that a figure names."""

from __future__ import annotations

import numpy as np

from standoff.motion import Path
from standoff.recording import Recording
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.resets import error_at

DECAY_PART = 0.01
"""Part of K by which the rate may differ: Heun's own differs by (K h)²/6, at most 4e-4 here, and
what is left is the law's error along the motion."""


def decay_rate(
    recording: Recording, paths: tuple[Path, Path], window: tuple[float, float]
) -> float:
    """Return the rate at which the projection errors fall between two times [1/s]."""
    frames = [int(np.abs(recording.time - t).argmin()) for t in window]
    sizes = np.array([error_at(recording, paths, frame) for frame in frames])
    with np.errstate(divide="ignore"):  # a mode without parameters has no errors
        first, last = np.log(sizes)
    return float((first - last) / (window[1] - window[0]))


def decay_statement(
    recording: Recording,
    paths: tuple[Path, Path],
    window: tuple[float, float],
    gain: float,
    by: str,
) -> Statement:
    """Say whether the errors of a wrong start fall at the gain that the figure names.

    Parameters
    ----------
    recording : Recording
    paths : (Path, Path)
        The motions that it was made along.
    window : (float, float)
        Between which times the decay is measured [s]: within one mode, and before the law's own
        error along the motion shows.
    gain : float
        K, as the figure names it [1/s].
    by : str
    """
    rate = decay_rate(recording, paths, window)
    return Statement(
        "Eq. (14)",
        "the projection errors decay as exp(−K t) from the wrong start",
        f"|Ψ| falls at {rate:.2f} per s from {window[0]:g} s to {window[1]:g} s, with "
        f"K = {gain:g} per s",
        abs(rate - gain) < DECAY_PART * gain,
        by=by,
    )
