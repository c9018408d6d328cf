"""Random bodies of swept surfaces: pucks with a torus, extruded conics and extruded lenses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families import curved_shapes, nurbs_bodies, shapes
from families.shapes import Rng, Twin, random_lengths
from oracles.exact_pairs import random_rotation
from oracles.loops import ConicArc as PlanarArc
from oracles.patches import BezierBody
from oracles.revolved import RevolvedHull
from standoff.geometry import BezierPatch, ConicArc, Extrusion, Plane, RationalBezier, Torus
from standoff_studies.oracles import Affine, Cylinder

Array = NDArray[np.float64]


def _disc(height: float, radius: float, up: int) -> tuple[so.bodies.Edge, Plane]:
    """Return a level circle and the plane of its disc, which faces up (1) or down (-1)."""
    centre = np.array([0, 0, height])
    circle = ConicArc(centre, (radius, 0, 0), (0, radius, 0))
    return so.bodies.Edge(circle), Plane.through(
        centre, np.array([1.0, 0, 0]), np.array([0, up, 0.0])
    )


def puck(rng: Rng) -> Twin:
    """A disc with a round rim: half a torus between two planes it touches smoothly."""
    major, minor = random_lengths(rng, 2, 0.3, 1.5)
    low, floor = _disc(-minor, major, -1)
    high, lid = _disc(minor, major, 1)
    torus = Torus(major, minor)
    isolines = [so.geometry.SurfaceCurve.isoline(torus, v=v).pcurve for v in torus.domain[2:]]
    faces = [
        so.bodies.Face((torus,), ((0, 1), (1, -1)), (), tuple(isolines)),
        so.bodies.Face((floor,), ((0, -1),)),
        so.bodies.Face((lid,), ((1, 1),)),
    ]
    arc = PlanarArc((major, 0), (minor, 0), (0, minor), -np.pi / 2, np.pi / 2)
    return Twin(RevolvedHull([arc]), so.Body.from_brep(edges=[low, high], faces=faces, name="puck"))


def elliptic_cylinder(rng: Rng) -> Twin:
    """An ellipse moved aslant."""
    a, b, length = random_lengths(rng, 3, 0.3, 1.5)
    direction = np.array([*rng.normal(size=2), length])
    arcs = [ConicArc(s * direction / 2, (a, 0, 0), (0, b, 0)) for s in (-1, 1)]
    wall = Extrusion(arcs[0], direction)
    isolines = [so.geometry.SurfaceCurve.isoline(wall, v=v).pcurve for v in wall.domain[2:]]
    x, y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    faces = [
        so.bodies.Face((wall,), ((0, 1), (1, -1)), (), tuple(isolines)),
        so.bodies.Face((Plane.through(-direction / 2, x, -y),), ((0, -1),)),
        so.bodies.Face((Plane.through(direction / 2, x, y),), ((1, 1),)),
    ]
    edges = [so.bodies.Edge(arc) for arc in arcs]
    matrix = np.column_stack([a * x, b * y, direction])
    body = so.Body.from_brep(edges=edges, faces=faces, name="elliptic cylinder")
    return Twin(Affine(Cylinder(1, 1), matrix), body)


def extruded_lens(rng: Rng) -> Twin:
    """A planar lens between two rational curves, extruded; its ends collapse at two corners."""
    width, length = random_lengths(rng, 2, 0.4, 1.5)
    curves = []
    for side in (1, -1):
        count = int(rng.integers(3, 6))
        x = np.linspace(-width, width, count)
        bulge = side * rng.uniform(0.2, 1.0) * (1 - (x / width) ** 2) * count / 2
        weights = np.ones(count)
        weights[1:-1] = rng.uniform(0.8, 1.2)
        curves.append((np.column_stack([x, bulge, np.zeros(count)]), weights))
    direction = np.array([*rng.normal(size=2), length])
    nets, patches = [], []
    for points, weights in curves:
        rows = np.stack([points, points + direction], axis=1)
        nets.append(nurbs_bodies.net(rows, np.stack([weights, weights], axis=1)))
        patches.append(Extrusion(RationalBezier(points, weights), direction))
    most = max(len(points) for points, _ in curves) - 1
    sides = [
        nurbs_bodies.net_of(BezierPatch(net[..., :3] / net[..., 3:], net[..., 3]).elevated(most, 1))
        for net in nets
    ]
    for end in (0, 1):
        cap = np.stack([side[:, end] for side in sides], axis=1)
        nets.append(cap)
        patches.append(BezierPatch(cap[..., :3] / cap[..., 3:], cap[..., 3]))
    return Twin(BezierBody(nets), so.Body.from_patches(patches))


MAKERS = (puck, elliptic_cylinder, extruded_lens)


def any_swept(rng: Rng) -> Twin:
    """One of the kinds above."""
    return MAKERS[rng.integers(len(MAKERS))](rng)


SMOOTH = (
    curved_shapes.egg,
    curved_shapes.spindle,
    curved_shapes.gore,
    curved_shapes.superellipsoid,
    curved_shapes.revolved_hull,
    nurbs_bodies.lens,
    nurbs_bodies.projective_egg,
    puck,
    elliptic_cylinder,
    shapes.lens,
)
"""Makers of bodies without a swept radius, which any affine map keeps exact."""


def affine_image(rng: Rng) -> Twin:
    """An affine image, mirrored in half of the cases, of a body of any kind."""
    twin = SMOOTH[rng.integers(len(SMOOTH))](rng)
    stretch = np.diag(random_lengths(rng, 3, 0.5, 2.0)) * (1 if rng.random() < 0.5 else -1)
    matrix = random_rotation(rng) @ stretch @ random_rotation(rng)
    shift = rng.normal(size=3)
    return Twin(Affine(twin.shape, matrix, shift), twin.body.transformed((matrix, shift)))
