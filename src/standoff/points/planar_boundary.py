"""A planar convex body's boundary, sampled: on which side a point is, and bounds of its depth.

Chords of the boundary lie in the body and its tangents outside. Each arc lies beyond its chord,
which bounds the depth of a point from below without any search, and chords and tangents decide
whether the point is inside. Chords are halved only where that is not sharp enough.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.best_first import SearchPart, best_first
from standoff.bodies.body import Body
from standoff.kernels.entries.queries import planar_edge_normal
from standoff.points.tolerances import ON_BOUNDARY, SHORTEST_CHORD
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

Place = tuple[int, float]
"""An edge and a parameter on it."""

Chord = tuple[int, float, Array, float, Array]
"""Its edge, then parameter and point, (2,), at both ends."""

INTERVALS = 64
"""Chords of an edge at first: a bound off by (turn of the edge / 64)² / 8 of its radius."""

MOST_TURN = 0.5
"""Radians by which the boundary may turn over a chord: well below a right angle."""

MOST_CHORDS = 4_000
"""Chords halved for one point. A touching disc needs some hundred; all the boundary needs them
only where it all is at one distance, as a circle's is from its centre."""


class DepthBounds(NamedTuple):
    """What is proven of a point's depth in the body.

    Attributes
    ----------
    depth : float
        Not more than the true depth [length].
    nearest : (int, float)
        Edge and parameter of the nearest point of the boundary that was met.
    distance : float
        From there to the point [length].
    samples : int
        Points of the boundary that were computed.
    """

    depth: float
    nearest: Place
    distance: float
    samples: int


class Bracket(NamedTuple):
    """Parameters of an edge between which the distance to a point has a local minimum."""

    edge: int
    low: float
    high: float

    @property
    def middle(self) -> float:
        """Halfway between."""
        return 0.5 * (self.low + self.high)


