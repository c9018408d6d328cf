"""All pairs of many bodies judged by themselves, without a world: balls, planes, cold queries.

The balls and support functions are the oracles' own, and their neighbours are found by SciPy's
k-d tree: nothing is taken from the boxes of the library. A pair whose balls are beyond the horizon,
or that a plane across the line of its centres parts by more, is beyond it; every other pair is
asked by a cold query. Frames are judged in blocks, since a call costs more than a query.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import standoff as so
from standoff.typing import Array
from standoff_studies.oracles import lengths
from standoff_studies.soak.checks import PROVEN, ROUNDOFF
from standoff_studies.soak.placing import heights
from standoff_studies.soak.shapes import Made
from standoff_studies.soak.world_truth import Extent, extent_of

Ints = NDArray[np.int64]

AGREED = 1e-9
"""How far two certified distances of bodies of size 1 may be from each other, length."""


class Told(NamedTuple):
    """What a world said of a frame of n bodies.

    Attributes
    ----------
    kinds : (n,) array
        The kind of each body.
    poses : (n, 4, 4) array
    within, clearance : float
    listed : (k, 2) array
        The pairs that it listed, of each the lesser number first.
    distance, lower : (k,) arrays
        Of these.
    table : (t, 2) array
        All pairs that it had a bound of, near or not.
    bounds : (t,) array
        These.
    """

    kinds: Ints
    poses: Array
    within: float
    clearance: float
    listed: Ints
    distance: Array
    lower: Array
    table: Ints
    bounds: Array


class Verdict(NamedTuple):
    """Counts over frames: near pairs, cold queries, and what was wrong."""

    frames: int = 0
    pairs: int = 0
    near: int = 0
    asked: int = 0
    missed: int = 0
    wrong: int = 0
    above: int = 0

    @property
    def sound(self) -> bool:
        return not (self.missed or self.wrong or self.above)

    def plus(self, other: Verdict) -> Verdict:
        return Verdict(*(a + b for a, b in zip(self, other, strict=True)))

    def __str__(self) -> str:
        return (
            f"{self.frames} frames, {self.pairs:,} pair-frames, {self.near:,} near, {self.asked:,} "
            f"asked; {self.missed} missed, {self.wrong} wrong, clearance {self.above} times above "
            "the truth"
        )


class _Pairs(NamedTuple):
    """Pairs of bodies of a block's frames: rows of all its poses, and keys that sort them."""

    frame: Ints
    a: Ints
    b: Ints
    key: Ints


class _Found(NamedTuple):
    """What is known of a block: its close pairs, those that were listed, where these stand among
    the close ones and whether they do; of close ones the distance where it was asked, an upper
    bound, and whether it was asked; what roundoff may do to a length."""

    close: _Pairs
    listed: _Pairs
    at: Ints
    there: NDArray[np.bool_]
    true: Array
    upper: Array
    asked: NDArray[np.bool_]
    noise: float


class Judge:
    """Judges frames of bodies of some kinds.

    Parameters
    ----------
    kinds : sequence of Made
    """

    def __init__(self, kinds: Sequence[Made]) -> None:
        self.kinds = list(kinds)
        self.extents: list[Extent] = [extent_of(made.support) for made in kinds]

    def verdict(self, block: Sequence[Told]) -> Verdict:
        """Judge all pairs of some frames."""
        counts = [len(told.kinds) for told in block]
        first = np.concatenate([[0], np.cumsum(counts)])
        kind = np.concatenate([told.kinds for told in block])
        poses = np.concatenate([_flat(told.poses) for told in block])
        within = np.array([told.within for told in block])
        centres, radii = self._balls(kind, poses)
        most = max(counts)
        close = [
            _neighbours(centres[f:end], radii[f:end], told.within)
            for f, end, told in zip(first, first[1:], block, strict=False)
        ]
        pairs = _pairs(close, first, most)
        lower, upper = self._parted(kind, poses, centres, pairs)
        listed = _pairs([told.listed for told in block], first, most)
        at, there = _positions(pairs.key, listed.key)
        noise = ROUNDOFF * 4.0 * (float(np.abs(poses[:, 9:]).max()) + float(radii.max()))
        doubtful = lower <= within[pairs.frame] + noise
        doubtful[at[there]] = True
        rows = np.flatnonzero(doubtful)
        true = np.full(len(pairs.key), np.nan)
        true[rows] = self._asked(kind, poses, pairs, rows, upper)
        found = _Found(pairs, listed, at, there, true, upper, doubtful, noise)
        return _compared(block, found, first, most)

    def _balls(self, kind: Ints, poses: Array) -> tuple[Array, Array]:
        """The centres, world, and radii of balls that hold the bodies."""
        local = np.array([extent.centre for extent in self.extents])[kind]
        turns = poses[:, :9].reshape(-1, 3, 3)
        centres = np.einsum("nij,nj->ni", turns, local) + poses[:, 9:]
        return centres, np.array([extent.radius for extent in self.extents])[kind]

    def _parted(
        self, kind: Ints, poses: Array, centres: Array, pairs: _Pairs
    ) -> tuple[Array, Array]:
        """Bounds of the distances, by the farthest points along the lines of the centres."""
        away = centres[pairs.b] - centres[pairs.a]
        n = away / np.maximum(lengths(away), np.finfo(float).tiny)[:, None]
        reach, ends = np.zeros(len(n)), np.zeros((2, len(n), 3))
        for end, (of, sign) in enumerate(((pairs.a, 1.0), (pairs.b, -1.0))):
            for number, made in enumerate(self.kinds):
                here = np.flatnonzero(kind[of] == number)
                if len(here):
                    height, ends[end, here] = heights(made, poses[of[here]], sign * n[here])
                    reach[here] += height
        return -reach, lengths(ends[1] - ends[0])

    def _asked(self, kind: Ints, poses: Array, pairs: _Pairs, rows: Ints, upper: Array) -> Array:
        """Distances by cold queries; upper bounds become theirs, in place."""
        true = np.empty(len(rows))
        a, b = pairs.a[rows], pairs.b[rows]
        turned = kind[a] > kind[b]
        a, b = np.where(turned, b, a), np.where(turned, a, b)
        both = kind[a] * len(self.kinds) + kind[b]
        for i, j in itertools.combinations_with_replacement(range(len(self.kinds)), 2):
            here = np.flatnonzero(both == i * len(self.kinds) + j)
            if len(here):
                of = self.kinds[i].body, self.kinds[j].body
                found = so.distances(*of, poses[a[here]], poses[b[here]])
                true[here], upper[rows[here]] = found.distance, found.upper_bound
        return true


