"""How fast the projection errors of a wrong start decay, compared with the gain of a figure."""

from __future__ import annotations

import numpy as np

from standoff.motion import Path
from standoff.recording import Recording
from standoff_studies.paper.figure import Statement
from standoff_studies.paper.resets import error_at

DECAY_PART = 0.01
"""Fraction of K by which the rate may differ: Heun's method differs by (K h)²/6, at most 4e-4 here,
and the rest is the law's error along the motion."""


def decay_rate(
    recording: Recording, paths: tuple[Path, Path], window: tuple[float, float]
) -> float:
    """Return the rate at which the projection errors decay between two times [1/s]."""
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
    """Return whether the errors of a wrong start decay at the gain that the figure names.

    Parameters
    ----------
    recording : Recording
    paths : (Path, Path)
        The motions along which it was made.
    window : (float, float)
        Times between which the decay is measured [s]: within one mode, and before the law's own
        error along the motion dominates.
    gain : float
        K, as named by the figure [1/s].
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
