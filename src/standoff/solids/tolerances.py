"""Tolerances of solids in the plane and in space alike, each with its unit and reason."""

from typing import Final

PARTED_BY: Final = 4.0
"""Times the tolerance: a solid is moved so far off each place of contact to see whether it then is
apart; if so, no more than that is shared, and they touch."""
NO_WAY_OUT: Final = 1e-6
"""Length of a mean of unit normals, and cosine to one, below which no way leads along all: a pin
that touches all round."""
FLAT_BOX: Final = 1e-9
"""Part of a picture's width: a box that is narrower is drawn as a line."""
FARTHER: Final = 1e-6
"""Of the sizes: pairs that are farther than the nearest by more are told as local minima."""
