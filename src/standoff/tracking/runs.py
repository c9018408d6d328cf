"""Many frames in one call: what is given for all of them, and the loop."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.errors import StandoffError
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Twist
from standoff.tracking.answers import Answers
from standoff.tracking.block import FrameBlock, with_polytope
from standoff.tracking.inputs import ABSENT, flat_twist
from standoff.tracking.pose_arrays import another_order, mended, numbers, read_poses
from standoff.tracking.proximity import Proximity
from standoff.tracking.reached import AddressTable
from standoff.tracking.state import TrackerState
from standoff.typing import Array


class Frames(NamedTuple):
    """The input of a run of n frames, as the kernels read it.

    Attributes
    ----------
    poses_a, poses_b : (n, 4, 4) arrays
    twists_a, twists_b : (n, 6) arrays, or (n, 1) where none was given
    steps : (n,) array
        Time since the frame before, s.
    repaired : (n,) array of int
        How many of a frame's poses were repaired when they were read.
    """

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array
    steps: Array
    repaired: NDArray[np.int64]

    @classmethod
    def of(cls, poses_a: Any, poses_b: Any, twists: tuple[Any, Any], steps: Array) -> Frames:
        """Read what the caller gave; `steps` are n times, or one.

        Raises StandoffError: a shape that is not one of those named, or different numbers of
        frames.
        """
        a, marks_a = read_poses(poses_a, "poses_a")
        b, marks_b = read_poses(poses_b, "poses_b")
        counts = {"poses_a": len(a), "poses_b": len(b)}
        given = [
            _twists(twist, name, poses)
            for twist, name, poses in zip(twists, ("twists_a", "twists_b"), (a, b), strict=True)
        ]
        counts |= {"twists_a": len(given[0]), "twists_b": len(given[1])}
        counts["dt"] = len(steps)
        n = max(counts.values())
        for name, count in counts.items():
            if count not in (1, n):
                raise StandoffError(
                    f"{name} is given for {count} frames, another for {n}: give all for n frames, "
                    "or one for all of them.",
                    name,
                )
        of_a, of_b, xi_a, xi_b, h = (_repeated(x, n) for x in (a, b, *given, steps))
        marks = np.broadcast_to(marks_a, n) + np.broadcast_to(marks_b, n)
        return cls(of_a, of_b, xi_a, xi_b, h, marks)

    def repeated(self, n: int) -> Frames:
        """The same for n frames, where it is of one."""
        if len(self.steps) != 1:
            return self
        a, b, xi_a, xi_b, h = (_repeated(x, n) for x in self[:5])
        return Frames(a, b, xi_a, xi_b, h, np.repeat(self.repaired, n))

    def mended(self, refused: int, first: int) -> Frames:
        """The same with the rounded poses from frame `first` on repaired and counted: those of the
        body that the kernel has refused, as BAD_POSE_A or BAD_POSE_B."""
        given = self.poses_a if refused == K.BAD_POSE_A else self.poses_b
        matrices, rounded, _ = mended(given[first:])
        repaired = self.repaired.copy()
        repaired[first:] += rounded
        poses = np.concatenate([given[:first], matrices]) if first else matrices
        if refused == K.BAD_POSE_A:
            return self._replace(poses_a=poses, repaired=repaired)
        return self._replace(poses_b=poses, repaired=repaired)

    def advice(self, first: int) -> str:
        """A sentence about another order that fits the refused poses from frame `first` on."""
        told = []
        for poses in (self.poses_a[first:], self.poses_b[first:]):
            refused = mended(poses).refused
            told += [f" {another_order(poses[refused])}"] if refused.any() else []
        return max(told, key=len, default="").rstrip()

    def frame(self, k: int) -> tuple[Any, Any, Any, Any]:
        """Poses and twists of frame k, as ``Tracker.step`` takes them."""
        a, b = (x[k] if x.shape[1] == 6 else None for x in (self.twists_a, self.twists_b))
        return self.poses_a[k], self.poses_b[k], a, b


def _repeated(array: Array, n: int) -> Array:
    """An array of n rows that a kernel can read: itself, where it is one."""
    if len(array) != n:
        return np.repeat(array, n, axis=0)
    return np.require(array, requirements=["C", "W"])


def _twists(value: Any, name: str, poses: Array) -> Array:
    """Twists (n, 6) in world axes, or one; (1, 1) of the mark where none is given."""
    forms = "an array of shape (n, 6), or one twist"
    if value is None:
        return ABSENT[None]
    if isinstance(value, Twist) and value.frame == "body":
        turns = poses[:, :3, :3]
        return np.hstack([turns @ value.v, turns @ value.omega])
    if isinstance(value, Twist | tuple):
        return flat_twist(value, Pose.identity())[None]
    array = numbers(value, name, forms)
    if array.shape == (6,):
        return array[None]
    if array.ndim == 2 and array.shape[1] == 6 and len(array):
        return array
    raise StandoffError(f"{name} has the shape {array.shape}: give {forms}.", name, value)


def steps_of(dt: Any, usual: float, check: Callable[[float], float]) -> Array:
    """Times since the frame before, s: n of them, or one."""
    if dt is None:
        return np.array([usual])
    array = np.atleast_1d(numbers(dt, "dt", "one time in seconds, or one for each frame"))
    if array.ndim != 1 or not len(array):
        raise StandoffError(f"dt has the shape {array.shape}: give one time, or n.", "dt", dt)
    for extreme in (array.min(), array.max()):
        check(float(extreme))
    return array


Single = Callable[[TrackerState, tuple[Any, Any, Any, Any], float], Proximity]
"""Makes one frame that the compiled loop does not make, from its state, its input and its time."""


def run(
    table: AddressTable, state: TrackerState, given: Frames, single: Single
) -> tuple[TrackerState, Answers]:
    """See ``Tracker.run``."""
    n = len(given.steps)
    bodies = state.proximity.bodies
    blocks, polytopes = np.empty((n + 1, K.N_BLOCK)), np.zeros((2, N_POLYTOPE))
    blocks[0] = state.proximity._out[: K.N_BLOCK]
    take_polytope(polytopes[0], state.proximity)
    unchecked = {K.BAD_POSE_A, K.BAD_POSE_B}
    longer: dict[int, Proximity] = {}
    at = 0
    while at < n:
        at, done = kernels.values(table.address, *given[:5], at, (blocks, polytopes))
        if done in unchecked:  # all the later ones are likely rounded alike
            unchecked.remove(done)
            given = given.mended(done, at)
            continue
        if done != K.FINE:
            before = TrackerState(Proximity(*bodies, with_polytope(blocks[at], polytopes[at % 2])))
            answer = frame_told(single, before, given, at)
            blocks[at + 1] = answer._out[: K.N_BLOCK]
            blocks[at + 1, K.BLOCK_POLYTOPE] = 0.0
            take_polytope(polytopes[(at + 1) % 2], answer)
            given.repaired[at] += answer.repaired
            if answer._out[K.OUT_COUNTS + N.EVENTS] > K.KEPT_EVENTS:
                mark = int(given.repaired[at])
                longer[at] = Proximity(*bodies, answer._out, mark)
        at += 1
    kept = with_polytope(blocks[n], polytopes[n % 2])
    last = longer.get(n - 1) or Proximity(*bodies, kept, int(given.repaired[-1]))
    answers = Answers(bodies, blocks[1:], given.repaired, longer)
    return TrackerState(last), answers


def take_polytope(polytope: Array, answer: Proximity) -> None:
    """Take over the polytope that an answer has kept, or none."""
    kept = FrameBlock(answer._out).polytope
    polytope[:] = kept if len(kept) else 0.0


def frame_told(
    single: Single, before: TrackerState, given: Frames, k: int, name: str = "Frame"
) -> Proximity:
    """A frame by itself; its number is in the error if something is wrong with it."""
    try:
        return single(before, given.frame(k), float(given.steps[k]))
    except StandoffError as error:
        told = f"{name} {k}: {error}{given.advice(k)}"
        raise type(error)(told, error.argument, error.value) from error
