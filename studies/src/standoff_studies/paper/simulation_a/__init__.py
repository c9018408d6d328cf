"""Simulation A, Figs. 6 and 7: a convex patch and a moving point, from a large initial error."""

from standoff_studies.paper.simulation_a.errors import figure_7
from standoff_studies.paper.simulation_a.snapshots import figure_6

__all__ = ["figure_6", "figure_7"]
