"""Shapes made by OpenCASCADE, and files of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np


def cast(kind: str, shape: Any) -> Any:
    from OCP.TopoDS import TopoDS

    return (getattr(TopoDS, kind, None) or getattr(TopoDS, f"{kind}_s"))(shape)


def explored(shape: Any, kind: str) -> list[Any]:
    from OCP import TopAbs
    from OCP.TopExp import TopExp_Explorer

    walk = TopExp_Explorer(shape, getattr(TopAbs, f"TopAbs_{kind.upper()}"))
    found = []
    while walk.More():
        found.append(cast(kind.capitalize(), walk.Current()))
        walk.Next()
    return found


def box(x: float, y: float, z: float, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(*at), x, y, z).Shape()


def cylinder(at: tuple[float, float, float], radius: float, height: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*at), gp_Dir(0, 0, 1)), radius, height).Shape()


def cut(a: Any, *others: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for other in others:
        a = BRepAlgoAPI_Cut(a, other).Shape()
    return explored(a, "solid")[0]


def filleted_box() -> Any:
    """All edges and corners rounded: planes, cylinders and eighths of spheres; convex."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

    solid = box(30, 20, 10)
    fillet = BRepFilletAPI_MakeFillet(solid)
    for edge in explored(solid, "edge"):
        fillet.Add(3.0, edge)
    return explored(fillet.Shape(), "solid")[0]


def plate() -> Any:
    """With four holes, one of them through two sides of a slot."""
    holes = [cylinder((x, y, -1), 4, 20) for x in (12, 48) for y in (12, 28)]
    return cut(box(60, 40, 8), *holes, box(20, 10, 9, (20, 15, 4)))


def flange() -> Any:
    """A hub on a disc, with a bore, six bolt holes and a fillet of a torus."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

    body = BRepAlgoAPI_Fuse(cylinder((0, 0, 0), 50, 10), cylinder((0, 0, 0), 25, 40)).Shape()
    fillet = BRepFilletAPI_MakeFillet(body)
    for edge in explored(body, "edge"):
        points = [_point(vertex) for vertex in explored(edge, "vertex")]
        if all(abs(np.hypot(*p[:2]) - 25) < 1e-6 and abs(p[2] - 10) < 1e-6 for p in points):
            fillet.Add(5.0, edge)
            break
    angles = np.arange(6) * np.pi / 3
    holes = [cylinder((40 * np.cos(a), 40 * np.sin(a), -1), 4, 20) for a in angles]
    return cut(fillet.Shape(), cylinder((0, 0, -1), 15, 60), *holes)


def _point(vertex: Any) -> tuple[float, float, float]:
    from OCP.BRep import BRep_Tool

    p = BRep_Tool.Pnt_s(vertex)
    return p.X(), p.Y(), p.Z()


def elbow() -> Any:
    """A quarter of a pipe: two tori that close round their tubes."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    outer = BRepPrimAPI_MakeTorus(30.0, 10.0, np.pi / 2).Shape()
    return cut(outer, BRepPrimAPI_MakeTorus(30.0, 8.0, np.pi / 2).Shape())


def cone() -> Any:
    """To its apex."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    return BRepPrimAPI_MakeCone(10.0, 0.0, 25.0).Solid()


def twisted() -> Any:
    """Through two squares, one turned: four faces of splines, which bend inward, like a thread."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakePolygon
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.gp import gp_Pnt

    loft = BRepOffsetAPI_ThruSections(True, False)
    for height, turn in ((0.0, 0.0), (10.0, 0.5), (20.0, 1.0)):
        polygon = BRepBuilderAPI_MakePolygon()
        for a in np.arange(4) * np.pi / 2 + turn:
            polygon.Add(gp_Pnt(10 * np.cos(a), 10 * np.sin(a), height))
        polygon.Close()
        loft.AddWire(polygon.Wire())
    return explored(loft.Shape(), "solid")[0]


def drilled_tube() -> Any:
    """A cylinder with a hole across: its trims are splines on a cylinder."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    across = gp_Ax2(gp_Pnt(-30, 0, 20), gp_Dir(1, 0, 0))
    hole = BRepPrimAPI_MakeCylinder(across, 6.0, 60.0).Shape()
    return cut(cylinder((0, 0, 0), 12, 40), hole)


def cut_off() -> Any:
    """A cylinder of radius 10 about z, cut off by a plane through (0, 0, 10) along (1, 0, 0.6)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 10), gp_Dir(0, -1, 0)), float(np.arctan(0.6)))
    above = BRepBuilderAPI_Transform(box(80, 80, 80, (-40, -40, 10)), turn, True).Shape()
    return cut(cylinder((0, 0, 0), 10, 30), above)


def hollow() -> Any:
    """A box with a ball-shaped cavity."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    return cut(box(20, 20, 20), BRepPrimAPI_MakeSphere(gp_Pnt(10, 10, 10), 6.0).Shape())


def dimpled() -> Any:
    """A box with a spherical pit."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    return cut(box(20, 20, 20), BRepPrimAPI_MakeSphere(gp_Pnt(10, 10, 22), 7.0).Shape())


