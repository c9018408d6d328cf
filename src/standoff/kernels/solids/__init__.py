"""Solids that need not be convex: potentials, searches and closings."""
