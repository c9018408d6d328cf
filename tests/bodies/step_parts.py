"""A solid of plane, cylindrical and conical faces from a STEP file, as parts of a boundary.

Only what the tests need: whole circles without their seams, lines and arcs.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from standoff.bodies import Edge, Face
from standoff.geometry import Cone, ConicArc, Curve, Cylinder, Line, Plane, Surface


def bracket(path: Path) -> tuple[float, float]:
    """Write an angle bracket with a rounded inner corner and a countersunk hole; returns its volume
    and area as OpenCASCADE computes them."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer

    foot = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 60, 30, 8).Shape()
    wall = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 8, 30, 40).Shape()
    angle = BRepAlgoAPI_Fuse(foot, wall)
    angle.SimplifyResult()
    fillet = BRepFilletAPI_MakeFillet(angle.Shape())
    found = TopExp_Explorer(angle.Shape(), TopAbs_EDGE)
    while found.More():
        edge = _cast("Edge", found.Current())
        a, b = _ends(edge)
        if all(abs(p[0] - 8) < 1e-9 and abs(p[2] - 8) < 1e-9 for p in (a, b)):
            fillet.Add(5.0, edge)
            break
        found.Next()
    axis = gp_Ax2(gp_Pnt(40, 15, -1), gp_Dir(0, 0, 1))
    drilled = BRepAlgoAPI_Cut(fillet.Shape(), BRepPrimAPI_MakeCylinder(axis, 4, 20).Shape())
    sink = gp_Ax2(gp_Pnt(40, 15, 5), gp_Dir(0, 0, 1))
    whole = BRepAlgoAPI_Cut(drilled.Shape(), BRepPrimAPI_MakeCone(sink, 4, 7, 3).Shape()).Shape()
    writer = STEPControl_Writer()
    writer.Transfer(whole, STEPControl_AsIs)
    writer.Write(str(path))
    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(whole, volume)
    BRepGProp.SurfaceProperties_s(whole, area)
    return volume.Mass(), area.Mass()


def _cast(name: str, shape: Any) -> Any:
    """A shape as the one it is; version 8 of the bindings dropped the names' endings."""
    from OCP.TopoDS import TopoDS

    return (getattr(TopoDS, name, None) or getattr(TopoDS, f"{name}_s"))(shape)


def _ends(edge: Any) -> tuple[np.ndarray, np.ndarray]:
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    return _point(curve.Value(curve.FirstParameter())), _point(curve.Value(curve.LastParameter()))


def _point(p: Any) -> np.ndarray:
    return np.array([p.X(), p.Y(), p.Z()])


def read(path: Path) -> Any:
    """The one solid of a file."""
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def parts(shape: Any) -> tuple[np.ndarray, list[Edge], list[Face]]:
    """Vertices, edges and faces. Seams, which a face has twice, and their vertices are left out."""
    from OCP.TopAbs import TopAbs_FACE

    vertices: list[np.ndarray] = []
    edges: list[Edge] = []
    known: list[Any] = []
    faces = []
    for face in _explored(shape, TopAbs_FACE):
        loop = []
        for wire in _wires(face):
            for edge, sense in wire:
                if sum(edge.IsSame(other) for other, _ in wire) == 2:
                    continue
                number = next((k for k, e in enumerate(known) if e.IsSame(edge)), len(known))
                if number == len(known):
                    known.append(edge)
                    edges.append(_edge(edge, vertices))
                loop.append((number, sense))
        faces.append(Face((_surface(face),), tuple(loop)))
    return np.reshape(vertices, (-1, 3)), edges, faces


def _explored(shape: Any, kind: Any) -> Iterator[Any]:
    from OCP.TopExp import TopExp_Explorer

    found = TopExp_Explorer(shape, kind)
    while found.More():
        yield _cast("Face", found.Current())
        found.Next()


def _wires(face: Any) -> Iterator[list[tuple[Any, int]]]:
    from OCP.BRepTools import BRepTools_WireExplorer
    from OCP.TopAbs import TopAbs_FORWARD, TopAbs_WIRE
    from OCP.TopExp import TopExp_Explorer

    found = TopExp_Explorer(face, TopAbs_WIRE)
    while found.More():
        along = BRepTools_WireExplorer(_cast("Wire", found.Current()), face)
        wire = []
        while along.More():
            edge = along.Current()
            wire.append((edge, 1 if edge.Orientation() == TopAbs_FORWARD else -1))
            along.Next()
        yield wire
        found.Next()


def _edge(edge: Any, vertices: list[np.ndarray]) -> Edge:
    curve = _curve(edge)
    if curve.closed:
        return Edge(curve)
    return Edge(curve, *(_vertex(curve.point(t), vertices) for t in (curve.first, curve.last)))


def _vertex(point: np.ndarray, vertices: list[np.ndarray]) -> int:
    for k, other in enumerate(vertices):
        if np.linalg.norm(point - other) < 1e-6:
            return k
    vertices.append(point)
    return len(vertices) - 1


def _curve(edge: Any) -> Curve:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Line

    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    if curve.GetType() == GeomAbs_Line:
        return Line(_point(curve.Value(first)), _point(curve.Value(last)))
    assert curve.GetType() == GeomAbs_Circle
    circle = curve.Circle()
    at, r = circle.Position(), circle.Radius()
    axes = (r * _point(at.XDirection()), r * _point(at.YDirection()))
    return ConicArc(_point(at.Location()), *axes, first, last)


def _surface(face: Any) -> Surface:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane

    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind == GeomAbs_Plane:
        at = surface.Plane().Position()
        x, y = _point(at.XDirection()), _point(at.YDirection())
        return Plane.through(_point(at.Location()), x, y)
    if kind == GeomAbs_Cylinder:
        own = surface.Cylinder()
        at, r = own.Position(), own.Radius()
        x, y, z = (_point(d) for d in (at.XDirection(), at.YDirection(), at.Direction()))
        return Cylinder(np.column_stack([r * x, r * y, z]), _point(at.Location()))
    assert kind == GeomAbs_Cone
    own = surface.Cone()
    at, slope = own.Position(), np.tan(own.SemiAngle())
    x, y, z = (_point(d) for d in (at.XDirection(), at.YDirection(), at.Direction()))
    up = np.sign(slope) * z
    return Cone(np.column_stack([abs(slope) * x, abs(slope) * y, up]), _point(own.Apex()))
