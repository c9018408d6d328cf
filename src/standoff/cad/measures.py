"""What OpenCASCADE finds about a shape: size, area, volume, tolerances, faults."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from OCP.TopoDS import TopoDS_Edge

from standoff.cad.opencascade import box_of, cast, coordinates, explored, forward
from standoff.cad.surfaces import kind_of
from standoff.cad.tolerances import QUADRATURE
from standoff.typing import Array

WRONG = (
    "BRepCheck_SelfIntersectingWire",
    "BRepCheck_IntersectingWires",
    "BRepCheck_UnorientableShape",
)
"""What no tolerance excuses."""


def size_of(shape: Any) -> float:
    """Diagonal of a box around a shape."""
    low, high = box_of(shape)
    return float(np.linalg.norm(high - low))


def named(face: Any, number: int) -> str:
    """A face as a CAD program finds it: its number in the file's order, kind, and a point on it."""
    from OCP.BOPTools import BOPTools_AlgoTools3D
    from OCP.gp import gp_Pnt, gp_Pnt2d
    from OCP.IntTools import IntTools_Context

    kind, point = kind_of(face), gp_Pnt()
    label = f"face {number} ({'an' if kind[0] in 'aeiou' else 'a'} {kind}"
    if BOPTools_AlgoTools3D.PointInFace_s(face, point, gp_Pnt2d(), IntTools_Context()):
        return f"{label})"
    x, y, z = coordinates(point)
    return f"{label} at ({x:.6g}, {y:.6g}, {z:.6g}))"


def area_of(shape: Any, adaptive: bool = False) -> float:
    """The area by one of OpenCASCADE's two rules: of a fixed number of points, or adaptive."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    if adaptive:
        BRepGProp.SurfaceProperties_s(shape, found, QUADRATURE, False)
    else:
        BRepGProp.SurfaceProperties_s(shape, found, False, False)
    return float(found.Mass())


def volume_of(shape: Any, adaptive: bool = False) -> float:
    """The volume by one of two rules: of a fixed number of points, or that of Gauss and Kronrod in
    each span. It is negative for a solid that is inside out."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    if adaptive:
        BRepGProp.VolumePropertiesGK_s(shape, found, QUADRATURE, False, True, False, False, False)
    else:
        BRepGProp.VolumeProperties_s(shape, found, False, False, False)
    return float(found.Mass())


