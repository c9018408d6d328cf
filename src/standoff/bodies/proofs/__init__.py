"""Proofs that patches are convex, over their whole domain."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from standoff.bodies.proofs.proof import PatchProof, prove_by_kind
from standoff.errors import StandoffTypeError
from standoff.geometry.surfaces import Surface

__all__ = ["PROOFS", "PatchProof", "prove_patch"]


def _by_bernstein(surface: Any, outward: int | None) -> PatchProof:
    from standoff.bodies.proofs import bernstein

    return bernstein.prove(surface, outward)


def _by_interval(surface: Any, outward: int | None) -> PatchProof:
    from standoff.bodies.proofs import interval

    return interval.prove(surface, outward)


def _swept(surface: Any, outward: int | None) -> PatchProof:
    from standoff.bodies.proofs.profiles import prove_swept

    return prove_swept(surface, outward)


PROOFS: dict[str, Callable[[Any, int | None], PatchProof]] = {
    "theorem": prove_by_kind,
    "bernstein": _by_bernstein,
    "interval": _by_interval,
    "swept": _swept,
}
"""By the kind of proof that a surface's class declares; each loads its modules at its first use."""


def prove_patch(surface: Surface, outward: int | None = None) -> PatchProof:
    """Prove that a patch is convex, or bound by how much it is not.

    Raises TypeError: not a surface, or a profile of a kind without a proof. Raises ValueError: a
    NURBS, or a profile, that may be creased inside.

    Parameters
    ----------
    surface : the patch with its domain.
    outward : +1 if f_u x f_v points out of the body, -1 if into it; if not given, the side to which
        the patch bulges.
    """
    given: Any = surface
    if not isinstance(given, Surface):
        raise StandoffTypeError(f"No convexity proof for a {type(surface).__name__}.")
    return PROOFS[surface.proof](surface, outward)
