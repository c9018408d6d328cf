"""The medial axis of a planar convex body, traced branch by branch from one leaf to all others.

A disc that touches the boundary at two feet leaves two gaps. As the feet move towards each other
within a gap, the disc's centre moves along a branch. Where the disc also meets the boundary within
the gap, the branch ends at a junction and the gap is split into two, each with at least one leaf.
In a gap with one leaf the branch ends at the leaf.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from standoff.bodies.voronoi.discs import Junction, Touch, greatest_disc, junction
from standoff.bodies.voronoi.leaves import AxisEnd, leaves_of
from standoff.bodies.voronoi.outline import ArcOutline, Place
from standoff.bodies.voronoi.tolerances import (
    BRACKET_SLACK,
    HALVINGS,
    LONGEST_CHORD,
    NEAR_JUNCTION,
    SAME_DEPTH,
    SAME_PLACE,
)
from standoff.errors import VoronoiError
from standoff.typing import Array

# Least and greatest number of bisections of a branch: the least so that symmetry hides no bend.
LEAST_DEPTH, MOST_DEPTH = 3, 14


@dataclass(eq=False)
class Node:
    """A point where branches end. Its kind is "corner", "focal", "junction", or "passage" where a
    foot passes a smooth vertex."""

    kind: str
    point: Array
    depth: float
    leaf: AxisEnd | None = None


@dataclass(frozen=True, eq=False)
class AxisBranch:
    """A branch between two nodes: the two edges that it separates, and its feet, centres (n, 2) and
    radii (n,) in order."""

    nodes: tuple[Node, Node]
    edges: tuple[int, int]
    feet: list[tuple[Place, Place]]
    centres: Array
    radii: Array


@dataclass(frozen=True)
class BoundaryGap:
    """The part of the boundary between two feet of a node's disc, and its leaves."""

    node: Node
    start: Place
    stop: Place
    leaves: tuple[AxisEnd, ...]


@dataclass(frozen=True)
class BoundaryWay:
    """A path along the boundary with a single parameter w: stretch k for w from k to k + 1."""

    stretches: tuple[tuple[int, float, float], ...]

    @property
    def length(self) -> float:
        return float(len(self.stretches))

    def place(self, w: float) -> Place:
        k = min(max(int(w), 0), len(self.stretches) - 1)
        n, lo, hi = self.stretches[k]
        s = w - k
        return n, min(max((1.0 - s) * lo + s * hi, lo), hi)

    def parameter(self, place: Place) -> float:
        for k, (n, lo, hi) in enumerate(self.stretches):
            if place <= (n, hi):
                return k + max((place[1] - lo) / (hi - lo), 0.0) if place[0] == n else float(k)
        return self.length


def trace_axis(outline: ArcOutline, tolerance: float) -> tuple[list[AxisBranch], list[Node]]:
    """All branches and nodes; for a disc, no branch and one node.

    Raises VoronoiError: a junction was not found.
    """
    leaves = leaves_of(outline)
    if not leaves:
        return [], [_middle_of_disc(outline)]
    count = len(outline.arcs)
    root = leaves[0]
    rest = tuple(leaf if leaf.lo >= root.hi else leaf.shifted(count) for leaf in leaves[1:])
    nodes = [Node(root.kind, root.point, root.depth, root)]
    traces: list[AxisBranch] = []
    gaps = [BoundaryGap(nodes[0], root.hi, root.shifted(count).lo, rest)]
    while gaps:
        gap = gaps.pop()
        if not gap.leaves:
            raise VoronoiError(
                f"Between {gap.start} and {gap.stop} (arc, parameter) the medial axis has no end."
            )
        if len(gap.leaves) == 1:
            leaf = gap.leaves[0]
            end = Node(leaf.kind, leaf.point, leaf.depth, leaf)
            ends = leaf.lo, leaf.hi
        else:
            found = _find_junction(outline, gap)
            end = Node("junction", found.centre, found.radius)
            ends = found.places[0], found.places[2]
        if np.linalg.norm(end.point - gap.node.point) <= SAME_PLACE * outline.size:
            end = gap.node
        else:
            nodes.append(end)
            traces += _traced(outline, gap, end, ends, tolerance)
        if len(gap.leaves) > 1:
            a, k, b = found.places
            split = _leaves_before(gap.leaves, k)
            gaps.append(BoundaryGap(end, a, k, gap.leaves[:split]))
            gaps.append(BoundaryGap(end, k, b, gap.leaves[split:]))
    return traces, nodes


def _middle_of_disc(outline: ArcOutline) -> Node:
    foot = outline.foot((0, outline.arc(0).lo))
    radius = 1.0 / foot.curvature if foot.curvature > 0.0 else np.inf
    point = foot.x - radius * foot.n
    if not all(
        np.allclose(np.linalg.norm(a.samples[0] - point, axis=1), radius, rtol=SAME_DEPTH)
        for a in outline.arcs
    ):
        raise VoronoiError("A loop with no corner and no maximum of curvature, but no circle.")
    return Node("focal", point, radius)


def _leaves_before(leaves: Sequence[AxisEnd], place: Place) -> int:
    return bisect_right([leaf.hi for leaf in leaves], place)


