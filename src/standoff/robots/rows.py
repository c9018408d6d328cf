"""The near pairs of a robot at one configuration: distances and Jacobian rows, as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.read_only import KeepsReadOnly
from standoff.robots.answer import Flag, RobotAnswer
from standoff.robots.kinematics import GeometryMotion
from standoff.robots.tolerances import TURN_LOST
from standoff.shown_names import hides
from standoff.tracking.derivatives import Smoothness
from standoff.typing import Array
from standoff.wording import counted
from standoff.world.answer import WorldAnswer
from standoff.world.pair_arrays import derived


class Mounted(NamedTuple):
    """What of a robot its rows read, in the order of the world's bodies.

    Attributes
    ----------
    links : tuple of str
    support : (n, ns) array
        1.0 where a screw moves a body.
    fold : (ns, nv) array or None
    size : float
        Of all bounded bodies together, length.
    """

    links: tuple[str, ...]
    support: Array
    fold: Array | None
    size: float


@hides("motion", "mounted", "flag")
class RobotRows(KeepsReadOnly):
    """All pairs of a robot within a horizon, nearest or not, in arrays of k rows.

    Iterating yields a `RobotAnswer` each. Rows are sorted by the numbers of their geometries.

    Attributes
    ----------
    q : (nq,) array
    answer : WorldAnswer
        Of the robot's world: all else that is known of the pairs.
    names, links : list of (str, str)
        Of the geometries A and B, and of the links that carry them.
    bodies : (k, 2) array of int
        Numbers of the geometries, as in ``robot.geoms``.
    distance, lower_bound, upper_bound : (k,) arrays
        Signed, length. Of a body that is inside a solid's material, with status CONTAINED, less
        the wall between the two boundaries: it is deeper than that, and the lower bound is the
        size of all bodies.
    point_a, point_b, normal : (k, 3) arrays
        World axes; the normal points from A to B. Moving B by -distance * normal parts the two, or
        with status CONTAINED brings it to the wall.
    jacobian : (k, nv) array
        Of the distances by the robot's velocity. A row always has numbers: where its distance has
        no derivative they are those of these witness points, and `smooth` is False.
    smooth : (k,) array of bool
        Is a row the derivative by every joint? Computed when first asked for.
    smoothness : (k,) array of Smoothness
        By the motions of the two bodies.
    status : (k,) array of Status
    certified : (k,) array of bool
    clearance : float
        A proven lower bound of the distances of *all* pairs that are watched, the far ones
        included: never more than the horizon.
    within : float
        The horizon, length.
    """

    __slots__ = ("_flags", "_jacobian", "_pairs", "answer", "motion", "mounted", "q", "within")

    def __init__(
        self, answer: WorldAnswer, q: Array, motion: GeometryMotion, mounted: Mounted, within: float
    ) -> None:
        self.answer, self.q, self.motion, self.mounted = answer, q, motion, mounted
        self.within = within
        self._pairs = answer.pairs
        self._jacobian: Array | None = None
        self._flags: dict[int, Flag] = {}
        q.flags.writeable = False

    @property
    def clearance(self) -> float:
        return self.answer.clearance

    @property
    def names(self) -> list[tuple[str, str]]:
        return self._pairs.names

    @property
    def bodies(self) -> NDArray[np.int64]:
        return self._pairs.bodies

    @property
    def links(self) -> list[tuple[str, str]]:
        every = self.mounted.links
        return [(every[i], every[j]) for i, j in self.bodies.tolist()]

    @property
    def distance(self) -> Array:
        return self._signed(self._pairs.distance)

    @property
    def lower_bound(self) -> Array:
        bounds, inside = self._pairs.lower_bound, self._pairs.inside
        return np.where(inside, -self.mounted.size, bounds) if inside.any() else bounds

    @property
    def upper_bound(self) -> Array:
        inside = self._pairs.inside
        if not inside.any():
            return self._pairs.upper_bound
        return np.where(inside, -self._pairs.lower_bound, self._pairs.upper_bound)

    def _signed(self, column: Array) -> Array:
        """Numbers (k, ...) of walls turned round, of bodies that are inside another."""
        inside = self._pairs.inside
        if not inside.any():
            return column
        signs = np.where(inside, -1.0, 1.0).reshape(-1, *(1,) * (column.ndim - 1))
        return np.asarray(signs * column)

    @property
    def point_a(self) -> Array:
        return self._pairs.point_a

    @property
    def point_b(self) -> Array:
        return self._pairs.point_b

    @property
    def normal(self) -> Array:
        return self._signed(self._pairs.normal)

    @property
    def status(self) -> NDArray[np.object_]:
        return self._pairs.status

    @property
    def certified(self) -> NDArray[np.bool_]:
        return self._pairs.certified

    @property
    def jacobian(self) -> Array:
        if self._jacobian is None:
            points = self.point_a, self.point_b
            fold = self.mounted.fold
            found = rows_by_velocity(self.normal, points, self._signs, self.motion, fold)
            found.flags.writeable = False
            self._jacobian = found
        return self._jacobian

    @property
    def _signs(self) -> Array:
        """(k, ns): 1 where a screw moves B alone, -1 where it moves A alone."""
        bodies, support = self.bodies, self.mounted.support
        return np.asarray(support[bodies[:, 1]] - support[bodies[:, 0]])

    def flag(self, k: int) -> Flag:
        """Whether row k is the derivative of its distance."""
        if k not in self._flags:
            smoothness, reason, gradient, smooth = derived(self._pairs[k])
            if smoothness is Smoothness.PARTIAL:
                # of a pair that is moved alike, its turns too are no change
                turns = self.motion.screws[3:] * self._signs[k]
                lost = np.isnan(gradient.reshape(4, 3)[1::2]).any(axis=0)
                smooth = bool(np.abs(turns[lost]).max(initial=0.0) <= TURN_LOST)
            self._flags[k] = Flag(smoothness, reason, smooth)
        return self._flags[k]

    @property
    def smooth(self) -> NDArray[np.bool_]:
        return np.array([self.flag(k).smooth for k in range(len(self))], dtype=bool)

    @property
    def smoothness(self) -> NDArray[np.object_]:
        found = np.empty(len(self), dtype=object)
        found[:] = [self.flag(k).smoothness for k in range(len(self))]
        return found

    @property
    def closest(self) -> RobotAnswer | None:
        """The nearest pair, or the deepest; None if no pair is within the horizon."""
        return self[int(np.argmin(self.distance))] if len(self) else None

    def __len__(self) -> int:
        return len(self._pairs)

    def __getitem__(self, k: int) -> RobotAnswer:
        k = range(len(self))[k]
        pair, bodies = self._pairs[k], self.bodies[k].tolist()
        links = self.mounted.links[bodies[0]], self.mounted.links[bodies[1]]
        return RobotAnswer(pair, links, self.jacobian[k], self.clearance, (self, k))

    def __iter__(self) -> Iterator[RobotAnswer]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        near = counted(len(self), "near pair")
        return f"<RobotRows: {near}, clearance {self.clearance:.6g}>"


# Rows of derivatives by a robot's velocity, of many pairs at once.


def rows_by_velocity(
    normal: Array,
    points: tuple[Array, Array],
    signs: Array,
    motion: GeometryMotion,
    fold: Array | None,
) -> Array:
    """(k, nv): the rate of each pair's distance by a unit of each velocity.

    It is the normal times the velocity of the point on B less that of the point on A. What moves
    both bodies alike drops out exactly, by its sign.

    Parameters
    ----------
    normal : (k, 3) array
        From A to B, world axes.
    points : pair of (k, 3) arrays
        Witness points on A and on B.
    signs : (k, ns) array
        1 where a screw moves B alone, -1 where it moves A alone, else 0.
    motion : GeometryMotion
    fold : (ns, nv) array or None
    """
    # the moment of the normal about the origin is the same at both points
    moment = np.cross(0.5 * (points[0] + points[1]), normal)
    rows: Array = (np.concatenate([normal, moment], axis=1) @ motion.screws) * signs
    return rows if fold is None else rows @ fold
