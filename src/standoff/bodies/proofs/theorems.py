"""Kinds of surfaces that are convex by theorem: planes, quadrics, tori, superellipsoids."""

from __future__ import annotations

import numpy as np

from standoff.bodies.proofs.proof import PatchProof
from standoff.geometry.surfaces import Cylinder, Surface
from standoff.geometry.torus import Torus


def prove_by_kind(surface: Surface, bulge: int) -> PatchProof:
    """An affine image of a plane, quadric, torus's outer half or superellipsoid: `Surface.bulge`.

    They never bend inward: a superellipsoid with exponents up to 2 is the unit ball of a norm, and
    its charts look at it from its centre.
    """
    side = 1 if np.linalg.det(surface.linear) > 0.0 else -1
    return PatchProof(
        convex=True,
        defect=0.0,
        method="theorem",
        hemisphere=_within_half(surface),
        place=_middle(surface),
        sense=bulge * side,
    )


def _within_half(surface: Surface) -> bool:
    """A gnomonic chart shows less than half a sphere, a cone's normals lean away from its axis;
    superellipsoids are symmetric: their normals lean to the side of the middle plane they are on.
    """
    u0, u1, v0, v1 = surface.domain
    if isinstance(surface, Cylinder):
        return bool(u1 - u0 < np.pi)
    if isinstance(surface, Torus):
        return bool(v0 > 0.0 or v1 < 0.0 or (u1 - u0 < np.pi and v1 - v0 < np.pi))
    return True


def _middle(surface: Surface) -> tuple[float, float]:
    """The middle of the domain, or a finite point of it."""
    middle = []
    for low, high in (surface.domain[:2], surface.domain[2:]):
        ends = [x for x in (low, high) if np.isfinite(x)]
        middle.append(float(np.mean(ends)) if ends else 0.0)
    return middle[0], middle[1]
