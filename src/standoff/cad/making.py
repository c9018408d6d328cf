"""From a solid of OpenCASCADE to a boundary, or to a body where it is convex, with its report."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.bodies.assembly import Joined, joined_parts
from standoff.bodies.body import Body, made_body
from standoff.bodies.boundary import Boundary, EdgeKind, made_boundary
from standoff.bodies.charts import loop_pcurve
from standoff.bodies.enclosed import MOST_NODES
from standoff.bodies.finishing import finish
from standoff.bodies.moments.cells import integrate
from standoff.bodies.moments.face_cells import face_cells
from standoff.bodies.moments.flux import AREA, COLUMNS, IntegralFrame
from standoff.bodies.report import BoundaryReport
from standoff.bodies.tolerances import JOIN_TOLERANCE, ROUNDOFF
from standoff.bodies.topology import Face
from standoff.cad.assembly import PartReport
from standoff.cad.closed_bounds import sphere_bound
from standoff.cad.limits import MOST_FACES
from standoff.cad.measures import (
    area_of,
    faults_of,
    free_edges,
    judged,
    named,
    size_of,
    tolerance_of,
    volume_of,
)
from standoff.cad.miss_bounds import miss_bound, side_miss
from standoff.cad.opencascade import cast, caught_lines, explored, is_kind
from standoff.cad.pieces import BoundaryPieces, PartRefusal, pieces_of
from standoff.cad.seams import without_corners, without_seams
from standoff.cad.surfaces import kind_of
from standoff.cad.tolerances import FILE_AREA, FILE_SLACK, LEAST_FACE, MOST_ACCURACY, SEWN_AT_LEAST
from standoff.errors import BodyError, StandoffError
from standoff.kernels.body import layout as L
from standoff.typing import Array
from standoff.wording import counted

if TYPE_CHECKING:
    from standoff.solids import SelfIntersection, Solid

# Places that a message names.
MOST_NAMED = 4


@dataclass(frozen=True)
class MadePart:
    """A part, or None where it was refused, and what was found; with its solid, if it was made."""

    shape: Boundary | Body | None
    report: PartReport
    solid: Solid | None = None


def made_part(
    shape: Any, name: str, heal: bool, accuracy: float = 0.0, most: float | None = None
) -> MadePart:
    """A part of a solid of OpenCASCADE; refused with a reason rather than half made.

    accuracy : that the file states, length; most : by how much its parts may miss each other,
    length, by default what the file claims.
    """
    start = perf_counter()
    told: tuple[str, ...] = ()
    with caught_lines() as lines:
        if heal:
            shape, told = healed(shape)
        report = PartReport(
            name, _kinds(shape), healed=told, tolerance=tolerance_of(shape), accuracy=accuracy
        )
        try:
            made, report, solid = _made_smooth(shape, report, most)
        except (StandoffError, RuntimeError) as error:
            made, solid = None, None
            report = replace(report, refused=str(error))
        except Exception as error:
            # OpenCASCADE's own have no common class in Python
            if not type(error).__module__.startswith("OCP"):
                raise
            made, solid = None, None
            failed = f"OpenCASCADE fails on it with {type(error).__name__} {error}"
            report = replace(report, refused=failed.rstrip())
    notes = (*report.notes, *(f"OpenCASCADE: {line}" for line in lines))
    return MadePart(made, replace(report, notes=notes, seconds=perf_counter() - start), solid)


def _kinds(shape: Any) -> dict[str, int]:
    return dict(Counter(kind_of(face) for face in explored(shape, "face")))


def _made_smooth(
    shape: Any, report: PartReport, most: float | None
) -> tuple[Boundary | Body, PartReport, Solid | None]:
    """A part; where it is refused, or an edge or a face has a corner inside, once more with its
    edges and faces divided where they are not smooth."""
    from standoff.solids.spatial.corners import CornerError

    try:
        return _made(shape, report, most)
    except (CornerError, PartRefusal) as error:
        divided = without_corners(shape)
        if divided is None:
            raise
        try:
            made, report, solid = _made(divided[0], report, most, divided[1])
        except (CornerError, PartRefusal):
            raise error from None
        note = "edges and faces with corners inside were divided there"
        return made, replace(report, notes=(*report.notes, note)), solid


def _made(
    shape: Any, report: PartReport, most: float | None, of: Sequence[int] = ()
) -> tuple[Boundary | Body, PartReport, Solid | None]:
    """of: of a divided shape the numbers of the faces of which its own are parts."""
    size = size_of(shape)
    _check(shape, size)
    solid, cut, numbers = without_seams(shape)
    if of:
        numbers = [of[number - 1] for number in numbers]
    pieces = pieces_of(solid, size, shape, numbers)
    claimed = max(FILE_SLACK * report.tolerance, min(report.accuracy, MOST_ACCURACY * size))
    allowed = max(claimed if most is None else most, JOIN_TOLERANCE * size)
    report = replace(report, allowed=allowed)
    points = np.reshape(pieces.vertices, (-1, 3))
    try:
        bound, face = trim_bound(pieces, size)
        if bound > allowed:
            raise PartRefusal(_missed(report, bound, pieces.names[face]))
        parts = points, pieces.edges, pieces.faces
        joined = joined_parts(*parts, allowed, closed=True, senses=pieces.senses)
        residual = max(joined.residual, bound + pieces.moved)
        # what parts miss each other by counts from here on, no longer what they were allowed to
        within = max(residual, JOIN_TOLERANCE * size)
        joined = replace(joined, residual=residual, tolerance=within)
        boundary = made_boundary(report.name, joined)
    except BodyError as error:
        raise PartRefusal(_in_file(str(error), pieces)) from error
    found = boundary.check()
    assert isinstance(found, BoundaryReport)
    near = FILE_AREA * found.volume + found.slack * found.area
    area, notes = _checked_areas(boundary, joined, pieces, size)
    if pieces.recognised:
        plural = {"torus": "tori"}
        kinds = ", ".join(
            counted(n, kind, plural.get(kind, "")) for kind, n in sorted(pieces.recognised.items())
        )
        notes = (*notes, f"of its splines these are others within {pieces.moved:.2g}: {kinds}")
    volume, room = judged(solid, "volume", found.volume, near)
    if abs(found.volume - volume) > room:
        raise PartRefusal(f"its volume is {found.volume:.9g} here, {volume:.9g} by OpenCASCADE")
    body = _convex(boundary, joined)
    made = _not_crossing(boundary, pieces) if body is None else None
    places = () if made is None else made.self_intersections.lines()
    report = replace(
        report,
        cut=cut,
        trims=dict(pieces.trims),
        convex=body is not None,
        size=found.size,
        area=found.area,
        volume=found.volume,
        area_error=abs(found.area - area) / area,
        volume_error=abs(found.volume - volume) / volume,
        slack=found.slack if body is None else body.check().slack,
        trim_bound=bound,
        self_intersections=tuple(_in_file(line, pieces) for line in places),
        notes=notes,
    )
    return body or boundary, report, made


def _missed(report: PartReport, by: float, face: str) -> str:
    """Why a part is refused whose edges leave its faces."""
    return (
        f"an edge of {face} leaves it by up to {by:.3g}, more than the {report.allowed:.3g} "
        f"that are allowed ({report.claims()}): mend it, or give tolerance={1.01 * by:.2g}, "
        "which becomes slack"
    )


NUMBERED = re.compile(r"\b([Ff]ace|[Ee]dge)(s?) (\d+(?:, \d+)*)")
"""Faces and edges of a boundary in a message."""


def _in_file(told: str, pieces: BoundaryPieces) -> str:
    """A message with the file's names of faces, and places of edges."""

    def name(match: re.Match[str]) -> str:
        numbers = [int(number) for number in match[3].split(", ")]
        if match[1] in ("Edge", "edge"):
            curves = [pieces.edges[number].curve for number in numbers]
            points = [curve.point(0.5 * (curve.first + curve.last)) for curve in curves]
            places = ", ".join("({:.6g}, {:.6g}, {:.6g})".format(*point) for point in points)
            return f"{match[1]}{match[2]} at {places}"
        return match[1][0] + ", ".join(pieces.names[number] for number in numbers)[1:]

    return NUMBERED.sub(name, told)


