"""First and second derivatives of a robot's distances by the numbers of its configuration.

In the chart of a pair's derivatives, R <- exp(omega) R and p <- p + v, motion i before motion j of
a chain moves the way that j moves: with their world screws, the second derivative of the position
is omega_i x v_j, and that of the turn is omega_i x omega_j / 2 (the first term of the product of
exponentials that is not their sum). Within one motion the numbers of a quaternion, or of (cos,
sin), turn by a vector theta(q) that is not linear in them: its own second derivative comes in.

Off the unit quaternions the distance is that of the quaternion made unit, as the packages read it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from standoff.robots.configurations import made_unit
from standoff.robots.motions import Motions, motions_of
from standoff.robots.robot import Robot
from standoff.typing import Array, Ints


class Column(NamedTuple):
    """How one number of q moves what a motion carries: world screw at the world's origin."""

    motion: int
    number: int
    v: Array
    omega: Array


class Bend(NamedTuple):
    """The second derivative of a motion's turn by two columns, about its centre, world axes."""

    motion: int
    i: int
    j: int
    turn: Array
    centre: Array


class Twists:
    """How the geometries of a robot move with the numbers of q, to second order.

    Parameters
    ----------
    robot : Robot
    given : (nq,) array
        A configuration; quaternions need not be of length 1.

    Attributes
    ----------
    poses : (n, 4, 4) array
        Of the geometries.
    """

    def __init__(self, robot: Robot, given: Array) -> None:
        motions = motions_of(robot.joints)
        q = robot.kinematics.check(made_unit(robot.joints, given))
        self.poses = robot.poses(q)
        self._origins = self.poses[:, :3, 3]
        frames = motions.frames(q[None])
        turned, at = frames.rotations[0], frames.origins[0]
        columns: list[Column] = []
        self._bends: list[Bend] = []
        for k in range(motions.size):
            columns += self._columns(motions, k, given, (turned, at), len(columns))
        self._motions = np.array([c.motion for c in columns], dtype=np.int64)
        self._sums = np.zeros((len(columns), robot.nq))
        self._sums[np.arange(len(columns)), [c.number for c in columns]] = 1.0
        self._v = np.array([c.v for c in columns]).reshape(-1, 3)
        self._omega = np.array([c.omega for c in columns]).reshape(-1, 3)
        self._carried = [_chain(motions, int(j)) for j in robot.geoms.joints]

    def _columns(
        self, motions: Motions, k: int, q: Array, frames: tuple[Array, Array], first: int
    ) -> list[Column]:
        turn, at = frames[0][k], frames[1][k]
        number = int(motions.q_at[k])
        if not motions.turns[k]:
            # a shift does not turn its frame: these are its axes at rest too
            one = [motions.ratios[k] * turn @ motions.axes[k]]
            ways = turn.T if motions.q_count[k] == 3 else one
            return [Column(k, number + i, way, np.zeros(3)) for i, way in enumerate(ways)]
        given = q[number : number + int(motions.q_count[k])]
        theta, bend = _turned(motions, k, given)
        spins = theta @ turn.T
        count = len(given)
        for i in range(count):
            for j in range(count):
                if bend[i, j].any():
                    self._bends.append(Bend(k, first + i, first + j, turn @ bend[i, j], at))
        return [Column(k, number + i, np.cross(at, w), w) for i, w in enumerate(spins)]

    def of(self, pair: tuple[int, int]) -> Array:
        """(12, nq) twists (v_A, omega_A, v_B, omega_B) of a pair's geometries by q."""
        found = np.concatenate([np.vstack(self._of_one(k, self._origins[k])) for k in pair])
        return self._folded(found)

    def hessian(self, pair: tuple[int, int], answer: Any) -> Array:
        """(nq, nq) second derivatives of a pair's distance; nan if they are not defined."""
        derived = answer.derivatives()
        each = [self._of_one(k, self._origins[k]) for k in pair]
        twists = np.concatenate([np.vstack(one) for one in each])
        found = twists.T @ derived.hessian @ twists
        before = self._motions[:, None] < self._motions[None]
        for side, (v, omega) in enumerate(each):
            by_place, by_turn = derived.gradient[6 * side : 6 * side + 6].reshape(2, 3)
            place = np.cross(omega.T[:, None], v.T[None]) @ by_place
            turn = 0.5 * np.cross(omega.T[:, None], omega.T[None]) @ by_turn
            same = self._motions[:, None] == self._motions[None]
            found += np.where(before, place, np.where(same, 0.5 * (place + place.T), place.T))
            found += np.where(before, turn, np.where(same, 0.0, turn.T))
            origin = self._origins[pair[side]]
            for bend in self._bends:
                if bend.motion in self._carried[pair[side]]:
                    shift = np.cross(bend.turn, origin - bend.centre)
                    found[bend.i, bend.j] += shift @ by_place + bend.turn @ by_turn
        return self._folded(self._folded(found).T)

    def _of_one(self, k: int, origin: Array) -> tuple[Array, Array]:
        """(3, n) velocities at a point that geometry k carries, and (3, n) angular ones."""
        carried = np.isin(self._motions, self._carried[k])[:, None]
        v = (self._v + np.cross(self._omega, origin)) * carried
        return v.T, (self._omega * carried).T

    def _folded(self, columns: Array) -> Array:
        """Sums of the columns of one number, (..., nq)."""
        found: Array = columns @ self._sums
        return found


def _cross(w: Array) -> Array:
    """The matrix of w x."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def _chain(motions: Motions, joint: int) -> Ints:
    """The motions that carry a joint's frame."""
    found, k = [], int(motions.links[joint]) if joint >= 0 else -1
    while k >= 0:
        found.append(k)
        k = int(motions.parents[k])
    return np.array(found, dtype=np.int64)


def _turned(motions: Motions, k: int, given: Array) -> tuple[Array, Array]:
    """First (n, 3) and second (n, n, 3) derivatives of the turn by its numbers, in the axes that
    it carries: theta of R exp(theta)."""
    n = len(given)
    axis = motions.ratios[k] * motions.axes[k]
    if n == 1:
        return axis[None], np.zeros((1, 1, 3))
    square = float(given @ given)
    if n == 2:
        c, s = given
        slope = np.array([-s, c]) / square
        curve = np.array([[2.0 * c * s, s * s - c * c], [s * s - c * c, -2.0 * c * s]])
        return slope[:, None] * axis, (curve / square**2)[..., None] * axis
    q = given if motions.scalar_first else np.roll(given, 1)
    # dq = q (s, w): a turn by 2 w / (1 + s), to second order 2 w - 2 s w
    s = q / square
    w = np.column_stack([-q[1:], q[0] * np.eye(3) - _cross(q[1:])]).T / square
    bend = -2.0 * (s[:, None, None] * w[None] + w[:, None] * s[None, :, None])
    theta = 2.0 * w
    if not motions.scalar_first:
        theta, bend = np.roll(theta, -1, 0), np.roll(bend, (-1, -1), (0, 1))
    return theta, bend
