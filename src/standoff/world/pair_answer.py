"""The answer of one pair of a world's bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.tracking.proximity import Proximity
from standoff.tracking.status import Status
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.tracking.derivatives import Derivatives


class PairAnswer(Proximity):
    """Witness points of two bodies of a world: a `Proximity` of the nearest pieces, with names.

    Of a pair beyond the horizon, with status FAR, only ``lower_bound`` is known: ``distance`` and
    ``upper_bound`` are inf, points and normal are nan, and there are no features. Of two bodies of
    several pieces in penetration, ``depth`` is the least translation that frees the deepest pair of
    pieces, with its bounds; another pair may then still overlap: of the whole no depth is claimed.

    Attributes
    ----------
    names : (str, str)
        Of the bodies.
    pieces : (str, str)
        Of the pieces, by name; empty for a body that is no compound.
    """

    __slots__ = ("_arms", "_time", "names", "pieces")

    def __init__(
        self,
        bodies: tuple[Body, Body],
        block: Array,
        names: tuple[str, str],
        pieces: tuple[str, str],
        arms: Array,
        time: float,
    ) -> None:
        super().__init__(*bodies, block)
        self.names, self.pieces = names, pieces
        self._arms, self._time = arms, time

    @property
    def time(self) -> float:
        return self._time

    def derivatives(self) -> Derivatives:
        """As of a `Proximity`, by the motions of the two *bodies*; of the nearest pair of pieces.

        Raises StandoffError: of a pair that is FAR.
        """
        self._refuse_far()
        found = super().derivatives()
        return of_bodies(found, self._arms) if self._arms.any() else found

    @property
    def gradient(self) -> Array:
        """(12,) of the distance by unit twists (v_A, omega_A, v_B, omega_B) of the bodies."""
        self._refuse_far()
        return gradient_of_bodies(super().gradient, self._arms)

    def as_dict(self) -> dict[str, Any]:
        return {"names": list(self.names), "pieces": list(self.pieces)} | super().as_dict()

    def _refuse_far(self) -> None:
        if self.far:
            raise StandoffError(
                f"The pair {self.names} is beyond the horizon: only its lower bound is known; "
                "raise `within`."
            )

    def __repr__(self) -> str:
        a, b = (" ".join(filter(None, each)) for each in zip(self.names, self.pieces, strict=True))
        if self.far:
            return f"PairAnswer({a!r}, {b!r}, FAR: at least {self.lower_bound:.6g} apart)"
        return (
            f"PairAnswer({a!r}, {b!r}, distance={self.distance:.12g}, {self.feature_a} - "
            f"{self.feature_b}, {self.status.name})"
        )


def convex(answer: Any) -> PairAnswer:
    """The answer of a pair where no world has solids, as what asks has refused them."""
    assert isinstance(answer, PairAnswer)
    return answer


def of_bodies(of_pieces: Derivatives, arms: Array) -> Derivatives:
    """Derivatives by the motions of bodies, of those by the motions of their pieces.

    Parameters
    ----------
    of_pieces : Derivatives
    arms : (2, 3) array
        From each body's origin to its piece's, world axes [length].
    """
    moved, bends = np.eye(12), np.zeros((12, 12))
    for side, arm in enumerate(arms):
        v, w = slice(6 * side, 6 * side + 3), slice(6 * side + 3, 6 * side + 6)
        # a turn carries the piece by omega x arm, and to second order by omega x (omega x arm) / 2
        moved[v, w] = np.cross(np.eye(3), arm).T
        by_place = of_pieces.gradient[v]
        both = np.outer(by_place, arm)
        bends[w, w] = 0.5 * (both + both.T) - (by_place @ arm) * np.eye(3)
    on_a, on_b = of_pieces.point_jacobians
    return of_pieces._replace(
        gradient=gradient_of_bodies(of_pieces.gradient, arms),
        hessian=moved.T @ of_pieces.hessian @ moved + bends,
        normal_jacobian=of_pieces.normal_jacobian @ moved,
        point_jacobians=(on_a @ moved, on_b @ moved),
    )


def gradient_of_bodies(of_pieces: Array, arms: Array) -> Array:
    """(12,) by the motions of bodies; a turn without a derivative stays nan, and no other."""
    found = np.array(of_pieces)
    for side, arm in enumerate(arms):
        part = found[6 * side : 6 * side + 6]
        part[3:] += np.cross(arm, part[:3])
    return found


def far_block(bound: float) -> Array:
    """The block of a pair of which only a lower bound is known."""
    block = np.full(K.N_BLOCK, np.nan)
    block[K.DISTANCE] = block[K.UPPER_BOUND] = math.inf
    block[K.LOWER_BOUND] = bound
    block[K.STATUS] = Status.FAR.value
    block[K.OUT_MODE : K.OUT_Q] = -1.0
    block[K.OUT_COUNTS : K.N_OUT] = 0.0
    return block


OF_SIDES = ((K.POINT_A, K.POINT_B, 3), (K.OUT_MODE, K.OUT_MODE + 2, 2), (K.OUT_Q, K.OUT_Q + 2, 2))
"""Where A's numbers and B's stand in an answer, and how many; its velocities follow."""


def swapped(block: Array) -> Array:
    """The answer of the pair (B, A): without the state of its tracker."""
    found = np.full(K.N_BLOCK, np.nan)
    found[: K.N_OUT] = block[: K.N_OUT]
    motion, first = K.BLOCK_MOTION, K.BLOCK_MOTION + K.TWIST_A
    sides = [
        *OF_SIDES,
        (K.VELOCITY_A, K.VELOCITY_B, 3),
        (motion + K.POSE_A, motion + K.POSE_B, 12),
        (first, motion + K.TWIST_B, 6),
    ]
    for a, b, n in sides:
        found[a : a + n], found[b : b + n] = block[b : b + n], block[a : a + n]
    found[K.NORMAL : K.NORMAL + 3] = -block[K.NORMAL : K.NORMAL + 3]
    for k in (K.BLOCK_TIME_STEP, K.BLOCK_HAS_TWIST):
        found[k] = block[k]
    found[K.BLOCK_POLYTOPE] = found[K.BLOCK_DONE] = 0.0
    found[K.BLOCK_EVENTS :] = block[K.BLOCK_EVENTS : K.N_BLOCK]
    kept = min(int(block[K.OUT_COUNTS + N.EVENTS]), K.KEPT_EVENTS)
    bodies = slice(
        K.BLOCK_EVENTS + N.BODY, K.BLOCK_EVENTS + N.EVENT_COLUMNS * kept, N.EVENT_COLUMNS
    )
    found[bodies] = 1.0 - found[bodies]
    return found
