"""What OpenCASCADE finds about a shape: size, area, volume, tolerances, faults."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from OCP.TopoDS import TopoDS_Edge

from standoff.cad.opencascade import coordinates, explored
from standoff.cad.surfaces import kind_of
from standoff.cad.tolerances import QUADRATURE

WRONG = (
    "BRepCheck_SelfIntersectingWire",
    "BRepCheck_IntersectingWires",
    "BRepCheck_UnorientableShape",
)
"""What no tolerance excuses."""
PARTS = (16, 64)
"""Into how many parts faces are cut, about, where integrals over the whole do not agree: near trims
that cross many spans OpenCASCADE's rules are off by 1e-5."""


def size_of(shape: Any) -> float:
    """Diagonal of a box around a shape."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    return 0.0 if box.IsVoid() else float(np.sqrt(box.SquareExtent()))


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


def nearest(measure: Callable[[Any, bool], float], shape: Any, own: float, near: float) -> float:
    """The measure that is nearest to one's own: no rule is right for all shapes. The adaptive one
    is tried where the other is farther off than `near`, and where both are, on faces that are cut
    into smaller ones."""
    found = []
    for parts in (0, 1, *PARTS):
        given = shape if parts < 2 else _divided(shape, abs(area_of(shape)) / parts)
        found.append(abs(measure(given, parts > 0)))
        if abs(found[-1] - own) <= near:
            break
    return min(found, key=lambda value: abs(value - own))


def _divided(shape: Any, most: float) -> Any:
    """The same with its faces cut into parts of an area, length squared, at most."""
    from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideArea

    divider = ShapeUpgrade_ShapeDivideArea(shape)
    divider.MaxArea = most
    divider.Perform()
    return divider.Result()


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
        found += _told(f"face {number} (a {kind_of(face)})", statuses, f" near {_middle(near)}")
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
