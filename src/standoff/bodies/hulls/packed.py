"""The two flat arrays of a polyhedron, the same that ``bodies.packing`` writes part by part."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.bodies.hulls.joints import Cones, WideCorners
from standoff.bodies.hulls.polyhedron import Polyhedron
from standoff.bodies.packing import Counts, Sample, Writer, put_header, put_samples
from standoff.kernels.body import layout as L
from standoff.typing import Array, Bools, Ints

# A line's pcurve: its range, then the 3 x 3 matrix; an edge's line: its range, 3 x 3 map and shift.
COEDGE_REALS = L.PCURVE_DATA + 9
LINE_REALS = L.CURVE_DATA + 12
SECTOR_REALS = 5


def pack_polyhedron(
    solid: Polyhedron,
    joints: tuple[Bools, Cones, WideCorners],
    pcurves: Array,
    box: tuple[Array, Array],
    inner: Array,
    radius: float,
    slack: float,
    samples: Sequence[Sample],
) -> tuple[Ints, Array]:
    """The (ints, reals) of a polyhedron.

    joints : which edges are smooth, the normal cones, the wide corners; inner : (f, 4) rectangles
    of parameters on the faces; the others as for ``packing.pack``.
    """
    smooth, cones, wide = joints
    w = Writer()
    faces, edges, vertices = solid.n_faces, len(solid.ends), len(solid.vertices)
    put_header(w, Counts(3, faces, edges, vertices, faces, len(samples)), box, radius, slack)
    _put_faces(w, solid, pcurves, inner)
    _put_edges(w, solid, smooth)
    _put_vertices(w, solid, cones, wide)
    put_samples(w, samples)
    return w.arrays()


def _put_faces(w: Writer, solid: Polyhedron, pcurves: Array, inner: Array) -> None:
    faces, corners = solid.n_faces, len(solid.corners)
    number, places = np.arange(faces), np.arange(corners)
    charts = len(w.reals) + L.SURFACE_DATA * number + COEDGE_REALS * solid.starts[:-1]
    coedges = len(w.reals) + L.SURFACE_DATA * (solid.owners + 1) + COEDGE_REALS * places
    block = np.zeros(L.SURFACE_DATA * faces + COEDGE_REALS * corners)
    surface = np.zeros((faces, L.SURFACE_DATA))
    surface[:, L.AFFINE : L.AFFINE + 9] = solid.planes.reshape(faces, 9)
    surface[:, L.AFFINE + 9 : L.AFFINE + 12] = solid.shifts
    surface[:, L.INVERSE : L.INVERSE + 9] = np.linalg.inv(solid.planes).reshape(faces, 9)
    surface[:, L.OUTWARD], surface[:, L.LIMIT] = 1.0, np.inf
    surface[:, L.INNER : L.INNER + 4] = inner
    own = np.zeros((corners, COEDGE_REALS))
    own[:, L.PCURVE_LAST] = own[:, -1] = 1.0
    own[:, L.PCURVE_DATA : L.PCURVE_DATA + 6] = pcurves.reshape(corners, 6)
    block[charts[:, None] - len(w.reals) + np.arange(L.SURFACE_DATA)] = surface
    block[coedges[:, None] - len(w.reals) + np.arange(COEDGE_REALS)] = own
    w.real_block(block)
    ones = np.ones(faces, dtype=np.int64)
    w.table(L.FACES, np.column_stack([number, ones]))
    kind, plain = L.PLANE * ones, 0 * ones
    rows = [kind, charts, solid.starts[:-1], np.diff(solid.starts), number, plain]
    w.table(L.CHARTS, np.column_stack(rows))
    line = np.full(corners, L.LINE)
    w.table(L.COEDGES, np.column_stack([solid.edges, line, coedges, solid.senses, solid.owners]))


def _put_edges(w: Writer, solid: Polyhedron, smooth: Bools) -> None:
    first, last = (solid.vertices[solid.ends[:, k]] for k in range(2))
    n = len(first)
    block = np.zeros((n, LINE_REALS))
    block[:, L.EDGE_T1] = 1.0
    block[:, L.CURVE_DATA : L.CURVE_DATA + 9 : 3] = last - first
    block[:, L.CURVE_DATA + 9 :] = first
    offsets = w.real_block(block.ravel()) + LINE_REALS * np.arange(n)
    flags = np.where(smooth, L.SMOOTH, 0)
    kind = np.full(n, L.LINE)
    w.table(L.EDGES, np.column_stack([kind, offsets, flags, solid.ends, solid.sides]))


def _put_vertices(w: Writer, solid: Polyhedron, cones: Cones, wide: WideCorners) -> None:
    n = len(solid.vertices)
    fans = np.bincount(solid.ends.ravel(), minlength=n)
    sectors = np.bincount(wide.vertices, minlength=n)
    reals = 3 + SECTOR_REALS * sectors + 3 * cones.counts
    points = len(w.reals) + np.cumsum(reals) - reals
    ints = 2 * (fans + sectors)
    rows = len(w.ints) + L.VERTEX_STRIDE * n
    fan_at = rows + np.cumsum(ints) - ints
    sector_at, cone_at = fan_at + 2 * fans, points + 3 + SECTOR_REALS * sectors
    base = len(w.reals)
    block = np.zeros(int(reals.sum()))
    block[points[:, None] - base + np.arange(3)] = solid.vertices
    sector_reals = points[wide.vertices] + 3 + SECTOR_REALS * _ranks(wide.vertices)
    sector = np.column_stack(
        [np.full(len(wide.faces), float(L.SECTOR_WIDE)), wide.spots, wide.spans]
    )
    block[sector_reals[:, None] - base + np.arange(SECTOR_REALS)] = sector
    at = np.repeat(np.arange(n), cones.counts)
    place = cone_at[at] + 3 * _ranks(at)
    block[place[:, None] - base + np.arange(3)] = solid.normals[cones.faces]
    w.real_block(block)
    w.table(
        L.VERTICES,
        np.column_stack([points, fan_at, fans, sector_at, sectors, cone_at, cones.counts]),
    )
    tail = np.zeros(int(ints.sum()), dtype=np.int64)
    order = np.argsort(solid.ends.ravel(), kind="stable")
    owner = solid.ends.ravel()[order]
    spot = fan_at[owner] - rows + 2 * _ranks(owner)
    tail[spot], tail[spot + 1] = order // 2, order % 2
    spot = sector_at[wide.vertices] - rows + 2 * _ranks(wide.vertices)
    tail[spot], tail[spot + 1] = wide.faces, sector_reals
    w.int_block(tail)


def _ranks(ascending: Ints) -> Ints:
    """Of every item of an ascending array how many equal ones come before it."""
    begins = np.searchsorted(ascending, ascending)
    return np.asarray(np.arange(len(ascending)) - begins, dtype=np.int64)
