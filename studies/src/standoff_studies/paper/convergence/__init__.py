"""Which starts arrive on tiled bodies: a comparison of laws, switchings, solves and gains."""

from standoff_studies.paper.convergence.figures import anew, as_committed

__all__ = ["anew", "as_committed"]
