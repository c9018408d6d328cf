"""Tolerances of solids in the plane and in space alike, each with its unit and reason."""

from typing import Final

PARTED_BY: Final = 4.0
"""Times the tolerance: a solid is moved so far off each place of contact to see whether it then is
apart; if so, no more than that is shared, and they touch."""
NO_WAY_OUT: Final = 1e-6
"""Length of a mean of unit normals, and cosine to one, below which no way leads along all: a pin
that touches all round."""
MOVED_MORE: Final = 1e-3
"""Of a length: how much farther than it B is moved to part the solids, and how much less than a gap
it is moved back; a gap is proven the faster the wider it is."""
WAY_GAIN: Final = 5e-3
"""Of the length of a way out: what a query has to shorten it by for another one to be made."""
FLAT_BOX: Final = 1e-9
"""Part of a picture's width: a box that is narrower is drawn as a line."""
FARTHER: Final = 1e-6
"""Of the sizes: pairs that are farther than the nearest by more are told as local minima."""
