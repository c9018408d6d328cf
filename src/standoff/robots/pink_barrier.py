"""Pink's barrier with exact rows: ``so.robots.PinkBarrier``."""

from __future__ import annotations

from typing import Any

import numpy as np

from standoff.checks.numbers import number, positive, whole_number
from standoff.errors import StandoffError, of_extra
from standoff.robots.near import NearLinks
from standoff.robots.robot import Robot
from standoff.typing import Array

with of_extra("Pink", "pink"):
    from pink.barriers import Barrier


class PinkBarrier(Barrier):  # type: ignore[misc]
    """Keeps the clearance of a robot's nearest pairs in Pink's inverse kinematics.

    The barrier is the proven bound of each distance less the minimum. It has a fixed number of
    rows, nearest first; rows of no pair are those of a pair at the horizon that does not move.

    Raises ModuleNotFoundError: pink is not installed; the message names the extra. Raises
    TypeError: no robot. Raises ValueError: a number out of its range; a horizon that is not above
    the minimum; more rows than pairs. When called: a configuration of another model.

    Parameters
    ----------
    robot : Robot
        Of the model that Pink's configuration has, with its obstacles.
    minimum : float
        The clearance that is kept, length; below zero that much overlap is let through.
    n_pairs : int, optional
        Rows; one for each pair that is watched if not given.
    gain : float
        How fast the rest of the clearance may be lost, 1/s.
    within : float, optional
        The horizon, length; the robot's own if not given.
    safe_displacement_gain : float
        As of every barrier of Pink: the weight of its damping near contact.
    """

    def __init__(
        self,
        robot: Robot,
        minimum: float = 0.02,
        *,
        n_pairs: int | None = None,
        gain: float = 1.0,
        within: float | None = None,
        safe_displacement_gain: float = 1.0,
    ) -> None:
        self.minimum = number(minimum, "minimum")
        self._near = NearLinks(robot, self.minimum, within)
        every = len(robot.pairs)
        rows = every if n_pairs is None else whole_number(n_pairs, "n_pairs")
        if not 0 < rows <= every:
            raise StandoffError(
                f"n_pairs = {rows}: the robot watches {every} pairs.", "n_pairs", n_pairs
            )
        super().__init__(
            dim=rows,
            gain=positive(gain, "gain"),
            safe_displacement_gain=number(safe_displacement_gain, "safe_displacement_gain"),
        )

    def compute_barrier(self, configuration: Any) -> Array:
        """(dim,) proven bounds less the minimum, length."""
        return self._rows(configuration)[0]

    def compute_jacobian(self, configuration: Any) -> Array:
        """(dim, nv) derivatives of the distances by the robot's velocity."""
        return self._rows(configuration)[1]

    def compute_qp_objective(self, configuration: Any) -> tuple[Array, Array]:
        """Pink's damping, and none while no pair is within the horizon."""
        square, nv = (
            float(np.sum(self.compute_jacobian(configuration) ** 2)),
            configuration.model.nv,
        )
        weight = self.safe_displacement_gain / square if square > 0.0 else 0.0
        return weight * np.eye(nv), np.zeros(nv)

    def compute_qp_inequalities(self, configuration: Any, dt: float = 1e-3) -> tuple[Array, Array]:
        """Rows G, h with G Δq <= h, of this configuration and no other.

        Pink keeps values while q changes by less than 1e-5 of itself; here each call asks anew.
        """
        barrier, jacobian = self._rows(configuration)
        return -jacobian / dt, self.gain * barrier

    def _rows(self, configuration: Any) -> tuple[Array, Array]:
        self._near.check_model(configuration.model)
        rows = self._near.rows(configuration.q)
        order = np.argsort(rows.lower_bound, kind="stable")[: self.dim]
        far = self._near.robot.within if np.isfinite(self._near.robot.within) else 0.0
        barrier, jacobian = np.full(self.dim, far), np.zeros((self.dim, configuration.model.nv))
        barrier[: len(order)] = rows.lower_bound[order]
        jacobian[: len(order)] = rows.jacobian[order]
        return barrier - self.minimum, jacobian
