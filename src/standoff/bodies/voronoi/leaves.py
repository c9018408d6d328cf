"""The leaves of a planar body's medial axis, where it ends: at corners, and at the focal points of
those maxima of curvature whose discs lie inside.

Every gap between two touching points of a disc contains at least one leaf, and the axis enters it
in one branch.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from standoff.bodies.voronoi.discs import edge_distances
from standoff.bodies.voronoi.outline import ArcOutline, Place
from standoff.bodies.voronoi.tolerances import AT_END, FLAT_CURVATURE, SAME_DEPTH
from standoff.kernels.tolerances import EPS
from standoff.typing import Array


class AxisEnd(NamedTuple):
    """An end of the medial axis.

    Attributes
    ----------
    kind : "corner" or "focal"
    lo, hi : Place
        The part of the boundary that belongs to it: one point (a joint has two places), or a
        circular arc.
    point : (2,) array
    depth : float
        0 at a corner.
    """

    kind: str
    lo: Place
    hi: Place
    point: Array
    depth: float

    def shifted(self, turns: int) -> AxisEnd:
        lo, hi = (self.lo[0] + turns, self.lo[1]), (self.hi[0] + turns, self.hi[1])
        return self._replace(lo=lo, hi=hi)


def leaves_of(outline: ArcOutline) -> list[AxisEnd]:
    """All leaves, in the order of the boundary; none on a circle."""
    found = [
        AxisEnd("corner", (n - 1, outline.arc(n - 1).hi), (n, arc.lo), arc.jet(arc.lo)[0], 0.0)
        for n, arc in enumerate(outline.arcs)
        if outline.corner(n)
    ]
    for lo, hi in _crests(outline):
        leaf = _focal(outline, lo, hi)
        if leaf is not None:
            found.append(leaf)
    return sorted(found, key=lambda leaf: leaf.hi)


def _crests(outline: ArcOutline) -> list[tuple[Place, Place]]:
    """Parts on which the sampled curvature is constant and higher than on both sides."""
    count = len(outline.arcs)
    first = next((n for n in range(count) if outline.corner(n)), 0)
    found: list[tuple[Place, Place]] = []
    chain: list[int] = []
    for n in range(first, first + count):
        chain.append(n)
        if outline.corner(n + 1):
            found += _crests_of(outline, chain, closed=False)
            chain = []
    return found + (_crests_of(outline, chain, closed=True) if chain else [])


def _crests_of(outline: ArcOutline, chain: list[int], closed: bool) -> list[tuple[Place, Place]]:
    """Crests of a smooth chain of arcs; one that reaches a corner belongs to the corner."""
    places: list[Place] = []
    for n in chain:
        places += [(n, float(u)) for u in outline.arc(n).us]
    values = np.concatenate([outline.arc(n).samples[2] for n in chain])
    same = np.abs(np.diff(values)) <= FLAT_CURVATURE * np.abs(values[:-1])
    if closed:
        joined = abs(values[-1] - values[0]) <= FLAT_CURVATURE * abs(values[0])
        if joined and same.all():
            return []
        shift = int(np.flatnonzero(~same)[0]) + 1 if joined else 0
        count = len(outline.arcs)
        places = places[shift:] + [(n + count, u) for n, u in places[:shift]]
        values = np.roll(values, -shift)
        same = np.abs(np.diff(values)) <= FLAT_CURVATURE * np.abs(values[:-1])
        around = values[-1], values[0]
    else:
        around = np.inf, np.inf
    bounds = [0, *(np.flatnonzero(~same) + 1).tolist(), len(values)]
    crests = []
    for a, b in pairwise(bounds):
        before = around[0] if a == 0 else values[a - 1]
        after = around[1] if b == len(values) else values[b]
        if values[a] > before and values[b - 1] > after and values[a] > 0.0:
            crests.append(_bracket(places, a, b, outline))
    return crests


def _bracket(places: list[Place], a: int, b: int, outline: ArcOutline) -> tuple[Place, Place]:
    """The whole crest if it is a circular arc, else the single highest place."""
    first, last = places[a], places[b - 1]
    us = {u for n, u in places[a:b] if n == first[0]}
    if b - a > 2 and len(us | {u for n, u in places[a:b] if n == last[0]}) > 2:
        return first, last
    tops: list[tuple[float, Place]] = []
    for n in range(first[0], last[0] + 1):
        arc = outline.arc(n)
        lo = places[a - 1][1] if a and places[a - 1][0] == n else arc.lo
        hi = places[b][1] if b < len(places) and places[b][0] == n else arc.hi
        found = scipy.optimize.minimize_scalar(
            lambda u, arc=arc: -arc.foot(float(u)).curvature,
            bounds=(lo, hi),
            method="bounded",
            options={"xatol": np.sqrt(EPS) * (hi - lo)},
        )
        tops += [(arc.foot(u).curvature, (n, u)) for u in (lo, float(found.x), hi)]
    n, u = max(tops)[1]
    arc = outline.arc(n)
    if u - arc.lo < AT_END * (arc.hi - arc.lo):
        return (n - 1, outline.arc(n - 1).hi), (n, arc.lo)
    if arc.hi - u < AT_END * (arc.hi - arc.lo):
        return (n, arc.hi), (n + 1, outline.arc(n + 1).lo)
    return (n, u), (n, u)


def _focal(outline: ArcOutline, lo: Place, hi: Place) -> AxisEnd | None:
    """The leaf of a crest, if its osculating disc lies inside the body."""
    foot = max((outline.foot(p) for p in (lo, hi)), key=lambda f: f.curvature)
    radius = 1.0 / foot.curvature
    if radius > outline.size:
        return None
    centre = foot.x - radius * foot.n
    least = min(distance for distance, _ in edge_distances(outline, centre).values())
    if least < radius - SAME_DEPTH * outline.size:
        return None
    count = len(outline.arcs)
    turns = hi[0] // count * count
    return AxisEnd("focal", (lo[0] - turns, lo[1]), (hi[0] - turns, hi[1]), centre, radius)