def _find_junction(outline: ArcOutline, gap: BoundaryGap) -> Junction:
    """The first disc in a gap with several leaves that touches the boundary between them.

    The foot at the gap's start is found by bisection: before the junction its disc touches beyond
    all leaves, after it between them.
    """
    leaves = gap.leaves
    way = BoundaryWay(tuple(outline.stretches(gap.start, leaves[0].lo)))
    low, high = 0.0, way.length
    before, after = Touch(gap.stop, np.inf), None
    for _ in range(HALVINGS):
        w = 0.5 * (low + high)
        place = way.place(w)
        touch = greatest_disc(outline, outline.foot(place), leaves[0].hi, gap.stop)
        if _leaves_before(leaves, touch.place) == len(leaves):
            low, before = w, touch
        else:
            high, after = w, touch
        if after is None or high - low > NEAR_JUNCTION:
            continue
        found = junction(outline, (way.place(high), after.place, before.place))
        if found is None or not _in_order(gap, found):
            continue
        at = way.parameter(found.places[0])
        if not low - BRACKET_SLACK <= at <= high + BRACKET_SLACK:
            continue
        first = greatest_disc(outline, outline.foot(found.places[0]), leaves[0].hi, gap.stop)
        if first.radius >= found.radius - SAME_DEPTH * outline.size:
            return found
    raise VoronoiError(
        f"No junction found between edges {outline.arc(gap.start[0]).edge} and "
        f"{outline.arc(gap.stop[0]).edge}, near the centre {gap.node.point}: some of the curves "
        "between them may be too small to be resolved in roundoff."
    )


def _in_order(gap: BoundaryGap, found: Junction) -> bool:
    a, k, b = found.places
    split = _leaves_before(gap.leaves, k)
    return (
        found.radius > 0.0
        and a <= gap.leaves[0].lo
        and gap.leaves[-1].hi <= b
        and 0 < split < len(gap.leaves)
        and k <= gap.leaves[split].lo
    )


class Point(NamedTuple):
    """A disc of a branch: the first foot's parameter w on its path, the other foot, the disc."""

    w: float
    touch: Place
    centre: Array
    radius: float


def _traced(
    outline: ArcOutline, gap: BoundaryGap, end: Node, ends: tuple[Place, Place], tolerance: float
) -> list[AxisBranch]:
    """A branch as polylines, split where a foot passes from one edge to another."""
    way = BoundaryWay(tuple(outline.stretches(gap.start, ends[0])))
    if not way.stretches:
        raise VoronoiError(f"No foot can move along the branch {gap.node.point} to {end.point}.")
    branch = _Branch(outline, way, (ends[1], gap.stop), tolerance)
    first = Point(0.0, gap.stop, gap.node.point, gap.node.depth)
    last = Point(way.length, ends[1], end.point, end.depth)
    stops, nodes = [first], [gap.node]
    for cut in branch.passages(gap.start, ends[0]):
        near = SAME_PLACE * outline.size
        if all(np.linalg.norm(cut.centre - p.centre) > near for p in (stops[-1], last)):
            stops.append(cut)
            nodes.append(Node("passage", cut.centre, cut.radius))
    stops.append(last)
    nodes.append(end)
    traces = []
    for i in range(len(nodes) - 1):
        points = [stops[i], *branch.between(stops[i], stops[i + 1]), stops[i + 1]]
        middle = points[len(points) // 2]
        traces.append(
            AxisBranch(
                (nodes[i], nodes[i + 1]),
                (outline.arc(way.place(middle.w)[0]).edge, outline.arc(middle.touch[0]).edge),
                [(way.place(p.w), p.touch) for p in points],
                np.array([p.centre for p in points]),
                np.array([p.radius for p in points]),
            )
        )
    return traces


@dataclass(frozen=True)
class _Branch:
    """One foot moves along `way`, the other one backwards within `span`."""

    outline: ArcOutline
    way: BoundaryWay
    span: tuple[Place, Place]
    tolerance: float

    def point(self, w: float) -> Point:
        foot = self.outline.foot(self.way.place(w))
        touch = greatest_disc(self.outline, foot, *self.span)
        return Point(w, touch.place, foot.x - touch.radius * foot.n, touch.radius)

    def passages(self, start: Place, stop: Place) -> list[Point]:
        """Where a foot passes a joint of two edges, in the branch's order."""
        found = [
            self.point(self.way.parameter((n, self.outline.arc(n).lo)))
            for n in range(start[0] + 1, stop[0] + 1)
            if self._joins(n)
        ]
        for n in range(self.span[0][0] + 1, self.span[1][0] + 1):
            if not self._joins(n):
                continue
            place = n, self.outline.arc(n).lo
            foot = self.outline.foot(place)
            touch = greatest_disc(self.outline, foot, start, stop)
            centre = foot.x - touch.radius * foot.n
            found.append(Point(self.way.parameter(touch.place), place, centre, touch.radius))
        return sorted(found, key=lambda p: p.w)

    def _joins(self, n: int) -> bool:
        return self.outline.arc(n - 1).edge != self.outline.arc(n).edge

    def between(self, a: Point, b: Point, depth: int = 0) -> list[Point]:
        """Points of the branch between two others, so dense that its chords stay close to it."""
        middle = self.point(0.5 * (a.w + b.w))
        chord = b.centre - a.centre
        length = float(np.linalg.norm(chord))
        out = middle.centre - a.centre
        share = min(max(float(out @ chord) / length**2, 0.0), 1.0) if length > 0.0 else 0.0
        off = float(np.linalg.norm(out - share * chord))
        fine = off <= self.tolerance and length <= LONGEST_CHORD * self.outline.size
        if (fine and depth >= LEAST_DEPTH) or depth >= MOST_DEPTH:
            return [middle]
        return [
            *self.between(a, middle, depth + 1),
            middle,
            *self.between(middle, b, depth + 1),
        ]
