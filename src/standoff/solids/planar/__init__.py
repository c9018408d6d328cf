"""Planar solids: loops of curves, not necessarily convex."""