class PlanarBoundary(KeepsReadOnly):
    """The curves of a planar body, sampled once. All in the body's frame, in x and y.

    Parameters
    ----------
    body : Body
        Of dimension 2.
    """

    def __init__(self, body: Body) -> None:
        self.body = body
        self.curves = [edge.curve for edge in body.edge_parts]
        self.parameters = [self._sampled(edge) for edge in range(len(self.curves))]
        jets = [
            [self.curves[edge].jet(float(t)) for t in own]
            for edge, own in enumerate(self.parameters)
        ]
        self._points = [np.array([jet[0][:2] for jet in own]) for own in jets]
        tangents = [np.array([jet[1][:2] for jet in own]) for own in jets]
        normals = [
            np.array([self.normal(edge, float(t)) for t in own])
            for edge, own in enumerate(self.parameters)
        ]
        # Counter-clockwise edges have the body on their left.
        self._sense = [
            1.0 if _cross(n[0], along[0]) > 0.0 else -1.0
            for n, along in zip(normals, tangents, strict=True)
        ]
        # the last sample of an edge begins no chord
        self._first = np.concatenate([p[:-1] for p in self._points])
        self._last = np.concatenate([p[1:] for p in self._points])
        self._outward = np.concatenate([n[:-1] for n in normals])
        self._outward_last = np.concatenate([n[1:] for n in normals])
        self._tangents_first = np.concatenate([along[:-1] for along in tangents])
        self._tangents_last = np.concatenate([along[1:] for along in tangents])
        self._starts = np.concatenate([t[:-1] for t in self.parameters])
        self._ends = np.concatenate([t[1:] for t in self.parameters])
        counts = [len(p) - 1 for p in self._points]
        self._edges = np.repeat(np.arange(len(counts)), counts)
        along = self._last - self._first
        self._chord_lengths = np.linalg.norm(along, axis=1)
        self._chord_tangents = along / self._chord_lengths[:, None]
        left = np.column_stack([self._chord_tangents[:, 1], -self._chord_tangents[:, 0]])
        self._chord_normals = left * np.repeat(self._sense, counts)[:, None]
        self._chord_offsets = np.einsum("ij,ij->i", self._chord_normals, self._first)

    def _sampled(self, edge: int) -> Array:
        """Parameters of an edge, so dense that its normal turns by less than `MOST_TURN`."""
        curve = self.curves[edge]
        t = np.linspace(curve.first, curve.last, INTERVALS + 1)
        t = np.unique(np.concatenate([t, curve.spans()]))
        while True:
            normals = np.array([self.normal(edge, float(s)) for s in t])
            wide = np.flatnonzero(
                np.einsum("ij,ij->i", normals[:-1], normals[1:]) < math.cos(MOST_TURN)
            )
            middles = 0.5 * (t[wide] + t[wide + 1])
            middles = middles[(middles > t[wide]) & (middles < t[wide + 1])]
            if not len(middles):
                return t
            t = np.sort(np.concatenate([t, middles]))

    def normal(self, edge: int, t: float) -> Array:
        """Outward unit normal of an edge, (2,)."""
        n = planar_edge_normal(self.body.ints, self.body.reals, self.body.n_faces + edge, t)
        return np.array(n[:2])

    def point(self, edge: int, t: float) -> Array:
        """Point of an edge, (2,)."""
        return self.curves[edge].point(t)[:2]

    def inside(self, x: Array) -> bool | None:
        """Is the point, (2,), in the body? None on the boundary, to roundoff."""
        heights = self._chord_offsets - self._chord_normals @ x
        doubtful = np.flatnonzero(heights <= 0.0)
        if not len(doubtful):
            return True
        if self._beyond(x, doubtful):
            return False
        verdicts = [self._inside_chord(x, int(k)) for k in doubtful]
        if False in verdicts:
            return False
        return None if None in verdicts else True

    def _beyond(self, x: Array, chords: NDArray[np.intp]) -> bool:
        """Is the point beyond the tangent at an end of one of these chords?"""
        first = np.einsum("ij,ij->i", self._outward[chords], x - self._first[chords])
        last = np.einsum("ij,ij->i", self._outward_last[chords], x - self._last[chords])
        return bool((first > 0.0).any() or (last > 0.0).any())

    def _inside_chord(self, x: Array, chord: int) -> bool | None:
        """The same for a point beyond a chord and behind the tangents at its ends."""
        edge = int(self._edges[chord])
        ends = [(float(self._starts[chord]), self._first[chord])]
        ends.append((float(self._ends[chord]), self._last[chord]))
        while True:
            (t0, a), (t1, b) = ends
            t = 0.5 * (t0 + t1)
            if not t0 < t < t1 or math.dist(a, b) <= ON_BOUNDARY * self.body.size:
                return None
            m = self.point(edge, t)
            if float(self.normal(edge, t) @ (x - m)) > 0.0:
                return False
            halves = [(ends[0], (t, m)), ((t, m), ends[1])]
            over = [h for h in halves if _height(h[0][1], h[1][1], self._sense[edge], x) <= 0.0]
            if not over:
                return True
            # Behind the tangent at the middle a point is beyond one of the two chords at most.
            ends = list(over[0])

    def bounds(self, x: Array, known: Place, goal: float) -> DepthBounds:
        """Bound the depth of a point inside, (2,), from below.

        Parameters
        ----------
        x : ndarray, shape (2,)
        known : (int, float)
            A place thought to be the nearest.
        goal : float
            The bound is made no sharper than this [length].

        Returns
        -------
        Bounds
            Its ``depth`` is at least the goal, unless a point of the boundary nearer than the
            goal was met, or more than `MOST_CHORDS` would be needed.
        """
        distance = math.dist(self.point(*known), x)
        bounds = self._chord_bounds(x)
        low = np.flatnonzero(bounds < goal)
        others = float(np.delete(bounds, low).min()) if len(low) < len(bounds) else math.inf
        shortest = SHORTEST_CHORD * self.body.size

        def part(chord: Chord, bound: float, seen: float = math.inf) -> SearchPart[Chord]:
            return SearchPart(bound, chord, seen, math.dist(chord[2], chord[4]) <= shortest)

        def halves(chosen: list[SearchPart[Chord]]) -> list[SearchPart[Chord]]:
            edge, t0, a, t1, b = chosen[0].body
            t = 0.5 * (t0 + t1)
            m = self.point(edge, t)
            first, last = (edge, t0, a, t, m), (edge, t, m, t1, b)
            # what is met in the first half is its end, the middle
            met = part(first, self._bound(first, x), math.dist(m, x))
            return [met, part(last, self._bound(last, x))]

        searched = best_first(
            [part(self._chord(int(k)), float(bounds[k])) for k in low],
            halves,
            goal=lambda met: goal if min(met, distance) >= goal else -math.inf,
            most=lambda _: MOST_CHORDS,
        )
        nearest = known
        if searched.found < distance and searched.place is not None:
            distance, nearest = searched.found, (searched.place[0], searched.place[3])
        depth = min(searched.least, others, distance) - self.body.report.slack
        return DepthBounds(depth, nearest, distance, searched.splits)

    def _chord_bounds(self, x: Array) -> Array:
        """`_bound` of all the chords at first, (n,)."""
        heights = np.maximum(self._chord_offsets - self._chord_normals @ x, 0.0)
        along = np.einsum("ij,ij->i", x - self._first, self._chord_tangents)
        aside = np.maximum(np.maximum(-along, along - self._chord_lengths), 0.0)
        return np.asarray(np.hypot(heights, aside))

    def _bound(self, chord: Chord, x: Array) -> float:
        """Least distance from a point to the half strip beyond a chord, where its arc lies.

        The arc turns from the chord by less than a right angle, so it goes along it only forwards.
        """
        edge, _, a, _, b = chord
        along = (b[0] - a[0], b[1] - a[1])
        away = (x[0] - a[0], x[1] - a[1])
        length = math.hypot(*along)
        height = self._sense[edge] * (along[0] * away[1] - along[1] * away[0]) / length
        forward = (along[0] * away[0] + along[1] * away[1]) / length
        return math.hypot(max(height, 0.0), max(-forward, forward - length, 0.0))

    def _chord(self, k: int) -> Chord:
        return (
            int(self._edges[k]),
            float(self._starts[k]),
            self._first[k],
            float(self._ends[k]),
            self._last[k],
        )

    def nearest_sample(self, edge: int, x: Array) -> float:
        """Parameter of an edge's sample that is nearest to a point, (2,)."""
        away = self._points[edge] - x
        k = int(np.einsum("ij,ij->i", away, away).argmin())
        return float(self.parameters[edge][k])

    def brackets(self, x: Array) -> tuple[Bracket, ...]:
        """Where the distance from a point, (2,), to an edge has a local minimum, by samples.

        Ends of edges are none, and two stationary points between neighbouring samples are not
        seen.
        """
        falls = np.einsum("ij,ij->i", self._tangents_first, self._first - x) < 0.0
        rises = np.einsum("ij,ij->i", self._tangents_last, self._last - x) >= 0.0
        return tuple(
            Bracket(int(self._edges[k]), float(self._starts[k]), float(self._ends[k]))
            for k in np.flatnonzero(falls & rises)
        )


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _height(a: Array, b: Array, sense: float, x: Array) -> float:
    """How far a point lies on the body's side of a chord [length]."""
    along = (b[0] - a[0], b[1] - a[1])
    length = math.hypot(*along)
    return float(sense * _cross(np.array(along), x - a) / length)


def without_radius(body: Body) -> Body:
    """Return a planar body without its swept radius."""
    if body.radius == 0.0:
        return body
    return Body.from_brep(
        body.vertex_points, body.edge_parts, dimension=2, name=f"core of {body.name}"
    )
