"""Loops of a face in (u, v): which is the outer one, which are holes, and which way each runs.

For a face of one chart, the loops alone determine where it is: on the left of each, seen from
x_u × x_v, once they all run counterclockwise around it. They are turned that way if necessary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.bodies.packing import Chart, Coedge
from standoff.bodies.topology import Edge, Face
from standoff.errors import BodyError
from standoff.typing import Array

# Points on each coedge.
ALONG = 33


@dataclass(frozen=True)
class ClosedEntries:
    """Entries of a face's loop that close on themselves.

    Attributes
    ----------
    entries : numbers in ``Face.loop``.
    area : in (u, v), enclosed together with collapsed sides; positive if it was given
        counterclockwise.
    turns : how often it goes around a surface whose u is an angle: 0, 1 or -1.
    links : (n, 2, 2) straight segments in (u, v) along it, in no particular order.
    """

    entries: tuple[int, ...]
    area: float
    turns: int
    links: Array


def traced(face: Face, edges: Sequence[Edge], number: int) -> list[tuple[int, ...]]:
    """A face's entries as closed chains, in the senses in which they were given.

    Raises BodyError: a chain that is open, or whose senses do not follow each other.
    """
    ends = [_ends(edges[j], sense) for j, sense in face.loop]
    alone = [(k,) for k, (first, _) in enumerate(ends) if first is None]
    waiting = {k for k, (first, _) in enumerate(ends) if first is not None}
    chains = []
    while waiting:
        chain = [min(waiting)]
        waiting.remove(chain[0])
        start, at = ends[chain[0]]
        while at != start:
            following = min((k for k in waiting if ends[k][0] == at), default=None)
            if following is None:
                raise _open(face, ends, number)
            waiting.remove(following)
            chain.append(following)
            at = ends[following][1]
        chains.append(tuple(chain))
    return [*alone, *chains]


def _ends(edge: Edge, sense: int) -> tuple[int | None, int | None]:
    return (edge.first, edge.last) if sense > 0 else (edge.last, edge.first)


def _open(face: Face, ends: Sequence[tuple[int | None, int | None]], number: int) -> BodyError:
    vertices = [v for pair in ends for v in pair if v is not None]
    loose = sorted({v for v in vertices if vertices.count(v) % 2})
    if loose:
        return BodyError(
            f"Face {number}: its loop is open at vertices {loose}.", part=("face", number)
        )
    starts = [first for first, _ in ends]
    against = [
        face.loop[k][0]
        for k, (first, _) in enumerate(ends)
        if first is not None and starts.count(first) > 1
    ]
    return BodyError(
        f"Face {number}: its loop runs both ways round (edges {against} leave the same vertex).",
        part=("face", number),
    )


def turn_loops(chart: Chart, face: Face, edges: Sequence[Edge], number: int) -> bool:
    """Turn the coedges of a face's one chart so that the face is on the left of x_u × x_v's side.

    Returns whether most of its loops had to be turned.

    Raises BodyError: loops that bound no face: open ones, several side by side, a single one around
    a surface.
    """
    loops = [_loop(chart, entries, edges) for entries in traced(face, edges, number)]
    round_ = sum(loop.turns != 0 for loop in loops)
    whole = not round_ and _closed(chart)
    wrong = _against(loops, chart, number, whole)
    chart.holed = whole or len(loops) > max(round_, 1)
    turned = {
        k for loop, against in zip(loops, wrong, strict=True) if against for k in loop.entries
    }
    for c in chart.coedges:
        if c.edge >= 0 and c.entry in turned:
            c.side = -c.side
    return 2 * len(turned) > len(face.loop)


def _against(loops: Sequence[ClosedEntries], chart: Chart, number: int, whole: bool) -> list[bool]:
    """Which loops run clockwise around the face as they were given."""
    if whole:
        return [loop.area > 0.0 for loop in loops]  # holes, all of them
    round_ = [loop for loop in loops if loop.turns]
    collapsed = [c for c in chart.coedges if c.edge < 0]
    if not round_:
        outer = max(loops, key=lambda loop: abs(loop.area))
        sides = [np.stack([p[:-1], p[1:]], 1) for p in map(_points, collapsed)]
        for loop in loops:
            if loop is not outer and not _within(loop, np.concatenate([outer.links, *sides])):
                raise BodyError(
                    f"Face {number} has loops beside each other: make each part a separate face.",
                    part=("face", number),
                )
        return [(loop.area < 0.0) == (loop is outer) for loop in loops]
    if len(round_) == 2 and not collapsed:
        low, high = sorted(round_, key=lambda loop: float(loop.links[..., 1].mean()))
        return [
            loop.turns < 0 if loop is low else loop.turns > 0 if loop is high else loop.area > 0.0
            for loop in loops
        ]
    if len(round_) == 1 and collapsed:
        return [(loop.area < 0.0) if loop is round_[0] else loop.area > 0.0 for loop in loops]
    raise BodyError(
        f"Face {number}: {len(round_)} of its loops go once around its surface; a face lies "
        "between two of them, or between one and an apex.",
        part=("face", number),
    )


def _closed(chart: Chart) -> bool:
    """Is a face all of a surface between two collapsed sides that go once around it, such as a
    sphere by longitude and latitude, but for holes?"""
    ends = [(c, c.first, c.last) for c in chart.coedges if c.edge < 0]
    around = [abs(c.pcurve.point(b)[0] - c.pcurve.point(a)[0]) for c, a, b in ends]
    return bool(chart.surface.periodic) and round(sum(around) / (2.0 * np.pi)) == 2


def _loop(chart: Chart, entries: tuple[int, ...], edges: Sequence[Edge]) -> ClosedEntries:
    coedges = [c for c in chart.coedges if c.edge >= 0 and c.entry in entries]
    spots = [_points(c) for c in coedges]
    steps = sum(c.side * float(p[-1, 0] - p[0, 0]) for c, p in zip(coedges, spots, strict=True))
    links = np.concatenate([np.stack([p[:-1], p[1:]], 1) for p in spots])
    if not chart.surface.periodic:
        return ClosedEntries(entries, _encircled(chart, coedges, spots), 0, links)
    widths: dict[tuple[int, float], float] = {}
    for c in chart.coedges:
        if c.edge < 0:
            (start, level, _), (end, *_) = c.pcurve.point(c.first), c.pcurve.point(c.last)
            key = (-1 - c.edge, level)
            widths[key] = widths.get(key, 0.0) + abs(end - start)
    sides = [_along(*key, width, coedges, edges) for key, width in widths.items()]
    turns = round((steps + sum(along for along, _ in sides)) / (2.0 * np.pi))
    if turns:
        return ClosedEntries(entries, _encircled(chart, coedges, spots), turns, links)
    area = -sum(level * along for along, level in sides)
    for c, points in zip(coedges, spots, strict=True):
        area -= c.side * float(0.5 * (points[1:, 1] + points[:-1, 1]) @ np.diff(points[:, 0]))
    return ClosedEntries(entries, area, 0, links)


def _along(
    vertex: int, level: float, width: float, coedges: Sequence[Coedge], edges: Sequence[Edge]
) -> tuple[float, float]:
    """(step in u, level of v) of a loop along a collapsed side: from the end of the coedge that
    comes to its vertex to the one that leaves it; (0, 0) where it does not pass there."""
    ends: dict[int, list[float]] = {1: [], -1: []}
    for c in coedges:
        edge = edges[c.edge]
        if edge.first == vertex and c.first == edge.curve.first:
            ends[c.side].append(c.pcurve.point(c.first)[0])
        if edge.last == vertex and c.last == edge.curve.last:
            ends[-c.side].append(c.pcurve.point(c.last)[0])
    if len(ends[1]) != 1 or len(ends[-1]) != 1:
        return 0.0, 0.0
    step = ends[1][0] - ends[-1][0]
    # up to turns where the loop was cut: it goes as far as the side is wide
    ways = [step + 2.0 * np.pi * turns for turns in (0, -1, 1)]
    return min(ways, key=lambda way: round(abs(abs(way) - width), 3)), level


def _points(c: Coedge) -> Array:
    return c.pcurve.places(np.linspace(c.first, c.last, ALONG))


def _encircled(chart: Chart, coedges: Sequence[Coedge], spots: Sequence[Array]) -> float:
    """Area in (u, v) that coedges enclose, positive if counterclockwise according to their sides.

    It is the integral of -v du, which also works for a rim that goes once around. Collapsed sides
    have no edge, so the integral is chosen so that they add nothing: u dv where v is constant
    along them, and on a periodic surface -v du with v measured from theirs.
    """
    level = None
    for c in chart.coedges:
        if c.edge < 0:
            (u0, v0, _), (u1, v1, _) = c.pcurve.point(c.first), c.pcurve.point(c.last)
            level = v0 if abs(v1 - v0) < abs(u1 - u0) else level
    area = 0.0
    for c, points in zip(coedges, spots, strict=True):
        middle, step = 0.5 * (points[1:] + points[:-1]), np.diff(points, axis=0)
        if level is None or chart.surface.periodic:
            area -= c.side * float((middle[:, 1] - (level or 0.0)) @ step[:, 0])
        else:
            area += c.side * float(middle[:, 0] @ step[:, 1])
    return area


def _within(loop: ClosedEntries, links: Array) -> bool:
    """Do most points of a loop lie inside the others, by the parity of a ray's crossings?"""
    u, v = loop.links[:, 0].T
    (a, b), (c, d) = links[:, 0].T, links[:, 1].T
    k, m = np.nonzero((b <= v[:, None]) != (d <= v[:, None]))
    at = a[m] + (v[k] - b[m]) / (d - b)[m] * (c - a)[m]
    crossed = np.bincount(k[at > u[k]], minlength=len(u)) % 2
    return 2 * int(crossed.sum()) > len(u)