def _not_crossing(boundary: Boundary, pieces: BoundaryPieces) -> Solid:
    """The solid of a boundary; raises Refused if it crosses itself."""
    from standoff.solids import SelfIntersections, Solid
    from standoff.solids.spatial.corners import CornerError

    try:
        return Solid(boundary)
    except CornerError as error:
        raise CornerError(_in_file(str(error), pieces), part=error.part) from error
    except StandoffError as error:
        if not isinstance(error.value, SelfIntersections):
            raise
        found = error.value.crossings
        told = [_crossing(place, pieces) for place in found[:MOST_NAMED]]
        dots = "; ..." if len(found) > MOST_NAMED else ""
        raise PartRefusal(f"it crosses itself: {'; '.join(told)}{dots}") from error


def _crossing(place: SelfIntersection, pieces: BoundaryPieces) -> str:
    one, other = (pieces.names[f.index] for f in (place.feature_a, place.feature_b))
    x, y, z = place.point_a
    return f"{one} crosses {other} near ({x:.6g}, {y:.6g}, {z:.6g}), by about {place.depth:.3g}"


def _check(shape: Any, size: float) -> None:
    """Raise Refused for what is no closed solid, or has faces without area."""
    faces = list(explored(shape, "face"))
    if not faces:
        raise PartRefusal("it has no face")
    if len(faces) > MOST_FACES:
        raise PartRefusal(f"it has {len(faces)} faces; at most {MOST_FACES} (standoff.cad.limits)")
    for number, face in enumerate(faces, 1):
        if abs(area_of(face)) <= LEAST_FACE * size**2:
            raise PartRefusal(f"{named(face, number)} has no area")
    at = free_edges(shape)
    if at or not is_kind(shape, "solid"):
        where = ", ".join(at[:MOST_NAMED]) + (", ..." if len(at) > MOST_NAMED else "")
        raise PartRefusal(
            f"its shell is open: {counted(len(at), 'edge bounds', 'edges bound')} one face, near "
            f"{where}; heal=True sews what lies within the file's tolerance"
            if at
            else "it is a closed shell, but no solid; heal=True makes it one"
        )
    if volume_of(shape) < 0.0:
        raise PartRefusal(
            f"it is inside out: its {counted(len(faces), 'face')}, from face 1 (a "
            f"{kind_of(faces[0])}) on, face into the solid; heal=True turns it"
        )
    faults = faults_of(shape)
    if faults:
        raise PartRefusal("; ".join(faults[:MOST_NAMED]))


