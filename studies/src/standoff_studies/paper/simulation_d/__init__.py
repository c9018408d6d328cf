"""Simulation D, Figs. 16-18: the lens and a point on a helix, through faces, edges and a vertex."""

from standoff_studies.paper.simulation_d.modes import figure_17
from standoff_studies.paper.simulation_d.parameters import figure_18
from standoff_studies.paper.simulation_d.scene import figure_16

__all__ = ["figure_16", "figure_17", "figure_18"]
