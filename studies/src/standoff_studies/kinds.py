"""Kinds of bodies, each twice: as the library's body, and as the support function to check it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from standoff.bodies import Body, shapes
from standoff.geometry import ConicArc, FormulaSurface, ellipsoid_patches
from standoff_studies import oracles


class Twin(NamedTuple):
    """Functions that make a kind's body and its support function from the same arguments."""

    body: Callable[..., Body]
    support: Callable[..., oracles.Shape]


def nurbs_ellipsoid(a: float, b: float, c: float) -> Body:
    """Six rational patches of degree (4, 4)."""
    return Body.from_patches(ellipsoid_patches(a, b, c))


def stretched(body: Callable[[], Body]) -> Callable[..., Body]:
    """Return a function that stretches a body, made only once, along x, y and z."""
    once = lru_cache(maxsize=1)(body)
    return lambda *axes: once().transformed(np.diag(axes))


def _power_ball() -> Body:
    """|x|^4 + |y|^4 + |z|^4 <= 1, from six patches given by formulas."""
    cube = [np.roll([f"{sign}1", "u", "v"], k) for k in range(3) for sign in ("", "-")]
    patches = []
    for side in cube:
        x, y, z = (f"({n})*(1 + u**4 + v**4)**(-1/4)" for n in side)
        patches.append(FormulaSurface(x, y, z, (-1, 1, -1, 1)))
    return Body.from_patches(patches)


def _dome() -> Body:
    """A paraboloid on a disc, from six patches given by formulas."""
    sectors = [(2 * np.pi * j / 3, 2 * np.pi * (j + 1) / 3, 0, 1) for j in range(3)]
    return Body.from_patches(
        [
            FormulaSurface("v*cos(u)", "v*sin(u)", z, sector)
            for sector in sectors
            for z in ("1 - v**2", "0")
        ]
    )


_round_dome = stretched(_dome)


def torus_hull(ring: float, width: float, height: float) -> Body:
    """The hull of a revolved ellipse."""
    profile = ConicArc([ring, 0.0, 0.0], [width, 0.0, 0.0], [0.0, 0.0, height])
    return shapes.hull_of_revolution(profile)


TWINS: Mapping[str, Twin] = {
    "point": Twin(shapes.point, oracles.Point),
    "segment": Twin(shapes.segment, oracles.Segment),
    "sphere": Twin(shapes.sphere, oracles.Sphere),
    "capsule": Twin(shapes.capsule, oracles.Capsule),
    "ellipsoid": Twin(shapes.ellipsoid, oracles.Ellipsoid),
    "NURBS ellipsoid": Twin(nurbs_ellipsoid, oracles.Ellipsoid),
    "sewn ellipsoid": Twin(stretched(lambda: nurbs_ellipsoid(1, 1, 1)), oracles.Ellipsoid),
    "superellipsoid": Twin(shapes.superellipsoid, oracles.Superellipsoid),
    "creased superellipsoid": Twin(shapes.superellipsoid, oracles.Superellipsoid),
    "egg": Twin(shapes.egg, oracles.Egg),
    "cylinder": Twin(shapes.cylinder, oracles.Cylinder),
    "cone": Twin(shapes.cone, oracles.Cone),
    "cap": Twin(shapes.cap, oracles.Cap),
    "lens": Twin(shapes.lens, oracles.Lens),
    "spindle": Twin(shapes.spindle, oracles.Spindle),
    "gore": Twin(shapes.gore, oracles.Gore),
    "torus hull": Twin(torus_hull, oracles.RingHull),
    "box": Twin(shapes.box, oracles.SharpBox),
    "rounded box": Twin(shapes.box, oracles.Box),
    "polytope": Twin(shapes.polytope, oracles.Polytope),
    "rounded polytope": Twin(shapes.rounded_polytope, oracles.RoundedPolytope),
    "halfspace": Twin(shapes.halfspace, oracles.HalfSpace),
    "formula power ball": Twin(
        stretched(_power_ball),
        lambda a, b, c: oracles.Superellipsoid(a, b, c, 0.5, 0.5),
    ),
    "formula dome": Twin(
        lambda radius, height: _round_dome(radius, radius, height),
        oracles.Dome,
    ),
}
