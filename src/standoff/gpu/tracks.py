"""Many pairs of poses of two bodies tracked at once on a GPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from standoff.checks.numbers import positive
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.gpu.compiler import check_there
from standoff.gpu.device_arrays import empty, pair_and_options, sent
from standoff.gpu.kinds import THERE_ARE, kind_of
from standoff.gpu.threads import N_GIVEN, start_threads
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.motion import PosesLike
from standoff.tracking.laws import PredictorCorrector
from standoff.tracking.many_states import TrackerStates
from standoff.tracking.pose_arrays import flat_poses, mended, read_poses
from standoff.tracking.state import TrackerState
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff.wording import counted


class Tracks:
    """n states of one tracker on a GPU, which step at once.

    A frame in which both witness points stay on faces is made by a thread, with the functions that
    make it on the processor; the others, as those that cross an edge, by ``Tracker.step_many``.
    Either way each has its own proof.

    It changes with each step, where ``step_many`` takes states and returns others: a thread reads
    and writes a row where it lies, and a copy of all rows for each frame would take as long on a
    GPU as the frame. `states` is a value.

    Raises TypeError: something that is no state. Raises ValueError: another law or other faces; no
    state, or one of other bodies; no GPU.

    Parameters
    ----------
    tracker : Tracker
        Of two bodies of patches of spheres (ellipsoids, lenses), or of NURBS of one degree from 2
        to 5, by the law `PredictorCorrector` without a horizon.
    states : TrackerStates or sequence of TrackerState
        Where the rows begin, of this tracker: as ``tracker.start_many`` finds them.

    Attributes
    ----------
    by_threads : int
        Number of the last step's frames that were made on the GPU.
    """

    def __init__(self, tracker: Tracker, states: TrackerStates | Sequence[TrackerState]) -> None:
        self._kernel = kernel_of(tracker)
        begun = states if isinstance(states, TrackerStates) else TrackerStates.of(states)
        tracker.check_state(begun[0])
        check_there()
        self.tracker, self.by_threads = tracker, 0
        self._blocks = sent(begun.blocks)
        self._done = empty((len(begun),), np.int64)
        keeping = np.flatnonzero(begun.polytopes[:, 0])
        self._kept = Kept(keeping, begun.polytopes[keeping])
        self._pair, self._options = pair_and_options(tracker.reached.table.arrays)

    @property
    def states(self) -> TrackerStates:
        """The states after the last step: a copy, as a value."""
        return self._states(np.arange(self._blocks.shape[0]), self.blocks)

    @property
    def blocks(self) -> Array:
        """(n, N_BLOCK) what each row's last frame has left, by ``standoff.kernels.state.arrays``; a
        copy."""
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

        Raises ValueError: poses or twists of another number or that are invalid; nothing has
        changed then.

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
        """
        h = self.tracker.dt if dt is None else positive(dt, "dt")
        n = self._blocks.shape[0]
        given = given_rows(n, (poses_a, poses_b), h, (twists_a, twists_b))
        self.start_step(sent(given))
        return self._finished(given)

    def start_step(self, given: Any) -> None:
        """Let the threads begin with what is given (n, 38), on the GPU: poses, twists, time, mark.

        For who measures: frames that no thread makes stay as they were.
        """
        arguments = self._pair, self._options, given, self._blocks, self._done
        start_threads(self._kernel, self._blocks.shape[0], arguments)

    def _finished(self, given: Array) -> Array:
        """Make the other frames here, and return the answers."""
        blocks = self.blocks
        left = np.flatnonzero(self.done == 0)
        self.by_threads = len(blocks) - len(left)
        if len(left):
            made = self._stepped_here(self._states(left, blocks), given[left])
            blocks[left] = made.blocks
            self._blocks.copy_to_device(blocks)
            self._kept = Kept(left, made.polytopes)
        else:
            self._kept = NOTHING_KEPT
        return blocks[:, : K.N_OUT]

    def _states(self, rows: NDArray[np.int64], blocks: Array) -> TrackerStates:
        """Some rows of all blocks as a value."""
        bodies, marks = (self.tracker.a, self.tracker.b), np.zeros(len(rows), dtype=np.int64)
        return TrackerStates(bodies, blocks[rows], self._kept.of(rows), marks, {})

    def _stepped_here(self, states: TrackerStates, given: Array) -> TrackerStates:
        """States after what is given of their frames."""
        told = bool(given[0, K.N_MOTION + 1])
        found, _ = self.tracker.step_many(
            states,
            given[:, K.POSE_A : K.POSE_B],
            given[:, K.POSE_B : K.TWIST_A],
            twists_a=given[:, K.TWIST_A : K.TWIST_B] if told else None,
            twists_b=given[:, K.TWIST_B : K.N_MOTION] if told else None,
            dt=given[:, K.N_MOTION],
        )
        return found


class Kept(NamedTuple):
    """What frames in penetration have kept of their proofs, of some rows."""

    rows: NDArray[np.int64]  # ascending
    polytopes: Array  # of these

    def of(self, rows: NDArray[np.int64]) -> Array:
        """(n, N_POLYTOPE) of rows, zero where nothing is kept."""
        found = np.zeros((len(rows), N_POLYTOPE))
        _, here, there = np.intersect1d(rows, self.rows, assume_unique=True, return_indices=True)
        found[here] = self.polytopes[there]
        return found


NOTHING_KEPT = Kept(np.zeros(0, dtype=np.int64), np.zeros((0, N_POLYTOPE)))


def given_rows(
    n: int,
    poses: tuple[PosesLike, PosesLike],
    h: float,
    twists: tuple[ArrayLike | None, ArrayLike | None] = (None, None),
) -> Array:
    """(n, N_GIVEN) what a frame is given: both motions, h [s], 1 where there are twists.

    Raises ValueError: poses or twists of another number, or that are invalid.
    """
    given = np.zeros((n, N_GIVEN))
    given[:, K.POSE_A : K.POSE_B] = _sound_poses(poses[0], "poses_a", n)
    given[:, K.POSE_B : K.TWIST_A] = _sound_poses(poses[1], "poses_b", n)
    given[:, K.TWIST_A : K.TWIST_B] = _sound_twists(twists[0], "twists_a", n)
    given[:, K.TWIST_B : K.N_MOTION] = _sound_twists(twists[1], "twists_b", n)
    given[:, K.N_MOTION] = h
    given[:, K.N_MOTION + 1] = twists[0] is not None or twists[1] is not None
    return given


def kernel_of(tracker: Tracker) -> str:
    """The name of the kernel that makes a tracker's frames.

    Raises ValueError: there is none.
    """
    law = tracker.law
    if not isinstance(law, PredictorCorrector) or law.within is not None:
        raise StandoffError(
            f"law = {shown(law)}: on a GPU there are frames of so.PredictorCorrector without a "
            "horizon alone.",
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
