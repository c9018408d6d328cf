"""A robot's joints taken apart into single motions, and where these are at many configurations.

A hinge is a turn about an axis, a slide a shift along one, a ball a turn about a point, a free
joint a shift anywhere and then a turn about a point. These are used for *bounds*; the poses that
distances are taken at are the package's own.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.robots.joints import JointKind, Joints
from standoff.typing import Array, Ints

WORLD = -1
"""The frame of the world among those of the motions: the last one."""


class LinkFrames(NamedTuple):
    """World poses of the frames that the motions carry, at m configurations; the last is the world.

    Attributes
    ----------
    rotations : (m, n + 1, 3, 3) array
    origins : (m, n + 1, 3) array
    """

    rotations: Array
    origins: Array


class Motions(NamedTuple):
    """n single motions; one comes before those that it carries.

    Attributes
    ----------
    turns : (n,) array of bool
        A turn, not a shift.
    axes : (n, 3) array
        Of unit length, in the frame that the motion carries; 0 where it has none of its own.
    parents : (n,) array of int
        The motion that carries it; -1 for the world.
    placements : (n, 4, 4) array
        Of its frame at rest in that of its parent.
    joints : (n,) array of int
        The joint that it is of.
    q_at, q_count : (n,) arrays of int
        Its first number in a configuration, and how many: a turn by (cos, sin) has two.
    v_at, v_count : (n,) arrays of int
        Its first number in a velocity, and how many: it is as fast as these are long.
    ratios, offsets : (n,) arrays
        It is at ``ratio q + offset``: not 1 and 0 where a joint mimics another.
    links : (nj,) array of int
        Of each joint the last of its motions, or what it is fixed to.
    ends : (nj, 4, 4) array
        Of each joint's moved frame in that motion's.
    scalar_first : bool
        Are quaternions (w, x, y, z)?
    """

    turns: NDArray[np.bool_]
    axes: Array
    parents: Ints
    placements: Array
    joints: Ints
    q_at: Ints
    q_count: Ints
    v_at: Ints
    v_count: Ints
    ratios: Array
    offsets: Array
    links: Ints
    ends: Array
    scalar_first: bool

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.turns)

    def rates(self, velocities: Array) -> Array:
        """(m, n + 1): sizes of the motions at joint velocities (m, nv); 0 for the world's frame."""
        found = np.zeros((len(velocities), self.size + 1))
        single = np.flatnonzero(self.v_count == 1)
        found[:, single] = np.abs(self.ratios[single] * velocities[:, self.v_at[single]])
        for k in np.flatnonzero(self.v_count > 1).tolist():
            found[:, k] = _lengths(velocities[:, self.v_at[k] : self.v_at[k] + self.v_count[k]])
        return found

    def least_ways(self, q: Array, velocities: Array) -> Array:
        """(m, n): how far each motion is from one of m + 1 configurations to the next at least,
        whatever way it takes; ``velocities`` (m, nv) are the package's differences of them."""
        found = self.rates(velocities)[:, : self.size]
        for k in np.flatnonzero(~self.turns & (self.v_count > 1)).tolist():
            # a velocity in axes that turn is of a way that is no line
            part = slice(self.q_at[k], self.q_at[k] + self.q_count[k])
            found[:, k] = _lengths(np.diff(q[:, part], axis=0))
        return found

    def swerves(self, rates: Array) -> Array:
        """(m, n + 1): accelerations at constant joint velocities: of the shifts of a free or planar
        joint, whose velocity may be given in the axes that turn with it."""
        found = np.zeros_like(rates)
        for k in np.flatnonzero(~self.turns & (self.v_count > 1)).tolist():
            (turn,) = np.flatnonzero(self.turns & (self.v_at == self.v_at[k] + self.v_count[k]))
            found[:, k] = rates[:, k] * rates[:, turn]
        return found

    def frames(self, q: Array) -> LinkFrames:
        """Where the motions' frames are at configurations (m, nq)."""
        m, n = len(q), self.size
        rotations, origins = np.zeros((m, n + 1, 3, 3)), np.zeros((m, n + 1, 3))
        rotations[:, WORLD] = np.eye(3)
        for k in range(n):
            before, placed = rotations[:, self.parents[k]], self.placements[k]
            origins[:, k] = origins[:, self.parents[k]] + before @ placed[:3, 3]
            here = before @ placed[:3, :3]
            given = q[:, self.q_at[k] : self.q_at[k] + self.q_count[k]]
            if self.turns[k]:
                rotations[:, k] = here @ self._turn(k, given)
                continue
            rotations[:, k] = here
            if self.q_count[k] == 3:
                origins[:, k] += np.einsum("mij,mj->mi", here, given)
            else:
                origins[:, k] += (here @ self.axes[k]) * self._position(k, given)[:, None]
        return LinkFrames(rotations, origins)

    def _position(self, k: int, given: Array) -> Array:
        found: Array = self.ratios[k] * given[:, 0] + self.offsets[k]
        return found

    def _turn(self, k: int, given: Array) -> Array:
        if self.q_count[k] == 4:
            return _of_quaternions(given if self.scalar_first else np.roll(given, 1, axis=1))
        if self.q_count[k] == 2:
            given = np.arctan2(given[:, 1], given[:, 0])[:, None]
        angles = self._position(k, given)
        return _about(self.axes[k], np.cos(angles), np.sin(angles))


