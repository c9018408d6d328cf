"""One pair of the soak: all frames in a compiled loop, then the checks, and some cold queries."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.kernels.entries import tracker as kernels
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.tracking import calls
from standoff.tracking.block import FrameBlock
from standoff.tracking.laws import PaperLaw
from standoff.tracking.status import Status
from standoff.tracking.tracker import Tracker
from standoff.typing import Array
from standoff_studies.soak.cases import Case
from standoff_studies.soak.checks import (
    GLOBAL,
    LOCAL,
    PROVEN,
    ROUNDOFF,
    Fault,
    Judged,
    apart_of,
    deep_of,
    judge,
    search,
)
from standoff_studies.soak.motions import Frames
from standoff_studies.soak.shapes import Made
from standoff_studies.soak.tally import Tally

Numbers = NDArray[np.int64]

COLD_EVERY = 100
"""Every how many frames a cold query is made too: it takes as long as dozens of frames."""

SEARCH_EVERY = 40
"""Every how many frames in penetration the depth is searched for."""

COUNTED = {
    "evaluations": N.EVALUATIONS,
    "corrections": N.CORRECTIONS,
    "switches": N.EVENTS,
}
"""Counts of a step of which the greatest is kept."""


class Failure(NamedTuple):
    """A failed check, and its context.

    Attributes
    ----------
    case : Case
    fault : Fault
        ``frame`` is the frame's number.
    cold : bool
        Was it the answer of a cold query?
    """

    case: Case
    fault: Fault
    cold: bool


class Answers(NamedTuple):
    """The tracker's answers: one row per frame, and the frame that it rejected (-1: none)."""

    rows: Array
    refused: int


def run_case(case: Case, a: Made, b: Made, frames: Frames) -> tuple[Tally, Failure | None]:
    """Track a case, check every answer, and count.

    Returns
    -------
    (Tally, Failure or None)
        The failure is the one of the earliest frame.
    """
    tracker = Tracker(a.body, b.body, case.motion.step, case.law)
    answers = track(tracker, frames, case.motion.twists)
    tally = Tally()
    if answers.refused >= 0:
        fault = Fault(answers.refused, "the frame was refused", 1.0, 0.0)
        return tally, Failure(case, fault, cold=False)
    tolerance = tracker.law.tolerance
    judged = judge(a, b, frames, answers.rows, tolerance, case.motion.twists)
    count(tally, case, answers.rows, judged)
    looked = _to_search(answers.rows)
    tally.count("depths searched for", len(looked))
    faults = judged.faults + search(a, b, frames, answers.rows, judged, looked)
    numbers = np.arange(case.number % COLD_EVERY, case.frames, COLD_EVERY)
    cold_faults = compare(tally, tracker, a, b, frames, answers.rows, judged, numbers)
    found = [Failure(case, fault, cold=False) for fault in faults]
    found += [Failure(case, fault, cold=True) for fault in cold_faults]
    return tally, min(found, key=lambda failure: failure.fault.frame, default=None)


def track(tracker: Tracker, frames: Frames, has_twist: bool) -> Answers:
    """Answer all frames: the first from a global start, the others in one compiled loop."""
    rows = np.empty((len(frames.steps), K.N_OUT))
    state = np.zeros(K.N_STATE)
    if start(tracker, frames, 0, has_twist, state, rows[0]) != K.FINE:
        return Answers(rows, 0)
    rest = frames.part(slice(1, None))
    rows[1:], refused = calls.run(tracker.table, rest.motions, has_twist, rest.steps, state)
    return Answers(rows, refused + 1 if refused >= 0 else -1)


def start(
    tracker: Tracker, frames: Frames, k: int, has_twist: bool, state: Array, row: Array
) -> int:
    """Answer frame k from a global start, into `state` and `row`; return FINE, or what was
    rejected."""
    block = FrameBlock.empty(state, frames.part(slice(k, k + 1)).motions[0], 0.0, has_twist)
    done = int(kernels.start(tracker.table.address, block.data, K.START_ANYWHERE))
    state[:], row[:] = block.state, block.out
    return done


def _to_search(rows: Array) -> Numbers:
    deep = np.flatnonzero(deep_of(rows[:, K.STATUS]))
    return np.asarray(deep[::SEARCH_EVERY])


