"""The hull of points as a packed body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.assembly import roundoff_note
from standoff.bodies.convexity import Convexity
from standoff.bodies.finishing import PackedBoundary, slack_of
from standoff.bodies.hulls.fewer_points import fewer_points
from standoff.bodies.hulls.heights import highest
from standoff.bodies.hulls.joints import (
    VertexCones,
    WideCorners,
    edge_turns,
    vertex_cones,
    wide_corners,
    widening,
)
from standoff.bodies.hulls.merging import merged
from standoff.bodies.hulls.outlines import Outlines, outlines
from standoff.bodies.hulls.polyhedron import Polyhedron, polyhedron
from standoff.bodies.hulls.qhull import hull_triangles
from standoff.bodies.made_parts import MadeParts
from standoff.bodies.packing import (
    ArrayWriter,
    Assembled,
    PartCounts,
    Sample,
    put_header,
    put_samples,
)
from standoff.bodies.report import BodyReport, DihedralAngle, PatchCheck
from standoff.bodies.sampling import (
    EDGE_BUDGET,
    FACE_BUDGET,
    VERTEX_BUDGET,
    along_each,
    first_grid,
    second_grid,
    stride,
)
from standoff.bodies.tolerances import (
    CONVEXITY_TOLERANCE,
    FAR_OFF,
    INNER_SHARE,
    JOIN_TOLERANCE,
    ON_SIDE,
    ROUNDOFF,
    SMOOTH_ANGLE,
    THIN,
    coordinate_roundoff,
)
from standoff.bodies.topology import Edge, Face
from standoff.errors import BodyError
from standoff.geometry.curves import Line
from standoff.geometry.quadrics import Plane
from standoff.kernels.body import layout as L
from standoff.typing import Array, Bools, Ints

# A polyhedron has as many faces at least.
LEAST_FACES = 4


def hull(
    points: Array, radius: float, tolerance: float | None = None, word: str = "vertices"
) -> PackedBoundary:
    """The hull of points, (n, 3), swept by a ball.

    Raises BodyError: the points span no volume, are too thin for their extent, or extend over too
    little.

    Parameters
    ----------
    tolerance : how far points that are left out may be above the faces, length; by default those
        alone are left out that are no vertices of the hull.
    word : what a message calls the points.
    """
    middle = middle_of(points)
    try:
        kept = points if tolerance is None else fewer_points(points, tolerance, word)
        found = facets(kept - middle, word)
        packed = solid_body(kept, found, radius, points, tolerance)
    except BodyError as error:
        # Points that Qhull finds in one plane are told as such.
        thin = None if error.__cause__ is not None else thin_error(points, word)
        if thin is None:
            raise
        raise thin from error
    return recentred(packed, points, middle)


def facets(points: Array, word: str = "vertices") -> Outlines:
    """The outlines of the faces of the points' hull; facets of one plane are one face."""
    triangles, reach = hull_triangles(points, word), coordinate_roundoff(points)
    found = outlines(points, triangles, merged(points, triangles, reach), reach)
    if len(found.starts) <= LEAST_FACES:
        raise thin_error(points, word) or BodyError("The hull has no four faces.")
    return found


def solid_body(
    points: Array,
    found: Outlines,
    radius: float,
    given: Array | None = None,
    tolerance: float | None = None,
    above: float = 0.0,
    solid: Polyhedron | None = None,
) -> PackedBoundary:
    """The polyhedron with given outlines, whose corners are among the points, (n, 3).

    Raises BodyError: a face whose corners are not in its plane, or a point above one.

    Parameters
    ----------
    given : all points that it should be the hull of, each compared with each face; by default
        those with the corners.
    tolerance : how far they may be above a face, length; 1e-6 of the size by default.
    above : how far other points, known to be within its hull, are above a face, length.
    solid : the polyhedron of these outlines, where it is known.
    """
    given = points if given is None else given
    low, high = points.min(axis=0), points.max(axis=0)
    size, roundoff = float(np.linalg.norm(high - low)), coordinate_roundoff(points)
    if solid is None:
        solid = polyhedron(points, found, max(ROUNDOFF * size, roundoff))
    allowed = max(JOIN_TOLERANCE * size, roundoff)
    residual = _residual(solid, found, allowed)
    share = max(CONVEXITY_TOLERANCE * size if tolerance is None else tolerance, allowed)
    defect = max(_defect(given, solid, share), above)
    turns, cones, pcurves = edge_turns(solid), vertex_cones(solid), solid.pcurves()
    smooth = (np.abs(turns) <= SMOOTH_ANGLE) & (np.abs(np.sin(turns)) < SMOOTH_ANGLE)
    joints = smooth, cones, wide_corners(solid, pcurves)
    noise = max(ROUNDOFF * size, roundoff)
    widen = widening(solid, turns, cones) if max(defect, residual) > noise else 1.0
    slack = slack_of(Convexity((), defect, widen), residual, 0.0, noise)
    parts = Assembled(3, solid.vertices, Edges(solid), Faces(solid), [])
    inner = inner_rectangles(solid, pcurves)
    samples = polyhedron_samples(solid, pcurves)
    ints, reals = pack_polyhedron(
        solid, joints, pcurves, (low, high), inner, radius, slack, samples
    )
    notes = _notes(found, len(given) - len(points), defect, residual, size, roundoff)
    report = BodyReport(
        **_facts(solid, turns, smooth),
        size=size + 2.0 * radius,
        convexity_defect=defect,
        notes=notes,
        convexity_tolerance=share,
        sewing_residual=residual,
        sewing_tolerance=allowed,
        slack=slack,
        coordinate_roundoff=roundoff,
    )
    return PackedBoundary(parts, ints, reals, report)


