"""What a page asks of the local minima of a pair with a solid."""

from __future__ import annotations

from typing import NamedTuple


class MinimaAsked(NamedTuple):
    """Options of a page.

    Attributes
    ----------
    minima : float or None
        Below which distance they are told [length]; None: 0.3 of the smaller one's size.
    patch : float or None
        With their patches, as of ``so.solids.distance`` [length].
    """

    minima: float | None = None
    patch: float | None = None
