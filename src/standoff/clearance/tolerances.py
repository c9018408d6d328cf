"""The tolerance of a verdict, with its unit and reason."""

from __future__ import annotations

from typing import Final

TOUCHING_PART: Final = 1e-9
"""Of the larger body's size: a gap or a depth up to this, beside the bodies' own slack, counts as
touching. Placements written with nine digits meet no better, and an answer's own error, some 1e-14
of the size, is far below it."""

FIRST_REACH: Final = 1e-3
"""Of the middle size of the bodies: the first horizon in which the closest pairs are sought. It is
doubled until they are within it, so less costs more rounds, and more costs pairs beyond them."""
