"""A solid of OpenCASCADE as vertices, edges and faces of a boundary.

Seams and collapsed edges have no place in a boundary: an angle needs no seam, a sphere no pole. A
closed edge whose vertex others use, or whose ends meet in a corner, becomes two.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from standoff.bodies.topology import Apex, Edge, Face
from standoff.cad.canonical import Likeness, recognised, recognised_curve
from standoff.cad.curves import Converted, converted, isoline
from standoff.cad.measures import named
from standoff.cad.opencascade import cast, coordinates, explored, forward
from standoff.cad.seams import once
from standoff.cad.sphere_faces import sphere_by_angles, sphere_charts, sphere_sense
from standoff.cad.surfaces import Carrier, basis_surface, carrier, grown
from standoff.cad.tolerances import MISSED_POLE, RECOGNISED
from standoff.cad.trims import extent, limits_of, trim
from standoff.errors import BodyError, StandoffError
from standoff.geometry.curves import FULL_TURN, Line
from standoff.geometry.pcurves import Pcurve
from standoff.typing import Array


class PartRefusal(StandoffError):
    """A part that can't be made; the message names the face or edge of the file and the reason."""


@dataclass
class BoundaryPieces:
    """Parts of a boundary, and where they come from.

    Attributes
    ----------
    vertices, edges, faces, senses : as for ``Boundary.from_brep``.
    sources : the file's faces.
    names : of the file's faces, as a CAD program finds them.
    trims : how often a trimming curve was "exact", the "file"'s or "fitted".
    recognised : how often a spline was a plane, cylinder, cone, sphere, torus, line or circle.
    moved : how far a surface or an edge was moved at most, length.
    """

    vertices: list[Array] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)
    faces: list[Face] = field(default_factory=list)
    senses: list[int | None] = field(default_factory=list)
    sources: list[Any] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    trims: Counter[str] = field(default_factory=Counter)
    recognised: Counter[str] = field(default_factory=Counter)
    moved: float = 0.0


def pieces_of(solid: Any, size: float, original: Any, numbers: Sequence[int]) -> BoundaryPieces:
    """The parts of a solid without seams that an angle can't take (``seams.without_seams``).

    `original` is the solid before; edges that it lacks are isolines of their surfaces. `numbers`
    are those of its faces of which the solid's are parts.

    Raises Refused: a curve or surface without an exact form, an edge without a curve, a face
    without edges.
    """
    from OCP.BRepClass3d import BRepClass3d

    outer = BRepClass3d.OuterShell_s(solid)
    maker = _Maker(solid, size, original)
    waiting = iter(numbers)
    for shell in explored(solid, "shell"):
        cavity = not shell.IsSame(outer)
        for face in explored(shell, "face"):
            name = named(face, next(waiting))
            maker.pieces.names.append(name)
            try:
                maker.add(face, cavity)
            except BodyError:
                raise
            except StandoffError as error:
                raise PartRefusal(f"{name}: {error}") from error
    return maker.pieces


