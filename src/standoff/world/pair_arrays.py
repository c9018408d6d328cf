"""The near pairs of a world in one frame, as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.state import arrays as K
from standoff.kernels.world import arrays as W
from standoff.read_only import KeepsReadOnly
from standoff.tracking.answers import proven, statuses
from standoff.tracking.derivatives import NOT_UNIQUE, Smoothness, flagged_gradient
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff.wording import counted
from standoff.world.pair_answer import PairAnswer
from standoff.world.pair_rows import PairRows

if TYPE_CHECKING:
    from standoff.world.solid_answer import SolidPairAnswer


GATHERED = np.array(
    [
        *(K.DISTANCE, K.UPPER_BOUND, K.OUT_RATE, K.LOWER_BOUND),
        *(o + i for o in (K.POINT_A, K.POINT_B, K.NORMAL) for i in range(3)),
    ]
)
"""The numbers of an answer that have an array here: read from the pages at once."""
DISTANCE, UPPER_BOUND, RATE, LOWER_BOUND = range(4)
POINT_A, POINT_B, NORMAL = slice(4, 7), slice(7, 10), slice(10, 13)


class PairArrays(KeepsReadOnly):
    """All pairs of bodies within their horizon, nearest or not, in arrays of n rows.

    Sorted by the bodies' numbers; iterating yields a `PairAnswer` or `SolidPairAnswer` each.

    Attributes
    ----------
    bodies : (n, 2) array of int
        Numbers of the two bodies, in the world's order.
    distance, lower_bound, upper_bound : (n,) arrays
        Of a body that is inside the other's material those of the wall around it.
    order : (n,) array
        The distances by which the nearest is told: -inf where one body is inside the other's
        material.
    inside : (n,) array of bool
        Is one body inside the other's material?
    point_a, point_b, normal : (n, 3) arrays
        As in `Proximity`, in world axes.
    rate : (n,) array
        Time derivatives of the distances; nan where no twists were given, and of a pair with a
        solid where its distance is not smooth.
    """

    __slots__ = ("_all", "_numbers", "_rows")

    def __init__(self, rows: PairRows) -> None:
        self._all, self._rows = rows, rows.nearest
        self._numbers: Array | None = None

    def _column(self, which: Any) -> Array:
        if self._numbers is None:
            self._numbers = self._all.state.column(self._rows, GATHERED)
        found = self._numbers[:, which].copy()
        found.flags.writeable = False
        return found

    @property
    def bodies(self) -> NDArray[np.int64]:
        ints = self._all.state.ints[self._rows]
        owners = self._all.model.search.pieces.owners
        return np.stack([owners[ints[:, W.I_A]], owners[ints[:, W.I_B]]], axis=1)

    @property
    def names(self) -> list[tuple[str, str]]:
        """The names of the two bodies of each pair."""
        listed = self._all.model.listed
        return [(listed[i][0], listed[j][0]) for i, j in self.bodies.tolist()]

    @property
    def distance(self) -> Array:
        return self._column(DISTANCE)

    @property
    def order(self) -> Array:
        return np.where(self.inside, -np.inf, self.distance)

    @property
    def inside(self) -> NDArray[np.bool_]:
        status = self._all.state.ints[self._rows, W.I_STATUS]
        return np.asarray(status == Status.CONTAINED.value)

    @property
    def lower_bound(self) -> Array:
        # what is known of a body inside another's material is of no signed distance
        bounds = self._all.lower_bounds(self._rows)
        return np.where(self.inside, self._column(LOWER_BOUND), bounds)

    @property
    def upper_bound(self) -> Array:
        return self._column(UPPER_BOUND)

    @property
    def rate(self) -> Array:
        return self._column(RATE)

    @property
    def point_a(self) -> Array:
        return self._column(POINT_A)

    @property
    def point_b(self) -> Array:
        return self._column(POINT_B)

    @property
    def normal(self) -> Array:
        return self._column(NORMAL)

    @property
    def status(self) -> NDArray[np.object_]:
        """(n,) the status of each pair."""
        return statuses(self._all.state.ints[self._rows, W.I_STATUS].astype(float))

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(n,) is the answer proven?"""
        return proven(self._all.state.ints[self._rows, W.I_STATUS].astype(float))

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, k: int) -> PairAnswer | SolidPairAnswer:
        return self._all.answer(int(self._rows[k]))

    def __iter__(self) -> Iterator[PairAnswer | SolidPairAnswer]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<PairArrays of {counted(len(self), 'pair')}>"


class Derived(NamedTuple):
    """What is known of a distance's derivative by the motions of the two bodies.

    Attributes
    ----------
    smoothness : Smoothness
    reason : str
        Why it is not smooth; empty if it is.
    gradient : (12,) array
        nan where it is undefined: of PARTIAL ones by turns.
    both_sides : bool
        Does the gradient hold on all sides?
    """

    smoothness: Smoothness
    reason: str
    gradient: Array
    both_sides: bool


def derived(answer: PairAnswer | SolidPairAnswer) -> Derived:
    """Of a pair of convex bodies, or of one with a solid, of which a tie is not smooth."""
    if isinstance(answer, PairAnswer):
        smoothness, reason, gradient = flagged_gradient(answer)
        holds = smoothness in (Smoothness.SMOOTH, Smoothness.ONE_SIDED)
        return Derived(smoothness, reason, gradient, holds)
    smooth = answer.smoothness is Smoothness.SMOOTH
    gradient = answer.gradient_rows.copy()
    if answer.smoothness is Smoothness.PARTIAL:
        gradient.reshape(4, 3)[1::2] = np.nan
    return Derived(answer.smoothness, "" if smooth else NOT_UNIQUE, gradient, smooth)
