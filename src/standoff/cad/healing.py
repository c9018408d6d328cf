"""Healing, only where it was asked for: OpenCASCADE's repairs, each counted."""

from __future__ import annotations

from typing import Any

from standoff.cad.measures import tolerance_of, volume_of
from standoff.cad.opencascade import cast, explored, is_kind
from standoff.cad.tolerances import SEWN_AT_LEAST
from standoff.wording import counted


def healed(shape: Any) -> tuple[Any, tuple[str, ...]]:
    """The shape after OpenCASCADE's repairs, and what they changed."""
    from OCP.ShapeFix import ShapeFix_Shape

    told: list[str] = []
    before = _counts(shape)
    loose = tolerance_of(shape)
    if not is_kind(shape, "solid"):
        shape, note = _sewn(shape)
        told += note
    fixer = ShapeFix_Shape(shape)
    if fixer.Perform():
        shape = fixer.Shape()
        told.append("OpenCASCADE's ShapeFix changed it")
    solids = list(explored(shape, "solid"))
    shape = solids[0] if len(solids) == 1 else shape
    if is_kind(shape, "solid") and volume_of(shape) < 0.0:
        shape = cast("solid", shape.Reversed())
        told.append("turned its faces, which were inside out")
    after = _counts(shape)
    told += [
        f"{kind}s: {before[kind]} became {after[kind]}"
        for kind in before
        if before[kind] != after[kind]
    ]
    if tolerance_of(shape) > loose:
        told.append(f"greatest tolerance: {loose:.3g} became {tolerance_of(shape):.3g}")
    return shape, tuple(told)


def _counts(shape: Any) -> dict[str, int]:
    kinds = ("face", "edge", "vertex")
    return {kind: len({hash(one) for one in explored(shape, kind)}) for kind in kinds}


def _sewn(shape: Any) -> tuple[Any, list[str]]:
    """Faces sewn within their tolerance, and made a solid if they close."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing

    sewing = BRepBuilderAPI_Sewing(max(tolerance_of(shape), SEWN_AT_LEAST))
    sewing.Add(shape)
    sewing.Perform()
    found = sewing.SewedShape()
    loose = counted(sewing.NbFreeEdges(), "edge stays", "edges stay")
    told = [f"sewn: {loose} open, {sewing.NbContigousEdges()} joined"]
    shells = list(explored(found, "shell"))
    if len(shells) != 1 or sewing.NbFreeEdges():
        return found, told
    maker = BRepBuilderAPI_MakeSolid(shells[0])
    return cast("solid", maker.Solid()), [*told, "made a solid of its shell"]
