"""Matplotlib pictures of a body with all its features, or of two with their witness points."""
