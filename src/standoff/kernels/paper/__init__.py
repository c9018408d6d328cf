"""The paper's law: its feedback, integrators, Voronoi regions and frame."""
