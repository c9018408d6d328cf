"""From a solid of OpenCASCADE to a boundary, or to a body where it is convex, with its report."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.bodies.assembly import Joined, joined_parts
from standoff.bodies.body import Body, proven_again
from standoff.bodies.boundary import Boundary, EdgeKind, made_boundary
from standoff.bodies.charts import loop_pcurve
from standoff.bodies.enclosed import MOST_NODES
from standoff.bodies.moments.cells import integrate
from standoff.bodies.moments.face_cells import face_cells
from standoff.bodies.moments.flux import AREA, COLUMNS, Frame
from standoff.bodies.report import BoundaryReport
from standoff.bodies.tolerances import JOIN_TOLERANCE, ROUNDOFF
from standoff.cad.assembly import PartReport
from standoff.cad.healing import healed
from standoff.cad.limits import MOST_FACES
from standoff.cad.measures import (
    area_of,
    faults_of,
    free_edges,
    nearest,
    size_of,
    tolerance_of,
    volume_of,
)
from standoff.cad.miss_bounds import miss_bound
from standoff.cad.opencascade import explored, is_kind
from standoff.cad.pieces import Pieces, Refused, pieces_of
from standoff.cad.seams import without_seams
from standoff.cad.surfaces import kind_of
from standoff.cad.tolerances import FILE_AREA, FILE_SLACK, LEAST_FACE
from standoff.errors import BodyError, StandoffError
from standoff.geometry.validation import Array
from standoff.wording import counted

if TYPE_CHECKING:
    from standoff.solids import SelfIntersection, Solid

# Places that a message names.
MOST_NAMED = 4


@dataclass(frozen=True)
class Made:
    """A part, or None where it was refused, and what was found; with its solid, if it was made."""

    shape: Boundary | Body | None
    report: PartReport
    solid: Solid | None = None


def made_part(shape: Any, name: str, heal: bool) -> Made:
    """A part of a solid of OpenCASCADE; refused with a reason rather than half made."""
    start = perf_counter()
    told: tuple[str, ...] = ()
    if heal:
        shape, told = healed(shape)
    report = PartReport(name, _kinds(shape), healed=told, tolerance=tolerance_of(shape))
    try:
        made, report, solid = _made(shape, report)
    except (StandoffError, RuntimeError) as error:
        spent = perf_counter() - start
        return Made(None, replace(report, refused=str(error), seconds=spent))
    return Made(made, replace(report, seconds=perf_counter() - start), solid)


def _kinds(shape: Any) -> dict[str, int]:
    return dict(Counter(kind_of(face) for face in explored(shape, "face")))


def _made(shape: Any, report: PartReport) -> tuple[Boundary | Body, PartReport, Solid | None]:
    size = size_of(shape)
    _check(shape, size)
    solid, cut = without_seams(shape)
    pieces = pieces_of(solid, size, shape)
    allowed = max(FILE_SLACK * report.tolerance, JOIN_TOLERANCE * size)
    points = np.reshape(pieces.vertices, (-1, 3))
    try:
        parts = points, pieces.edges, pieces.faces
        joined = joined_parts(*parts, allowed, closed=True, senses=pieces.senses)
        bound = trim_bound(pieces, size)
        if bound > allowed:
            raise Refused(
                f"edges miss their faces by up to {bound:.3g}, the file allows {allowed:.3g}"
            )
        residual = max(joined.residual, bound + pieces.moved)
        # what parts miss each other by counts from here on, no longer what they were allowed to
        within = max(residual, JOIN_TOLERANCE * size)
        closing = replace(joined, residual=residual, tolerance=within)
        boundary = made_boundary(report.name, closing)
    except BodyError as error:
        raise Refused(f"{error}{_place(error, pieces)}") from error
    found = boundary.check()
    assert isinstance(found, BoundaryReport)
    near = FILE_AREA * found.volume + found.slack * found.area
    volume = nearest(volume_of, shape, found.volume, near)
    area = nearest(area_of, shape, found.area, FILE_AREA * found.area)
    off = abs(found.volume - volume) / volume
    _check_areas(boundary, pieces, size)
    if abs(found.volume - volume) > near:
        raise Refused(f"its volume is {found.volume:.9g} here, {volume:.9g} by OpenCASCADE")
    body = _convex(boundary, pieces, joined)
    solid = _not_crossing(boundary, pieces) if body is None else None
    report = replace(
        report,
        cut=cut,
        trims=dict(pieces.trims),
        convex=body is not None,
        size=found.size,
        area=found.area,
        volume=found.volume,
        area_error=abs(found.area - area) / area,
        volume_error=off,
        slack=found.slack if body is None else body.check().slack,
        trim_bound=bound,
        self_intersections=() if solid is None else tuple(solid.self_intersections.lines()),
    )
    return body or boundary, report, solid


def _not_crossing(boundary: Boundary, pieces: Pieces) -> Solid:
    """The solid of a boundary; raises Refused if it crosses itself."""
    from standoff.solids import SelfIntersections, Solid

    try:
        return Solid(boundary)
    except StandoffError as error:
        if not isinstance(error.value, SelfIntersections):
            raise
        found = error.value.crossings
        told = [_crossing(place, pieces) for place in found[:MOST_NAMED]]
        dots = "; ..." if len(found) > MOST_NAMED else ""
        raise Refused(f"it crosses itself: {'; '.join(told)}{dots}") from error


def _crossing(place: SelfIntersection, pieces: Pieces) -> str:
    one, other = (
        f"face {feature.index + 1} (a {pieces.kinds[feature.index]})"
        for feature in (place.feature_a, place.feature_b)
    )
    x, y, z = place.point_a
    return f"{one} crosses {other} near ({x:.6g}, {y:.6g}, {z:.6g}), by about {place.depth:.3g}"


def _check(shape: Any, size: float) -> None:
    """Raise Refused for what is no closed solid, or has faces without area."""
    faces = list(explored(shape, "face"))
    if not faces:
        raise Refused("it has no face")
    if len(faces) > MOST_FACES:
        raise Refused(f"it has {len(faces)} faces; at most {MOST_FACES} (standoff.cad.limits)")
    for number, face in enumerate(faces, 1):
        if abs(area_of(face)) <= LEAST_FACE * size**2:
            raise Refused(f"face {number} (a {kind_of(face)}) has no area")
    at = free_edges(shape)
    if at or not is_kind(shape, "solid"):
        where = ", ".join(at[:MOST_NAMED]) + (", ..." if len(at) > MOST_NAMED else "")
        raise Refused(
            f"its shell is open: {counted(len(at), 'edge bounds', 'edges bound')} one face, near "
            f"{where}; heal=True sews what lies within the file's tolerance"
            if at
            else "it is a closed shell, but no solid; heal=True makes it one"
        )
    if volume_of(shape) < 0.0:
        raise Refused(
            f"it is inside out: its {counted(len(faces), 'face')}, from face 1 (a "
            f"{kind_of(faces[0])}) on, face into the solid; heal=True turns it"
        )
    faults = faults_of(shape)
    if faults:
        raise Refused("; ".join(faults[:MOST_NAMED]))


def trim_bound(pieces: Pieces, size: float) -> float:
    """A proven bound of how far edges are from their faces, length."""
    worst = 0.0
    for face in pieces.faces:
        if len(face.charts) > 1:
            continue  # exact: plane sections of a sphere
        surface = face.charts[0]
        for entry, (number, _) in enumerate(face.loop):
            curve = pieces.edges[number].curve
            pcurve = loop_pcurve(face, entry, pieces.edges, surface)
            worst = max(worst, miss_bound(pcurve, curve, surface, size))
    return worst if worst > ROUNDOFF * size else 0.0


def _check_areas(boundary: Boundary, pieces: Pieces, size: float) -> None:
    """Raise Refused if a face has not the area that OpenCASCADE gives it."""
    slack = boundary.check().slack
    for number, face in enumerate(pieces.sources):
        own = face_area(boundary, number, size)
        near = FILE_AREA * (own + FILE_AREA * size**2) + slack * size
        theirs = nearest(area_of, face, own, near)
        if abs(own - theirs) > near:
            raise Refused(
                f"face {number + 1} (a {pieces.kinds[number]}): its area is {own:.9g} here, "
                f"{theirs:.9g} by OpenCASCADE"
            )


def face_area(boundary: Boundary, number: int, size: float) -> float:
    """The area of one face, length squared."""
    face = boundary.face_parts[number]
    centre = face.charts[0].shift
    if face.loop:
        curve = boundary.edge_parts[face.loop[0][0]].curve
        centre = curve.point(curve.first)

    def scale(values: Array) -> Array:
        sizes = np.full(COLUMNS, np.inf)
        sizes[AREA] = abs(float(values[AREA])) + FILE_AREA
        return sizes

    cells = list(face_cells(boundary, number, Frame(centre, size, 0.0)))
    found = integrate(cells, scale, FILE_AREA, MOST_NODES)
    return float(found.values[AREA]) * size**2


def _convex(boundary: Boundary, pieces: Pieces, joined: Joined) -> Body | None:
    """The same as a body with its proofs; None if it is not convex."""
    found = boundary.check()
    bent = {EdgeKind.REFLEX, EdgeKind.MIXED}
    if getattr(found, "cavities", ()) or bent & set(boundary.edge_kinds):
        return None
    try:
        parts = np.reshape(pieces.vertices, (-1, 3)), pieces.edges, pieces.faces
        return proven_again(parts, boundary.name, 0.0, joined.tolerance, found.sewing_residual)
    except StandoffError:
        return None


def _place(error: BodyError, pieces: Pieces) -> str:
    """Where the part is that an error names."""
    if error.part is None:
        return ""
    kind, number = error.part
    if kind == "edge":
        curve = pieces.edges[number].curve
        x, y, z = curve.point(0.5 * (curve.first + curve.last))
        return f" (near ({x:.6g}, {y:.6g}, {z:.6g}))"
    if kind == "face" and number < len(pieces.kinds):
        return f" (a {pieces.kinds[number]})"
    return ""
