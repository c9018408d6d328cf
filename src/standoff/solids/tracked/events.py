"""Local minima over many frames: each has a key, begins and ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.kernels.solids.minima_sets import SET_BRANCH, SET_SPOT
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.recording.local_minima import LocalMinima, MinimumEvent
from standoff.solids.answer import NearestPair, SolidProximity
from standoff.solids.spatial.solid_model import SolidModel
from standoff.tracking.branches import NONE, Birth, End
from standoff.typing import Array


def minima_of(
    solids: tuple[SolidModel, SolidModel],
    rows: Array,
    first: NDArray[np.int64],
    special: Mapping[int, SolidProximity],
    poses_a: Array,
) -> LocalMinima:
    """Of frames whose minima the kernel told, `rows` from `first[k]` on, and of others; `poses_a`
    are (n, 12), world."""
    frames = np.repeat(np.arange(len(first) - 1), np.diff(first))
    kept = np.array([int(k) not in special for k in frames], dtype=bool)
    rows, frames = rows[kept], frames[kept]
    turns, shifts = poses_a[frames, :9].reshape(-1, 3, 3), poses_a[frames, 9:]
    spots = [
        np.einsum("nij,nj->ni", turns, rows[:, o : o + 3]) + shifts
        for o in (SET_SPOT, SET_SPOT + 3)
    ]
    told = LocalMinima(
        frames,
        rows[:, SET_BRANCH].astype(np.int64),
        rows[:, 0].copy(),
        rows[:, BOUND] - sum(solid.slack for solid in solids),
        *spots,
        *(features_at(solid, rows[:, 1 + side]) for side, solid in enumerate(solids)),
    )
    others = [(k, m) for k in sorted(special) for m in special[k].minima]
    if not others:
        return told
    every = [np.concatenate(pair) for pair in zip(told, _of_pairs(others), strict=True)]
    order = np.argsort(every[0], kind="stable")
    return LocalMinima(*(each[order] for each in every))


def features_at(solid: SolidModel, leaves: Array) -> NDArray[np.object_]:
    """The features of leaves (m,), an object each; equal ones share theirs."""
    known, which = np.unique(leaves.astype(np.int64), return_inverse=True)
    return _objects([solid.feature_of(int(leaf)) for leaf in known])[which]


def _objects(items: Sequence[Any]) -> NDArray[np.object_]:
    found = np.empty(len(items), dtype=object)
    for k, item in enumerate(items):
        found[k] = item
    return found


def _of_pairs(others: Sequence[tuple[int, NearestPair]]) -> LocalMinima:
    pairs = [pair for _, pair in others]
    return LocalMinima(
        np.array([k for k, _ in others], dtype=np.int64),
        np.array([p.key for p in pairs], dtype=np.int64),
        np.array([p.distance for p in pairs]),
        np.array([p.lower_bound for p in pairs]),
        np.array([p.point_a for p in pairs]),
        np.array([p.point_b for p in pairs]),
        _objects([p.feature_a for p in pairs]),
        _objects([p.feature_b for p in pairs]),
    )


class _Live(NamedTuple):
    distance: float
    features: tuple[Feature, Feature]


class EventCourse(NamedTuple):
    """What events are told of.

    Attributes
    ----------
    minima : of all frames.
    motion : (n,) what no point of B has moved more than in each, as A sees it, length.
    length : below which minima are told.
    merged : of a frame and a key the key of the one whose place it has come to.
    """

    minima: LocalMinima
    motion: Array
    length: float
    merged: Mapping[tuple[int, int], int]


def events_of(course: EventCourse, before: SolidProximity) -> Iterator[MinimumEvent]:
    """What becomes of the minima, from the answer before the first frame on."""
    last = {
        m.key: _Live(m.distance, (m.feature_a, m.feature_b)) for m in before.minima if m.key != NONE
    }
    told, n = course.minima, len(course.motion)
    ends = np.searchsorted(told.frame, np.arange(n + 1))
    for k in range(n):
        now = {
            int(told.key[i]): _Live(
                float(told.distance[i]),
                (told.feature_a[i], told.feature_b[i]),
            )
            for i in range(int(ends[k]), int(ends[k + 1]))
            if told.key[i] != NONE
        }
        yield from _between(course, k, last, now)
        last = now


def _between(
    course: EventCourse, k: int, last: dict[int, _Live], now: dict[int, _Live]
) -> Iterator[MinimumEvent]:
    for key, was in last.items():
        if key not in now:
            reason, into = _why_ended(course, k, (key, was), now)
            yield MinimumEvent(k, "end", key, was.distance, was.features, reason, into)
    for key, (distance, features) in now.items():
        if key not in last:
            why = Birth.SEARCH if last else Birth.START
            yield MinimumEvent(k, "birth", key, distance, features, why)
        elif features != last[key].features:
            yield MinimumEvent(k, "switch", key, distance, features)
    nearest, earlier = next(iter(now), NONE), next(iter(last), NONE)
    if now and last and nearest != earlier:
        live = now[nearest]
        yield MinimumEvent(k, "handover", nearest, live.distance, live.features, other=earlier)


def _why_ended(
    course: EventCourse, k: int, last: tuple[int, _Live], now: dict[int, _Live]
) -> tuple[End, int]:
    key, was = last
    if not now:
        return End.MET, NONE
    motion = float(course.motion[k])
    if not was.distance + motion < course.length:
        return End.FAR, NONE
    into = course.merged.get((k, key), NONE)
    return (End.LEFT if into == NONE else End.MERGED), into
