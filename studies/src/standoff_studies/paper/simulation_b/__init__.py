"""Simulation B, Figs. 8-11: a planar body, and a point on a spiral from inside to outside."""

from standoff_studies.paper.simulation_b.automaton import figure_9
from standoff_studies.paper.simulation_b.parameters import figure_11
from standoff_studies.paper.simulation_b.regions import figure_8
from standoff_studies.paper.simulation_b.snapshots import figure_10

__all__ = ["figure_8", "figure_9", "figure_10", "figure_11"]
