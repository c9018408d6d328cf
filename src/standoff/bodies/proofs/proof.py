"""What a convexity proof of one patch says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class PatchProof:
    """Is a patch convex over its whole domain, and by how much may it fail to be.

    Attributes
    ----------
    convex : no normal curvature bends inward, but for the rounding of the control points (of a
        pole's points: but for what they miss each other by).
    defect : length, >= 0. No point of the patch rises by more above the tangent plane of another
        for want of curvature; so the patch dents by no more below its convex hull. 0 where every
        curvature is proven not to bend inward.
    method : "theorem" (by its kind), "bernstein" (bounds of polynomials) or "interval".
    hemisphere : all normals are proven to make less than 90 degrees with one axis.
    place : (u, v) of the least curvature found, the worst place of a patch that is not convex.
    sense : +1 where f_u x f_v points to the outer, convex side, -1 where it points to the inner
        one, 0 for a flat patch, which may serve either way.
    tilt : radians, the greatest turn of a normal the wrong way. A body much greater than the
        patch may rise above the patch's tangent planes by its own size times this.
    curvature : 1/length, the least normal curvature over the patch is at least this; negative
        where the patch bends inward (or is not proven not to), -inf where no bound was found.
    """

    convex: bool
    defect: float
    method: Literal["theorem", "bernstein", "interval"]
    hemisphere: bool
    place: tuple[float, float]
    sense: int = 1
    tilt: float = 0.0
    curvature: float = 0.0