def trim_bound(pieces: BoundaryPieces, size: float) -> tuple[float, int]:
    """(a proven bound of how far edges, and vertices of collapsed sides, are from their faces,
    length; of which face)."""
    bounds = [
        max([0.0, *_edge_misses(face, pieces, size), *_apex_misses(face, pieces)])
        for face in pieces.faces
    ]
    worst = int(np.argmax(bounds))
    return (bounds[worst] if bounds[worst] > ROUNDOFF * size else 0.0), worst


def _edge_misses(face: Face, pieces: BoundaryPieces, size: float) -> Iterator[float]:
    surface = face.charts[0]
    for entry, (number, _) in enumerate(face.loop):
        curve = pieces.edges[number].curve
        exact = not face.pcurves or face.pcurves[entry] is None
        if surface.kind == L.SPHERE and exact:
            yield sphere_bound(curve, surface)
        else:
            pcurve = loop_pcurve(face, entry, pieces.edges, surface)
            yield miss_bound(pcurve, curve, surface, size)


def _apex_misses(face: Face, pieces: BoundaryPieces) -> Iterator[float]:
    for apex in face.apexes:
        yield side_miss(face.charts[0], apex, pieces.vertices[apex.vertex])


def _checked_areas(
    boundary: Boundary, joined: Joined, pieces: BoundaryPieces, size: float
) -> tuple[float, tuple[str, ...]]:
    """The area by OpenCASCADE, and notes; raises Refused if a face has another one than that."""
    slack, total, notes = boundary.check().slack, 0.0, []
    known = {k: area for shell in joined.enclosed.values() for k, area in shell.areas.items()}
    for number, face in enumerate(pieces.sources):
        own, off = known.get(number, (0.0, np.inf))
        # the whole solid's integrals tell enough of most faces
        if abs(own - area_of(face)) + off > _near(own, size, slack):
            own = face_area(boundary, number, size)
        near = _near(own, size, slack)
        theirs, room = judged(face, "area", own, near)
        total += theirs
        if abs(own - theirs) > near:
            told = f"its area is {own:.9g} here, {theirs:.9g} by OpenCASCADE"
            if abs(own - theirs) > room:
                raise PartRefusal(f"{pieces.names[number]}: {told}")
            notes.append(f"{pieces.names[number]}: {told}, whose trimming curves miss its edges")
    return total, tuple(notes)


