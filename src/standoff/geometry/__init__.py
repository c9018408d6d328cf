"""Curves and surfaces: validated, immutable descriptions of shapes."""
