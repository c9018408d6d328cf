"""The box of a robot's joints: every pair that it watches, in every cell.

How far the pieces of a pair move against each other is bounded as `Robot.certify_box` does it
(docs/certify.md); a cell is proven where all pairs are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from standoff.robots.limits import check_limits
from standoff.robots.motion_bounds import Reaches
from standoff.robots.sight import Middle, Sight, closing, some_of
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof.box import Looked, ParameterBox, Told
from standoff.sweep.proof.cells import Cells
from standoff.sweep.subjects.robot import RobotSubject

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

SEEN_TOGETHER = 8192
"""Pairs in cells whose bounding boxes are seen at once: some 10 MB."""


class RobotBox(ParameterBox):
    """The joints of a robot.

    Parameters
    ----------
    subject : RobotSubject
    parameters : sequence of Parameter
        Joints of one number.
    clearance : float

    Raises
    ------
    StandoffError
        A range that is outside a joint's limits.
    """

    def __init__(
        self, subject: RobotSubject, parameters: Sequence[Parameter], clearance: float
    ) -> None:
        super().__init__(parameters, clearance)
        self.subject, self.sight = subject, Sight(subject.robot)
        self.unit = np.array([np.pi / 180.0 if p.degrees else 1.0 for p in parameters])
        self.block = max(1, SEEN_TOGETHER // max(1, self.sight.pairs))
        motions, joints = self.sight.watched.motions, subject.robot.joints
        at = [int(joints.q_at[joints.names.index(p.moves)]) for p in parameters]
        self.columns = np.array([at.index(q) if q in at else -1 for q in motions.q_at.tolist()])
        ends = np.array([[p.low for p in parameters], [p.high for p in parameters]])
        corners = subject.configurations(parameters, np.stack([ends[0], ends.mean(0), ends[1]]))
        check_limits(subject.robot, corners, "parameters")
        whole = self.ways(np.full((1, len(parameters)), 0.5))[0]
        self.doubt = self.sight.roundoff(corners[1], whole)

    def ways(self, halves: Array) -> Array:
        """Return how far each motion goes in cells (n, nm + 1); the last is the world's, 0."""
        motions = self.sight.watched.motions
        half, found = halves * self.width * self.unit, np.zeros((len(halves), motions.size + 1))
        moved = np.flatnonzero(self.columns >= 0)
        found[:, moved] = np.abs(motions.ratios[moved]) * half[:, self.columns[moved]]
        return found

    def _middles(self, cells: Cells) -> tuple[Array, Whole, Whole, Middle, object]:
        n, pairs = len(cells.place), self.sight.pairs
        q = self.subject.configurations(self.parameters, self.numbers(cells))
        frames = self.sight.frames(q)
        at, every = np.repeat(np.arange(n), pairs), np.tile(np.arange(pairs), n)
        middle = self.sight.middle(every, frames, at, self.ways(cells.halves)[at])
        return q, at, every, middle, frames

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        n = len(cells.place)
        _, _, _, middle, _ = self._middles(cells)
        by_column = self._by_column(middle.reaches).reshape(n, -1, len(self.parameters))
        return middle.way.reshape(n, -1).max(axis=1), by_column.max(axis=1)

    def look(self, cells: Cells) -> Looked:
        n, pairs = len(cells.place), self.sight.pairs
        q, at, every, middle, frames = self._middles(cells)
        boxed = self.sight.by_boxes(every, frames, at, middle)
        bound = boxed.lower - closing(middle, boxed)
        upper, distance = np.full(len(at), np.inf), np.full(len(at), np.inf)
        ask = np.flatnonzero(bound - self.clearance < self.doubt)
        uncertified = 0
        if len(ask):
            apart = self.sight.ask(every[ask], q, frames, at[ask])
            some = some_of(middle, ask)
            bound[ask] = np.maximum(bound[ask], apart.lower - closing(some, apart))
            distance[ask] = apart.upper + self.doubt
            upper[ask] = distance[ask] + some.way
            uncertified = int(np.count_nonzero(~np.isfinite(apart.lower)))
        bound -= self.doubt
        worst = np.arange(n) * pairs + bound.reshape(n, pairs).argmin(axis=1)
        by_column = self._by_column(_of(middle.reaches, worst))
        open_ = (bound < self.clearance).reshape(n, pairs)
        moved = np.where(open_, middle.way.reshape(n, pairs), 0.0).max(axis=1)
        told = Told(
            bound[worst],
            upper.reshape(n, pairs).min(axis=1),
            distance.reshape(n, pairs).min(axis=1),
            by_column,
            by_column.copy(),
        )
        return self.decided(cells, moved, told, np.array([len(ask), uncertified]))

    def _by_column(self, reaches: Reaches) -> Array:
        """How far each parameter moves the two pieces of a pair against each other (k, columns)."""
        ways = reaches.h * np.minimum(reaches.r_a, reaches.r_b)
        found = np.zeros((len(ways), len(self.parameters)))
        columns = np.append(self.columns, -1)[reaches.chain]
        for k in range(len(self.parameters)):
            found[:, k] = np.where((columns == k) & (reaches.chain >= 0), ways, 0.0).sum(axis=1)
        return found


def _of(reaches: Reaches, which: Whole) -> Reaches:
    return Reaches(*(x[which] for x in reaches))
