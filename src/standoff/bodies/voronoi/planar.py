"""Voronoi regions of a planar body: rays outside, the medial axis inside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.voronoi.discs import edge_distances, greatest_disc
from standoff.bodies.voronoi.medial_axis import AxisBranch, Node, trace_axis
from standoff.bodies.voronoi.outline import ArcOutline, Place, outline_of
from standoff.bodies.voronoi.regions import (
    BranchEnd,
    MedialBranch,
    NormalCone,
    RegionBoundary,
    VoronoiRegions,
)
from standoff.bodies.voronoi.tolerances import (
    CHECK_SAMPLES,
    FINEST_POLYLINE,
    POLYLINE,
    SAME_DEPTH,
    SAME_PLACE,
)
from standoff.checks.numbers import magnitude
from standoff.errors import StandoffError, VoronoiError
from standoff.typing import Array


def planar_regions(body: Body, reach: float, tolerance: float | None) -> VoronoiRegions:
    """See ``voronoi_regions``; tolerance None for the default."""
    outline = outline_of(body)
    if tolerance is None:
        tolerance = POLYLINE * outline.size
    elif magnitude(tolerance, "tolerance") < FINEST_POLYLINE * outline.size:
        raise StandoffError(
            f"tolerance = {tolerance:g} is too fine for the size {outline.size:.3g}: give at least "
            f"{FINEST_POLYLINE * outline.size:.3g}.",
            "tolerance",
            tolerance,
        )
    traces, nodes = trace_axis(outline, tolerance)
    branches = _branches(outline, traces, nodes)
    check_axis(outline, branches, tolerance)
    external, cones = _outside(outline)
    return VoronoiRegions(body, reach, external, branches, cones)


def _outside(outline: ArcOutline) -> tuple[tuple[RegionBoundary, ...], tuple[NormalCone, ...]]:
    """The normals at every vertex as rays, and as cones."""
    rays: list[RegionBoundary] = []
    cones: list[NormalCone] = []
    for n, number in enumerate(outline.joints):
        if number < 0:
            continue
        before, after = outline.arc(n - 1), outline.arc(n)
        edges = Feature("edge", before.edge), Feature("edge", after.edge)
        vertex = Feature("vertex", number)
        foot = after.foot(after.lo)
        point = _in_space(foot.x)
        normals = _in_space(np.array([before.foot(before.hi).n, foot.n]))
        cones.append(NormalCone(vertex, point, normals))
        if outline.corner(n):
            pairs = ((edges[0], vertex), normals[:1]), ((edges[1], vertex), normals[1:])
            rays += [RegionBoundary(pair, point[None], normal) for pair, normal in pairs]
        elif edges[0] != edges[1]:
            rays.append(RegionBoundary(edges, point[None], normals[:1]))
    cones.sort(key=lambda cone: cone.vertex)
    return tuple(rays), tuple(cones)


def _branches(
    outline: ArcOutline, traces: list[AxisBranch], nodes: list[Node]
) -> tuple[MedialBranch, ...]:
    ends = {id(node): _end(outline, node) for trace in traces for node in trace.nodes}
    if not traces:  # a disc
        centre, edges = nodes[0], sorted({arc.edge for arc in outline.arcs})
        end = BranchEnd("focal", tuple(Feature("edge", j) for j in edges))
        arc = outline.arc(0)
        pair = Feature("edge", arc.edge), Feature("edge", outline.arc(-1).edge)
        parameters = np.array([[arc.sign * arc.lo, outline.arc(-1).sign * outline.arc(-1).hi]])
        depth = np.array([centre.depth])
        return (MedialBranch(pair, (end, end), _in_space(centre.point[None]), depth, parameters),)
    return tuple(_branch(outline, trace, ends) for trace in traces)


def _branch(outline: ArcOutline, trace: AxisBranch, ends: dict[int, BranchEnd]) -> MedialBranch:
    first, last = trace.nodes
    parameters = np.array(
        [
            [_parameter(outline, p, edge) for p, edge in zip(feet, trace.edges, strict=True)]
            for feet in trace.feet
        ]
    )
    return MedialBranch(
        (Feature("edge", trace.edges[0]), Feature("edge", trace.edges[1])),
        (ends[id(first)], ends[id(last)]),
        _in_space(trace.centres),
        trace.radii,
        parameters,
    )


def _parameter(outline: ArcOutline, place: Place, edge: int) -> float:
    """The curve's own parameter at a place of an edge, or at its end next to the place."""
    n, u = place
    arc = outline.arc(n)
    if arc.edge != edge:  # the same joint, from its other side
        other = outline.arc(n + 1) if u >= arc.hi else outline.arc(n - 1)
        u = other.lo if u >= arc.hi else other.hi
        arc = other
    return arc.sign * u


