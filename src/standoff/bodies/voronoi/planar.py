"""Voronoi regions of a planar body: rays outside, the medial axis inside."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.features import Feature
from standoff.bodies.voronoi.checks import check_axis
from standoff.bodies.voronoi.discs import edge_distances
from standoff.bodies.voronoi.medial_axis import Node, Trace, trace_axis
from standoff.bodies.voronoi.outline import Outline, Place, outline_of
from standoff.bodies.voronoi.regions import (
    BranchEnd,
    MedialBranch,
    NormalCone,
    RegionBoundary,
    VoronoiRegions,
)
from standoff.bodies.voronoi.tolerances import FINEST_POLYLINE, POLYLINE, SAME_PLACE
from standoff.checks.numbers import magnitude
from standoff.errors import StandoffError
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


def _outside(outline: Outline) -> tuple[tuple[RegionBoundary, ...], tuple[NormalCone, ...]]:
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


def _branches(outline: Outline, traces: list[Trace], nodes: list[Node]) -> tuple[MedialBranch, ...]:
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


def _branch(outline: Outline, trace: Trace, ends: dict[int, BranchEnd]) -> MedialBranch:
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


def _parameter(outline: Outline, place: Place, edge: int) -> float:
    """The curve's own parameter at a place of an edge, or at its end next to the place."""
    n, u = place
    arc = outline.arc(n)
    if arc.edge != edge:  # the same joint, from its other side
        other = outline.arc(n + 1) if u >= arc.hi else outline.arc(n - 1)
        u = other.lo if u >= arc.hi else other.hi
        arc = other
    return arc.sign * u


def _end(outline: Outline, node: Node) -> BranchEnd:
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
