"""Kinds of surfaces that are convex by theorem: planes and quadrics."""

from __future__ import annotations

import numpy as np

from standoff.bodies.proofs.proof import PatchProof
from standoff.geometry.surfaces import Cone, Cylinder, Plane, Sphere

Quadric = Plane | Sphere | Cylinder | Cone


def prove_quadric(surface: Quadric) -> PatchProof:
    """An affine image of a plane, sphere, cylinder or cone never bends inward."""
    side = 1 if np.linalg.det(surface.linear) > 0.0 else -1
    return PatchProof(
        convex=True,
        defect=0.0,
        method="theorem",
        hemisphere=_within_half(surface),
        place=_middle(surface),
        sense=0 if isinstance(surface, Plane) else side,
    )


def _within_half(surface: Quadric) -> bool:
    """A gnomonic chart shows less than half a sphere, a cone's normals lean away from its axis."""
    if isinstance(surface, Cylinder):
        u0, u1, _, _ = surface.domain
        return bool(u1 - u0 < np.pi)
    return True


def _middle(surface: Quadric) -> tuple[float, float]:
    """The middle of the domain, or a finite point of it."""
    middle = []
    for low, high in (surface.domain[:2], surface.domain[2:]):
        ends = [x for x in (low, high) if np.isfinite(x)]
        middle.append(float(np.mean(ends)) if ends else 0.0)
    return middle[0], middle[1]
