"""Comparison of one answer with the truth."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from math import isfinite, nan
from typing import Any

import numpy as np

from standoff.tracking import Status, distance
from standoff_studies.accuracy.cases import Case, catalogue, draw_cases, pairs
from standoff_studies.accuracy.least_depth import least_depth
from standoff_studies.accuracy.peers.answer import NOTHING, Peer, PeerAnswer, Pose
from standoff_studies.accuracy.solids import Kind
from standoff_studies.accuracy.truth import support_sum
from standoff_studies.oracles import Array

WRONG = 1e-6
"""An answer whose error of distance is greater, over the size, counts as wrong."""
ELSEWHERE = 0.05
"""Angle (rad) from the true normal beyond which a depth is that of another minimum."""
BOUND_SLACK = 1e-12
"""By how much a lower bound may be above the truth, over the size: roundoff."""
SEARCHED_SLACK = 1e-7
"""The same if the truth is a depth found by search, known to 1e-8."""
SHALLOWER = 1e-11
"""A depth below the constructed one by more than this, over the size, is not roundoff."""
PROVEN = 1e-3
"""What GLOBAL promises: no depth is less than (1 - this) of the reported one."""
OURS = "Standoff"


class Verdict(StrEnum):
    """How good an answer is."""

    RIGHT = "right"
    OTHER = "other minimum"  # right, at another minimum, no deeper than the constructed one
    DEEPER = "not least"  # a true depth along its normal, although a smaller one exists
    WRONG = "wrong"
    NOTHING = "no answer"


@dataclass(frozen=True)
class Row:
    """One answer: a row of the Parquet file. Errors are over the size, normals in rad.

    ``pose_a`` and ``pose_b`` are 12 numbers each, R row-major and p; ``body_a`` and ``body_b``
    the Python expressions that build the bodies after ``import standoff as so``. ``constructed``
    says whether the constructed answer is the least depth. Points and normals are in world axes.
    Errors are NaN if the answer is that of another minimum. docs/accuracy.md explains each column.
    """

    engine: str
    shape_1: str
    shape_2: str
    level: float
    case: int
    size: float
    contact: str
    stiffness: float
    constructed: bool
    truth: float
    distance: float
    distance_error: float
    witness_error: float
    normal_error: float
    verdict: str
    status: str
    certified: bool | None
    lower_bound: float
    shape_a: str
    shape_b: str
    body_a: str
    body_b: str
    pose_a: list[float]
    pose_b: list[float]
    true_point_a: list[float]
    true_point_b: list[float]
    true_normal: list[float]
    point_a: list[float]
    point_b: list[float]
    normal: list[float]


@dataclass(frozen=True)
class OwnAnswer(PeerAnswer):
    """Standoff's answer with what it claims: status, certificate, lower bound (length)."""

    status: Status
    certified: bool
    lower_bound: float


def own_answer(case: Case) -> OwnAnswer:
    """Return Standoff's cold answer."""
    truth = case.truth
    found = distance(case.a.body, case.b.body, truth.pose_a, truth.pose_b)
    return OwnAnswer(
        found.distance,
        found.point_a,
        found.point_b,
        found.normal,
        found.status,
        found.certified,
        found.lower_bound,
    )


def errors(case: Case, answer: PeerAnswer) -> tuple[float, float, float]:
    """Return the errors of distance and witness points, over the size, and of the normal, rad."""
    truth = case.truth
    witness = max(
        float(np.linalg.norm(answer.point_a - truth.point_a)),
        float(np.linalg.norm(answer.point_b - truth.point_b)),
    )
    # by the chord: the arc cosine of a product cannot resolve angles below 1e-8
    chord = float(np.linalg.norm(answer.normal - truth.normal))
    turn = 2 * float(np.arcsin(min(1.0, chord / 2))) if isfinite(chord) else nan
    return abs(answer.distance - truth.distance) / case.size, witness / case.size, turn


def judge(case: Case, answer: PeerAnswer) -> Verdict:
    """Judge one answer by its distance, and by its normal if it is that of another minimum.

    Our own answer is also wrong if its lower bound is above the truth, or if it claims the least
    depth, to within `PROVEN`, and is not.
    """
    if isinstance(answer, OwnAnswer) and not bounded_rightly(case, answer):
        return Verdict.WRONG
    claims_least = isinstance(answer, OwnAnswer) and answer.certified
    slack = WRONG * case.size
    if not isfinite(answer.distance):
        return Verdict.NOTHING
    close = abs(answer.distance - case.truth.distance) <= slack
    if case.level > 0 or (case.constructed and close):
        return Verdict.RIGHT if close and answer.distance * case.level > 0 else Verdict.WRONG
    # a reported normal says which minimum is meant; without one any true depth is accepted
    if not close and np.isfinite(answer.normal).all() and not is_elsewhere(case, answer):
        return Verdict.WRONG
    depth, least = -answer.distance, case.least
    if depth < least - slack:
        least = least_depth(case.a, case.b, case.truth, case.size)[1]
    if depth < least - slack:
        return Verdict.WRONG
    if depth <= least + slack:
        return Verdict.OTHER
    allowed = least * (1 + 2 * PROVEN) + slack
    return Verdict.WRONG if claims_least and depth > allowed else Verdict.DEEPER


