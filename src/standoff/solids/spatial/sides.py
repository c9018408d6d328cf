"""Which side of a boundary is outside, at a point of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from standoff.bodies.tessellation import chart_row, coedge_range
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import chart_normal, coedge_parameters, edge_jet
from standoff.kernels.entries.solid_points import outward_at
from standoff.kernels.solids.spatial_tolerances import NO_SIDE
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.tolerances import CUSP, PIECE_END_SPARE
from standoff.typing import Array


def outside_direction(solid: SolidModel, leaf: int, u: float, v: float) -> Array | None:
    """A vector d at a point y of the boundary, own frame: a point p whose nearest point of the
    boundary is y is outside where d . (p - y) > 0. None where it is not known.

    At an edge p - y is a sum of the faces' normals with weights of one sign, so their plain sum
    tells which. At a vertex the normals' sum weighted by the faces' angles there does (Baerentzen
    and Aanaes, 2005).
    """
    part = solid.leaves[leaf]
    vertices = [number_of(solid, leaf)] if part.dim == 0 else []
    normals = vertex_normals_of(solid, vertices).ravel()
    found = np.array(outward_at(solid.packed, normals, int(leaf), float(u), float(v)))
    return found if found.any() else None


def number_of(solid: SolidModel, leaf: int) -> int:
    """Of a leaf that is a vertex, among the vertices."""
    return int(solid.leaves[leaf].feature - solid.boundary.n_faces - solid.boundary.n_edges)


class Corner(NamedTuple):
    """Of a face at a vertex: unit directions along the edges that leave it and that arrive, the
    outward unit normal, and the face's angle from the one to the other, 0 to 2 pi."""

    out: Array
    into: Array
    normal: Array
    angle: float


def corners_at(
    solid: SolidModel, vertex: int, charts: Iterable[int]
) -> tuple[list[Corner], dict[int, list[Array]]]:
    """The faces' corners at a vertex, and the ways from it along the edges of charts of which no
    corner is known: with sides that are collapsed to it, or edges without a direction. All charts
    that are there are among `charts`.

    The charts of an atlas overlap: of each face the one that sees most of the edges' ends counts.
    Corners of one face do not overlap: what leaves belongs to the next that arrives.
    """
    boundary = solid.boundary
    seen: dict[int, tuple[int, list[Array], list[Array], Array | None]] = {}
    for chart in charts:
        out, into, normal = _ends_at(solid, chart, vertex)
        face = int(chart_row(boundary, chart)[L.CHART_FACE])
        if (out or into) and (
            face not in seen or len(out) + len(into) > len(seen[face][1]) + len(seen[face][2])
        ):
            seen[face] = (chart, out, into, normal)
    corners: list[Corner] = []
    unknown: dict[int, list[Array]] = {}
    for chart, out, into, normal in seen.values():
        ways = [way for way in (*out, *into) if way.any()]
        size = 0.0 if normal is None else float(np.linalg.norm(normal))
        if size == 0.0 or normal is None or 2 * len(out) != len(ways) or len(out) != len(into):
            unknown[chart] = ways
            continue
        n = normal / size
        for a in out:
            across = np.cross(n, a)
            angles = [float(np.arctan2(across @ b, a @ b) % (2.0 * np.pi)) for b in into]
            k = int(np.argmin(angles))
            corners.append(Corner(a, into[k], n, angles[k]))
    return corners, unknown


def _at_vertex(solid: SolidModel, vertex: int, charts: Iterable[int]) -> Array | None:
    """The sum of the faces' normals at a vertex, each weighted by the face's angle there; None
    where a corner is not known, or a cusp, whose angle may be 0 or all around."""
    corners, unknown = corners_at(solid, vertex, charts)
    angles = np.array([corner.angle for corner in corners])
    if unknown or np.any(np.minimum(angles, 2.0 * np.pi - angles) < CUSP):
        return None
    total = np.sum([corner.angle * corner.normal for corner in corners], axis=0)
    return total if float(np.linalg.norm(total)) > NO_SIDE else None


def _ends_at(
    solid: SolidModel, chart: int, vertex: int
) -> tuple[list[Array], list[Array], Array | None]:
    """Directions from a vertex along the edges of a chart's loop that leave it and that arrive,
    counterclockwise seen from outside; and the outward normal there."""
    boundary = solid.boundary
    ints, reals = boundary.ints, boundary.reals
    row = chart_row(boundary, chart)
    outward = reals[int(row[L.CHART_REALS]) + L.OUTWARD]
    out: list[Array] = []
    into: list[Array] = []
    normal = None
    for coedge in coedge_range(boundary, chart):
        at = int(ints[L.COEDGES]) + L.COEDGE_STRIDE * coedge
        edge = int(ints[at + L.COEDGE_EDGE])
        if edge < 0:
            if -1 - edge == vertex:
                return [], [np.zeros(3)], None  # a collapsed side: no plane corner
            continue
        side = float(ints[at + L.COEDGE_SIDE]) * outward
        part = boundary.edge_parts[edge]
        o = int(ints[at + L.COEDGE_REALS])
        for end, sign in ((part.first, 1.0), (part.last, -1.0)):
            t = part.curve.first if sign > 0.0 else part.curve.last
            if (
                end != vertex
                or not reals[o] - PIECE_END_SPARE <= t <= reals[o + 1] + PIECE_END_SPARE
            ):
                continue
            tangent = np.array(edge_jet(ints, reals, boundary.n_faces + edge, t)[1])
            size = float(np.linalg.norm(tangent))
            (out if sign * side > 0.0 else into).append(sign * tangent / size if size else tangent)
            u, v, *_ = coedge_parameters(ints, reals, coedge, t)
            normal = np.array(chart_normal(ints, reals, chart, u, v))
    return out, into, normal


def charts_at(solid: SolidModel) -> dict[int, list[int]]:
    """The charts around each vertex."""
    boundary = solid.boundary
    found: dict[int, list[int]] = defaultdict(list)
    for chart in range(int(boundary.ints[L.N_CHARTS])):
        mine: set[int] = set()
        for coedge in coedge_range(boundary, chart):
            at = int(boundary.ints[L.COEDGES]) + L.COEDGE_STRIDE * coedge
            edge = int(boundary.ints[at + L.COEDGE_EDGE])
            if edge < 0:
                mine.add(-1 - edge)
                continue
            part = boundary.edge_parts[edge]
            mine.update(end for end in (part.first, part.last) if end is not None)
        for vertex in sorted(mine):
            found[vertex].append(chart)
    return found


def vertex_normals_of(solid: SolidModel, vertices: Iterable[int] | None = None) -> Array:
    """What `outside_direction` tells at all vertices (n, 3), nan where it is not known; where some
    of them are named, at these: what others have is not said then."""
    if solid.vertex_normals is None:
        solid.vertex_normals = np.full((solid.boundary.n_vertices, 3), np.inf)
    found = solid.vertex_normals
    missing: list[int] = np.flatnonzero(np.isinf(found[:, 0])).tolist()
    if vertices is None:
        around = charts_at(solid) if missing else {}
    else:
        missing = [vertex for vertex in vertices if np.isinf(found[vertex, 0])]
        every = list(range(int(solid.boundary.ints[L.N_CHARTS])))
        around = dict.fromkeys(missing, every)
    for vertex in missing:
        told = _at_vertex(solid, vertex, around[vertex])
        found[vertex] = np.nan if told is None else told
    return found
