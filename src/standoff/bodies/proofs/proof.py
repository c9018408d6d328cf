"""The result of a convexity proof of one patch, and the proof by theorem: of planes, quadrics, tori
and superellipsoids."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from standoff.geometry.surfaces import Surface


@dataclass(frozen=True)
class PatchProof:
    """Is a patch convex over its whole domain, and by how much may it fail to be?

    Attributes
    ----------
    convex : no normal curvature bends inward, up to the rounding of the control points (for the
        points of a pole: up to their distance from each other).
    defect : length, >= 0. No point of the patch rises by more above the tangent plane at another
        because of inward curvature; so the patch dents by no more below its convex hull. 0 if no
        curvature bends inward, as proven.
    method : "theorem" (by its kind), "bernstein" (bounds of polynomials) or "interval".
    hemisphere : all normals are proven to make less than 90 degrees with one axis.
    place : (u, v) of the least curvature found, the worst place of a patch that is not convex.
    sense : +1 if f_u x f_v points to the outer, convex side, -1 if it points to the inner one, 0
        for a flat patch, which can be used either way.
    tilt : radians, the greatest angle by which normals turn back. A body much larger than the patch
        may rise above the patch's tangent planes by its own size times this.
    curvature : 1/length, a lower bound of the normal curvature over the patch; negative if the
        patch bends inward (or is not proven not to), -inf if no bound was found.
    """

    convex: bool
    defect: float
    method: Literal["theorem", "bernstein", "interval"]
    hemisphere: bool
    place: tuple[float, float]
    sense: int = 1
    tilt: float = 0.0
    curvature: float = 0.0


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
