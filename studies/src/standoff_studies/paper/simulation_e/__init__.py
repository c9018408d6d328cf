"""Simulation E, Figs. 19-20: two bodies of three patches each, through faces and edges of both."""

from standoff_studies.paper.simulation_e.parameters import figure_20
from standoff_studies.paper.simulation_e.snapshots import figure_19

__all__ = ["figure_19", "figure_20"]
