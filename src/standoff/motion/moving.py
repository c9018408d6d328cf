"""What moves a body: a path of the library's or of the user's own, a function, a pose at rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.motion.paths import Fixed
from standoff.motion.pose import Pose, PoseLike
from standoff.motion.pose_function import path_of
from standoff.motion.twist import TwistLike


class Moving(Protocol):
    """Where a body is and how it moves: any of ``standoff.motion``'s paths, or your own."""

    def pose(self, t: float) -> PoseLike:
        """Return where the body is at time `t` [s]."""
        ...

    def twist(self, t: float) -> TwistLike:
        """Return how it moves at time `t` [s]: the derivative of `pose`."""
        ...


MotionLike: TypeAlias = Moving | Callable[[float], PoseLike] | PoseLike
"""What is read as a path: a path, a function of time that returns a pose, or a pose at rest."""


def moving(given: Any, name: str, start: float = 0.0, end: float = math.inf) -> Moving:
    """Return a path; a function is one from `start` to `end`, a pose is one at rest.

    Raises TypeError if it is none of these.
    """
    try:
        path: Moving = path_of(given, start, end)
        return path
    except TypeError:
        pass
    try:
        return Fixed(Pose.of(given))
    except (ValueError, TypeError) as error:
        raise StandoffTypeError(
            f"{name} = {shown(given)} is neither a path with pose(t) and twist(t), such as those "
            f"of standoff.motion, nor a function of the time, nor a pose: {error}",
            name,
            given,
        ) from error
