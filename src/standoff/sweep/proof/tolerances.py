"""The tolerances of proofs over boxes of parameters, each with its unit and its reason."""

from typing import Final

CELL_ROUNDINGS: Final = 64.0
"""Roundings (of the lengths that take part) by which the pose of a cell's middle, and what is
computed from it, may be off: each of six turns has 3, shifts and products the rest."""

RANGE_ROUNDINGS: Final = 8.0
"""Roundings (of a range's ends) by which the number in a cell's middle may be off: the product and
sum with both ends have 3, the turn from degrees to rad 2."""

SQUARE_ROUNDINGS: Final = 16.0
"""Roundings (of 1) by which the square of the sine of a normal's angle to an axis may be off: the
normal's number along it has passed six turns."""

UNIT_NORMAL: Final = 1e-9
"""By which the square of a normal's length, without a unit, may differ from 1; one that is nan, or
was not found, differs by more."""

FINEST_SHARE: Final = 1e-3
"""A cell is not halved any more where its points move by no more than this fraction of what they
move in the whole box: without a unit. A job says otherwise by `finest`."""
