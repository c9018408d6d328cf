"""Scenes in TOML: bodies, placements, motions, and tracking settings."""
