"""Exact, certified minimum distance of curved convex bodies in motion."""

__version__ = "0.1.0"
