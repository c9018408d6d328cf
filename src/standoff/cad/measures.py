"""What OpenCASCADE finds about a shape: size, area, volume, tolerances, faults."""

from __future__ import annotations

from typing import Any

import numpy as np
from OCP.TopoDS import TopoDS_Edge

from standoff.cad.opencascade import box_of, coordinates, explored
from standoff.cad.quadrature import face_integrals
from standoff.cad.surfaces import kind_of
from standoff.cad.tolerances import QUADRATURE

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
