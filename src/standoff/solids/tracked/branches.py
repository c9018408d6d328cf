"""Local minima over many frames: each a branch with a number, which begins and ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.features import Feature
from standoff.kernels.solids.minima_sets import SET_BRANCH, SET_SPOT
from standoff.kernels.solids.spatial_progress import BOUND
from standoff.solids.answer import NearestPair, SolidProximity
from standoff.solids.spatial.solid_model import SolidModel

Array = NDArray[np.float64]
Kind = Literal["birth", "end", "switch", "handover"]


class Branches(NamedTuple):
    """All local minima of many frames, a row each, frame after frame, the nearest first.

    Attributes
    ----------
    frame : (m,) array of int
    branch : (m,) array of int
        The number that a minimum keeps while it lives; -1 of a frame in which the solids meet.
    distance, lower_bound : (m,) arrays
        As in `NearestPair`.
    point_a, point_b : (m, 3) arrays
        World axes.
    feature_a, feature_b : (m,) arrays of Feature
    """

    frame: NDArray[np.int64]
    branch: NDArray[np.int64]
    distance: Array
    lower_bound: Array
    point_a: Array
    point_b: Array
    feature_a: NDArray[np.object_]
    feature_b: NDArray[np.object_]


class BranchEvent(NamedTuple):
    """What becomes of a branch from one frame to the next.

    Attributes
    ----------
    frame : int
        The first in which it is so.
    kind : "birth", "end", "switch", "handover"
        It comes up; it is gone, or is farther than is asked; it goes to another face, edge or
        vertex; or it is the nearest from now on.
    branch : int
    distance : float
        In that frame; of one that ends in the frame before.
    features : (Feature, Feature)
        The same.
    before : int
        Of a handover the branch that was the nearest; else -1.
    """

    frame: int
    kind: Kind
    branch: int
    distance: float
    features: tuple[Feature, Feature]
    before: int = -1


def branches_of(
    solids: tuple[SolidModel, SolidModel],
    rows: Array,
    first: NDArray[np.int64],
    special: Mapping[int, SolidProximity],
    poses_a: Array,
    slack: float,
) -> Branches:
    """Of frames whose minima the kernel told, `rows` from `first[k]` on, and of others; `poses_a`
    are (n, 12), world."""
    n = len(first) - 1
    frames = np.repeat(np.arange(n), np.diff(first))
    kept = np.array([int(k) not in special for k in frames], dtype=bool)
    rows, frames = rows[kept], frames[kept]
    turns, shifts = poses_a[frames, :9].reshape(-1, 3, 3), poses_a[frames, 9:]
    spots = [
        np.einsum("nij,nj->ni", turns, rows[:, o : o + 3]) + shifts
        for o in (SET_SPOT, SET_SPOT + 3)
    ]
    told = Branches(
        frames,
        rows[:, SET_BRANCH].astype(np.int64),
        rows[:, 0].copy(),
        rows[:, BOUND] - slack,
        *spots,
        *(_features(solid, rows[:, 1 + side]) for side, solid in enumerate(solids)),
    )
    others = [(k, m) for k in sorted(special) for m in special[k].minima]
    if not others:
        return told
    every = [np.concatenate(pair) for pair in zip(told, _of_pairs(others), strict=True)]
    order = np.argsort(every[0], kind="stable")
    return Branches(*(each[order] for each in every))


def _features(solid: SolidModel, leaves: Array) -> NDArray[np.object_]:
    known, which = np.unique(leaves.astype(np.int64), return_inverse=True)
    return _objects([solid.feature_of(int(leaf)) for leaf in known])[which]


def _objects(items: Sequence[Any]) -> NDArray[np.object_]:
    found = np.empty(len(items), dtype=object)
    for k, item in enumerate(items):
        found[k] = item
    return found


def _of_pairs(others: Sequence[tuple[int, NearestPair]]) -> Branches:
    pairs = [pair for _, pair in others]
    return Branches(
        np.array([k for k, _ in others], dtype=np.int64),
        np.array([p.branch for p in pairs], dtype=np.int64),
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


def events_of(branches: Branches, n: int, before: SolidProximity) -> Iterator[BranchEvent]:
    """What becomes of the branches over `n` frames, from the answer before the first on."""
    last = {
        m.branch: _Live(m.distance, (m.feature_a, m.feature_b))
        for m in before.minima
        if m.branch >= 0
    }
    ends = np.searchsorted(branches.frame, np.arange(n + 1))
    for k in range(n):
        rows = range(int(ends[k]), int(ends[k + 1]))
        now = {
            int(branches.branch[i]): _Live(
                float(branches.distance[i]), (branches.feature_a[i], branches.feature_b[i])
            )
            for i in rows
            if branches.branch[i] >= 0
        }
        yield from _between(k, last, now)
        last = now


def _between(k: int, last: dict[int, _Live], now: dict[int, _Live]) -> Iterator[BranchEvent]:
    for branch, (distance, features) in last.items():
        if branch not in now:
            yield BranchEvent(k, "end", branch, distance, features)
    for branch, (distance, features) in now.items():
        if branch not in last:
            yield BranchEvent(k, "birth", branch, distance, features)
        elif features != last[branch].features:
            yield BranchEvent(k, "switch", branch, distance, features)
    nearest, was = next(iter(now), -1), next(iter(last), -1)
    if now and last and nearest != was:
        yield BranchEvent(k, "handover", nearest, *now[nearest], was)
