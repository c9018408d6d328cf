"""Vectors, rotations and small dense solves."""
