"""One start after another by one law: whether each arrives, and the cause if it does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature, feature_of
from standoff.kernels.pair import events as N
from standoff.kernels.state import arrays as K
from standoff.motion import Fixed, Path, Pose
from standoff.recording import track
from standoff.recording.times import even_times
from standoff.tracking import Tracker, pair_system
from standoff.tracking.calls import run
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff_studies.paper.convergence.pairs import Pair
from standoff_studies.paper.many_starts import LEFT, begun, motion_along
from standoff_studies.paper.pair_simulation import REST

STEP = 1e-3
"""Sample time [s]: the paper's 1 kHz."""

PATIENCE = 15.0
"""Time in units of 1/K after which a start counts as not having arrived: exp(-15) is 3e-7."""

LEAST_FRAMES = 20
"""Frames added to it: a start may have to cross several features, one per frame."""

STAYED = 2.0
"""Time in units of 1/K, plus `LEAST_FRAMES`, for which it must stay at the true distance."""

ARRIVED = 1e-4
"""Greatest error of the distance of a start that arrived [length]; the bodies are of size 2."""

MORE = 4
"""Extra time, as a multiple of the patience, for a start that still moves, with bodies at rest."""

STILL = 5
"""Frames in which nothing changes, after which nothing ever will while the bodies are at rest."""

CAUSES = {
    "late": "arrives later, with the bodies at rest",
    "pinned": "held at a side by the zeroing, errors left, printed M indefinite",
    "held": "held at a side by the zeroing, errors left, printed M definite",
    "stationary": "errors gone, but not at the closest points",
    "other": "errors left, at no side",
}
"""Why a start did not arrive."""


class End(NamedTuple):
    """Where a start that did not arrive ended.

    Attributes
    ----------
    cause : str
        A key of `CAUSES`.
    placed : bool
        On the features of the closest points?
    feature_a, feature_b : str
    parameters : tuple of float
    error : float
        Of the distance [length].
    psi : float
        |Psi| [length²].
    least : float
        The least eigenvalue of the printed H; nan on two vertices.
    zeroed : int
        Components that the last frame zeroed.
    """

    cause: str
    placed: bool
    feature_a: str
    feature_b: str
    parameters: tuple[float, ...]
    error: float
    psi: float
    least: float
    zeroed: int


class Outcome(NamedTuple):
    """The result of one start.

    Attributes
    ----------
    time : float
        When it arrived for good [s]; nan if it did not.
    right : bool
        On the features of the closest points after the first frame?
    settled : bool
        The same at the end.
    definite : bool
        On the right features after the first frame, with the printed H definite there?
    end : End or None
        Of a start that did not arrive.
    """

    time: float
    right: bool
    settled: bool
    definite: bool
    end: End | None


@dataclass(frozen=True, eq=False)
class Trial:
    """A law, a pair and a motion, from which starts are tried.

    Attributes
    ----------
    pair : Pair
    path : Path
        Of B.
    law : PaperLaw
        Without restarts, with a gain.
    tracker : Tracker
    motion, rest : ndarray
        Poses and twists, a row a frame: of the trial, and of the bodies at rest where it ends.
    due : ndarray, shape (frames,)
        The true distance after each frame [length].
    features : ndarray of Feature, shape (frames, 2)
        Those of the closest points.
    """

    pair: Pair
    path: Path
    law: PaperLaw
    tracker: Tracker
    motion: Array
    rest: Array
    due: Array
    features: NDArray[np.object_]

    @property
    def still(self) -> bool:
        """Are the bodies at rest?"""
        return isinstance(self.path, Fixed)


def frames_of(gain: float) -> int:
    """Return how many frames a start is given."""
    return round(PATIENCE / gain / STEP) + LEAST_FRAMES


def trial(pair: Pair, motion: str, law: PaperLaw) -> Trial:
    """Prepare a trial."""
    assert law.gain is not None
    n, path = frames_of(law.gain), pair.path_of(motion)
    exact = track(Tracker(pair.a, pair.b, STEP), REST, path, n * STEP)
    last = Fixed(path.pose(n * STEP))
    return Trial(
        pair,
        path,
        law,
        Tracker(pair.a, pair.b, STEP, law=law),
        motion_along(REST, path, even_times(0.0, n * STEP, STEP)),
        motion_along(REST, last, even_times(0.0, MORE * n * STEP, STEP)),
        exact.distance[1:],
        np.column_stack([exact.feature_a[1:], exact.feature_b[1:]]),
    )


def outcome(tried: Trial, place_a: Any, place_b: Any) -> Outcome:
    """Start the law at a place of each body, and follow it."""
    state = begun(tried.tracker, (REST, tried.path), place_a, place_b).data.copy()
    answers, time = _followed(tried, state)
    first, last = answers[0], answers[-1]
    right = _features(tried, first) == tuple(tried.features[0])
    settled = _features(tried, last) == tuple(tried.features[len(answers) - 1])
    definite = right and _system(tried, first, tried.motion[0])[1] > 0.0
    end = None if np.isfinite(time) else _end(tried, state, answers, settled)
    return Outcome(time, right, settled, definite, end)


