"""The truth of a world's frames, for all pairs: support functions first, cold queries of the rest.

With n the direction between the centres of two pieces, -s(n) is how far a plane parts them, never
more than their distance, and their farthest points along it are never nearer than that. Where
these two do not settle a question, the pair is asked by itself, by a cold query.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.tolerances import BLUR
from standoff.tracking.laws import DEFAULT_LAW
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff_studies.oracles import HalfSpace, Shape, lengths
from standoff_studies.soak.checks import BLURRED, ROUNDOFF
from standoff_studies.soak.drawn_worlds import Chapter, Part
from standoff_studies.soak.placing import heights

Ints = NDArray[np.int64]
NONE = -1
"""Status of a pair of pieces that was not asked."""


class Extent(NamedTuple):
    """Of a piece, by its support function alone: the centre of its box in its frame, and the radius
    of a ball about it that holds it (inf for a half-space)."""

    centre: Array
    radius: float


class Pieces(NamedTuple):
    """All pieces of a world in all frames.

    Attributes
    ----------
    parts : list of Part
    owners : (p,) array
    extents : list of Extent
    poses : (m, p, 12) array
    """

    parts: list[Part]
    owners: Ints
    extents: list[Extent]
    poses: Array

    @property
    def centres(self) -> Array:
        """(m, p, 3), world axes."""
        turn = self.poses[..., :9].reshape(*self.poses.shape[:2], 3, 3)
        local = np.array([extent.centre for extent in self.extents])
        return np.asarray(np.einsum("mpij,pj->mpi", turn, local) + self.poses[..., 9:])


class Truth(NamedTuple):
    """What is proven of pairs of pieces, (m, k) each; pairs of one pair of bodies stand together.

    Attributes
    ----------
    a, b : (k,) arrays
        The pieces.
    first : (g,) array
        Where the pairs of each counted pair of bodies begin.
    lower, upper : (m, k) arrays
        Bounds, roundoff not counted.
    distance, status : (m, k) arrays
        Of cold queries, where they were made: nan and NONE elsewhere.
    gap : (m, k) array
        How far a certified distance may be from the true one.
    noise : (m, k) array
        What roundoff may do to a length.
    """

    a: Ints
    b: Ints
    first: Ints
    lower: Array
    upper: Array
    distance: Array
    status: Ints
    gap: Array
    noise: Array


def placed_pieces(chapter: Chapter) -> Pieces:
    """Where all pieces are."""
    parts = [part for body in chapter.parts for part in body]
    owners = np.repeat(np.arange(len(chapter.parts)), [len(body) for body in chapter.parts])
    local = np.array([part.pose for part in parts])
    whole = chapter.flight.poses[:, owners] @ local
    turns = whole[..., :3, :3].reshape(*whole.shape[:2], 9)
    return Pieces(
        parts,
        owners,
        [extent_of(part.made.support) for part in parts],
        np.dstack([turns, whole[..., :3, 3]]),
    )


def extent_of(support: Shape) -> Extent:
    """The ball of a body, by its support function."""
    if isinstance(support, HalfSpace):
        return Extent(np.zeros(3), np.inf)
    axes = np.eye(3)
    ends = np.array(
        [[(support.points(s * n[None])[0] @ n) for n in axes] for s in (-1.0, 1.0)], dtype=float
    )
    return Extent(ends.mean(axis=0), float(np.linalg.norm(ends[1] - ends[0]) / 2.0))


def bounds_of(chapter: Chapter, pieces: Pieces) -> Truth:
    """Bounds by support functions, of all pairs of pieces of the pairs that count."""
    first: list[int] = []
    a: list[int] = []
    b: list[int] = []
    for i, j in chapter.counted.tolist():
        first.append(len(a))
        for p in np.flatnonzero(pieces.owners == i).tolist():
            for q in np.flatnonzero(pieces.owners == j).tolist():
                a.append(p)
                b.append(q)
    pair_a, pair_b = np.array(a, dtype=np.int64), np.array(b, dtype=np.int64)
    m, k = len(pieces.poses), len(a)
    centres = pieces.centres
    n = centres[:, pair_b] - centres[:, pair_a]
    away = lengths(n.reshape(-1, 3)).reshape(m, k)
    n = np.where(away[..., None] > 0.0, n / np.where(away > 0.0, away, 1.0)[..., None], [1.0, 0, 0])
    for p, part in enumerate(pieces.parts):
        if isinstance(part.made.support, HalfSpace):
            up = pieces.poses[:, p, [2, 5, 8]][:, None]
            n[:, pair_a == p], n[:, pair_b == p] = up, -up
    heights_of, points = np.zeros((m, k)), np.zeros((2, m, k, 3))
    for p, part in enumerate(pieces.parts):
        for side, (mine, sign) in enumerate(((pair_a, 1.0), (pair_b, -1.0))):
            here = np.flatnonzero(mine == p)
            if len(here):
                rows = np.repeat(pieces.poses[:, p], len(here), axis=0)
                height, point = heights(part.made, rows, sign * n[:, here].reshape(-1, 3))
                heights_of[:, here] += height.reshape(m, -1)
                points[side][:, here] = point.reshape(m, -1, 3)
    upper = lengths((points[1] - points[0]).reshape(-1, 3)).reshape(m, k)
    endless = np.array([not np.isfinite(extent.radius) for extent in pieces.extents])
    if k:
        plane = endless[pair_a] | endless[pair_b]
        upper[:, plane] = np.maximum(-heights_of[:, plane], 0.0)
    size = _sizes(pieces, pair_a, pair_b, away)
    noise = ROUNDOFF * size
    return Truth(
        pair_a,
        pair_b,
        np.array(first, dtype=np.int64),
        -heights_of,
        upper,
        np.full((m, k), np.nan),
        np.full((m, k), NONE),
        _gaps(pieces, pair_a, pair_b) * size + 2.0 * _slack(pieces, pair_a, pair_b) + 2.0 * noise,
        noise,
    )


def _sizes(pieces: Pieces, a: Ints, b: Ints, away: Array) -> Array:
    """To what roundoff and tolerances are relative: sizes, the distance, and that of the origins,
    with the way from a body's origin to its piece."""
    radii = np.array([x.radius if np.isfinite(x.radius) else 0.0 for x in pieces.extents])
    offsets = np.array([np.linalg.norm(x.centre) for x in pieces.extents])
    arms = np.array([np.linalg.norm(part.pose[:3, 3]) for part in pieces.parts])
    out = lengths(pieces.poses[..., 9:].reshape(-1, 3)).reshape(pieces.poses.shape[:2])
    each = 2.0 * radii + offsets + 2.0 * arms + out
    return np.asarray(each[:, a] + each[:, b] + away)