def measured(shape: Any) -> tuple[float, float]:
    """Volume and area by OpenCASCADE."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, volume, 1e-12, False, False)
    BRepGProp.SurfaceProperties_s(shape, area, 1e-12, False)
    return volume.Mass(), area.Mass()


def write_step(shape: Any, path: Path, unit: str = "MM", shell: bool = False) -> Path:
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import (
        STEPControl_AsIs,
        STEPControl_ShellBasedSurfaceModel,
        STEPControl_Writer,
    )

    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl_ShellBasedSurfaceModel if shell else STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path


def write_brep(shape: Any, path: Path) -> Path:
    from OCP.BRepTools import BRepTools

    assert BRepTools.Write_s(shape, str(path))
    return path


def write_assembly(path: Path, names: tuple[str, str, str]) -> Path:
    """A box, and twice a rod: one moved, one turned and moved; the box is red."""
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.Quantity import Quantity_Color, Quantity_TOC_RGB
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("made"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    root = shapes.NewShape()
    named = [(root, "all")]
    parts = [shapes.AddShape(one, False) for one in (box(10, 10, 10), cylinder((0, 0, 0), 2, 30))]
    moved, turned = gp_Trsf(), gp_Trsf()
    moved.SetTranslation(gp_Vec(20, 0, 5))
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), np.pi / 2)
    turned.SetTranslationPart(gp_Vec(0, -15, 0))
    uses = ((parts[0], gp_Trsf()), (parts[1], moved), (parts[1], turned))
    for (part, at), name in zip(uses, names, strict=True):
        named.append((shapes.AddComponent(root, part, TopLoc_Location(at)), name))
    for label, name in named:
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))
    colours.SetColor(parts[0], Quantity_Color(1.0, 0.0, 0.0, Quantity_TOC_RGB), XCAFDoc_ColorSurf)
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.SetColorMode(True)
    writer.Transfer(document)
    writer.Write(str(path))
    return path


def drilled_ball(radius: float, *holes: tuple[float, ...]) -> Any:
    """A ball about the origin with round holes off its centre, each (start, direction, radius): its
    face has both poles, and edges that are no circles."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    tools = [
        BRepPrimAPI_MakeCylinder(
            gp_Ax2(gp_Pnt(*hole[:3]), gp_Dir(*hole[3:6])), hole[6], 4.0 * radius
        ).Shape()
        for hole in holes
    ]
    return cut(BRepPrimAPI_MakeSphere(radius).Shape(), *tools)


def crossing_shells() -> Any:
    """A box of 2 x 2 x 2 with a shell inside as a cavity, which pokes through its side x = 2."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Solid

    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, explored(box(2, 2, 2), "shell")[0])
    builder.Add(solid, explored(box(1.2, 1, 1, (1.0, 0.5, 0.5)), "shell")[0].Reversed())
    return solid


def turned_cylinder(
    at: tuple[float, float, float], way: tuple[float, float, float], radius: float, height: float
) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    axes = gp_Ax2(gp_Pnt(*map(float, at)), gp_Dir(*map(float, way)))
    return BRepPrimAPI_MakeCylinder(axes, radius, height).Shape()


def blunt_cone(at: tuple[float, float, float], low: float, high: float, height: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    axes = gp_Ax2(gp_Pnt(*map(float, at)), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeCone(axes, low, high, height).Shape()


def ball(at: tuple[float, float, float], radius: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeSphere(gp_Pnt(*map(float, at)), radius).Shape()


def ring(major: float, minor: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(major, minor).Shape()


def from_boundary(shape: Any, points: list[tuple[float, float, float]]) -> list[float]:
    """Distances of points from the boundary, by OpenCASCADE."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt

    shells = explored(shape, "shell")
    vertices = [BRepBuilderAPI_MakeVertex(gp_Pnt(*map(float, p))).Vertex() for p in points]
    return [
        min(BRepExtrema_DistShapeShape(vertex, shell).Value() for shell in shells)
        for vertex in vertices
    ]


def as_splines(shape: Any) -> Any:
    """With every surface and curve as a spline; round ones close."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

    return BRepBuilderAPI_NurbsConvert(shape, True).Shape()


def spun(points: list[tuple[float, float]]) -> Any:
    """A closed spline through points (x, z), rotated about the axis z."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeRevol(_disc(points), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def pulled(points: list[tuple[float, float]], height: float) -> Any:
    """A closed spline through points (x, z), moved along y."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec

    return BRepPrimAPI_MakePrism(_disc(points), gp_Vec(0, height, 0)).Shape()


def _disc(points: list[tuple[float, float]]) -> Any:
    from OCP import collections as arrays
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.GeomAPI import GeomAPI_Interpolate
    from OCP.gp import gp_Pnt

    places = arrays.HArray1_gp_Pnt(1, len(points))
    for k, (x, z) in enumerate(points, 1):
        places.SetValue(k, gp_Pnt(x, 0.0, z))
    maker = GeomAPI_Interpolate(places, True, 1e-9)
    maker.Perform()
    wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(maker.Curve()).Edge()).Wire()
    return BRepBuilderAPI_MakeFace(wire).Face()