def _near(area: float, size: float, slack: float) -> float:
    """By how much OpenCASCADE's area of a face may differ, length squared."""
    return FILE_AREA * (area + FILE_AREA * size**2) + slack * size


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

    cells = list(face_cells(boundary, number, IntegralFrame(centre, size, 0.0)))
    found = integrate(cells, scale, FILE_AREA, MOST_NODES)
    return float(found.values[AREA]) * size**2


def _convex(boundary: Boundary, joined: Joined) -> Body | None:
    """The same as a body with its proofs; None if it is not convex."""
    found = boundary.check()
    assert isinstance(found, BoundaryReport)
    bent = {EdgeKind.REFLEX, EdgeKind.MIXED}
    if len(found.shells) > 1 or bent & set(boundary.edge_kinds):
        return None
    try:
        return made_body(boundary.name, 0.0, finish(joined, 0.0, None))
    except StandoffError:
        return None


# Healing, only where it was asked for: OpenCASCADE's repairs, each counted.


def healed(shape: Any) -> tuple[Any, tuple[str, ...]]:
    """The shape after OpenCASCADE's repairs, and what they changed."""
    from OCP.ShapeFix import ShapeFix_Shape

    told: list[str] = []
    before = _counts(shape)
    loose = tolerance_of(shape)
    if not is_kind(shape, "solid"):
        shape, note = _sewn(shape)
        told += note
    fixer = ShapeFix_Shape(shape)
    if fixer.Perform():
        shape = fixer.Shape()
        told.append("OpenCASCADE's ShapeFix changed it")
    solids = list(explored(shape, "solid"))
    shape = solids[0] if len(solids) == 1 else shape
    if is_kind(shape, "solid") and volume_of(shape) < 0.0:
        shape = cast("solid", shape.Reversed())
        told.append("turned its faces, which were inside out")
    after = _counts(shape)
    told += [
        f"{kind}s: {before[kind]} became {after[kind]}"
        for kind in before
        if before[kind] != after[kind]
    ]
    if tolerance_of(shape) > loose:
        told.append(f"greatest tolerance: {loose:.3g} became {tolerance_of(shape):.3g}")
    return shape, tuple(told)


def _counts(shape: Any) -> dict[str, int]:
    kinds = ("face", "edge", "vertex")
    return {kind: len({hash(one) for one in explored(shape, kind)}) for kind in kinds}


def _sewn(shape: Any) -> tuple[Any, list[str]]:
    """Faces sewn within their tolerance, and made a solid if they close."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing

    sewing = BRepBuilderAPI_Sewing(max(tolerance_of(shape), SEWN_AT_LEAST))
    sewing.Add(shape)
    sewing.Perform()
    found = sewing.SewedShape()
    loose = counted(sewing.NbFreeEdges(), "edge stays", "edges stay")
    told = [f"sewn: {loose} open, {sewing.NbContigousEdges()} joined"]
    shells = list(explored(found, "shell"))
    if len(shells) != 1 or sewing.NbFreeEdges():
        return found, told
    maker = BRepBuilderAPI_MakeSolid(shells[0])
    return cast("solid", maker.Solid()), [*told, "made a solid of its shell"]
