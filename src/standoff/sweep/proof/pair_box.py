"""How far the distance of a pair can change within a cell of its parameters.

Let a plane with the normal n keep the bodies apart by the bound L where the cell's middle is. Where
the parameters differ from that, the bodies are still apart along n by L less

- what the shifts take along n, |n_i| h_i each, with h the half side of the cell, and
- what turns add to each body's support along n. Seen from the body, n turns by an angle of at most
  δ. With R a bound on the distance of the core's points from the origin, about which the body
  turns, and s <= R its support along n, that is at most s cos δ + √(R² - s²) sin δ - s, or R - s
  where s >= R cos δ: no point of the core is beyond the ball, nor beyond the plane of the support.

A turn by θ about an axis at the angle α from n turns n by 2 asin(sin(θ/2) sin α). Of several turns
the angles add up: let v be n after those before, in the middle, and v' anywhere else. The turn T'
leaves the angle of T'v' and T'v as it is, and T'v differs from Tv by that of the turn at v.
The support of the witness point stands for s: it is not greater, and what is taken falls with s.

From above, the distance is at most that in the middle and all that the bodies' points can move.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.impact.moment import Box
from standoff.kernels.body import layout as L
from standoff.kernels.state import arrays as K
from standoff.motion import Pose
from standoff.sweep.parameters import SHIFTS, TURNS, Parameter
from standoff.sweep.parameters import moved as moved_poses
from standoff.sweep.proof.box import Looked, ParameterBox, Told
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.extent import farthest
from standoff.sweep.proof.tolerances import (
    CELL_ROUNDINGS,
    RANGE_ROUNDINGS,
    SQUARE_ROUNDINGS,
    UNIT_NORMAL,
)
from standoff.tracking.answers import proven
from standoff.tracking.many_distances import Distances, answered_rows

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

EPS = float(np.finfo(np.float64).eps)

TOGETHER = -1
"""Of all turns of a body together."""


class PlacedBody(NamedTuple):
    """A convex body, or a piece of one, and where it is where all parameters are zero.

    Attributes
    ----------
    name : str
        That parameters move it by.
    body : Body
    home : Pose
        In the world.
    """

    name: str
    body: Body
    home: Pose


class Mover:
    """A body, and the parameters that move it.

    Parameters
    ----------
    placed : PlacedBody
    parameters : sequence of Parameter
        Its own and others.
    """

    def __init__(self, placed: PlacedBody, parameters: Sequence[Parameter]) -> None:
        self.name, self.body, self.home_pose = placed
        own = [(k, p) for k, p in enumerate(parameters) if p.moves == self.name]
        self.shifts = [(k, SHIFTS.index(p.what)) for k, p in own if p.what in SHIFTS]
        self.turns = [(k, TURNS.index(p.what)) for k, p in own if p.what in TURNS]
        self.home = self.home_pose.rotation
        self.box = Box(self.body)
        self.radius = float(self.body.reals[L.RADIUS])
        self.far = farthest(self.body) if self.turns else 0.0

    @property
    def size(self) -> float:
        """Lengths that take part in a point's place, in all."""
        return self.far + self.radius + self.box.reach + float(np.abs(self.box.middle).sum())

    def moved(self, half: Array) -> tuple[Array, dict[int, Array]]:
        """Return how far a point of the body moves at most, and by each parameter alone."""
        alone = {k: half[:, k] for k, _ in self.shifts}
        square, angle = np.zeros(len(half)), np.zeros(len(half))
        for k, _ in self.shifts:
            square = square + half[:, k] * half[:, k]
        for k, _ in self.turns:
            alone[k] = self._chord(half[:, k])
            angle = angle + half[:, k]
        return np.sqrt(square) + self._chord(angle), alone

    def _chord(self, angle: Array) -> Array:
        chord: Array = 2.0 * self.far * np.sin(np.minimum(angle, np.pi) / 2.0)
        return chord

    def given_up(self, outward: Array, point: Array, at: Array, half: Array) -> dict[int, Array]:
        """Return what each parameter by itself takes from a bound along a normal, and what all
        turns take together.

        Parameters
        ----------
        outward : (n, 3) array
            The normal, away from the body.
        point : (n, 3) array
            Of the body's surface, from the body's origin; world axes.
        at, half : (n, columns) arrays
            Middles and half sides; of angles, rad.
        """
        taken = {k: np.abs(outward[:, axis]) * half[:, k] for k, axis in self.shifts}
        if self.turns:
            angle, alone = self.turned(outward, at, half)
            support = np.sum(outward * point, axis=1) - self.radius
            taken |= {k: self.taken(support, own) for k, own in alone.items()}
            taken[TOGETHER] = self.taken(support, angle)
        return taken

    def turned(self, normal: Array, at: Array, half: Array) -> tuple[Array, dict[int, Array]]:
        """Return by which angle n, seen from the body, turns at most, and for each turn by itself.

        Parameters
        ----------
        normal : (n, 3) array
            World.
        at, half : (n, columns) arrays
            Middles and half sides, rad.
        """
        seen = normal @ self.home
        whole, alone = np.zeros(len(at)), {}
        for k, axis in self.turns:
            left = np.maximum(0.0, 1.0 - seen[:, axis] * seen[:, axis])
            across = np.sqrt(left + SQUARE_ROUNDINGS * EPS)
            sine = np.sin(np.minimum(half[:, k], np.pi) / 2.0)
            alone[k] = 2.0 * np.arcsin(np.minimum(1.0, sine * across))
            whole = whole + alone[k]
            seen = _seen_after(seen, axis, at[:, k])
        return whole, alone

    def taken(self, support: Array, angle: Array) -> Array:
        """Return what a turn of n by an angle adds to the support at most."""
        s = np.clip(support, -self.far, self.far)
        square = np.sqrt((self.far - s) * (self.far + s))
        angle = np.minimum(angle, np.pi)
        more = s * np.cos(angle) + square * np.sin(angle) - s
        added: Array = np.where(s >= self.far * np.cos(angle), self.far - s, more)
        return added


