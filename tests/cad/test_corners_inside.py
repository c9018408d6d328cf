"""Edges with corners inside, and faces with creases: divided there, or refused."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import standoff as so
from standoff.geometry import NurbsCurve, NurbsSurface
from standoff.solids.spatial import tree
from standoff.solids.spatial.corners import CornerError, check_corners, check_creases

SQUARE = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 0)], dtype=float)
UP = np.array([0.0, 0.0, 1.0])
KNOTS = [0, 0, 1, 2, 3, 4, 4]


def test_corners_of_curves() -> None:
    """A corner is where the direction changes, not where the speed alone does."""
    with pytest.raises(CornerError, match=r"Edge 7 has a corner inside, at t = 1, \(2, 0, 0\)"):
        check_corners({7: NurbsCurve(SQUARE, KNOTS)})
    straight = SQUARE[:1] + np.array([0.0, 1.0, 5.0, 5.5, 9.0])[:, None] * [1.0, 2.0, 0.5]
    check_corners({0: NurbsCurve(straight, KNOTS), 1: so.geometry.Line(SQUARE[0], SQUARE[1])})
    bent = straight + np.array([0, 0, 0, 0, 1e-6])[:, None] * [2.0, -1.0, 0.0]
    with pytest.raises(CornerError, match="t = 3"):
        check_corners({0: NurbsCurve(bent, KNOTS)})
    # there and back is a corner too
    with pytest.raises(CornerError, match="t = 2"):
        check_corners({0: NurbsCurve(straight[[0, 1, 2, 1, 0]], KNOTS)})


@pytest.mark.parametrize("along", [0, 1])
def test_creases_of_surfaces(along: int) -> None:
    net = np.stack([SQUARE[:3], SQUARE[:3] + UP])
    row = np.array([0.0, 1.0, 3.0])[:, None] * [1.0, 0.0, 0.0]
    flat = np.stack([row, row + UP])
    knots = [[0, 0, 1, 1], [0, 0, 1, 2, 2]]

    def leaves(*ends: tuple[float, float]) -> Any:
        whole = (0.0, 1.0)
        boxes = [(*part, *whole) if along == 0 else (*whole, *part) for part in ends]
        return [SimpleNamespace(dim=2, chart=4, reals=np.array(box)) for box in boxes]

    def surface(points: Any) -> NurbsSurface:
        if along == 0:
            return NurbsSurface(np.swapaxes(points, 0, 1), knots[1], knots[0])
        return NurbsSurface(points, knots[0], knots[1])

    check_creases({4: (2, surface(flat))}, leaves((0.0, 1.0), (1.0, 2.0)))
    creased = {4: (2, surface(net))}
    with pytest.raises(CornerError, match=f"Face 2 has a crease inside, at {'uv'[along]} = 1, "):
        check_creases(creased, leaves((0.0, 0.5), (0.5, 1.0), (1.0, 2.0)))
    # what is on one side of the crease alone has none
    check_creases(creased, leaves((0.0, 0.5), (0.5, 1.0)))


def test_a_prism_over_one_polyline_is_divided() -> None:
    """Its faces and edges come from a single curve of degree 1, as OpenCASCADE cuts them."""
    pytest.importorskip("OCP")
    from OCP import collections as arrays
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.Geom import Geom_BSplineCurve
    from OCP.gp import gp_Pnt, gp_Vec

    poles, knots = arrays.Array1_gp_Pnt(1, 5), arrays.Array1_double(1, 5)
    times = arrays.Array1_int(1, 5)
    for k, place in enumerate(SQUARE.tolist(), 1):
        poles.SetValue(k, gp_Pnt(*place))
        knots.SetValue(k, float(k - 1))
        times.SetValue(k, 2 if k in (1, 5) else 1)
    edge = BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(poles, knots, times, 1)).Edge()
    face = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(edge).Wire()).Face()
    part = so.cad.from_shape(BRepPrimAPI_MakePrism(face, gp_Vec(0.0, 0.0, 3.0)).Shape())[0]
    points = np.random.default_rng(1).uniform([-1, -1, -1], [3, 3, 4], (200, 3))
    off = np.maximum(-points, points - [2.0, 2.0, 3.0])
    true = np.linalg.norm(np.maximum(off, 0.0), axis=1) + np.minimum(off.max(axis=1), 0.0)
    told = part.solid.signed_distance(points)
    np.testing.assert_allclose(told.distance, true, atol=1e-9)
    assert told.converged.all()


def test_every_solid_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """All sharp edges, and all faces with their leaves; faces have the points at smooth ones."""
    edges: dict[int, Any] = {}
    faces: dict[int, Any] = {}
    monkeypatch.setattr(tree, "check_corners", edges.update)
    monkeypatch.setattr(tree, "check_creases", lambda charts, leaves: faces.update(charts))
    so.solids.Solid(so.shapes.box((1.0, 2.0, 3.0)))
    assert (len(edges), len(faces)) == (12, 6)


def test_roundoff_beside_a_pole_is_no_crease() -> None:
    """As on a rounding of a part of an assembly, far from its origin: normals at a pole
    are products of a tangent and of next to nothing."""
    across = np.linspace(0.0, np.pi / 2, 7)
    rings = [np.array([np.cos(a), 0.0, np.sin(a)]) for a in across[:-1]]
    turns = [
        np.array([[np.cos(t), -np.sin(t), 0.0], [np.sin(t), np.cos(t), 0.0], UP])
        for t in (0, 0.3, 0.6, 0.9, 1.2, 1.5)
    ]
    net = np.array([[turn @ ring for turn in turns] for ring in rings] + [[UP] * len(turns)])
    knots = [[0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4], [0, 0, 0, 0, 0.5, 0.5, 1, 1, 1, 1]]
    surface = NurbsSurface(net + np.array([300.0, -200.0, 100.0]), *knots)
    ends = 4.0 - np.array([4.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
    leaves: Any = [
        SimpleNamespace(dim=2, chart=0, reals=np.array([a, b, *side]))
        for a, b in pairwise(ends)
        for side in ((0.0, 0.5), (0.5, 1.0))
    ]
    check_creases({0: (3, surface)}, leaves)
