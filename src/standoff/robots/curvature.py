"""Second derivatives of a robot's distances by its joints.

In the chart of a pair's derivatives, R <- exp(omega) R and p <- p + v, joint i before joint j of a
chain moves the way that j moves: with their world screws, the second derivative of the position is
omega_i x v_j, and that of the turn is omega_i x omega_j / 2 (the first term of the product of
exponentials that is not their sum).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.robots.robot import Robot

Array = NDArray[np.float64]


class Twists:
    """How the geometries of a robot move with its joints at q, to second order."""

    def __init__(self, robot: Robot, q: Array) -> None:
        motion = robot.kinematics.motion(q)
        self._origins, self._fold = robot.poses(q)[:, :3, 3], robot.kinematics.fold
        self._screws = motion.screws
        self._support = np.zeros((len(robot.geoms.names), motion.screws.shape[1]))
        self._support[robot.geoms.moving] = robot.kinematics.support

    def of(self, pair: tuple[int, int]) -> Array:
        """(12, nv) twists (v_A, omega_A, v_B, omega_B) of a pair's geometries by the velocity."""
        return self._folded(np.concatenate([self._of_one(k) for k in pair]))

    def hessian(self, pair: tuple[int, int], answer: Any) -> Array:
        """(nv, nv) second derivatives of a pair's distance; nan if they are not defined."""
        derived = answer.derivatives()
        each = [self._of_one(k) for k in pair]
        twists = np.concatenate(each)
        found = twists.T @ derived.hessian @ twists
        for side, moved in enumerate(each):
            by_place, by_turn = derived.gradient[6 * side : 6 * side + 6].reshape(2, 3)
            turns = moved[3:].T
            # entry (i, j) is that of joint i before joint j; the other half mirrors it
            place = np.cross(turns[:, None], moved[:3].T[None]) @ by_place
            turn = 0.5 * np.cross(turns[:, None], turns[None]) @ by_turn
            upper = np.triu(place) + np.triu(turn, 1)
            found += upper + np.triu(upper, 1).T
        folded: Array = found if self._fold is None else self._fold.T @ found @ self._fold
        return folded

    def _of_one(self, k: int) -> Array:
        """(6, ns) twists of geometry k at its origin."""
        v, omega = self._screws[:3], self._screws[3:]
        at_origin = v + np.cross(omega.T, self._origins[k]).T
        moved: Array = np.concatenate([at_origin, omega]) * self._support[k]
        return moved

    def _folded(self, twists: Array) -> Array:
        return twists if self._fold is None else twists @ self._fold
