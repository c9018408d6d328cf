"""Which loop is inside which, and whether any meets itself or another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from standoff.errors import BodyError
from standoff.kernels.entries import planar_solids as entries
from standoff.kernels.solids import planar_crossings as C
from standoff.kernels.solids import planar_layout as P
from standoff.solids.planar.area import area_of, rough_area
from standoff.solids.planar.loops import Loop, size_of
from standoff.solids.planar.outline import PlanarOutline, packed_outline
from standoff.solids.planar.tolerances import APART_FROM_ITSELF, CLEAR_AREA

# Pairs of parts that may be looked at.
MOST_LOOKS = 10_000_000


def turned(loop: Loop, outer: bool) -> Loop:
    """The loop counterclockwise if it is an outer one, else clockwise.

    Raises BodyError: no area.
    """
    area, error = rough_area(loop), 0.0
    if abs(area) <= CLEAR_AREA * size_of(loop.curves) ** 2:
        area, error = area_of((loop,))
    if abs(area) <= error:
        check_simple(packed_outline((loop,)), (loop,))  # an eight has no area either
        place = loop.curves[0].point(loop.curves[0].first)[:2]
        raise BodyError(
            f"A loop of {len(loop.curves)} curves at {place} encloses no area: its curves run "
            "there and back; remove the doubled ones.",
            "loops",
        )
    return loop if (area > 0.0) == outer else loop.reversed()


def check_simple(outline: PlanarOutline, loops: tuple[Loop, ...]) -> None:
    """Raise BodyError with the place where a boundary meets itself."""
    touch = APART_FROM_ITSELF * outline.size
    found, x, y, leaf_p, leaf_q = entries.self_crossing(outline.arrays, touch, MOST_LOOKS)
    if found == C.NONE:
        return
    first, second = outline.leaf_int(leaf_p, P.CURVE), outline.leaf_int(leaf_q, P.CURVE)
    place = np.array([x, y])
    if found == C.MEETS:
        what = (
            f"edges {first} and {second} meet" if first != second else f"edge {first} meets itself"
        )
        raise BodyError(
            f"The boundary crosses or touches itself at {place}: {what} there (edges are numbered "
            "through all loops); a curve given twice does too.",
            "loops",
        )
    if found == C.TURNS_BACK:
        raise BodyError(
            f"The boundary turns back on itself at {place}, between edges {first} and {second}: "
            "the solid would have no thickness there.",
            "loops",
        )
    raise BodyError(
        "Whether the boundary meets itself could not be decided: parts of it are too close to "
        "each other.",
        "loops",
    )


def oriented(outer: Loop, inner: Sequence[Loop]) -> tuple[Loop, ...]:
    """An outer loop and its holes, each turned; the holes are proven to be inside by one point of
    each, once no loop meets another.

    Raises BodyError: a hole outside of the outer loop or inside another one.
    """
    loops = (turned(outer, True), *(turned(loop, False) for loop in inner))
    if not inner:
        return loops
    check_simple(packed_outline(loops), loops)
    around = packed_outline(loops[:1])
    alone = [packed_outline((turned(loop, True),)) for loop in inner]
    for k, hole in enumerate(inner):
        place = _point_of(hole)
        if not _is_in(around, hole):
            raise BodyError(f"Inner loop {k} at {place} is outside of the outer loop.", "inner")
        for j, other in enumerate(alone):
            if j != k and _is_in(other, hole):
                raise BodyError(
                    f"Inner loop {k} at {place} is inside inner loop {j}: what is in a hole is "
                    "another solid.",
                    "inner",
                )
    return loops


def nested(loops: Sequence[Loop]) -> list[tuple[Loop, ...]]:
    """The loops of each separate solid, its outer loop first, by how many others each is in.

    Raises BodyError: loops that meet.
    """
    upright = [turned(loop, True) for loop in loops]
    if len(loops) > 1:
        check_simple(packed_outline(tuple(upright)), tuple(upright))
    alone = [packed_outline((loop,)) for loop in upright]
    holders = [
        {j for j, other in enumerate(alone) if j != k and _is_in(other, loop)}
        for k, loop in enumerate(upright)
    ]
    found = []
    for k, loop in enumerate(upright):
        if len(holders[k]) % 2:
            continue
        holes = [
            upright[j].reversed()
            for j, outside in enumerate(holders)
            if k in outside and len(outside) == len(holders[k]) + 1
        ]
        found.append((loop, *holes))
    return found


def _point_of(loop: Loop) -> np.ndarray:
    curve = loop.curves[0]
    return curve.point(0.5 * (curve.first + curve.last))[:2]


def _is_in(outline: PlanarOutline, loop: Loop) -> bool:
    _, inside, _ = outline.foot(_point_of(loop)[None, :].copy(), 0.0)
    return bool(inside[0])
