"""How a caller is told how far a long computation has come."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Told now and then how many parts are done (frames, ticks, modules), and of how many."""
