"""Many answers of one pair, as arrays."""

from __future__ import annotations

import operator
from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.kernels.state import arrays as K
from standoff.motion.poses import matrices_of
from standoff.read_only import KeepsReadOnly
from standoff.shown_names import hides
from standoff.tracking.proximity import Event, Proximity
from standoff.tracking.rows import AnswerRows
from standoff.tracking.status import BY_NUMBER, Status
from standoff.typing import Array
from standoff.wording import counted, short_name

if TYPE_CHECKING:
    from standoff.tracking.contact.patches import Patch, Patches


def _field(name: str, doc: str) -> Any:
    def read(answers: AnswerArrays) -> Any:
        values = getattr(AnswerRows(answers._numbers), name)
        values.flags.writeable = False
        return values

    return property(read, doc=doc)


def statuses(numbers: Array) -> NDArray[np.object_]:
    """The statuses of the kernels' numbers (n,), REFUSED of nan."""
    return np.array(BY_NUMBER, dtype=object)[_whole(numbers)]


def proven(numbers: Array) -> NDArray[np.bool_]:
    """Which answers are proven, by the kernels' numbers (n,) of their statuses."""
    found: NDArray[np.bool_] = PROVEN[_whole(numbers)]
    return found


PROVEN = np.array([status.certified for status in BY_NUMBER])
"""By a status's number."""


def _whole(numbers: Array) -> NDArray[np.int64]:
    return np.where(np.isnan(numbers), Status.REFUSED.value, numbers).astype(np.int64)


class AnswerArrays(KeepsReadOnly):
    """What every table of answers has, in arrays of n rows."""

    __slots__ = ()

    @property
    @abstractmethod
    def _numbers(self) -> Array:
        """Rows that begin with the kernels' answers."""

    distance = _field("distance", "(n,) signed distances, length.")
    lower_bound = _field("lower_bound", "(n,) certified lower bounds of them.")
    upper_bound = _field("upper_bound", "(n,) upper bounds of them.")
    point_a = _field("point_a", "(n, 3) witness points on A.")
    point_b = _field("point_b", "(n, 3) witness points on B.")
    normal = _field("normal", "(n, 3) unit vectors from A to B.")


@hides("blocks", "rows")
class Answers(AnswerArrays):
    """Answers of n frames of two bodies, in arrays of n rows; ``answers[k]`` is one `Proximity`.

    A frame takes 1.2 kB: `standoff.track` records longer runs.

    Attributes
    ----------
    distance, lower_bound, upper_bound, rate, residual : (n,) arrays
    point_a, point_b, normal, velocity_a, velocity_b : (n, 3) arrays
        As in `Proximity`, in world axes.
    repaired : (n,) array of int
        How many of a frame's two poses had a rounded rotation and were replaced by the nearest.
    """

    __slots__ = ("_a", "_b", "_longer", "blocks", "repaired")

    def __init__(
        self,
        bodies: tuple[Body, Body],
        blocks: Array,
        repaired: NDArray[np.int64],
        longer: dict[int, Proximity],
    ) -> None:
        self._a, self._b = bodies
        self.blocks, self.repaired = blocks, repaired
        self._longer = longer  # those whose switches a row of `blocks` does not hold
        for array in (blocks, repaired):
            array.flags.writeable = False

    @property
    def _numbers(self) -> Array:
        return self.blocks

    rate = _field("rate", "(n,) time derivatives of the distance; nan without twists.")
    velocity_a = _field("velocity_a", "(n, 3) velocities of the witness points on A.")
    velocity_b = _field("velocity_b", "(n, 3) velocities of those on B.")
    residual = _field("residual", "(n,) lengths of the projection errors.")

    @property
    def bodies(self) -> tuple[Body, Body]:
        """(A, B)."""
        return self._a, self._b

    @property
    def parts(self) -> list[tuple[Answers, NDArray[np.int64]]]:
        """All rows, as `Distances` has those of each pair."""
        return [(self, np.arange(len(self)))]

    @property
    def rows(self) -> Array:
        """The kernels' answers, as `Distances` has them."""
        return np.ascontiguousarray(self.blocks[:, : K.N_OUT])

    @property
    def poses(self) -> tuple[Array, Array]:
        """World poses of A and B in each frame, two (n, 4, 4)."""
        motions = self.blocks[:, K.BLOCK_MOTION :]
        flat = (motions[:, at : at + 12] for at in (K.POSE_A, K.POSE_B))
        a, b = (matrices_of(x[:, :9].reshape(-1, 3, 3), x[:, 9:]) for x in flat)
        return a, b

    @property
    def time(self) -> Array:
        """(n,) time since the tracker's start, s."""
        return self.blocks[:, K.BLOCK_STATE + K.TIME]

    @property
    def status(self) -> NDArray[np.object_]:
        """(n,) the status of each frame."""
        return statuses(AnswerRows(self.blocks).status)

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(n,) is the answer proven?"""
        return proven(AnswerRows(self.blocks).status)

    @property
    def events(self) -> tuple[Event, ...]:
        """The switches of all frames, in their order."""
        return tuple(event for answer in self for event in answer.events)

    def patches(self, gap: float, after: Patch | None = None) -> Patches:
        """The patch of each frame as ``Proximity.patch`` has it, each after that of the frame
        before, in one compiled loop.

        Raises TypeError, ValueError as ``Proximity.patch``, but for a frame without a distance: it
        has no pairs.

        Parameters
        ----------
        gap : float
            By how much the gap along the normal may be wider than the distance, length.
        after : Patch, optional
            That of the frame before the first.
        """
        from standoff.tracking.contact.patches import N_POSES, patches_of

        poses = self.blocks[:, K.BLOCK_MOTION + K.POSE_A :][:, :N_POSES].copy()
        return patches_of((self._a, self._b), self.blocks, poses, gap, keeping=True, after=after)

    def __len__(self) -> int:
        return len(self.blocks)

    def __getitem__(self, k: int) -> Proximity:
        index = range(len(self))[operator.index(k)]
        if index in self._longer:
            return self._longer[index]
        return Proximity(self._a, self._b, self.blocks[index], int(self.repaired[index]))

    def __iter__(self) -> Iterator[Proximity]:
        return (self[k] for k in range(len(self)))

    def __repr__(self) -> str:
        names = " and ".join(short_name(body.name) for body in (self._a, self._b))
        return f"<Answers of {counted(len(self), 'frame')}: {names}>"
