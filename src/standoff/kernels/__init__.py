"""Compiled kernels over tuples and flat arrays: jets, equations, feedback, tracking."""
