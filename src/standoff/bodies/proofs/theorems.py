"""Kinds of surfaces that are convex by theorem: planes, quadrics, tori, superellipsoids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from standoff.bodies.proofs.proof import PatchProof
from standoff.geometry.surfaces import Surface


def prove_by_kind(surface: Surface, outward: int | None = None) -> PatchProof:
    """An affine image of a plane, quadric, torus's outer half or superellipsoid: `Surface.bulge`.

    A torus that extends beyond its outer half has no bulge: it is saddle-shaped there.

    The others never bend inward: a superellipsoid with exponents up to 2 is the unit ball of a
    norm, and its charts project it from its centre.
    """
    bulge, side = surface.bulge, 1 if np.linalg.det(surface.linear) > 0.0 else -1
    proof = PatchProof(
        convex=True,
        defect=0.0,
        method="theorem",
        hemisphere=bool(surface.within_hemisphere()),
        place=_middle(surface),
        sense=side if bulge is None else bulge * side,
    )
    if bulge is None or (outward is not None and proof.sense == -outward):
        # hollow or saddle-shaped: no bound needed, such a face is no part of a convex body
        sense = outward or proof.sense
        return replace(
            proof, convex=False, defect=np.inf, sense=sense, tilt=np.pi, curvature=-np.inf
        )
    return proof


def _middle(surface: Surface) -> tuple[float, float]:
    """The middle of the domain, or a finite point of it."""
    middle = []
    for low, high in (surface.domain[:2], surface.domain[2:]):
        ends = [x for x in (low, high) if np.isfinite(x)]
        middle.append(float(np.mean(ends)) if ends else 0.0)
    return middle[0], middle[1]
