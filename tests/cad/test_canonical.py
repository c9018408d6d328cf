"""Splines that are planes, circles and so on: found, proven, and as good as those themselves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

import cad_shapes as made

import standoff as so
from shares import only
from standoff.cad.canonical import recognised
from standoff.cad.surfaces import Carrier, carrier
from standoff.geometry.quadrics import Sphere

PLACE = (0.3, -1.2, 2.0)
WAY = (0.48, -0.6, 0.64)
KINDS = ("plane", "cylinder", "cone", "sphere", "torus")
OTHERS = ("bent", "egg")


def spline(kind: str, poke: float = 0.0) -> Any:
    """A part of a surface as a rational spline, of which one inner control point is moved."""
    from OCP import Geom
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt

    at = gp_Ax3(gp_Pnt(*PLACE), gp_Dir(*WAY))
    surface, over = {
        "plane": lambda: (Geom.Geom_Plane(at), (-1.0, 2.0, 0.0, 1.5)),
        "cylinder": lambda: (Geom.Geom_CylindricalSurface(at, 0.7), (0.4, 3.9, -1.0, 2.0)),
        "cone": lambda: (Geom.Geom_ConicalSurface(at, 0.5, 1.0), (0.4, 3.9, -1.0, 2.0)),
        "sphere": lambda: (Geom.Geom_SphericalSurface(at, 1.0), (0.4, 3.9, -1.0, 1.0)),
        "torus": lambda: (Geom.Geom_ToroidalSurface(at, 1.0, 0.3), (0.4, 3.9, -1.0, 1.0)),
        "bent": lambda: (Geom.Geom_ToroidalSurface(at, 1.0, 0.3), (0.4, 3.9, -1.0, 1.0)),
        "egg": lambda: (Geom.Geom_SphericalSurface(at, 1.0), (0.4, 3.9, -1.0, 1.0)),
    }[kind]()
    trimmed = Geom.Geom_RectangularTrimmedSurface(surface, *over)
    found = GeomConvert.SurfaceToBSplineSurface_s(trimmed)
    found.InsertUKnot(0.5 * (found.UKnot(1) + found.UKnot(2)), 1, 0.0)
    found.IncreaseDegree(max(found.UDegree(), 3), max(found.VDegree(), 3))
    pole, poke = found.Pole(2, 2), 0.1 if kind in OTHERS else poke
    found.SetPole(2, 2, gp_Pnt(pole.X() + poke, pole.Y() - 0.5 * poke, pole.Z() + 0.7 * poke))
    return found


def carried(geometry: Any) -> Carrier:
    return carrier(geometry, tuple(geometry.Bounds()))


def away(of: Carrier, geometry: Any, rng: Generator) -> float:
    """How far points of a spline are from a surface at most, by feet in closed form."""
    spots = rng.uniform(0.0, 1.0, (4000, 2))
    u0, u1, v0, v1 = geometry.Bounds()
    points = np.array(
        [
            [p.X(), p.Y(), p.Z()]
            for s, t in spots
            for p in [geometry.Value(u0 + s * (u1 - u0), v0 + t * (v1 - v0))]
        ]
    )
    if isinstance(of.surface, Sphere):
        out = points - of.surface.shift
        radius = np.linalg.norm(of.surface.linear[:, 0])
        return float(np.abs(np.linalg.norm(out, axis=1) - radius).max())
    assert of.inverse is not None
    feet = of.surface.points(of.inverse(points))
    return float(np.linalg.norm(points - feet, axis=1).max())


@pytest.mark.parametrize("poke", [0.0, 1e-12, 1e-9, 1e-7])
@pytest.mark.parametrize("kind", KINDS)
def test_what_a_spline_is_off_by_is_bounded(kind: str, poke: float, rng: Generator) -> None:
    geometry = spline(kind, poke)
    like = recognised(carried(geometry), 0.1)
    assert like is not None
    found = like[0]
    assert found.kind == kind
    off = away(found, geometry, rng)
    assert off <= found.moved + 1e-15
    assert found.moved <= max(30.0 * off, 1e-11)
    if poke > 1e-10:
        assert recognised(carried(geometry), 0.1 * poke) is None


@pytest.mark.parametrize("kind", OTHERS)
def test_other_splines_stay_what_they_are(kind: str) -> None:
    assert recognised(carried(spline(kind)), 1e-6) is None


@pytest.mark.parametrize("name", only(["plate", "flange"], ["plate", "flange", "drilled_tube"]))
def test_parts_of_splines_are_those_of_their_kinds(name: str, rng: Generator) -> None:
    """Volumes, and distances of points, but for the slack of both."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

    shape = getattr(made, name)()
    exact = so.cad.from_shape(shape)[0]
    splines = so.cad.from_shape(BRepBuilderAPI_NurbsConvert(shape, True).Shape())[0]
    assert splines.report.faces["spline"] == sum(exact.report.faces.values())
    assert "of its splines these are others" in splines.report.notes[0]
    kinds = {type(face.charts[0]).__name__ for face in splines.shape.face_parts}
    assert kinds == {type(face.charts[0]).__name__ for face in exact.shape.face_parts}
    curves = {type(edge.curve).__name__ for edge in splines.shape.edge_parts}
    assert curves == {"Line", "ConicArc"}
    assert splines.report.slack <= 3e-9 * exact.report.size + 2.0 * exact.report.slack
    assert splines.report.volume == pytest.approx(exact.report.volume, rel=1e-8)
    points = rng.uniform(-0.7, 0.7, (10, 3)) * exact.report.size
    one, other = (part.solid.signed_distance(points).distance for part in (exact, splines))
    np.testing.assert_allclose(one, other, atol=exact.report.slack + splines.report.slack + 1e-9)
