"""How far the distance of a pair can change within a cell of its parameters.

Let a plane with the normal n keep the bodies apart by the bound L where the cell's middle is. Where
the parameters differ from that, the bodies are still apart along n by L less

- what the shifts take along n, |n_i| h_i each, with h the half side of the cell, and
- what turns add to each body's support along n (`mover`).

From above, the distance is at most that in the middle and all that the bodies' points can move.

Parameters of a body's shape nest the bodies (`nesting`). So the bodies of a cell are all within
those of one of its corners, the largest, and hold those of the opposite one. The query is of the
largest bodies, at the pose in the middle: its plane keeps the smaller ones apart as well, so that
the bound above, with the largest bodies' supports, holds for all bodies of the cell. The row that
is asked is a row of the sweep: where it is nearer than the clearance, it is told as a
counterexample. From above, the distance is at most that of the smallest bodies at the same pose,
which takes another query, and what points can move. The ends of a cell are numbers as they are
computed, the same for the cells on both sides, and so leave nothing out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.kernels.state import arrays as K
from standoff.sweep.parameters import Parameter, in_ranges
from standoff.sweep.parameters import moved as moved_poses
from standoff.sweep.proof.box import CellFindings, ParameterBox, QueryFindings
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.mover import EPS, TOGETHER, Mover, PlacedBody
from standoff.sweep.proof.tolerances import (
    CELL_ROUNDINGS,
    RANGE_ROUNDINGS,
    UNIT_NORMAL,
)
from standoff.sweep.subjects.shaped_body import answered_shapes, some_poses
from standoff.tracking.answers import AnswerArrays, proven
from standoff.tracking.distance_arrays import Distances
from standoff.tracking.many_distances import fit_poses
from standoff.typing import Array, Ints


class RowAnswers(AnswerArrays):
    """The answers of some rows, each of its own bodies.

    Attributes
    ----------
    rows : (n, N_OUT) array
        As the kernels write them.
    radii : pair of (n,) arrays
        Of the balls swept over the bodies' cores.
    poses : pair of (n, 4, 4) arrays, or (1, 4, 4)
        World.
    """

    __slots__ = ("poses", "radii", "rows")

    def __init__(self, rows: Array, radii: tuple[Array, Array], poses: tuple[Array, Array]) -> None:
        self.rows, self.radii, self.poses = rows, radii, poses

    @property
    def _numbers(self) -> Array:
        return self.rows

    @property
    def counts(self) -> Ints:
        """How many they are, and how many of them are not proven."""
        doubtful = int(np.count_nonzero(~proven(self.rows[:, K.STATUS])))
        return np.array([len(self.rows), doubtful])


class PairBox(ParameterBox):
    """The parameters of two convex bodies.

    Raises StandoffError: parameters of a shape of which the bodies do not nest.

    Parameters
    ----------
    pair : pair of PlacedBody
    parameters : sequence of Parameter
        Shifts, turns and numbers of shapes, of these bodies and of others.
    clearance : float
    """

    block = 8192
    """Their poses and answers, some 5 MB, stay near the processor."""

    def __init__(
        self,
        pair: tuple[PlacedBody, PlacedBody],
        parameters: Sequence[Parameter],
        clearance: float,
    ) -> None:
        super().__init__(parameters, clearance)
        self.movers = Mover(pair[0], parameters), Mover(pair[1], parameters)
        self.shaped = pair[0].shaped, pair[1].shaped
        self.senses, self.rates = np.zeros(len(self.width)), np.zeros(len(self.width))
        for mover in self.movers:
            if mover.growth is not None:
                self.senses[mover.growth.columns] = mover.growth.senses
                self.rates[mover.growth.columns] = mover.growth.most
        ends = np.array([abs(p.low) + abs(p.high) for p in parameters])
        self.doubt = RANGE_ROUNDINGS * EPS * ends
        self.unit = np.array([np.pi / 180.0 if p.degrees else 1.0 for p in parameters])
        lengths = [float(np.abs(pose.translation).sum()) for _, _, pose, _ in pair]
        lengths += [float(ends[k]) for mover in self.movers for k, _ in mover.shifts]
        lengths += [mover.size for mover in self.movers]
        self.rounding = CELL_ROUNDINGS * EPS * sum(lengths)

    def numbers(self, cells: Cells) -> Array:
        """Return the rows (n, columns) that are asked: in the middles, with the largest bodies."""
        return in_ranges(self.parameters, cells.middles + self.senses * cells.halves)

    def smallest(self, cells: Cells) -> Array:
        """Return the rows (n, columns) in the middles, with the smallest bodies."""
        return in_ranges(self.parameters, cells.middles - self.senses * cells.halves)

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        half = self.half(cells)
        whole, ways = self.moved(half)
        grown = half * self.rates
        return whole + grown.sum(axis=1), ways + grown

    def look(self, cells: Cells) -> CellFindings:
        told, moved, asked = self.told(cells)
        return self.decided(cells, moved, told, asked)

    def told(self, cells: Cells) -> tuple[QueryFindings, Array, Ints]:
        """Return what is told of cells, by a query in the middle where no ball is enough; how far
        points move in them; and the number of queries, and of those that are not proven."""
        n = len(cells.place)
        moved, ways = self.moves(cells)
        numbers = self.numbers(cells)
        poses = self.poses(numbers)
        lower = self.by_balls(poses, self.moved(self.half(cells))[0])
        told = QueryFindings(lower, np.full(n, np.inf), np.full(n, np.inf), ways.copy(), ways)
        ask = np.flatnonzero(~(lower >= self.clearance))
        asked = np.zeros(2, dtype=np.int64)
        if len(ask):
            some = cells.at(ask)
            found = self.answered(numbers[ask], some_poses(poses, ask))
            own, more = self.bounds(some, found), np.zeros(2, dtype=np.int64)
            if self.senses.any():
                own, more = self.by_smallest(some, found, own)
            own = own._replace(lower=np.maximum(lower[ask], own.lower))
            for every, few in zip(told, own, strict=True):
                every[ask] = few
            asked = found.counts + more
        return told, moved, asked

    def poses(self, numbers: Array) -> tuple[Array, Array]:
        """Return the world poses of both bodies, (n, 4, 4) each, or (1, 4, 4) of one that stays."""
        a, b = (
            moved_poses(mover.home_pose, mover.name, self.parameters, numbers)
            for mover in self.movers
        )
        return a, b

    def answered(self, numbers: Array, poses: tuple[Array, Array]) -> RowAnswers:
        """Return the answers of rows, each with its own bodies."""
        own = self.movers[0].body, self.movers[1].body
        poses = fit_poses(*own, poses)
        return RowAnswers(*answered_shapes(own, self.shaped, numbers, poses, None), poses)

    def by_smallest(
        self, cells: Cells, found: RowAnswers, told: QueryFindings
    ) -> tuple[QueryFindings, Ints]:
        """Return what is told with bounds from above that hold for all shapes in the cells; and the
        number of queries, and of those that are not proven."""
        whole, _ = self.moved(self.half(cells))
        upper = np.full(len(whole), np.inf)
        # no smaller bodies are nearer than those that were asked
        ask = np.flatnonzero(found.lower_bound + whole < self.clearance)
        if not len(ask):
            return told._replace(upper=upper), np.zeros(2, dtype=np.int64)
        small = self.answered(self.smallest(cells.at(ask)), some_poses(found.poses, ask))
        bound = small.upper_bound + whole[ask]
        upper[ask] = np.where(np.isnan(bound), np.inf, bound)
        return told._replace(upper=upper), small.counts

    def half(self, cells: Cells) -> Array:
        """Return half sides (n, columns), of angles in rad, with what rounding may add."""
        half: Array = (cells.halves * self.width + self.doubt) * self.unit
        return half

    def moved(self, half: Array) -> tuple[Array, Array]:
        """Return how far the bodies' points move at most against each other, and by each parameter
        alone (n, columns)."""
        whole, ways = np.zeros(len(half)), np.zeros(half.shape)
        for mover in self.movers:
            together, alone = mover.moved(half)
            whole = whole + together
            for k, way in alone.items():
                ways[:, k] = way
        return whole + self.rounding, ways

    def by_balls(self, poses: Sequence[Array], moved: Array) -> Array:
        """Return lower bounds of the distances that need no query."""
        centres = [
            np.sum(pose[:, :3, :3] * mover.box.middle, axis=2) + pose[:, :3, 3]
            for pose, mover in zip(poses, self.movers, strict=True)
        ]
        if any(mover.box.plane for mover in self.movers):
            return np.full(len(moved), -np.inf)
        between = centres[1] - centres[0]
        apart: Array = np.sqrt(np.sum(between * between, axis=1)) - moved
        return apart - sum(mover.box.reach + mover.radius for mover in self.movers)

    def bounds(self, cells: Cells, found: Distances | RowAnswers) -> QueryFindings:
        """Return what the distances in the middles of cells prove of the cells; where shapes
        change, `upper` is of the bodies that were asked."""
        half = self.half(cells)
        whole, moved = self.moved(half)
        at = self.numbers(cells) * self.unit
        ways, taken = np.zeros(half.shape), np.full(len(half), self.rounding)
        known = np.abs(np.sum(found.normal * found.normal, axis=1) - 1.0) < UNIT_NORMAL
        points, radii = (found.point_a, found.point_b), getattr(found, "radii", (None, None))
        for side, (mover, pose) in enumerate(zip(self.movers, found.poses, strict=True)):
            outward = -found.normal if side else found.normal
            given = mover.given_up(outward, points[side] - pose[:, :3, 3], at, half, radii[side])
            if mover.growth is not None:
                seen = np.matmul(outward[:, None, :], pose[:, :3, :3])[:, 0]
                rates = mover.growth.along(np.where(known[:, None], seen, 0.0))
                rates = np.where(known[:, None], rates, mover.growth.most)
                own = mover.growth.columns
                ways[:, own] = moved[:, own] = half[:, own] * rates
            together = given.pop(TOGETHER, None)
            for k, way in given.items():
                ways[:, k] = way
            for k, _ in mover.shifts:
                taken = taken + ways[:, k]
            taken = taken if together is None else taken + together
        ways[~known] = moved[~known]
        lower = found.lower_bound - np.where(known, taken, whole)
        upper = found.upper_bound + whole
        return QueryFindings(
            np.where(np.isnan(lower), -np.inf, lower),
            np.where(np.isnan(upper), np.inf, upper),
            np.where(np.isnan(found.upper_bound), np.inf, found.upper_bound),
            ways,
            moved,
        )