def _seen_after(seen: Array, axis: int, angle: Array) -> Array:
    """Return directions as seen from a body that has turned about one of its axes."""
    found = seen.copy()
    j, k = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    found[:, j] = cosine * seen[:, j] + sine * seen[:, k]
    found[:, k] = cosine * seen[:, k] - sine * seen[:, j]
    return found


class PairBox(ParameterBox):
    """The parameters of two convex bodies.

    Parameters
    ----------
    pair : pair of PlacedBody
    parameters : sequence of Parameter
        Shifts and turns, of these bodies and of others.
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
        ends = np.array([abs(p.low) + abs(p.high) for p in parameters])
        self.doubt = RANGE_ROUNDINGS * EPS * ends
        self.unit = np.array([np.pi / 180.0 if p.degrees else 1.0 for p in parameters])
        lengths = [float(np.abs(pose.translation).sum()) for _, _, pose in pair]
        lengths += [float(ends[k]) for mover in self.movers for k, _ in mover.shifts]
        lengths += [mover.size for mover in self.movers]
        self.rounding = CELL_ROUNDINGS * EPS * sum(lengths)

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        return self.moved(self.half(cells))

    def look(self, cells: Cells) -> Looked:
        told, moved, asked = self.told(cells)
        return self.decided(cells, moved, told, asked)

    def told(self, cells: Cells) -> tuple[Told, Array, Whole]:
        """Return what is told of cells, by a query in the middle where no ball is enough; how far
        points move in them; and the number of queries, and of those that are not proven."""
        n = len(cells.place)
        moved, ways = self.moves(cells)
        numbers = self.numbers(cells)
        poses = tuple(
            moved_poses(mover.home_pose, mover.name, self.parameters, numbers)
            for mover in self.movers
        )
        lower = self.by_balls(poses, moved)
        told = Told(lower, np.full(n, np.inf), np.full(n, np.inf), ways.copy(), ways)
        ask = np.flatnonzero(~(lower >= self.clearance))
        doubtful = 0
        if len(ask):
            bodies = (mover.body for mover in self.movers)
            found = answered_rows(*bodies, *(x if len(x) == 1 else x[ask] for x in poses))
            own = self.bounds(cells.at(ask), found)
            own = own._replace(lower=np.maximum(lower[ask], own.lower))
            for every, some in zip(told, own, strict=True):
                every[ask] = some
            doubtful = int(np.count_nonzero(~proven(found.rows[:, K.STATUS])))
        return told, moved, np.array([len(ask), doubtful])

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

    def bounds(self, cells: Cells, found: Distances) -> Told:
        """Return what the distances in the middles of cells prove of the cells."""
        half = self.half(cells)
        whole, moved = self.moved(half)
        at = self.numbers(cells) * self.unit
        ways, taken = np.zeros(half.shape), np.full(len(half), self.rounding)
        known = np.abs(np.sum(found.normal * found.normal, axis=1) - 1.0) < UNIT_NORMAL
        for sign, mover, pose, point in zip(
            (1.0, -1.0), self.movers, found.poses, (found.point_a, found.point_b), strict=True
        ):
            given = mover.given_up(sign * found.normal, point - pose[:, :3, 3], at, half)
            together = given.pop(TOGETHER, None)
            for k, way in given.items():
                ways[:, k] = way
            for k, _ in mover.shifts:
                taken = taken + ways[:, k]
            taken = taken if together is None else taken + together
        ways[~known] = moved[~known]
        lower = found.lower_bound - np.where(known, taken, whole)
        upper = found.upper_bound + whole
        return Told(
            np.where(np.isnan(lower), -np.inf, lower),
            np.where(np.isnan(upper), np.inf, upper),
            np.where(np.isnan(found.upper_bound), np.inf, found.upper_bound),
            ways,
            moved,
        )
