"""The hull of points as a packed body."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.assembly import roundoff_note
from standoff.bodies.convexity import Convexity
from standoff.bodies.finishing import Packed, slack_of
from standoff.bodies.hulls.fewer_points import fewer_points
from standoff.bodies.hulls.heights import highest
from standoff.bodies.hulls.joints import edge_turns, vertex_cones, wide_corners, widening
from standoff.bodies.hulls.merging import merged
from standoff.bodies.hulls.outlines import Outlines, outlines
from standoff.bodies.hulls.packed import pack_polyhedron
from standoff.bodies.hulls.parts import Edges, Faces, plane_checks
from standoff.bodies.hulls.polyhedron import Polyhedron, polyhedron
from standoff.bodies.hulls.qhull import hull_triangles
from standoff.bodies.hulls.rectangles import inner_rectangles
from standoff.bodies.hulls.samples import polyhedron_samples
from standoff.bodies.packing import Assembled
from standoff.bodies.report import BodyReport, DihedralAngle
from standoff.bodies.tolerances import (
    CONVEXITY_TOLERANCE,
    FAR_OFF,
    JOIN_TOLERANCE,
    ROUNDOFF,
    SMOOTH_ANGLE,
    THIN,
    coordinate_roundoff,
)
from standoff.errors import BodyError
from standoff.typing import Array

# A polyhedron has as many faces at least.
LEAST_FACES = 4


def hull(
    points: Array, radius: float, tolerance: float | None = None, word: str = "vertices"
) -> Packed:
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
) -> Packed:
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
    return Packed(parts, ints, reals, report)


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


def image_of(solid: Polyhedron, linear: Array, shift: Array, radius: float, above: float) -> Packed:
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


def recentred(packed: Packed, given: Array, middle: Array) -> Packed:
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
