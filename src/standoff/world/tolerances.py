"""Every tolerance of worlds, with its unit and its reason."""

from typing import Final

COMPOSED_ROUNDOFF: Final = 1e-14
"""No unit. What roundoff may add to the defect of a pose's rotation where it is composed with the
placement of a piece: three products and sums for each entry, and as many for the defect."""