def _facts(solid: Polyhedron, turns: Array, smooth: NDArray[np.bool_]) -> dict[str, Any]:
    """What a report says of the parts: counts, and the angles of the edges."""
    return {
        "dimension": 3,
        "faces": solid.n_faces,
        "edges": len(solid.ends),
        "vertices": len(solid.vertices),
        "smooth_edges": int(smooth.sum()),
        "charts": solid.n_faces,
        "closed": True,
        "outward": True,
        "patches": plane_checks(solid.n_faces),
        "sharpest": _dihedral(solid, turns, int(turns.argmax())),
        "flattest": _dihedral(solid, turns, int(turns.argmin())),
    }


def image_of(
    solid: Polyhedron, linear: Array, shift: Array, radius: float, above: float
) -> PackedBoundary:
    """The image of a polyhedron under an affine map, x -> linear x + shift, swept by a ball.

    Its parts have the parameters of the given one's, but for a mirror's.

    above : as for `solid_body`, of the image.
    """
    points = solid.vertices @ linear.T + shift
    if np.linalg.det(linear) < 0.0:  # a mirror turns the outlines round
        starts = solid.starts
        ends = np.repeat(starts[:-1] + starts[1:] - 1, np.diff(starts))
        turned = solid.corners[ends - np.arange(len(solid.corners))]
        normals = np.asarray(np.linalg.solve(linear.T, solid.normals.T).T, dtype=np.float64)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        found = Outlines(turned, starts, normals)
        return solid_body(points, found, radius, tolerance=above or None, above=above)
    planes, shifts = linear @ solid.planes, solid.shifts @ linear.T + shift
    normals = np.cross(planes[:, :, 0], planes[:, :, 1])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for array in (points, planes, shifts, normals):
        array.flags.writeable = False
    image = replace(solid, vertices=points, planes=planes, shifts=shifts, normals=normals)
    found = Outlines(solid.corners, solid.starts, normals)
    return solid_body(points, found, radius, tolerance=above or None, above=above, solid=image)


def _residual(solid: Polyhedron, found: Outlines, allowed: float) -> float:
    """How far faces are from their corners, and from those left out on straight sides."""
    away = solid.vertices[solid.corners] - solid.shifts[solid.owners]
    off = np.abs(np.einsum("ij,ij->i", away, solid.normals[solid.owners]))
    worst = int(off.argmax())
    if off[worst] > allowed:
        raise BodyError(
            f"Face {solid.owners[worst]} misses its corner {solid.vertices[solid.corners[worst]]} "
            f"by {off[worst]:.3g}, more than tolerance={allowed:.3g} allows."
        )
    return max(float(off[worst]), found.left_out)


