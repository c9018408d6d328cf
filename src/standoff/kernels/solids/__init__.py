"""Compiled parts of solids that need not be convex."""