def _end(outline: ArcOutline, node: Node) -> BranchEnd:
    if node.kind == "corner" and node.leaf is not None:
        vertex = outline.joints[node.leaf.hi[0] % len(outline.arcs)]
        return BranchEnd("corner", (Feature("vertex", vertex),))
    near = node.depth + SAME_PLACE * outline.size
    if node.kind == "passage":
        joints = {
            vertex: float(np.linalg.norm(arc.jet(arc.lo)[0] - node.point))
            for vertex, arc in zip(outline.joints, outline.arcs, strict=True)
            if vertex >= 0
        }
        passed = sorted(vertex for vertex, distance in joints.items() if distance <= near)
        return BranchEnd("passage", tuple(Feature("vertex", v) for v in passed))
    if node.kind == "focal" and node.leaf is not None:
        edges = {outline.arc(p[0]).edge for p in (node.leaf.lo, node.leaf.hi)}
    else:
        found = edge_distances(outline, node.point)
        edges = {edge for edge, (distance, _) in found.items() if distance <= near}
    return BranchEnd(node.kind, tuple(Feature("edge", j) for j in sorted(edges)))


def _in_space(points: Array) -> Array:
    """(..., 2) as read-only (..., 3) in z = 0."""
    full = np.concatenate([points, np.zeros((*points.shape[:-1], 1))], axis=-1)
    full.flags.writeable = False
    return full


# Checks of a medial axis by brute force: that it is correct and complete.

# The polyline may miss the true axis by its tolerance between two points, but this was checked at
# only one point between them: this many times more is certainly wrong.
DOUBT = 8.0


def check_axis(outline: ArcOutline, branches: Sequence[MedialBranch], tolerance: float) -> None:
    """Raise VoronoiError if the edges of a branch are not nearest, or if a branch is missing."""
    for branch in branches:
        _check_nearest(outline, branch)
    _check_complete(outline, branches, DOUBT * tolerance)


def _check_nearest(outline: ArcOutline, branch: MedialBranch) -> None:
    allowed = SAME_DEPTH * outline.size
    for point, depth in zip(branch.points, branch.depth, strict=True):
        found = edge_distances(outline, point[:2])
        least = min(distance for distance, _ in found.values())
        worst = max(abs(found[f.index][0] - depth) for f in branch.features)
        if not (worst <= allowed and abs(least - depth) <= allowed):
            raise VoronoiError(
                f"The branch of {branch.features[0]} and {branch.features[1]} fails its check at "
                f"{point[:2]}: depth {depth:.12g}, the two edges' distances differ from it by up "
                f"to {worst:.3g}, the nearest edge's by {abs(least - depth):.3g}; allowed is "
                f"{allowed:.3g}."
            )


def _check_complete(outline: ArcOutline, branches: Sequence[MedialBranch], allowed: float) -> None:
    """Check that the largest disc at every boundary point has its centre on the axis."""
    starts = np.vstack([b.points[: max(len(b.points) - 1, 1), :2] for b in branches])
    stops = np.vstack([b.points[min(len(b.points) - 1, 1) :, :2] for b in branches])
    count = len(outline.arcs)
    for n, arc in enumerate(outline.arcs):
        for share in (np.arange(CHECK_SAMPLES) + 0.5) / CHECK_SAMPLES:
            u = float(arc.lo + share * (arc.hi - arc.lo))
            foot = arc.foot(u)
            radius = greatest_disc(outline, foot, (n, u), (n + count, u), graded=False).radius
            if foot.curvature > 0.0:
                radius = min(radius, 1.0 / foot.curvature)
            miss = _to_segments(foot.x - radius * foot.n, starts, stops)
            if not miss <= allowed:
                raise VoronoiError(
                    f"A branch of the medial axis is missing: the largest disc inside at {foot.x} "
                    f"(edge {arc.edge}) has its centre {miss:.3g} off the axis found."
                )


def _to_segments(point: Array, starts: Array, stops: Array) -> float:
    """Distance to the nearest of segments, (m, 2) each."""
    along, out = stops - starts, point - starts
    square = np.einsum("ij,ij->i", along, along)
    dots = np.einsum("ij,ij->i", along, out)
    share = np.clip(dots / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return float(np.linalg.norm(out - share[:, None] * along, axis=1).min())