def _defect(points: Array, solid: Polyhedron, allowed: float) -> float:
    """How far a point is above a face at most."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    normals = solid.normals
    offsets = np.einsum("ij,ij->i", normals, solid.shifts - middle)
    heights, numbers = highest(points - middle, normals, offsets)
    worst = int(heights.argmax())
    if not heights[worst] <= allowed:
        raise BodyError(
            f"Not convex: the point {points[numbers[worst]]} is {heights[worst]:.3g} above face "
            f"{worst} at {solid.shifts[worst]}, more than {allowed:.3g}; its corners are too "
            "nearly in one line. Leave out points that are nearly on it, or give a tolerance."
        )
    return float(heights[worst])


def _notes(
    found: Outlines, left_out: int, defect: float, residual: float, size: float, roundoff: float
) -> tuple[str, ...]:
    notes = []
    if left_out:
        notes.append(
            f"{left_out} points left out: they are inside the hull of the others, or up to "
            f"{defect:.3g} above its faces"
        )
    if residual > max(ROUNDOFF * size, roundoff):
        notes.append(
            f"facets nearly in one plane are one face: corners are off theirs by up to "
            f"{residual:.3g}"
        )
    if found.split:
        notes.append(
            f"{found.split} groups of facets nearly in one plane have no single outline: their "
            "facets stay faces of their own"
        )
    if roundoff > JOIN_TOLERANCE * size > 0.0:
        notes.append(roundoff_note(roundoff))
    return tuple(notes)


def _dihedral(solid: Polyhedron, turns: Array, edge: int) -> DihedralAngle:
    x, y, z = solid.vertices[solid.ends[edge]].mean(axis=0).tolist()
    return DihedralAngle(np.pi - float(turns[edge]), edge, 0.5, (x, y, z))


def middle_of(points: Array) -> Array:
    """About which the hull is taken: the middle of points that are far off, else the origin."""
    extent = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    if extent == 0.0 or float(np.abs(points).max()) <= FAR_OFF * extent:
        return np.zeros(3)
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def recentred(packed: PackedBoundary, given: Array, middle: Array) -> PackedBoundary:
    """A hull that was taken about a middle, with a note of it."""
    if not middle.any():
        return packed
    away = float(np.abs(given).max()) / float(np.ptp(given, axis=0).max())
    note = f"recentred: the hull is computed about {middle}: the origin is {away:.3g} extents away"
    notes = (note, *packed.report.notes)
    return replace(packed, report=replace(packed.report, notes=notes))


def thin_error(points: Array, word: str) -> BodyError | None:
    """What to say of a polytope that cannot be built, if it is because it is thin."""
    axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]
    extent, thickness = (float(np.ptp(points @ axis)) for axis in (axes[0], axes[-1]))
    if thickness >= THIN * extent:
        return None
    return BodyError(
        f"The {len(points)} {word} are too nearly in one plane: {thickness:.3g} thick on an "
        f"extent of {extent:.3g}, so that its facets cannot be distinguished. Make it thicker than "
        f"{THIN * extent:.1g}, or use a flat body, so.shapes.polygon."
    )


# Edges and faces of a polyhedron as objects.


class Edges(MadeParts[Edge]):
    """The edges of a `Polyhedron`."""

    source: Polyhedron

    def __len__(self) -> int:
        return len(self.source.ends)

    def make(self, number: int) -> Edge:
        first, last = self.source.ends[number].tolist()
        vertices = self.source.vertices
        return Edge(Line(vertices[first], vertices[last]), first, last)


class Faces(MadeParts[Face]):
    """The faces of a `Polyhedron`."""

    source: Polyhedron

    def __len__(self) -> int:
        return self.source.n_faces

    def make(self, number: int) -> Face:
        solid = self.source
        own = slice(*solid.starts[number : number + 2])
        plane = Plane(solid.planes[number], solid.shifts[number])
        loop = zip(solid.edges[own].tolist(), solid.senses[own].tolist(), strict=True)
        return Face((plane,), tuple(loop))


def plane_checks(count: int) -> tuple[PatchCheck, ...]:
    """Of so many plane faces that each is convex, by theorem."""
    return tuple(
        PatchCheck(k, "Plane", "theorem", True, 0.0, True, (0.0, 0.0)) for k in range(count)
    )


# Rectangles of parameters on plane faces with straight sides, in which a frame need not ask for
# the boundary (see ``bodies.sampling``, which finds those of any face).


def inner_rectangles(solid: Polyhedron, pcurves: Array) -> Array:
    """(f, 4) rows u0, u1, v0, v1 about the middles of faces, as large as their sides let them be
    in the proportions of the corners' box; NO_INNER where the middle is not inside all sides."""
    begins, owners = solid.starts[:-1], solid.owners
    spots = np.where((solid.senses > 0)[:, None], pcurves[:, :, 2], pcurves.sum(axis=2))
    steps = pcurves[:, :, 0] * solid.senses[:, None]
    # the face is on the left of every step: the middle, u = v = 0, by this much
    inside = spots[:, 0] * steps[:, 1] - spots[:, 1] * steps[:, 0]
    half = np.minimum(np.maximum.reduceat(spots, begins), -np.minimum.reduceat(spots, begins))
    reach = np.abs(steps[:, 1]) * half[owners, 0] + np.abs(steps[:, 0]) * half[owners, 1]
    share = np.minimum.reduceat(inside / np.where(reach > 0.0, reach, 1.0), begins)
    kept = INNER_SHARE * np.clip(share, 0.0, 1.0)[:, None] * half
    found = np.column_stack([-kept[:, 0], kept[:, 0], -kept[:, 1], kept[:, 1]])
    found[(share <= 0.0) | (half <= 0.0).any(axis=1)] = L.NO_INNER
    return found


