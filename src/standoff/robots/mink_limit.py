"""mink's collision limit with exact rows: ``so.robots.MinkLimit``."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.numbers import not_negative, number
from standoff.errors import StandoffError, of_extra
from standoff.robots.certify_tolerances import ASKED_CLEARANCE
from standoff.robots.near import NearLinks
from standoff.robots.robot import Robot

with of_extra("mink", "mink"):
    from mink.limits import Constraint, Limit


class MinkLimit(Limit):  # type: ignore[misc]
    """Keeps the clearance of all near pairs of a robot in mink's inverse kinematics.

    One row for each pair within the horizon: in a step the distance may lose at most the part
    `gain` of what its proven bound has above the minimum. To first order it is never below that.

    Raises ModuleNotFoundError: mink is not installed; the message names the extra. Raises
    TypeError: no robot. Raises ValueError: a number out of its range; a horizon that is not above
    the minimum. When called: a configuration of another model.

    Parameters
    ----------
    robot : Robot
        Of the model that mink's configuration has, with its obstacles.
    minimum : float
        The clearance that is kept, length; below zero that much overlap is let through.
    gain : float
        Above 0 and at most 1, no unit.
    within : float, optional
        The horizon, length; the robot's own if not given.
    recover : float
        Of a pair that is below the minimum: the part of what it lacks that a step must win back,
        0 to 1, no unit. 0 only forbids coming nearer. More may leave no solution.
    """

    def __init__(
        self,
        robot: Robot,
        minimum: float = ASKED_CLEARANCE,
        *,
        gain: float = 0.85,
        within: float | None = None,
        recover: float = 0.0,
    ) -> None:
        self.minimum, self.gain = number(minimum, "minimum"), number(gain, "gain")
        self.recover = not_negative(recover, "recover")
        if not 0.0 < self.gain <= 1.0 or self.recover > 1.0:
            raise StandoffError(
                f"gain = {gain}, recover = {recover}: give a gain above 0 and at most 1, and "
                "recover from 0 to 1.",
                "gain",
                gain,
            )
        self._near = NearLinks(robot, self.minimum, within)

    def compute_qp_inequalities(self, configuration: Any, dt: float) -> Constraint:
        """Rows G, h with G Δq <= h, as mink asks for; Δq is the way of one step, whatever dt is.

        Raises ValueError: a configuration of another model.
        """
        self._near.check_model(configuration.model)
        rows = self._near.rows(configuration.q)
        if not len(rows):
            return Constraint()
        above = rows.lower_bound - self.minimum
        return Constraint(-rows.jacobian, np.where(above > 0.0, self.gain, self.recover) * above)
