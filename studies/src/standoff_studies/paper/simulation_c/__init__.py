"""Simulation C, Figs. 12-15: two planar bodies, one spins while its centre spirals in."""

from standoff_studies.paper.simulation_c.automaton import figure_13
from standoff_studies.paper.simulation_c.parameters import figure_15
from standoff_studies.paper.simulation_c.regions import figure_12
from standoff_studies.paper.simulation_c.snapshots import figure_14

__all__ = ["figure_12", "figure_13", "figure_14", "figure_15"]