def _flat(poses: Array) -> Array:
    """(n, 12) R row-major, p."""
    return np.concatenate([poses[:, :3, :3].reshape(-1, 9), poses[:, :3, 3]], axis=1)


def _neighbours(centres: Array, radii: Array, within: float) -> Ints:
    """Pairs (k, 2), of each the lesser number first, whose balls come within the horizon."""
    widest = (2.0 * float(radii.max()) + within) * (1.0 + ROUNDOFF)
    pairs = cKDTree(centres).query_pairs(widest, output_type="ndarray")
    a, b = pairs.T
    reach = (radii[a] + radii[b] + within) * (1.0 + ROUNDOFF)
    found: Ints = pairs[lengths(centres[b] - centres[a]) <= reach].astype(np.int64)
    return found


def _pairs(each: Sequence[Ints], first: Ints, most: int) -> _Pairs:
    """The pairs of all frames, sorted."""
    frame = np.repeat(np.arange(len(each)), [len(pairs) for pairs in each])
    i, j = np.concatenate(each).T
    key = (frame * most + i) * most + j
    order = np.argsort(key)
    frame, i, j = frame[order], i[order], j[order]
    return _Pairs(frame, first[frame] + i, first[frame] + j, key[order])


def _positions(keys: Ints, wanted: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """Where each wanted key stands among sorted keys, and whether it does."""
    at = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
    there = keys[at] == wanted if len(keys) else np.zeros(len(wanted), dtype=bool)
    return at, there


def _compared(block: Sequence[Told], found: _Found, first: Ints, most: int) -> Verdict:
    """What worlds said, beside the truth."""
    close, at, upper, noise = found.close, found.at, found.upper, found.noise
    within = np.array([one.within for one in block])
    near = found.asked & (upper <= within[close.frame] - noise)
    missed = near.copy()
    missed[at[found.there]] = False
    distance, lower = (_sorted(block, name, "listed") for name in ("distance", "lower"))
    true = found.true[at]
    off = ~(np.abs(distance - true) <= AGREED + PROVEN * np.maximum(0.0, -true))
    wrong = ~found.there | off | (lower > upper[at] + noise)
    table = _pairs([one.table for one in block], first, most)
    where, known = _positions(close.key, table.key)
    above = known & (_sorted(block, "bounds", "table") > upper[where] + noise)
    least = within.copy()
    np.minimum.at(least, close.frame[found.asked], upper[found.asked])
    clearance = np.array([one.clearance for one in block])
    sizes = np.diff(first)
    return Verdict(
        len(block),
        int((sizes * (sizes - 1) // 2).sum()),
        int(np.count_nonzero(near)),
        int(np.count_nonzero(found.asked)),
        int(np.count_nonzero(missed)),
        int(np.count_nonzero(wrong) + np.count_nonzero(above)),
        int(np.count_nonzero(clearance > least + noise)),
    )


def _sorted(block: Sequence[Told], name: str, pairs: str) -> Array:
    """Numbers of all frames, in the order of the keys of their pairs."""
    each = [getattr(one, name)[np.lexsort(getattr(one, pairs).T[::-1])] for one in block]
    return np.concatenate(each)
