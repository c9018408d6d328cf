"""Many frames in one call: what is given for all of them, and the loop."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.errors import MaskedNumbers, StandoffError
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.motion import Pose, Twist
from standoff.real_numbers import real_array, shown
from standoff.tracking.address_table import AddressTable
from standoff.tracking.answers import Answers
from standoff.tracking.block import Block, with_polytope
from standoff.tracking.inputs import ABSENT, flat_twist, matrix_and_mark
from standoff.tracking.proximity import Proximity
from standoff.tracking.state import TrackerState

Array = NDArray[np.float64]


class Steps(Protocol):
    """A tracker, as a run sees it."""

    a: Body
    b: Body
    dt: float
    planar: bool
    table: AddressTable
    values: Any

    def check_state(self, state: TrackerState) -> None: ...
    def check_frame_time(self, dt: float) -> float: ...
    def name_overlap(self, block: Block) -> None: ...
    def step_anew(
        self, state: TrackerState, given: tuple[Any, Any, Any, Any], h: float
    ) -> tuple[TrackerState, Proximity]: ...


class Given(NamedTuple):
    """What a run is given, as the kernels read it, for n frames.

    Attributes
    ----------
    poses_a, poses_b : (n, 4, 4) arrays
    twists_a, twists_b : (n, 6) arrays, or (n, 1) where none was given
    steps : (n,) array
        Time since the frame before, s.
    repaired : int
        How many of a frame's poses were repaired when they were read.
    """

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array
    steps: Array
    repaired: int

    @classmethod
    def of(
        cls, tracker: Steps, poses_a: Any, poses_b: Any, twists: tuple[Any, Any], dt: Any
    ) -> Given:
        """Read what the caller gave.

        Raises
        ------
        StandoffError
            A shape that is not one of those named, or different numbers of frames.
        """
        a, mark_a = read_poses(poses_a, "poses_a")
        b, mark_b = read_poses(poses_b, "poses_b")
        counts = {"poses_a": len(a), "poses_b": len(b)}
        given = [
            _twists(twist, name, poses)
            for twist, name, poses in zip(twists, ("twists_a", "twists_b"), (a, b), strict=True)
        ]
        counts |= {"twists_a": len(given[0]), "twists_b": len(given[1])}
        steps = _steps(tracker, dt)
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
        return cls(of_a, of_b, xi_a, xi_b, h, mark_a + mark_b)

    def frame(self, k: int) -> tuple[Any, Any, Any, Any]:
        """Poses and twists of frame k, as ``Tracker.step`` takes them."""
        a, b = (x[k] if x.shape[1] == 6 else None for x in (self.twists_a, self.twists_b))
        return self.poses_a[k], self.poses_b[k], a, b


def _repeated(array: Array, n: int) -> Array:
    """An array of n rows that a kernel can read: itself, where it is one."""
    if len(array) != n:
        return np.repeat(array, n, axis=0)
    return np.require(array, requirements=["C", "W"])


def _numbers(value: Any, name: str, forms: str) -> Array:
    try:
        return real_array(value, copy=False)
    except MaskedNumbers as error:
        raise StandoffError(f"{name} {error}: {shown(value)}", name, value) from error
    except (TypeError, ValueError) as error:
        raise StandoffError(
            f"{name} is {shown(value)}: give {forms}, all of them real numbers.", name, value
        ) from error


def read_poses(value: Any, name: str) -> tuple[Array, int]:
    """Poses (n, 4, 4), or one of them (1, 4, 4), and was it repaired?"""
    forms = "an array of shape (n, 4, 4) or (n, 12), or one pose"
    if isinstance(value, Pose | tuple):
        matrix, mark = matrix_and_mark(value)
        return matrix[None], int(mark)
    array = _numbers(value, name, forms)
    if array.shape == (4, 4):
        return array[None], 0
    if array.ndim == 3 and array.shape[1:] == (4, 4) and len(array):
        return array, 0
    if array.ndim == 2 and array.shape[1] == 12 and len(array):
        poses = np.zeros((len(array), 4, 4))
        poses[:, :3, :3], poses[:, :3, 3] = array[:, :9].reshape(-1, 3, 3), array[:, 9:]
        poses[:, 3, 3] = 1.0
        return poses, 0
    raise StandoffError(f"{name} has the shape {array.shape}: give {forms}.", name, value)


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
    array = _numbers(value, name, forms)
    if array.shape == (6,):
        return array[None]
    if array.ndim == 2 and array.shape[1] == 6 and len(array):
        return array
    raise StandoffError(f"{name} has the shape {array.shape}: give {forms}.", name, value)


def _steps(tracker: Steps, dt: Any) -> Array:
    if dt is None:
        return np.array([tracker.dt])
    array = np.atleast_1d(_numbers(dt, "dt", "one time in seconds, or one for each frame"))
    if array.ndim != 1 or not len(array):
        raise StandoffError(f"dt has the shape {array.shape}: give one time, or n.", "dt", dt)
    for extreme in (array.min(), array.max()):
        tracker.check_frame_time(float(extreme))
    return array


def run(tracker: Steps, state: TrackerState, given: Given) -> tuple[TrackerState, Answers]:
    """See ``Tracker.run``."""
    tracker.check_state(state)
    if isinstance(tracker.values, Entry):
        tracker.values.prepare()
    n = len(given.steps)
    blocks, polytopes = np.empty((n + 1, K.N_BLOCK)), np.zeros((2, N_POLYTOPE))
    blocks[0] = state.proximity._out[: K.N_BLOCK]
    _take(polytopes[0], state.proximity)
    repaired = np.full(n, given.repaired)
    longer: dict[int, Proximity] = {}
    at = 0
    while at < n:
        # planar bodies: whether they stay in their plane is looked at in Python
        done = K.BAD_ARRAYS
        if not tracker.planar:
            at, done = tracker.values(tracker.table.address, *given[:5], at, (blocks, polytopes))
        if done == K.UNDECIDED:
            tracker.name_overlap(Block(blocks[at + 1]))
        elif done != K.FINE:
            kept = with_polytope(blocks[at], polytopes[at % 2])
            before = TrackerState(Proximity(tracker.a, tracker.b, kept))
            answer = _single(tracker, before, given, at)
            blocks[at + 1] = answer._out[: K.N_BLOCK]
            blocks[at + 1, K.BLOCK_POLYTOPE] = 0.0
            _take(polytopes[(at + 1) % 2], answer)
            repaired[at] += answer.repaired
            if answer._out[K.OUT_COUNTS + N.EVENTS] > K.KEPT_EVENTS:
                longer[at] = answer
        at += 1
    kept = with_polytope(blocks[n], polytopes[n % 2])
    last = longer.get(n - 1) or Proximity(tracker.a, tracker.b, kept, repaired[-1])
    return TrackerState(last), Answers((tracker.a, tracker.b), blocks[1:], repaired, longer)


def _take(polytope: Array, answer: Proximity) -> None:
    """Take over the polytope that an answer has kept, or none."""
    kept = Block(answer._out).polytope
    polytope[:] = kept if len(kept) else 0.0


def _single(tracker: Steps, before: TrackerState, given: Given, k: int) -> Proximity:
    """A frame that the compiled loop does not make."""
    try:
        return tracker.step_anew(before, given.frame(k), float(given.steps[k]))[1]
    except StandoffError as error:
        raise type(error)(f"Frame {k}: {error}", error.argument, error.value) from error
