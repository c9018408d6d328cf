"""Many states of one tracker, which step together: a compiled loop, shared among threads."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.numbers import whole_number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.kernels.entries import tracker as kernels
from standoff.kernels.pair import events as N
from standoff.kernels.pair.polytope_layout import N_POLYTOPE
from standoff.kernels.state import arrays as K
from standoff.read_only import KeepsReadOnly
from standoff.tracking.answers import Answers
from standoff.tracking.block import with_polytope
from standoff.tracking.proximity import Proximity
from standoff.tracking.runs import Frames, frame_told, take_polytope
from standoff.tracking.state import TrackerState
from standoff.tracking.threads import in_parts
from standoff.typing import Array


class TrackerStates(KeepsReadOnly):
    """n states of one tracker, as a value: `Tracker.step_many` takes it and returns the next.

    ``states[k]`` is one `TrackerState`, and `TrackerStates.of` puts some together.

    Parameters
    ----------
    bodies : pair of Body
    blocks : (n, ...) array
        What their last frames have left, by ``standoff.kernels.state.arrays``.
    polytopes : (n, 510) array
        What a frame in penetration has kept of its proof.
    repaired : (n,) array of int
        How many of a row's two poses were repaired when they were read.
    longer : dict of int to Proximity
        Rows with more switches than a row of `blocks` holds.

    Attributes
    ----------
    blocks, polytopes
        As given, read-only.
    """

    __slots__ = ("_a", "_b", "_longer", "_repaired", "blocks", "polytopes")

    def __init__(
        self,
        bodies: tuple[Body, Body],
        blocks: Array,
        polytopes: Array,
        repaired: NDArray[np.int64],
        longer: dict[int, Proximity],
    ) -> None:
        self._a, self._b = bodies
        self.blocks, self.polytopes = blocks, polytopes
        self._repaired, self._longer = repaired, longer
        for array in (blocks, polytopes, repaired):
            array.flags.writeable = False

    @classmethod
    def of(cls, states: Sequence[TrackerState]) -> TrackerStates:
        """Put states of one tracker together.

        Raises TypeError, ValueError: something that is no state; none; states of different bodies.
        """
        given = list(states)
        if not given:
            raise StandoffError("states is empty: give at least one.", "states", states)
        for k, state in enumerate(given):
            if not isinstance(state, TrackerState):
                raise StandoffTypeError(
                    f"states[{k}] = {shown(state)} is not a TrackerState: get one from "
                    "tracker.start.",
                    "states",
                    states,
                )
        bodies = given[0].proximity.bodies
        blocks, polytopes = np.empty((len(given), K.N_BLOCK)), np.zeros((len(given), N_POLYTOPE))
        for k, state in enumerate(given):
            if state.proximity.bodies != bodies:
                raise StandoffError(
                    f"states[{k}] is of other bodies than states[0]: give those of one tracker.",
                    "states",
                    states,
                )
            blocks[k] = state.proximity._out[: K.N_BLOCK]
            blocks[k, K.BLOCK_POLYTOPE] = 0.0
            take_polytope(polytopes[k], state.proximity)
        marks = np.array([state.proximity.repaired for state in given], dtype=np.int64)
        return cls(bodies, blocks, polytopes, marks, {})

    @property
    def answers(self) -> Answers:
        """The answers at the frames of these states."""
        return Answers((self._a, self._b), self.blocks, self._repaired, self._longer)

    def __len__(self) -> int:
        return len(self.blocks)

    def __getitem__(self, k: int) -> TrackerState:
        row = range(len(self))[operator.index(k)]
        if row in self._longer:
            return TrackerState(self._longer[row])
        kept = with_polytope(self.blocks[row], self.polytopes[row])
        return TrackerState(Proximity(self._a, self._b, kept, int(self._repaired[row])))

    def __repr__(self) -> str:
        return f"<TrackerStates of {len(self)} rows>"


def step_many(
    tracker: Any, states: TrackerStates, given: Frames, workers: int
) -> tuple[TrackerStates, Answers]:
    """See ``Tracker.step_many``."""
    n = len(states)
    if len(given.steps) != n:
        raise StandoffError(
            f"poses, twists and dt are given for {len(given.steps)} rows, and there are {n} "
            "states: give one of each for every state, or one for all.",
            "poses_a",
        )
    # of polytopes of 0 no memory is touched
    blocks, polytopes = np.empty((n, K.N_BLOCK)), np.zeros((n, N_POLYTOPE))
    records = states.blocks, states.polytopes, blocks, polytopes
    given = _made(tracker, given, records, whole_number(workers, "workers"))
    longer: dict[int, Proximity] = {}
    for k in np.flatnonzero(blocks[:, K.BLOCK_DONE] != K.FINE).tolist():
        answer = frame_told(tracker.step_anew, states[k], given, k, "Row")
        blocks[k] = answer._out[: K.N_BLOCK]
        blocks[k, K.BLOCK_POLYTOPE] = 0.0
        take_polytope(polytopes[k], answer)
        if answer._out[K.OUT_COUNTS + N.EVENTS] > K.KEPT_EVENTS:
            longer[k] = Proximity(tracker.a, tracker.b, answer._out, int(given.repaired[k]))
    bodies = tracker.a, tracker.b
    found = TrackerStates(bodies, blocks, polytopes, given.repaired, longer)
    return found, found.answers


def _made(tracker: Any, given: Frames, records: Any, workers: int) -> Frames:
    """Make all rows that the compiled frame makes; returns what was given, poses repaired where
    many were rounded."""
    n = len(given.steps)
    unchecked = [K.BAD_POSE_A, K.BAD_POSE_B]
    while True:

        def part(first: int, end: int, now: Frames = given) -> None:
            done = kernels.value_of_each(tracker.table.address, *now[:5], (first, end), records)
            if done != K.FINE:
                raise AssertionError(f"rows that were read are refused: {done}")

        in_parts(part, n, workers)
        told = records[2][:, K.BLOCK_DONE]
        bad = [why for why in unchecked if (told == why).any()]
        if not bad:
            return given
        unchecked.remove(bad[0])
        given = given.mended(bad[0], 0)