class _Maker:
    """Makes each edge once, for the two faces that use it."""

    def __init__(self, solid: Any, size: float, original: Any) -> None:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as Shapes

        self.pieces = BoundaryPieces()
        self.size = size
        self.vertex_map, self.edge_map, self.face_map = Shapes(), Shapes(), Shapes()
        self.given = Shapes()
        for edge in explored(solid if original is None else original, "edge"):
            self.given.Add(edge)
        self.vertex_numbers: dict[int, int] = {}
        self.made: dict[int, list[tuple[int, Converted]]] = {}
        self.busy = self._busy_vertices(solid)
        self.carriers: dict[int, tuple[Carrier, Likeness | None]] = {}
        self.plain = self._plain_edges(solid)

    def _carrier(self, face: Any) -> tuple[Carrier, Likeness | None]:
        """A face's surface, and what it was recognised by."""
        from OCP.BRep import BRep_Tool
        from OCP.BRepTools import BRepTools

        key = int(self.face_map.Add(face))
        if key not in self.carriers:
            on = carrier(BRep_Tool.Surface_s(face), BRepTools.UVBounds_s(face))
            found = None
            if on.kind == "spline" and not any(BRep_Tool.Degenerated_s(e) for e in once(face)):
                found = recognised(on, RECOGNISED * self.size)
            self.carriers[key] = found or (on, None)
        return self.carriers[key]

    def _plain_edges(self, solid: Any) -> set[int]:
        """Edges whose faces all have surfaces on which points are found in closed form."""
        plain: dict[int, bool] = {}
        for face in explored(solid, "face"):
            try:
                on = self._carrier(face)[0]
                closed = on.inverse is not None or on.kind == "sphere"
            except StandoffError:  # told when its turn comes
                closed = False
            for edge in once(face):
                key = int(self.edge_map.Add(edge))
                plain[key] = closed and plain.get(key, True)
        return {key for key, closed in plain.items() if closed}

    def _vertex_key(self, vertex: Any) -> int:
        return int(self.vertex_map.Add(vertex))

    def _busy_vertices(self, solid: Any) -> set[int]:
        """Vertices at which an edge ends that is neither closed, a seam, nor collapsed."""
        busy = set()
        for face in explored(solid, "face"):
            for edge in once(face):
                a, b = (self._vertex_key(v) for v in _ends(edge))
                if a != b:
                    busy |= {a, b}
        return busy

    def vertex(self, shape: Any) -> int:
        from OCP.BRep import BRep_Tool

        key = self._vertex_key(shape)
        if key not in self.vertex_numbers:
            self.vertex_numbers[key] = len(self.pieces.vertices)
            self.pieces.vertices.append(coordinates(BRep_Tool.Pnt_s(shape)))
        return self.vertex_numbers[key]

    def edge(self, shape: Any, flat: Any, surface: Any) -> list[tuple[int, Converted]]:
        """Numbers of the edges that a file's edge becomes, with their curves, along its curve."""
        from OCP.BRep import BRep_Tool

        key = int(self.edge_map.Add(shape))
        if key in self.made:
            return self.made[key]
        geometry = BRep_Tool.Curve_s(shape, 0.0, 0.0)
        if geometry is None:
            raise PartRefusal("an edge without a curve in space")
        first, last = BRep_Tool.Range_s(shape)
        shift = 0.0
        if not self.given.Contains(shape):
            line = isoline(flat, surface)
            if line is not None:
                geometry, shift = line
                first, last = first + shift, last + shift
        start, stop = _ends(shape)
        keys = (self._vertex_key(start), self._vertex_key(stop))

        def curve(first: float, last: float) -> Converted:
            made = converted(geometry, first, last)
            like = recognised_curve(made, RECOGNISED * self.size) if key in self.plain else None
            if like is None:
                return made
            self.pieces.moved = max(self.pieces.moved, like[1])
            self.pieces.recognised["line" if isinstance(like[0].curve, Line) else "circle"] += 1
            return like[0]

        whole = curve(first, last)
        found = []
        if keys[0] != keys[1]:
            found.append(self._put(whole, self.vertex(start), self.vertex(stop), shift))
        elif whole.curve.closed and keys[0] not in self.busy:
            found.append(self._put(whole, None, None, shift))
        else:
            middle = 0.5 * (first + last)
            halves = curve(first, middle), curve(middle, last)
            amid = len(self.pieces.vertices)
            self.pieces.vertices.append(halves[0].curve.point(halves[0].curve.last))
            found.append(self._put(halves[0], self.vertex(start), amid, shift))
            found.append(self._put(halves[1], amid, self.vertex(start), shift))
        self.made[key] = found
        return found

    def _put(
        self, made: Converted, first: int | None, last: int | None, shift: float
    ) -> tuple[int, Converted]:
        if shift:
            made = replace(made, shift=made.shift + made.scale * shift)
        self.pieces.edges.append(Edge(made.curve, first, last))
        return len(self.pieces.edges) - 1, made

    def add(self, face: Any, cavity: bool) -> None:
        from OCP.BRep import BRep_Tool
        from OCP.BRepTools import BRepTools

        geometry = basis_surface(BRep_Tool.Surface_s(face))
        over = BRepTools.UVBounds_s(face)
        on, like = self._carrier(face)
        uses = once(face)
        made = [m for e in uses if not BRep_Tool.Degenerated_s(e) for m in self._edges(e, face)]
        if like is not None:  # the file's trimming curves are in the spline's parameters
            geometry, over = like.geometry, like.over
            made = [(number, edge, way, None) for number, edge, way, _ in made]
            self.pieces.recognised[on.kind] += 1
        elif on.kind == "spline" and not any(BRep_Tool.Degenerated_s(e) for e in uses):
            on = grown(on, *extent([(edge, flat) for _, edge, _, flat in made], on))
        sense = None
        if on.kind == "sphere":
            charts, trims = sphere_charts(
                on.surface, [m.curve for _, m, _, _ in made], face, self.size
            )
            if not charts:
                on = sphere_by_angles(geometry, over)
            elif len(charts) > 1 and made:
                sense = sphere_sense(geometry, face) * (-1 if cavity else 1)
                sense *= 1 if like is None else like.way
        if on.surface.part_of is None:
            charts, trims = (on.surface,), []
            for _, converted_edge, _, flat in made:
                pcurve, how = trim(converted_edge, on, flat, self.size)
                trims.append(pcurve)
                self.pieces.trims[how] += 1
        apexes = []
        if on.surface.part_of is None:
            collapsed = [e for e in uses if BRep_Tool.Degenerated_s(e)]
            apexes = [self._met(self._apex(e, face, on, over), made, trims) for e in collapsed]
            if not made and not apexes:
                raise PartRefusal(f"a {on.kind} without an edge")
        loop = tuple((number, way) for number, _, way, _ in made)
        given = tuple(trims) if any(t is not None for t in trims) else ()
        self.pieces.faces.append(Face(tuple(charts), loop, tuple(apexes), given))
        self.pieces.senses.append(sense)
        self.pieces.sources.append(face)
        self.pieces.moved = max(self.pieces.moved, on.moved)

    def _edges(self, edge: Any, face: Any) -> list[tuple[int, Converted, int, Any]]:
        """(number, curve, sense, the file's trimming curve) of the edges that an edge becomes."""
        from OCP.BRep import BRep_Tool

        flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
        sense = 1 if forward(edge) else -1
        found = self.edge(edge, flat, BRep_Tool.Surface_s(face))
        return [(number, made, sense, flat) for number, made in found]

    def _apex(self, edge: Any, face: Any, on: Carrier, over: tuple[float, ...]) -> Apex:
        """A collapsed edge, which must be a side in (u, v)."""
        from OCP.BRep import BRep_Tool

        flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
        first, last = BRep_Tool.Range_s(edge, face)
        ends = on.own(np.array([coordinates(flat.Value(t)) for t in (first, last)]))
        ends = np.clip(ends, *limits_of(on))
        middle = on.own(0.5 * np.array([[over[0] + over[1], over[2] + over[3]]]))[0]
        across = int(abs(ends[1, 1] - ends[0, 1]) < abs(ends[1, 0] - ends[0, 0]))
        level = float(ends[:, across].mean())
        if on.kind == "cone":
            level = 0.0
        lo, hi = sorted(ends[:, 1 - across].tolist())
        side = ("u", "v")[across] + ("0" if middle[across] > level else "1")
        return Apex(self.vertex(_ends(edge)[0]), level, lo, hi, side)

    def _met(self, apex: Apex, made: Sequence[Any], trims: Sequence[Pcurve | None]) -> Apex:
        """A collapsed side that ends where the trimming curves at its vertex do."""
        if apex.side[0] != "v":
            return apex
        ends = [
            pcurve.point(t)[0]
            for (number, _, _, _), pcurve in zip(made, trims, strict=True)
            if pcurve is not None
            for edge in [self.pieces.edges[number]]
            for vertex, t in ((edge.first, edge.curve.first), (edge.last, edge.curve.last))
            if vertex == apex.vertex
        ]
        return replace(apex, lo=_near(apex.lo, ends), hi=_near(apex.hi, ends))


def _near(u: float, ends: Sequence[float]) -> float:
    """The angle among some, up to turns, that another one misses by a little; else itself."""
    turned = [end + FULL_TURN * round((u - end) / FULL_TURN) for end in ends]
    best = min(turned, key=lambda end: abs(end - u), default=u)
    return best if abs(best - u) <= MISSED_POLE else u


def _ends(edge: Any) -> tuple[Any, Any]:
    """First and last vertex along an edge's curve, whatever its orientation in a wire."""
    from OCP.TopAbs import TopAbs_FORWARD
    from OCP.TopExp import TopExp

    along = cast("edge", edge.Oriented(TopAbs_FORWARD))
    return TopExp.FirstVertex_s(along), TopExp.LastVertex_s(along)
