"""The boundary of a convex body with a radius: its core's surface, moved out by it."""
