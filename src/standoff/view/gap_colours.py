"""Colours of gaps: dark is near; those of bodies that overlap or touch are of another kind."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.clearance.verdicts import Verdict

Bytes = NDArray[np.uint8]

STOPS = np.array(
    [(8, 29, 88), (34, 94, 168), (29, 145, 192), (65, 182, 196), (127, 205, 187)],
    dtype=float,
)
"""Of gaps from 0 to the scale's end: ColorBrewer's yellow, green and blue without the palest, which
are not seen on white."""

OF_VERDICT = {
    Verdict.OVERLAPPING: (213, 94, 0),
    Verdict.UNDECIDED: (204, 121, 167),
    Verdict.TOUCHING: (230, 159, 0),
}
"""After Okabe and Ito, as in the matrix of `standoff clearance`."""

FAR: tuple[int, int, int] = (229, 229, 229)

BRIGHT = 0.55
"""Brightness of a colour from which writing on it is black."""


def gap_colours(gaps: ArrayLike, end: float) -> Bytes:
    """Return the colours of gaps.

    Parameters
    ----------
    gaps : (n,) array
        Length; a negative one is that of bodies that overlap.
    end : float
        Gap of the palest colour [length], above 0.

    Returns
    -------
    (n, 3) array of uint8
    """
    given = np.asarray(gaps, dtype=float)
    share = np.clip(given / end, 0.0, 1.0) * (len(STOPS) - 1)
    places = np.arange(len(STOPS))
    found = np.stack([np.interp(share, places, stops) for stops in STOPS.T], axis=-1)
    found[given < 0.0] = OF_VERDICT[Verdict.OVERLAPPING]
    rounded: Bytes = np.rint(found).astype(np.uint8)
    return rounded


def css(colour: ArrayLike) -> str:
    """Return a colour as a page of HTML has it."""
    red, green, blue = np.asarray(colour, dtype=int).tolist()
    return f"rgb({red},{green},{blue})"


def writing_on(colour: ArrayLike) -> str:
    """Return black or white, whichever is read on a colour."""
    bright = float(np.asarray(colour, dtype=float) @ (0.3, 0.59, 0.11)) / 255.0
    return "black" if bright > BRIGHT else "white"
