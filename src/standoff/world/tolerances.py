"""Every tolerance of worlds, with its unit and its reason."""

from typing import Final

COMPOSED_ROUNDOFF: Final = 1e-14
"""No unit. What roundoff may add to the defect of a pose's rotation where it is composed with the
placement of a piece: three products and sums for each entry, and as many for the defect."""
ALIKE_PLACED: Final = 1e-11
"""Of the sizes of two solids, a tenth of what their distance is proven to: by how much two pairs of
the same solids may differ in how they are to each other, and be asked once. It is subtracted from
the bounds."""
