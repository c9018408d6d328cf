"""The study's solids made by OpenCASCADE itself, from their outlines, and its meshes of them.

``pip install cadquery-ocp-novtk`` has it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff_studies.soak.solid_outlines import Arc, Array, Cubic, Outline, Piece, Segment
from standoff_studies.soak.solid_truth import Egg, Elbow, Hollowed, Swept, Truth, Turned

ANGLE = 0.2
"""Radians: of a mesh, between neighbouring triangles."""


def shape_of(truth: Truth) -> Any:
    """OpenCASCADE's shape of a solid.

    Raises
    ------
    ImportError
        Without OpenCASCADE: ``pip install cadquery-ocp-novtk``.
    TypeError
        Another solid.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeTorus
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Vec

    if isinstance(truth, Turned):
        first = truth.outline.pieces[0]
        if isinstance(first, Arc) and first.full:
            return BRepPrimAPI_MakeTorus(float(first.centre[0]), first.radius).Shape()
        axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
        return BRepPrimAPI_MakeRevol(_face(truth.outline, turned=True), axis).Shape()
    if isinstance(truth, Swept):
        along = gp_Vec(0.0, 0.0, truth.high - truth.low)
        return BRepPrimAPI_MakePrism(_face(truth.outline, height=truth.low), along).Shape()
    if isinstance(truth, Hollowed):
        return BRepAlgoAPI_Cut(shape_of(truth.outer), shape_of(truth.cavity)).Shape()
    if isinstance(truth, Elbow):
        return _elbow(truth)
    if isinstance(truth, Egg):
        return _egg(truth)
    raise TypeError(f"{type(truth).__name__} is no solid of the study.")


def _face(outline: Outline, *, turned: bool = False, height: float = 0.0) -> Any:
    """A face in the plane y = 0, or at a height; a full circle is a hole."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
    from OCP.TopoDS import TopoDS

    loop = BRepBuilderAPI_MakeWire()
    holes = []
    for piece in (*outline.pieces, *outline.closing):
        if isinstance(piece, Arc) and piece.full:
            holes.append(piece)
        else:
            loop.Add(_edge(piece, turned, height))
    face = BRepBuilderAPI_MakeFace(loop.Wire())
    for arc in holes:
        middle = gp_Pnt(float(arc.centre[0]), float(arc.centre[1]), height)
        circle = gp_Circ(gp_Ax2(middle, gp_Dir(0.0, 0.0, 1.0)), arc.radius)
        wire = BRepBuilderAPI_MakeWire(_made_edge(circle)).Wire()
        # the name of the static method depends on the version
        cast = getattr(TopoDS, "Wire_s", None) or TopoDS.Wire
        face.Add(cast(wire.Reversed()))
    return face.Face()


def _made_edge(*curve: Any) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

    return BRepBuilderAPI_MakeEdge(*curve).Edge()


def _edge(piece: Piece, turned: bool, height: float) -> Any:
    """A piece (rho, z) in the plane y = 0, or (x, y) at a height."""
    from OCP.collections import Array1_gp_Pnt
    from OCP.Geom import Geom_BezierCurve
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    def point(spot: Array) -> Any:
        x, y = (round(float(c), 13) for c in spot)
        return gp_Pnt(x, 0.0, y) if turned else gp_Pnt(x, y, height)

    if isinstance(piece, Segment):
        return _made_edge(point(piece.p), point(piece.q))
    if isinstance(piece, Arc):
        normal = gp_Dir(0.0, -1.0, 0.0) if turned else gp_Dir(0.0, 0.0, 1.0)
        frame = gp_Ax2(point(piece.centre), normal, gp_Dir(1.0, 0.0, 0.0))
        circle = gp_Circ(frame, piece.radius)
        return _made_edge(circle, *sorted((piece.first, piece.last)))
    if isinstance(piece, Cubic):
        net = Array1_gp_Pnt(1, 4)
        for k, spot in enumerate(piece.control):
            net.SetValue(k + 1, point(spot))
        return _made_edge(Geom_BezierCurve(net))
    raise TypeError(f"{type(piece).__name__} is no piece of the study.")


def _elbow(truth: Elbow) -> Any:
    """Fused of the bend and both legs."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeTorus
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    up = gp_Ax2(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0), gp_Dir(1.0, 0.0, 0.0))

    def pipe(maker: Any) -> Any:
        return BRepAlgoAPI_Cut(maker(truth.outside).Shape(), maker(truth.bore).Shape()).Shape()

    found = pipe(lambda r: BRepPrimAPI_MakeTorus(up, truth.major, r, 0.5 * np.pi))
    for axes, origin in truth.legs:
        way, across = (gp_Dir(*(float(c) for c in axes[:, k])) for k in (2, 0))
        frame = gp_Ax2(gp_Pnt(*(float(c) for c in origin)), way, across)
        leg = pipe(lambda r, frame=frame: BRepPrimAPI_MakeCylinder(frame, r, truth.leg))
        found = BRepAlgoAPI_Fuse(found, leg).Shape()
    return found


def _egg(truth: Egg) -> Any:
    """A ball, stretched."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_GTrsf, gp_Mat, gp_XYZ

    a, b, c = (float(each) for each in truth.semiaxes)
    stretch = gp_GTrsf(gp_Mat(a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c), gp_XYZ(0.0, 0.0, 0.0))
    return BRepBuilderAPI_GTransform(BRepPrimAPI_MakeSphere(1.0).Shape(), stretch, True).Shape()


def placed(shape: Any, pose: Array) -> Any:
    """A shape at a pose."""
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    move = gp_Trsf()
    move.SetValues(*(float(x) for x in pose[:3].ravel()))
    return shape.Located(TopLoc_Location(move))


def triangles_of(shape: Any, chord: float) -> NDArray[np.float64]:
    """(n, 3, 3) corners of a mesh whose triangles are within `chord` of the faces; seen from
    outside they go round to the left."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    BRepMesh_IncrementalMesh(shape, chord, False, ANGLE)
    cast = getattr(TopoDS, "Face_s", None) or TopoDS.Face
    found = []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        face, place = cast(explorer.Current()), TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        move = place.Transformation()
        spots = [mesh.Node(k + 1).Transformed(move) for k in range(mesh.NbNodes())]
        points = np.array([[p.X(), p.Y(), p.Z()] for p in spots])
        rows = np.array([mesh.Triangle(k + 1).Get() for k in range(mesh.NbTriangles())]) - 1
        found.append(points[rows[:, ::-1] if face.Orientation() == TopAbs_REVERSED else rows])
        explorer.Next()
    return np.concatenate(found)
