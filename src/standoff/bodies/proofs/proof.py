"""The result of a convexity proof of one patch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


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
