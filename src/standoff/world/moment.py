"""A frame's place in time."""

from __future__ import annotations

from typing import NamedTuple

from standoff.progress import Progress
from standoff.typing import Array


class FrameTime(NamedTuple):
    """A frame's place in time, and what else its answers are made with.

    Attributes
    ----------
    frame : int
        Its number.
    time, dt : float
        Since the start, and since the frame before, s.
    twists : (n, 9) array
        Of each body: (v, omega) and its origin, world axes.
    has_twist : bool
    may_rest : bool
        May answers of the frame before be kept where nothing has moved?
    minima : float
        All minima below it are asked, length.
    workers : int
    progress : callable, optional
        Told how many pairs with a solid are done, and of how many.
    """

    frame: int
    time: float
    dt: float
    twists: Array
    has_twist: bool
    may_rest: bool
    minima: float
    workers: int
    progress: Progress | None = None
