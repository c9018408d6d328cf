"""Proofs that patches are convex, over their whole domain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from standoff.bodies.proofs import interval
from standoff.bodies.proofs.bernstein import prove
from standoff.bodies.proofs.profiles import prove_swept
from standoff.bodies.proofs.proof import PatchProof
from standoff.bodies.proofs.theorems import prove_by_kind
from standoff.errors import StandoffTypeError
from standoff.geometry.formulas import FormulaSurface
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution

__all__ = ["PatchProof", "prove_patch"]


def prove_patch(surface: Surface, outward: int | None = None) -> PatchProof:
    """Prove that a patch is convex, or bound how far it is not.

    Parameters
    ----------
    surface : the patch with its domain.
    outward : +1 where f_u x f_v is to point out of the body, -1 where into it; when left out,
        the side to which the patch bulges.

    Raises
    ------
    TypeError
        A kind of surface without a proof.
    ValueError
        A NURBS, or a profile, that may be creased inside.
    """
    if isinstance(surface, NurbsSurface):
        return prove(surface, outward)
    if isinstance(surface, FormulaSurface):
        return interval.prove(surface, outward)
    if isinstance(surface, Revolution | Extrusion):
        return prove_swept(surface, outward)
    bulge = getattr(surface, "bulge", None)  # what is not a surface has none, and is named below
    if bulge is not None:
        proof = prove_by_kind(surface, bulge)
        if outward is not None and proof.sense == -outward:
            # hollow: no bound is sought, such a face is not a part of a convex body
            return replace(
                proof, convex=False, defect=np.inf, sense=outward, tilt=np.pi, curvature=-np.inf
            )
        return proof
    raise StandoffTypeError(f"No convexity proof for a {type(surface).__name__}.")