def motions_of(joints: Joints) -> Motions:
    """The motions of a robot's joints."""
    rows: list[tuple[Any, ...]] = []
    links: list[int] = []
    ends: list[Array] = []
    for j, number in enumerate(joints.kinds.tolist()):
        kind, carrier = JointKind(number), int(joints.parents[j])
        parent, placement = WORLD, np.asarray(joints.placements[j], dtype=float)
        if carrier >= 0:
            parent, placement = links[carrier], ends[carrier] @ placement
        q_at, v_at = int(joints.q_at[j]), int(joints.v_at[j])
        for turn, q_count, v_count in _PARTS[kind]:
            along = kind not in (JointKind.BALL, JointKind.FREE)
            ratio, offset = (joints.ratios[j], joints.offsets[j]) if along else (1.0, 0.0)
            axis = joints.axes[j] if along else np.zeros(3)
            numbers = q_at, q_count, v_at, v_count
            rows.append((turn, axis, parent, placement, j, *numbers, ratio, offset))
            parent, placement = len(rows) - 1, np.eye(4)
            q_at, v_at = q_at + q_count, v_at + v_count
        links.append(parent)
        ends.append(placement)
    whole = np.array([[row[0], row[2], *row[4:9]] for row in rows], dtype=np.int64).reshape(-1, 7)
    turns, parents, of, q_at_, q_count_, v_at_, v_count_ = whole.T.copy()
    ratios = np.array([row[9:] for row in rows], dtype=float).reshape(-1, 2)
    return Motions(
        turns=turns.astype(bool),
        axes=np.array([row[1] for row in rows], dtype=float).reshape(-1, 3),
        parents=parents,
        placements=np.array([row[3] for row in rows], dtype=float).reshape(-1, 4, 4),
        joints=of,
        q_at=q_at_,
        q_count=q_count_,
        v_at=v_at_,
        v_count=v_count_,
        ratios=ratios[:, 0],
        offsets=ratios[:, 1],
        links=np.array(links, dtype=np.int64),
        ends=np.array(ends, dtype=float).reshape(-1, 4, 4),
        scalar_first=joints.scalar_first,
    )


_PARTS = {
    JointKind.FIXED: (),
    JointKind.HINGE: ((True, 1, 1),),
    JointKind.SLIDE: ((False, 1, 1),),
    JointKind.BALL: ((True, 4, 3),),
    JointKind.FREE: ((False, 3, 3), (True, 4, 3)),
    JointKind.CONTINUOUS: ((True, 2, 1),),
    JointKind.GLIDE: ((False, 1, 2),),
}
"""The motions of each kind of joint: is it a turn, and how many numbers of q and of v it has."""


def _lengths(vectors: Array) -> Array:
    found: Array = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return found


def _about(axis: Array, cosines: Array, sines: Array) -> Array:
    """(m, 3, 3): turns about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    c, s = cosines[:, None, None], sines[:, None, None]
    found: Array = c * np.eye(3) + s * cross + (1.0 - c) * np.outer(axis, axis)
    return found


def _of_quaternions(q: Array) -> Array:
    """(m, 3, 3): turns of quaternions (m, 4), w first, of any length."""
    w, x, y, z = (q / _lengths(q)[:, None]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
