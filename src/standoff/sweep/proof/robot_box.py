"""The box of a robot's joints: every pair that it watches, in every cell.

How far the pieces of a pair move against each other is bounded as `Robot.certify_box` does it
(docs/certify.md); a cell is proven where all pairs are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.robots.limits import check_limits
from standoff.robots.motions import Frames
from standoff.robots.sight import Apart, Middle, Sight, closing, gains, some_of
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof.box import Looked, ParameterBox, Told
from standoff.sweep.proof.cells import Cells
from standoff.sweep.subjects.robot import RobotSubject
from standoff.typing import Array, Bools, Ints

SEEN_TOGETHER = 8192
"""Pairs in cells whose bounding boxes are seen at once: some 10 MB."""


class RobotBox(ParameterBox):
    """The joints of a robot.

    Raises StandoffError: a range that is outside a joint's limits.

    Parameters
    ----------
    subject : RobotSubject
    parameters : sequence of Parameter
        Joints of one number.
    clearance : float
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
        whole = self.ways(self.whole)[0]
        self.doubt = self.sight.roundoff(corners[1], whole)

    def ways(self, cells: Cells) -> Array:
        """Return how far each motion goes in cells (n, nm + 1); the last is the world's, 0."""
        motions = self.sight.watched.motions
        half = cells.halves * self.width * self.unit
        found = np.zeros((len(half), motions.size + 1))
        moved = np.flatnonzero(self.columns >= 0)
        found[:, moved] = np.abs(motions.ratios[moved]) * half[:, self.columns[moved]]
        return found

    @property
    def pairs(self) -> int:
        return self.sight.pairs

    def _seen(self, cells: Cells) -> tuple[Array, Frames, Ints, Ints, Middle]:
        """Configurations in the middles with their frames; of each pair that is left in a cell, the
        cell, the pair, and how far it can move."""
        q = self.subject.configurations(self.parameters, self.numbers(cells))
        frames = self.sight.frames(q)
        at, pairs = np.nonzero(cells.known < self.clearance)
        return q, frames, at, pairs, self.sight.middle(pairs, frames, at, self.ways(cells)[at])

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        n = len(cells.place)
        _, frames, at, pairs, middle = self._seen(cells)
        whole, ways = np.zeros(n), np.zeros((n, len(self.parameters)))
        np.maximum.at(whole, at, middle.way)
        np.maximum.at(ways, at, self._gains(middle, self.sight.by_boxes(pairs, frames, at, middle)))
        return whole, ways

    def look(self, cells: Cells) -> Looked:
        n = len(cells.place)
        q, frames, at, pairs, middle = self._seen(cells)
        boxed = self.sight.by_boxes(pairs, frames, at, middle)
        bound = boxed.lower - closing(middle, boxed)
        upper, distance = np.full(n, np.inf), np.full(n, np.inf)
        worth = self._worth(pairs, middle, boxed, bound)
        ask, apart = self._asked(worth, pairs, q, frames, at, boxed)
        some = some_of(middle, ask)
        bound[ask] = np.maximum(bound[ask], apart.lower - closing(some, apart))
        bound -= self.doubt
        best = boxed._replace(normals=boxed.normals.copy(), along=boxed.along.copy())
        best.normals[ask], best.along[ask] = apart.normals, apart.along
        np.minimum.at(distance, at[ask], apart.upper + self.doubt)
        np.minimum.at(upper, at[ask], apart.upper + some.way + self.doubt)
        known, moved = cells.known.copy(), np.zeros(n)
        known[at, pairs] = np.maximum(known[at, pairs], bound)
        lower = known.min(axis=1)
        open_ = known[at, pairs] < self.clearance
        np.maximum.at(moved, at[open_], middle.way[open_])
        ways = np.zeros((n, len(self.parameters)))
        # along what gives back most of the pair that stands in the way most
        worst = np.flatnonzero(open_ & (known[at, pairs] == lower[at]))
        ways[at[worst]] = self._gains(some_of(middle, worst), Apart._make(x[worst] for x in best))
        # and where the middle is too near, of the pair that is nearest there
        steps = ways.copy()
        nearest = np.flatnonzero(apart.upper + self.doubt == distance[at[ask]])
        steps[at[ask[nearest]]] = self._gains(some_of(some, nearest), None)
        told = Told(lower, upper, distance, ways, steps)
        uncertified = int(np.count_nonzero(~np.isfinite(apart.lower)))
        asked = np.array([len(ask), uncertified])
        return self.decided(cells, moved, told, asked)._replace(known=known)

    def _asked(
        self, worth: Bools, pairs: Ints, q: Array, frames: Frames, at: Ints, boxed: Apart
    ) -> tuple[Ints, Apart]:
        """Which pairs are asked, and what they answer: those that are worth it, and in a cell whose
        middle is too near, all that may be nearer still."""
        ask = np.flatnonzero(worth)
        apart = self.sight.ask(pairs[ask], q, frames, at[ask])
        nearest = np.full(len(q), np.inf)
        np.minimum.at(nearest, at[ask], apart.upper + self.doubt)
        near = nearest[at]
        more = np.flatnonzero(~worth & (near < self.clearance) & (boxed.lower < near))
        if not len(more):
            return ask, apart
        rest = self.sight.ask(pairs[more], q, frames, at[more])
        both = (np.concatenate(each) for each in zip(apart, rest, strict=True))
        return np.concatenate([ask, more]), Apart._make(both)

    def _worth(self, pairs: Ints, middle: Middle, boxed: Apart, bound: Array) -> Bools:
        """Is a pair asked? Not where its boxes prove it, nor where a query would hardly prove
        anything: as far as can be seen the middle is too near for that, and surely too far for a
        violation of the whole cell."""
        watched = self.sight.watched
        a, b = watched.a[pairs], watched.b[pairs]
        between = middle.seen[1].centres - middle.seen[0].centres
        flat = watched.cores.planes[a] | watched.cores.planes[b]
        apart = np.where(
            flat,
            np.einsum("ki,ki->k", boxed.normals, between),
            np.sqrt(np.einsum("ki,ki->k", between, between)),
        )
        for piece in (a, b):
            apart -= watched.cores.radius[piece] + watched.cores.half[piece].min(axis=1)
        taken = boxed.lower - bound
        hopeless = (apart - taken < self.clearance) & (boxed.lower + middle.way >= self.clearance)
        found: Bools = (bound - self.clearance < self.doubt) & ~hopeless
        return found

    def _gains(self, middle: Middle, apart: Apart | None) -> Array:
        """What halving each parameter gives back of what its pairs can move (k, columns)."""
        chain = middle.reaches.chain
        numbers = np.where(chain >= 0, np.append(self.columns, -1)[chain], -1)
        return gains(middle, apart, numbers, len(self.parameters))
