"""The nearest pair at each of many configurations, as arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from standoff.read_only import KeepsReadOnly
from standoff.robots.answer import RobotAnswer
from standoff.tracking.status import Status
from standoff.wording import counted


class RobotAnswers(KeepsReadOnly):
    """Nearest pairs of a robot at m configurations, in arrays of m rows.

    Attributes
    ----------
    distance, lower_bound, upper_bound : (m,) arrays
        Of the nearest pair, signed, length.
    clearance : (m,) array
        Proven lower bounds of the distances of all pairs that are watched.
    names, links : list of (str, str)
        Of the nearest pair: geometries and links.
    point_a, point_b, normal : (m, 3) arrays
        World axes.
    gradient : (m, nv) array
        Of the distance by the robot's velocity, as of a `RobotAnswer`.
    certified : (m,) array of bool
    status : (m,) array of Status
    """

    __slots__ = (
        "certified",
        "clearance",
        "distance",
        "gradient",
        "links",
        "lower_bound",
        "names",
        "normal",
        "point_a",
        "point_b",
        "status",
        "upper_bound",
    )

    def __init__(self, answers: Sequence[RobotAnswer], nv: int) -> None:
        self.names = [answer.names for answer in answers]
        self.links = [answer.links for answer in answers]
        self.distance = np.array([answer.distance for answer in answers])
        self.lower_bound = np.array([answer.lower_bound for answer in answers])
        self.upper_bound = np.array([answer.upper_bound for answer in answers])
        self.clearance = np.array([answer.clearance for answer in answers])
        self.point_a = np.array([answer.point_a for answer in answers]).reshape(-1, 3)
        self.point_b = np.array([answer.point_b for answer in answers]).reshape(-1, 3)
        self.normal = np.array([answer.normal for answer in answers]).reshape(-1, 3)
        self.gradient = np.array([answer.gradient for answer in answers]).reshape(-1, nv)
        self.certified = np.array([answer.certified for answer in answers], dtype=bool)
        self.status: NDArray[np.object_] = np.empty(len(answers), dtype=object)
        self.status[:] = [answer.status for answer in answers]
        for name in self.__slots__:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        if not len(self):
            return "<RobotAnswers of no configuration>"
        least: Status = self.status[int(np.argmin(self.distance))]
        what = counted(len(self), "configuration")
        return f"<RobotAnswers of {what}: least distance {self.distance.min():.6g}, {least.name}>"
