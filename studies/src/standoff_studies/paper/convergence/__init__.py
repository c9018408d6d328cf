"""Which starts arrive on tiled bodies: laws, switchings, solves and gains side by side."""

from standoff_studies.paper.convergence.figures import anew, as_committed

__all__ = ["anew", "as_committed"]
