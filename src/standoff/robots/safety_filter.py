"""A safety filter: the nearest velocities that keep the clearance (control barrier function)."""

from __future__ import annotations

from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from standoff.checks.arrays import finite, numbers
from standoff.checks.numbers import number, positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, of_extra
from standoff.robots.near import NearLinks
from standoff.robots.robot import Robot
from standoff.robots.rows import RobotRows
from standoff.robots.tolerances import RATE_LOST
from standoff.typing import Array

with of_extra("qpsolvers", "qp"):
    import qpsolvers


class FilterStatus(Enum):
    """What became of the velocity that was given."""

    UNCHANGED = "unchanged"
    CHANGED = "changed"
    INFEASIBLE = "infeasible"


class SafeVelocity(NamedTuple):
    """The answer of a `SafetyFilter`.

    Attributes
    ----------
    velocity : (nv,) array or None
        None if there is no velocity that keeps all rows and limits: what to do then (brake, stop,
        retreat) is the caller's to say.
    status : FilterStatus
    slack : float
        By how much the velocity keeps its tightest row, length per time; -inf if infeasible.
    rows : RobotRows
        The near pairs that were asked.
    """

    velocity: Array | None
    status: FilterStatus
    slack: float
    rows: RobotRows


class SafetyFilter:
    """From velocities to the nearest ones that keep the clearance of all near pairs.

    For each pair within the horizon: distance' >= -gain (proven bound - minimum). The bound is
    proven, so the row asks for no less than the true distance does. Between two calls the
    velocity holds: keep ``gain`` times their time below 1, and the horizon above the minimum and
    what the robot can come nearer in that time.

    Raises ModuleNotFoundError: qpsolvers is not installed; the message names the extra. Raises
    TypeError, ValueError: no robot; a number or size that does not fit; a solver that is not there.

    Parameters
    ----------
    robot : Robot
        With its obstacles.
    minimum : float
        The clearance that is kept, length.
    gain : float
        How fast the rest of the clearance may be lost, 1/s.
    within : float, optional
        The horizon, length; the robot's own if not given.
    lower, upper : (nv,) arrays, optional
        Limits of the velocities.
    weights : (nv,) array, optional
        Of the squares of the changes; ones if not given.
    solver : str
        As ``qpsolvers`` names it.
    """

    def __init__(
        self,
        robot: Robot,
        minimum: float = 0.0,
        *,
        gain: float = 1.0,
        within: float | None = None,
        lower: Any = None,
        upper: Any = None,
        weights: Any = None,
        solver: str = "daqp",
    ) -> None:
        self.minimum, self.gain = number(minimum, "minimum"), positive(gain, "gain")
        self._near = NearLinks(robot, self.minimum, within)
        nv = (robot.nv,)
        self.lower = np.full(nv, -np.inf) if lower is None else numbers(lower, "lower", nv)
        self.upper = np.full(nv, np.inf) if upper is None else numbers(upper, "upper", nv)
        self.weights = np.ones(nv) if weights is None else finite(weights, "weights", nv)
        if (self.weights <= 0.0).any() or not (self.lower <= self.upper).all():
            raise StandoffError("Give weights above zero, and lower limits below the upper ones.")
        if solver not in qpsolvers.available_solvers:
            raise StandoffError(
                f"solver = {shown(solver)} is not installed; there are "
                f"{qpsolvers.available_solvers}.",
                "solver",
                solver,
            )
        self.solver = solver

    def filter(self, q: Any, velocity: Any) -> SafeVelocity:
        """The nearest safe velocity.

        Raises ValueError: sizes that do not fit, numbers that are not finite.

        Parameters
        ----------
        q : (nq,) array
        velocity : (nv,) array
            That is wanted.

        Returns
        -------
        SafeVelocity
            UNCHANGED has the velocity as it was given, to the last bit.
        """
        wanted = finite(velocity, "velocity", (self._near.robot.nv,))
        rows = self._near.rows(q)
        least = -self.gain * (rows.lower_bound - self.minimum)
        slack = self._slack(rows, least, wanted)
        if slack >= 0.0:
            return SafeVelocity(wanted, FilterStatus.UNCHANGED, slack, rows)
        found = qpsolvers.solve_problem(
            qpsolvers.Problem(
                np.diag(self.weights),
                -self.weights * wanted,
                *((-rows.jacobian, -least) if len(rows) else (None, None)),
                lb=self.lower,
                ub=self.upper,
            ),
            self.solver,
        )
        if not found.found or found.x is None:
            return SafeVelocity(None, FilterStatus.INFEASIBLE, -np.inf, rows)
        safe = np.clip(found.x, self.lower, self.upper)
        slack = self._slack(rows, least, safe)
        size = 1.0 + float(np.abs(least).max(initial=0.0))
        if slack < -RATE_LOST * size:
            return SafeVelocity(None, FilterStatus.INFEASIBLE, -np.inf, rows)
        return SafeVelocity(safe, FilterStatus.CHANGED, slack, rows)

    def _slack(self, rows: RobotRows, least: Array, velocity: Array) -> float:
        """By how much the tightest row or limit is kept; below zero if it is not."""
        kept = rows.jacobian @ velocity - least
        limits = np.minimum(velocity - self.lower, self.upper - velocity)
        return float(min(kept.min(initial=np.inf), limits.min(initial=np.inf)))