def _slack(pieces: Pieces, a: Ints, b: Ints) -> Array:
    slack = np.array([part.made.body.reals[L.SLACK] for part in pieces.parts])
    return np.asarray(slack[a] + slack[b])


def _gaps(pieces: Pieces, a: Ints, b: Ints) -> Array:
    """What the tolerance and blurred normals allow, twice: of the world's answer and the cold
    one."""
    blurred = np.array([part.made.shape.kind in BLURRED for part in pieces.parts], dtype=bool)
    return np.asarray(2.0 * (DEFAULT_LAW.tolerance + BLUR * (blurred[a] | blurred[b])))


def ask(pieces: Pieces, truth: Truth, asked: NDArray[np.bool_]) -> int:
    """Ask some pairs of pieces, (m, k), by cold queries: their bounds and distances, in place.
    Returns how many queries that took."""
    for k in np.flatnonzero(asked.any(axis=0)).tolist():
        frames = np.flatnonzero(asked[:, k])
        p, q = int(truth.a[k]), int(truth.b[k])
        found = so.distances(
            pieces.parts[p].made.body,
            pieces.parts[q].made.body,
            pieces.poses[frames, p],
            pieces.poses[frames, q],
        )
        truth.distance[frames, k] = found.distance
        truth.status[frames, k] = [Status(one).value for one in found.status]
        truth.lower[frames, k] = np.maximum(truth.lower[frames, k], found.lower_bound)
        truth.upper[frames, k] = np.minimum(truth.upper[frames, k], found.upper_bound)
    return int(asked.sum())