def _run(tried: Trial, rows: Array, state: Array) -> Array:
    """Follow some rows of motion; a frame that the law rejects is nan, and all after it."""
    return run(tried.tracker.table, rows, True, np.full(len(rows), STEP), state).rows


def _followed(tried: Trial, state: Array) -> tuple[Array, float]:
    """The answers, and the time of arrival: until it has stayed, or stands still, or time is up."""
    assert tried.law.gain is not None
    rows, n = tried.motion, len(tried.due)
    stay = round(STAYED / tried.law.gain / STEP) + LEAST_FRAMES
    length, answers = max(LEAST_FRAMES, n // 12), np.empty((0, K.N_OUT))
    while len(answers) < n:
        more = _run(tried, rows[len(answers) : len(answers) + length], state)
        answers = np.vstack([answers, more])
        off = ~(np.abs(answers[:, K.DISTANCE] - tried.due[: len(answers)]) < ARRIVED)
        since = len(answers) - int(off[::-1].argmax()) if off.any() else 0
        over = len(answers) >= n or (tried.still and _stands(answers))
        if len(answers) - since >= (1 if over else stay):
            return answers, (since + 1) * STEP
        if over:
            break
    return answers, np.nan


def _stands(answers: Array) -> bool:
    """Has nothing changed for some frames?"""
    held = answers[-STILL:, K.OUT_MODE : K.OUT_Q + 4]
    return bool((held == held[0]).all())


def _features(tried: Trial, answer: Array) -> tuple[Feature, Feature]:
    a, b = answer[[K.OUT_MODE, K.OUT_MODE + 2]].astype(int).tolist()
    return feature_of(tried.pair.a, a), feature_of(tried.pair.b, b)


def _places(tried: Trial, answer: Array) -> list[tuple[Feature, tuple[float, ...]]]:
    """Where an answer's witness points are; on an atlas with the number of the chart."""
    places = []
    for k, (feature, body) in enumerate(
        zip(_features(tried, answer), (tried.pair.a, tried.pair.b), strict=True)
    ):
        count = {"face": 2, "edge": 1, "vertex": 0}[feature.kind]
        at = answer[K.OUT_Q + 2 * k : K.OUT_Q + 2 * k + count].tolist()
        if feature.kind == "edge":  # roundoff may have taken it past an end
            curve = body.edge_parts[feature.index].curve
            at = [min(max(at[0], curve.first), curve.last)]
        assert feature.kind != "face" or len(body.face_parts[feature.index].charts) == 1
        places.append((feature, tuple(at)))
    return places


def _system(tried: Trial, answer: Array, row: Array) -> tuple[float, float]:
    """(|Psi|, the least eigenvalue of the printed H) at an answer."""
    pose = Pose(row[12:21].reshape(3, 3), row[21:24])
    place_a, place_b = _places(tried, answer)
    system = pair_system(tried.pair.a, tried.pair.b, Pose.identity(), pose, place_a, place_b)
    if not system.H.size:
        return 0.0, np.nan
    return float(np.linalg.norm(system.Psi)), float(np.linalg.eigvalsh(system.H)[0])


def _end(tried: Trial, state: Array, answers: Array, settled: bool) -> End:
    """Trace a start that did not arrive."""
    last = answers[-1]
    row = tried.motion[len(answers) - 1]
    if not np.isfinite(last[K.DISTANCE]):
        return End("other", False, "", "", (), np.nan, np.nan, np.nan, 0)
    psi, least = _system(tried, last, row)
    zeroed = int(last[K.OUT_COUNTS + N.SATURATIONS])
    error = float(last[K.DISTANCE] - tried.due[len(answers) - 1])
    if not _stands(answers) and _is_late(tried, state):
        cause = "late"
    elif psi <= LEFT:
        cause = "stationary"
    elif zeroed:
        cause = "pinned" if least < 0.0 else "held"
    else:
        cause = "other"
    places = _places(tried, last)
    at = tuple(x for _, own in places for x in own)
    a, b = (str(feature) for feature, _ in places)
    return End(cause, settled, a, b, at, error, psi, least, zeroed)


def _is_late(tried: Trial, state: Array) -> bool:
    """Does it arrive after all, with the bodies at rest where the motion ends?"""
    rows, due = tried.rest, tried.due[-1]
    answers, n = np.empty((0, K.N_OUT)), len(tried.due)
    for k in range(MORE):
        answers = _run(tried, rows[k * n : (k + 1) * n], state)
        if abs(answers[-1, K.DISTANCE] - due) < ARRIVED:
            return True
        if _stands(answers):
            break
    return False