# Points of a polyhedron's boundary where a cold start may begin, as ``bodies.sampling`` has them
# of any body: the same grids and budgets.


def polyhedron_samples(solid: Polyhedron, pcurves: Array) -> list[Sample]:
    """Points on every kind of feature, the budgets shared among the features of a kind."""
    edges, vertices = len(solid.ends), len(solid.vertices)
    found = []
    normals = solid.normals
    for face in range(0, solid.n_faces, stride(solid.n_faces, FACE_BUDGET)):
        columns, shift = solid.planes[face, :, :2], solid.shifts[face]
        for u, v in _spots(solid, pcurves, face).tolist():
            point = shift + columns @ (u, v)
            found.append(Sample(point, normals[face], face, face, u, v))
    shares = along_each(edges)
    for edge in range(0, edges, stride(edges, EDGE_BUDGET)):
        first, last = solid.vertices[solid.ends[edge]]
        for t in shares.tolist():
            point = first + t * (last - first)
            found.append(Sample(point, np.zeros(3), solid.n_faces + edge, -1, t, 0.0))
    for vertex in range(0, vertices, stride(vertices, VERTEX_BUDGET)):
        feature = solid.n_faces + edges + vertex
        found.append(Sample(solid.vertices[vertex], np.zeros(3), feature, -1, 0.0, 0.0))
    return found


def _spots(solid: Polyhedron, pcurves: Array, face: int) -> Array:
    """(n, 2) parameters on a face."""
    own = slice(*solid.starts[face : face + 2])
    ahead = (solid.senses[own] > 0)[:, None]
    corners = np.where(ahead, pcurves[own, :, 2], pcurves[own].sum(axis=2))
    steps = np.where(ahead, pcurves[own, :, 0], -pcurves[own, :, 0])
    low, high = corners.min(axis=0), corners.max(axis=0)
    n = first_grid(solid.n_faces)
    for count in (n, second_grid(n)):  # a slender face may miss the first grid
        ticks = (np.arange(count) + 0.5) / count
        grid = np.stack(np.meshgrid(ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 2)
        spots = low + grid * (high - low)
        away = spots[:, None] - corners
        left = steps[:, 0] * away[:, :, 1] - steps[:, 1] * away[:, :, 0]
        inside = (left >= -ON_SIDE * np.prod(high - low)).all(axis=1)
        if inside.any():
            return np.asarray(spots[inside])
    return np.zeros((0, 2))


# The two flat arrays of a polyhedron, the same that ``bodies.packing`` writes part by part.

# A line's pcurve: its range, then the 3 x 3 matrix; an edge's line: its range, 3 x 3 map and shift.
COEDGE_REALS = L.PCURVE_DATA + 9
LINE_REALS = L.CURVE_DATA + 12
SECTOR_REALS = 5


def pack_polyhedron(
    solid: Polyhedron,
    joints: tuple[Bools, VertexCones, WideCorners],
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
    w = ArrayWriter()
    faces, edges, vertices = solid.n_faces, len(solid.ends), len(solid.vertices)
    put_header(w, PartCounts(3, faces, edges, vertices, faces, len(samples)), box, radius, slack)
    _put_faces(w, solid, pcurves, inner)
    _put_edges(w, solid, smooth)
    _put_vertices(w, solid, cones, wide)
    put_samples(w, samples)
    return w.arrays()


def _put_faces(w: ArrayWriter, solid: Polyhedron, pcurves: Array, inner: Array) -> None:
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


def _put_edges(w: ArrayWriter, solid: Polyhedron, smooth: Bools) -> None:
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


def _put_vertices(w: ArrayWriter, solid: Polyhedron, cones: VertexCones, wide: WideCorners) -> None:
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
