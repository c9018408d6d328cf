"""Figs. 3 and 4: the law's two realisations, Psi integrated as a state or evaluated."""

from standoff_studies.paper.realisations.figures import figure_3, figure_4

__all__ = ["figure_3", "figure_4"]