def common_volume(a: Any, b: Any) -> float | None:
    """The volume that two shapes have in common, by OpenCASCADE's boolean operation; None where it
    fails."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common

    common = BRepAlgoAPI_Common(a, b)
    if not common.IsDone() or common.Shape().IsNull():
        return None
    found = abs(volume_of(common.Shape(), adaptive=True))
    return found if found <= min(abs(volume_of(a, True)), abs(volume_of(b, True))) else None


def judged(shape: Any, what: str, own: float, near: float) -> tuple[float, float]:
    """(area or volume, by how much one's own may differ from it): by OpenCASCADE's two rules, as
    no one is right for all shapes, and where neither is nearer than `near` by a quadrature that
    tells its error, and what the file's trimming curves miss their edges by."""
    measure = {"area": area_of, "volume": volume_of}[what]
    for adaptive in (False, True):
        found = abs(measure(shape, adaptive))
        if abs(found - own) <= near:
            return found, near
    faces = list(explored(shape, "face"))
    low, high = box_of(shape)
    parts = [face_integrals(face, 0.5 * (low + high)) for face in faces]
    column, share = (0, 1.0) if what == "area" else (1, 1.0 / 3.0)
    values = [part.values[column] for part in parts]
    total = sum(abs(x) for x in values) if what == "area" else abs(sum(values))
    room = sum(part.error[column] + part.room[column] for part in parts)
    return float(share * total), float(near + share * room)


def tolerance_of(shape: Any) -> float:
    """The greatest tolerance of an edge or a vertex."""
    from OCP.BRep import BRep_Tool

    parts = [*explored(shape, "edge"), *explored(shape, "vertex")]
    return max((float(BRep_Tool.Tolerance_s(part)) for part in parts), default=0.0)


def faults_of(shape: Any) -> list[str]:
    """What OpenCASCADE's check finds wrong with shells and faces, by their numbers."""
    from OCP.BRepCheck import BRepCheck_Analyzer, BRepCheck_Face, BRepCheck_Shell, BRepCheck_Wire

    analyzer = BRepCheck_Analyzer(shape)
    if analyzer.IsValid():
        return []
    found = []
    for number, shell in enumerate(explored(shape, "shell"), 1):
        if not analyzer.IsValid(shell):
            found += _told(f"shell {number}", [BRepCheck_Shell(shell).Orientation()])
    for number, face in enumerate(explored(shape, "face"), 1):
        if analyzer.IsValid(face):
            continue
        wires = list(explored(face, "wire"))
        statuses = [BRepCheck_Face(face).IntersectWires()]
        near = next(explored(wires[-1], "edge"))
        for wire in wires:
            first, second = TopoDS_Edge(), TopoDS_Edge()
            statuses.append(BRepCheck_Wire(wire).SelfIntersect(face, first, second))
            near = near if first.IsNull() else first
        found += _told(named(face, number), statuses, f" near {_middle(near)}")
    return found


def _told(place: str, statuses: list[Any], where: str = "") -> list[str]:
    names = sorted({status.name for status in statuses} & set(WRONG))
    return [f"{place}: {name.removeprefix('BRepCheck_')}{where}" for name in names]


def _middle(edge: Any) -> str:
    """The point in the middle of an edge."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    x, y, z = coordinates(curve.Value(0.5 * (curve.FirstParameter() + curve.LastParameter())))
    return f"({x:.6g}, {y:.6g}, {z:.6g})"


def free_edges(shape: Any) -> list[str]:
    """Where a shell is open: middles of edges that bound one face."""
    from OCP.BRep import BRep_Tool

    users: dict[Any, int] = {}
    kept: dict[Any, Any] = {}
    for face in explored(shape, "face"):
        for edge in explored(face, "edge"):
            if not BRep_Tool.Degenerated_s(edge):
                users[hash(edge)] = users.get(hash(edge), 0) + 1
                kept[hash(edge)] = edge
    return [_middle(kept[key]) for key, times in users.items() if times == 1]


# Area and volume of OpenCASCADE's faces, where its own rules have not converged.
#
# By Green's theorem an integral over a face is one over its trimming curves, of integrals along u.
# Surface and curves are OpenCASCADE's, so that ours are compared with what the file has.

# Points of Gauss's rule in a panel, panels of a face at most, and points at which its edges are
# compared with its trimming curves.
POINTS, MOST_PANELS, COMPARED = 10, 3000, 33
NODES, WEIGHTS = np.polynomial.legendre.leggauss(POINTS)


class Integrals(NamedTuple):
    """Of a face: its area and what it adds to three times the volume, (2,) each.

    values : with the sign of the face's side; error : about, of the quadrature; room : by how much
    they may differ since edges miss the trimming curves.
    """

    values: Array
    error: Array
    room: Array


class _Face:
    """A face forward, about a centre."""

    def __init__(self, face: Any, centre: Array) -> None:
        from OCP.BRep import BRep_Tool
        from OCP.BRepTools import BRepTools
        from OCP.GeomAbs import GeomAbs_CN
        from OCP.GeomAdaptor import GeomAdaptor_Surface
        from OCP.gp import gp_Pnt, gp_Vec
        from OCP.TopAbs import TopAbs_FORWARD

        self.face = cast("face", face.Oriented(TopAbs_FORWARD))
        self.surface = BRep_Tool.Surface_s(face)
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        self.middle, self.centre = 0.5 * (u0 + u1), gp_Vec(*centre.tolist())
        adaptor = GeomAdaptor_Surface(self.surface, u0, u1, v0, v1)
        self.knots = intervals(adaptor.NbUIntervals, adaptor.UIntervals, GeomAbs_CN)
        self.room = gp_Pnt(), gp_Vec(), gp_Vec()

    def along(self, u: float, v: float) -> Array:
        """The integrals from the middle to u, at v."""
        from OCP.gp import gp_Vec

        point, xu, xv = self.room
        low, high = sorted((self.middle, u))
        ends = [low, *(k for k in self.knots if low < k < high), high]
        total = np.zeros(2)
        for a, b in pairwise(ends):
            for node, weight in zip(NODES.tolist(), WEIGHTS.tolist(), strict=True):
                self.surface.D1(0.5 * (a + b + node * (b - a)), v, point, xu, xv)
                normal = xu.Crossed(xv)
                flux = (gp_Vec(point.XYZ()) - self.centre).Dot(normal)
                total += 0.5 * (b - a) * weight * np.array([normal.Magnitude(), flux])
        return total if u > self.middle else -total


def intervals(count: Any, fill: Any, *smooth: Any) -> list[float]:
    """Parameters between which a curve or surface is smooth, as OpenCASCADE's adaptors tell."""
    from OCP import collections as arrays

    ends = arrays.Array1_double(1, count(*smooth) + 1)
    fill(ends, *smooth)
    return [ends.Value(k) for k in range(1, ends.Length() + 1)]


def face_integrals(face: Any, centre: Array) -> Integrals:
    """The integrals of a face about a centre.

    Parameters
    ----------
    face : TopoDS_Face
    centre : (3,) array

    Returns
    -------
    Integrals
    """
    from OCP.TopAbs import TopAbs_EXTERNAL, TopAbs_INTERNAL

    own = _Face(face, centre)
    panels: list[tuple[Any, float, float, float, Array]] = []
    room = 0.0
    for edge in explored(own.face, "edge"):
        if edge.Orientation() in (TopAbs_INTERNAL, TopAbs_EXTERNAL):
            continue
        flat, ends, missed = _trim(edge, own.face)
        room += missed
        sign = 1.0 if forward(edge) else -1.0
        panels += [(flat, sign, a, b, _panel(own, flat, a, b)) for a, b in pairwise(ends)]
    values, error = _refined(own, panels)
    values = values if forward(face) else -values
    reach = max(float(np.linalg.norm(corner - centre)) for corner in box_of(face))
    return Integrals(values, error, room * np.array([1.0, reach]))


def _refined(own: _Face, panels: list[Any]) -> tuple[Array, Array]:
    """Panels halved until both halves agree with the whole."""
    scale = np.abs(sum(sign * part for _, sign, _, _, part in panels))
    scale = np.maximum(scale, scale[0])
    total, error, count = np.zeros(2), np.zeros(2), len(panels)
    while panels:
        flat, sign, a, b, whole = panels.pop()
        middle = 0.5 * (a + b)
        halves = [_panel(own, flat, *part) for part in ((a, middle), (middle, b))]
        off = np.abs(sum(halves) - whole)
        count += 2
        if count > MOST_PANELS or np.all(off <= QUADRATURE * scale / len(NODES)):
            total, error = total + sign * sum(halves), error + off
        else:
            panels += [(flat, sign, a, middle, halves[0]), (flat, sign, middle, b, halves[1])]
    return total, error


def _panel(own: _Face, flat: Any, a: float, b: float) -> Array:
    from OCP.gp import gp_Pnt2d, gp_Vec2d

    place, way = gp_Pnt2d(), gp_Vec2d()
    total = np.zeros(2)
    for node, weight in zip(NODES.tolist(), WEIGHTS.tolist(), strict=True):
        flat.D1(0.5 * (a + b + node * (b - a)), place, way)
        if way.Y() != 0.0:
            total += 0.5 * (b - a) * weight * way.Y() * own.along(place.X(), place.Y())
    return total


def _trim(edge: Any, face: Any) -> tuple[Any, Sequence[float], float]:
    """A trimming curve, the ends of its smooth parts, and the area between it and its edge."""
    from OCP.BRep import BRep_Tool
    from OCP.Geom2dAdaptor import Geom2dAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_CN

    flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
    first, last = BRep_Tool.Range_s(edge, face)
    adaptor = Geom2dAdaptor_Curve(flat, first, last)
    ends = intervals(adaptor.NbIntervals, adaptor.Intervals, GeomAbs_CN)
    curve = None if BRep_Tool.Degenerated_s(edge) else BRep_Tool.Curve_s(edge, 0.0, 0.0)
    if curve is None:
        return flat, ends, 0.0
    surface = BRep_Tool.Surface_s(face)
    ts = np.linspace(first, last, COMPARED).tolist()
    points = np.array([coordinates(curve.Value(t)) for t in ts])
    images = np.array(
        [coordinates(surface.Value(p.X(), p.Y())) for p in (flat.Value(t) for t in ts)]
    )
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return flat, ends, length * float(np.linalg.norm(images - points, axis=1).max())