def bounded_rightly(case: Case, answer: OwnAnswer) -> bool:
    """Is the certified lower bound not above the true distance?

    The depth along the reported normal is a true depth, so it must not be below the bound either.
    """
    truth = case.truth.distance if case.constructed else -case.least
    if case.level < 0 and case.a.bounded and case.b.bounded:
        along = float(support_sum(case.a, case.b, case.truth, answer.normal[None])[0])
        truth = max(truth, -along)
    slack = BOUND_SLACK if case.constructed else SEARCHED_SLACK
    return not answer.lower_bound > truth + slack * case.size


def is_elsewhere(case: Case, answer: PeerAnswer) -> bool:
    """Is a depth that of another stationary point, with a different normal and a true depth?

    Near the focal depth two minima may be close together; a true depth below the constructed one
    belongs to another minimum, however close.
    """
    if case.level > 0 or not (case.a.bounded and case.b.bounded):
        return False
    along = float(support_sum(case.a, case.b, case.truth, answer.normal[None])[0])
    off = abs(along + answer.distance) / case.size
    less = (answer.distance - case.truth.distance) / case.size
    if less > SHALLOWER and off <= SHALLOWER:
        return True
    return errors(case, answer)[2] > ELSEWHERE and off <= WRONG


def _numbers(pose: Pose) -> list[float]:
    return [float(x) for x in (*np.ravel(pose[0]), *np.ravel(pose[1]))]


def _vector(vector: Array) -> list[float]:
    return [float(x) for x in vector]


def _claims(answer: PeerAnswer) -> tuple[str, bool | None, float]:
    if isinstance(answer, OwnAnswer):
        return answer.status.name, answer.certified, answer.lower_bound
    return "", None, nan


def _row(case: Case, engine: str, answer: PeerAnswer) -> Row:
    verdict = judge(case, answer)
    compared = verdict is not Verdict.NOTHING and not is_elsewhere(case, answer)
    found = errors(case, answer) if compared else (nan, nan, nan)
    truth = case.truth
    status, certified, lower_bound = _claims(answer)
    return Row(
        engine,
        *case.kinds,
        case.level,
        case.number,
        case.size,
        truth.contact,
        truth.stiffness,
        case.constructed,
        truth.distance,
        answer.distance,
        *found,
        str(verdict),
        status,
        certified,
        lower_bound,
        case.a.kind.name,
        case.b.kind.name,
        case.a.call,
        case.b.call,
        _numbers(truth.pose_a),
        _numbers(truth.pose_b),
        *map(_vector, (truth.point_a, truth.point_b, truth.normal)),
        *map(_vector, (answer.point_a, answer.point_b, answer.normal)),
    )


def measure_case(case: Case) -> Row:
    """Query Standoff."""
    return _row(case, OURS, own_answer(case))


def measure_peer(case: Case, peer: Peer) -> Row | None:
    """Query a peer; None if it does not support the pair."""
    if case.level < 0 and not peer.overlaps:
        return None
    query = peer.query(case.a, case.b)
    if query is None:
        return None
    try:
        answer = query(case.truth.pose_a, case.truth.pose_b)
    except (RuntimeError, ValueError, ArithmeticError):
        answer = NOTHING
    return _row(case, peer.name, answer)


Tell = Callable[[str], None]


def measure(
    kinds: Sequence[Kind],
    count: int,
    seed: int,
    peers: Sequence[Peer] = (),
    tell: Tell = lambda pair: None,
) -> Iterator[Row]:
    """Measure all pairs of some kinds, ``count`` cases at each gap and depth.

    Parameters
    ----------
    tell : called with the name of each pair before it is measured.
    """
    solids = catalogue(kinds, seed)
    for pair in pairs(kinds):
        tell(f"{pair[0].name} – {pair[1].name}")
        for case in draw_cases(pair, solids, count, seed):
            yield measure_case(case)
            for peer in peers:
                row = measure_peer(case, peer)
                if row is not None:
                    yield row


def columns(rows: Sequence[Row]) -> dict[str, list[Any]]:
    """Return the rows by columns."""
    records = [asdict(row) for row in rows]
    return {name: [record[name] for record in records] for name in Row.__annotations__}
