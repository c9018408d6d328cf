"""Poses, twists, and paths in time."""
