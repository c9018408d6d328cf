"""Fig. 5: device, virtual coupler, dynamics and tracker integrated in one operator."""

from standoff_studies.paper.in_the_loop.figure import figure_5

__all__ = ["figure_5"]
