"""Many pairs of poses of two bodies tracked at once on a GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.checks.numbers import positive
from standoff.errors import StandoffError
from standoff.gpu.compiler import check_there
from standoff.gpu.device_arrays import empty, pair_and_options, sent
from standoff.gpu.kinds import THERE_ARE, kind_of
from standoff.gpu.threads import N_GIVEN, start_threads
from standoff.kernels.entries import tracker as entries
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.pose_arrays import flat_poses, mended, read_poses
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker
from standoff.wording import counted

Array = NDArray[np.float64]


class Tracks:
    """n states of one tracker on a GPU, which step at once.

    A frame in which both witness points stay on faces is made by a thread, with the functions that
    make it on the processor; another frame, as one that crosses an edge, by the processor. Either
    way it has its own proof.

    Parameters
    ----------
    tracker : Tracker
        Of two bodies of patches of spheres (ellipsoids, lenses), or of NURBS of one degree from 2
        to 5, by the law `PredictorCorrector` without a horizon.
    states : sequence of TrackerState
        Where the rows begin, of this tracker.

    Attributes
    ----------
    blocks : (n, N_BLOCK) array
        What each row's last frame has left, by ``standoff.kernels.state.arrays``; a copy.
    by_threads : int
        Number of the last step's frames that were made on the GPU.

    Raises
    ------
    ValueError
        Another law or other faces; no state; no GPU.
    """

    def __init__(self, tracker: Tracker, states: Sequence[TrackerState]) -> None:
        self._kernel = kernel_of(tracker)
        if len(states) == 0:
            raise StandoffError("states is empty: give at least one.", "states", states)
        for state in states:
            tracker.check_state(state)
        check_there()
        self.tracker, self.by_threads = tracker, 0
        self._blocks = sent(blocks_of(states))
        self._done = empty((len(states),), np.int64)
        self._pair, self._options = pair_and_options(tracker.reached.table.arrays)

    @property
    def blocks(self) -> Array:
        found: Array = self._blocks.copy_to_host()
        return found

    @property
    def done(self) -> NDArray[np.int64]:
        """(n,) 1 where a thread has made the row's last frame, else 0."""
        found: NDArray[np.int64] = self._done.copy_to_host()
        return found

    def step(
        self,
        poses_a: PosesLike,
        poses_b: PosesLike,
        dt: float | None = None,
        *,
        twists_a: ArrayLike | None = None,
        twists_b: ArrayLike | None = None,
    ) -> Array:
        """The next frame of every row.

        Parameters
        ----------
        poses_a, poses_b : array_like, shape (n, 4, 4) or (n, 12), and others, or one pose for all
            World poses.
        dt : float, optional
            Time since the last frame, s; the tracker's own if not given.
        twists_a, twists_b : array_like, shape (n, 6) or (6,), optional
            Velocities (v, w) in world axes, v that of the frame's origin.

        Returns
        -------
        (n, 40) array
            The rows' answers, by ``standoff.kernels.state.arrays``.

        Raises
        ------
        ValueError
            Poses or twists of another number or that are invalid; nothing has changed then.
        """
        h = self.tracker.dt if dt is None else positive(dt, "dt")
        n = self._blocks.shape[0]
        given = given_rows(n, (poses_a, poses_b), h, (twists_a, twists_b))
        self.start_step(sent(given))
        return self._finished()

    def start_step(self, given: Any) -> None:
        """Let the threads begin with what is given (n, 38), on the GPU: poses, twists, time, mark.

        For who measures: frames that no thread makes stay as they were.
        """
        arguments = self._pair, self._options, given, self._blocks, self._done
        start_threads(self._kernel, self._blocks.shape[0], arguments)

    def _finished(self) -> Array:
        """Make the other frames here, and return the answers."""
        blocks = self.blocks
        left = np.flatnonzero(self.done == 0)
        self.by_threads = len(blocks) - len(left)
        for k in left:
            blocks[k] = stepped_here(self.tracker, blocks[k])
        if len(left):
            self._blocks.copy_to_device(blocks)
        return blocks[:, : K.N_OUT]


def blocks_of(states: Sequence[TrackerState]) -> Array:
    """(n, N_BLOCK) what the threads begin with: the last answer and the state after it."""
    blocks = np.zeros((len(states), K.N_BLOCK))
    for block, state in zip(blocks, states, strict=True):
        block[: K.BLOCK_MOTION] = state.proximity._out[: K.BLOCK_MOTION]
    return blocks


def given_rows(
    n: int,
    poses: tuple[PosesLike, PosesLike],
    h: float,
    twists: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> Array:
    """(n, N_GIVEN) what a frame is given: both motions, h [s], 1 where there are twists.

    Raises
    ------
    ValueError
        Poses or twists of another number, or that are invalid.
    """
    given = np.zeros((n, N_GIVEN))
    given[:, K.POSE_A : K.POSE_B] = _sound_poses(poses[0], "poses_a", n)
    given[:, K.POSE_B : K.TWIST_A] = _sound_poses(poses[1], "poses_b", n)
    given[:, K.TWIST_A : K.TWIST_B] = _sound_twists(twists[0], "twists_a", n)
    given[:, K.TWIST_B : K.N_MOTION] = _sound_twists(twists[1], "twists_b", n)
    given[:, K.N_MOTION] = h
    given[:, K.N_MOTION + 1] = twists[0] is not None or twists[1] is not None
    return given


def stepped_here(tracker: Tracker, block: Array) -> Array:
    """A block (N_BLOCK,) after a frame on the processor."""
    room = np.zeros(K.N_LONG_BLOCK)
    room[: K.N_BLOCK] = block
    done = entries.step(tracker.reached.address, room)
    if done != K.FINE:
        raise AssertionError(f"a frame that was checked is refused: {done}")
    return room[: K.N_BLOCK]


def kernel_of(tracker: Tracker) -> str:
    """The name of the kernel that makes a tracker's frames.

    Raises
    ------
    ValueError
        There is none.
    """
    law = tracker.law
    if not isinstance(law, PredictorCorrector) or law.within is not None:
        raise StandoffError(
            f"law = {law!r}: on a GPU there are frames of so.PredictorCorrector without a horizon "
            "alone.",
            "law",
            law,
        )
    kind = kind_of(tracker.a, tracker.b)
    if kind is None:
        raise StandoffError(
            f"tracker: on a GPU there are frames of two bodies of {THERE_ARE}; step such bodies "
            "with so.Tracker.",
            "tracker",
            tracker,
        )
    return f"frames_{kind}"


def _sound_poses(poses: PosesLike, name: str, n: int) -> Array:
    """Flat poses (n, 12) or (1, 12)."""
    matrices, _, refused = mended(read_poses(poses, name).matrices)
    if len(matrices) not in (1, n):
        raise StandoffError(
            f"{name} has {counted(len(matrices), 'pose')}: give {n}, or one for all rows.", name
        )
    if refused.any():
        first = int(refused.argmax())
        raise StandoffError(f"{name}[{first}] is not a pose: {matrices[first].tolist()}.", name)
    return flat_poses(matrices)


def _sound_twists(twists: ArrayLike | None, name: str, n: int) -> Array:
    found: Array = np.zeros(6) if twists is None else np.asarray(twists, dtype=np.float64)
    if found.shape not in ((6,), (n, 6)):
        raise StandoffError(
            f"{name} has the shape {found.shape}: give ({n}, 6), or (6,) for all rows.", name
        )
    if not np.isfinite(found).all():
        raise StandoffError(f"{name} holds numbers that are not finite: give (v, w).", name)
    return found