def count(tally: Tally, case: Case, rows: Array, judged: Judged) -> None:
    """Count a pair's frames by status, restarts and searches, and keep the worst numbers."""
    status = rows[:, K.STATUS].astype(int)
    tally.count("pairs", 1)
    tally.count("frames", len(rows))
    for one in Status:
        tally.count(one.name, (status == one.value).sum())
    apart, deep = apart_of(status), deep_of(status)
    tally.count("certified", (apart | (status == GLOBAL)).sum())
    counts = rows[:, K.OUT_COUNTS :]
    open_ = (status == LOCAL) & (rows[:, K.DISTANCE] > ROUNDOFF * judged.size)
    tally.count("LOCAL at a positive distance", open_.sum())
    tally.count("restarted", (counts[1:, N.RESTARTS] > 0.0).sum())
    tally.count("searched", (counts[1:, N.SEARCHES] > 0.0).sum())
    for name, column in COUNTED.items():
        tally.note(f"{name} in a step", counts[:, column].max())
    if deep.any():
        tally.note("unrest of a depth, over what the tolerance allows", judged.unrest.max())
        tally.count("depths not at rest", (judged.unrest > 1.0).sum())
        tally.note("depth over size", (-rows[deep, K.DISTANCE] / judged.size[deep]).max())
    if apart.any():
        short = (rows[apart, K.DISTANCE] - judged.separation[apart]) / judged.size[apart]
        tally.note("distance above what the normal separates, over size", short.max())
    doubtful = np.flatnonzero(~apart & ~deep & (status != Status.TRACKING.value))
    if len(doubtful):
        names = " - ".join(sorted((case.a.kind, case.b.kind)))
        tally.count(f"uncertified: {names}", len(doubtful))
        k = int(doubtful[0])
        tally.examples.append(
            [case.number, k, Status(status[k]).name, names, _number(rows[k, K.DISTANCE])]
        )


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def compare(
    tally: Tally,
    tracker: Tracker,
    a: Made,
    b: Made,
    frames: Frames,
    rows: Array,
    judged: Judged,
    numbers: Numbers,
) -> list[Fault]:
    """Query some frames cold; the answers must pass the same checks and agree with tracked ones."""
    cold = np.empty((len(numbers), K.N_OUT))
    cold_tracker = Tracker(tracker.a, tracker.b) if isinstance(tracker.law, PaperLaw) else tracker
    for row, k in zip(cold, numbers.tolist(), strict=True):
        if start(cold_tracker, frames, k, False, np.zeros(K.N_STATE), row) != K.FINE:
            return [Fault(k, "the frame was refused", 1.0, 0.0)]
    some = frames.part(numbers)
    tolerance = cold_tracker.law.tolerance
    alone = judge(a, b, some, cold, tolerance, twists=False)
    status = cold[:, K.STATUS].astype(int)
    tally.count("cold queries", len(numbers))
    tally.count("cold certified", (apart_of(status) | (status == GLOBAL)).sum())
    tally.note("evaluations in a cold query", cold[:, K.OUT_COUNTS + N.EVALUATIONS].max(initial=0))
    # the same for the tracked answers: for the paper's law another tracker makes cold queries
    either = max(tolerance, tracker.law.tolerance)
    faults = alone.faults + _differing(tally, rows[numbers], cold, alone, either)
    return [fault._replace(frame=int(numbers[fault.frame])) for fault in faults]


def _differing(
    tally: Tally, warm: Array, cold: Array, judged: Judged, tolerance: float
) -> list[Fault]:
    """Return where tracked and cold answers contradict each other."""
    opposed = deep_of(cold[:, K.STATUS]) & apart_of(warm[:, K.STATUS])
    opposed |= apart_of(cold[:, K.STATUS]) & deep_of(warm[:, K.STATUS])
    gap = np.where(opposed, np.abs(cold[:, K.DISTANCE] - warm[:, K.DISTANCE]), 0.0)
    limit = (tolerance + ROUNDOFF) * judged.size
    faults = _first("apart or not: cold and tracked differ", gap, limit)
    both = deep_of(cold[:, K.STATUS]) & deep_of(warm[:, K.STATUS])
    deeper = np.where(both, cold[:, K.DISTANCE] - warm[:, K.DISTANCE], 0.0)
    limit = PROVEN * np.abs(np.minimum(cold[:, K.DISTANCE], warm[:, K.DISTANCE])) + limit
    proven = np.where(warm[:, K.STATUS] == GLOBAL, deeper, 0.0)
    faults += _first("GLOBAL, but a cold query has a lesser depth", proven, limit)
    proven = np.where(cold[:, K.STATUS] == GLOBAL, -deeper, 0.0)
    faults += _first("a cold GLOBAL, but the tracked depth is less", proven, limit)
    local = warm[:, K.STATUS] == LOCAL
    tally.count("LOCAL compared with cold", (both & local).sum())
    tally.count("LOCAL deeper than cold", (local & (deeper > limit)).sum())
    return faults


def _first(what: str, value: Array, limit: Array) -> list[Fault]:
    wrong = value > limit
    k = int(wrong.argmax()) if len(wrong) else 0
    return [Fault(k, what, float(value[k]), float(limit[k]))] if wrong.any() else []
