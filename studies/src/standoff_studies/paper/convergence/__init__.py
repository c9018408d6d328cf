"""Which starts arrive on tiled bodies: a comparison of laws, switchings, solves and gains."""

from standoff_studies.paper.convergence.figures import anew, as_committed
from standoff_studies.paper.convergence.harder import harder

__all__ = ["anew", "as_committed", "harder"]
