"""Wrenches: what pushes and turns a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from standoff.checks.arrays import finite
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array


@dataclass(frozen=True, init=False, eq=False)
class Wrench(KeepsReadOnly):
    """A force at a body's origin, and a torque about it, both along the world's axes.

    The power that it gives a body with the `Twist` (v, ω) is ``force @ v + torque @ omega``.

    Raises ValueError if a component is not finite or a shape is wrong.

    Parameters
    ----------
    force : array_like, shape (3,)
        [N]
    torque : array_like, shape (3,)
        [N m]

    Attributes
    ----------
    force, torque : ndarray, shape (3,)
        Read-only, float64.
    """

    force: Array
    torque: Array

    def __init__(self, force: ArrayLike, torque: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        object.__setattr__(self, "force", finite(force, "force", (3,)))
        object.__setattr__(self, "torque", finite(torque, "torque", (3,)))

    @classmethod
    def zero(cls) -> Wrench:
        """Return no force and no torque."""
        return cls.from_checked((0.0, 0.0, 0.0, 0.0, 0.0, 0.0))

    @classmethod
    def from_checked(cls, six: tuple[float, ...]) -> Wrench:
        """Wrap six finite numbers, force first, unchecked."""
        wrench = cls.__new__(cls)
        for name, part in (("force", six[:3]), ("torque", six[3:])):
            vector = np.array(part)
            vector.setflags(write=False)
            object.__setattr__(wrench, name, vector)
        return wrench
