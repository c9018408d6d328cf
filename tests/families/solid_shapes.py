"""Solids in space that the tests measure: turned parts, prisms and closed surfaces."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from standoff.bodies import Face
from standoff.bodies.face_leaves import face_charts
from standoff.geometry import (
    Cone,
    Cylinder,
    Plane,
    Torus,
    ellipsoid_patches,
)
from standoff.geometry.quadrics import sphere_atlas
from standoff.kernels.entries.queries import on_face
from standoff.solids import Solid
from standoff_studies.soak import solid_parts
from standoff_studies.soak.solid_parts import circle

x, y, z = np.eye(3)


def level(height: float, *loop: tuple[int, int]) -> Face:
    return Face((Plane.through(height * z, x, y),), loop)


def wall(radius: float, *loop: tuple[int, int]) -> Face:
    return Face((Cylinder(np.diag([radius, radius, 1.0]), np.zeros(3)),), loop)


@cache
def peg(radius: float, low: float, high: float) -> Solid:
    edges = [circle(radius, low), circle(radius, high)]
    faces = [level(low, (0, 1)), wall(radius, (0, 1), (1, 1)), level(high, (1, 1))]
    return Solid.from_brep(edges=edges, faces=faces, name="peg")


@cache
def tube(inner: float, outer: float, low: float, high: float) -> Solid:
    edges = [circle(inner, low), circle(inner, high), circle(outer, low), circle(outer, high)]
    faces = [
        level(low, (0, 1), (2, 1)),
        wall(inner, (0, 1), (1, 1)),
        wall(outer, (2, 1), (3, 1)),
        level(high, (1, 1), (3, 1)),
    ]
    return Solid.from_brep(edges=edges, faces=faces, name="tube")


def taper(slope: float, apex: float, *loop: tuple[int, int]) -> Face:
    """A cone about z of so much radius per height above its apex."""
    return Face((Cone(np.diag([slope, slope, 1.0]), apex * z),), loop)


@cache
def taper_plug(slope: float, apex: float, low: float, high: float) -> Solid:
    edges = [circle(slope * (low - apex), low), circle(slope * (high - apex), high)]
    faces = [level(low, (0, 1)), taper(slope, apex, (0, 1), (1, 1)), level(high, (1, 1))]
    return Solid.from_brep(edges=edges, faces=faces, name="taper plug")


@cache
def taper_bore(slope: float, apex: float, outer: float, low: float, high: float) -> Solid:
    """A tapered bore through a cylinder."""
    radii = (slope * (low - apex), slope * (high - apex), outer, outer)
    edges = [circle(r, h) for r, h in zip(radii, (low, high, low, high), strict=True)]
    faces = [
        level(low, (0, 1), (2, 1)),
        taper(slope, apex, (0, 1), (1, 1)),
        wall(outer, (2, 1), (3, 1)),
        level(high, (1, 1), (3, 1)),
    ]
    return Solid.from_brep(edges=edges, faces=faces, name="taper bore")


@cache
def bolt() -> Solid:
    return Solid(solid_parts.bolt(1.0, 2.0, 3.0, 4.0).boundary)


def prism(outline: Iterable[tuple[float, float]], height: float) -> Solid:
    """Of a polygon in the plane z = 0, up to a height."""
    return _prism(tuple(outline), height)


@cache
def _prism(outline: tuple[tuple[float, float], ...], height: float) -> Solid:
    return Solid(solid_parts.swept(np.array(outline, dtype=float), 0.0, height, 0.0, "prism"))


BRACKET = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.4), (0.4, 0.4), (0.4, 1.5), (0.0, 1.5)]


@cache
def bracket() -> Solid:
    return prism(BRACKET, 0.7)


def sphere(radius: float) -> Face:
    return Face(sphere_atlas(radius * np.eye(3), np.zeros(3)))


@cache
def ball(radius: float) -> Solid:
    return Solid.from_brep(faces=[sphere(radius)], name="ball")


@cache
def socket(inner: float, outer: float) -> Solid:
    """A ball with a round cavity."""
    return Solid.from_brep(faces=[sphere(outer), sphere(inner)], name="socket")


@cache
def egg(a: float, b: float, c: float) -> Solid:
    """An ellipsoid of Bezier patches."""
    return Solid.from_patches(ellipsoid_patches(a, b, c), name="egg")


@cache
def ring(major: float, minor: float) -> Solid:
    half = np.pi / 2
    patches = [
        Torus(major, minor, v0=-half, v1=half),
        Torus(major, minor, v0=half, v1=3.0 * half),
    ]
    return Solid.from_patches(patches, name="ring")


def samples(solid: Solid, across: int = 40) -> np.ndarray:
    """Points (n, 3) of a solid's faces, edges and vertices, own frame."""
    boundary = solid.boundary
    found = [np.asarray(boundary.vertex_points).reshape(-1, 3)]
    for chart in face_charts(boundary):
        u0, u1, v0, v1 = chart.rectangle
        found += [
            chart.surface.jet(u, v)[0][None]
            for u in np.linspace(u0, u1, across)
            for v in np.linspace(v0, v1, across)
            if on_face(boundary.ints, boundary.reals, chart.number, u, v)
        ]
    for edge in boundary.edge_parts:
        spots = np.linspace(edge.curve.first, edge.curve.last, 100)
        found.append(np.array([edge.curve.point(t) for t in spots]))
    return np.vstack(found)
