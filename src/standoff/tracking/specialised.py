"""Which pairs of bodies have a frame that is compiled for the kinds of their faces."""

from __future__ import annotations

from collections import Counter
from functools import lru_cache
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.calls import CAN_CALL, address_in_memory
from standoff.kernels.entries import smooth

Kind = tuple[int, int]
"""Of a face: its kind, and the degree of a NURBS along both parameters, 0 for the others."""

PLANE, SPHERE = (L.PLANE, 0), (L.SPHERE, 0)

MIXED = -1
"""In place of a degree: another along u than along v."""

COMPILED_AHEAD = {
    (SPHERE, SPHERE): smooth.sphere_sphere,
    (PLANE, SPHERE): smooth.plane_sphere,
    (SPHERE, PLANE): smooth.sphere_plane,
    ((L.NURBS, 2), (L.NURBS, 2)): smooth.nurbs_2,
    ((L.NURBS, 3), (L.NURBS, 3)): smooth.nurbs_3,
    ((L.NURBS, 4), (L.NURBS, 4)): smooth.nurbs_4,
    ((L.NURBS, 5), (L.NURBS, 5)): smooth.nurbs_5,
}
"""The frames by the kinds of A's faces and of B's."""


def checked_choice(specialise: bool | None) -> bool | None:
    """True, False or None as they are given.

    Raises TypeError: anything else.
    """
    if specialise is None or isinstance(specialise, bool):
        return specialise
    raise TypeError(
        f"specialise: {shown(specialise)} is neither True (compile a frame for this pair), False "
        "(use none) nor None (use one that is compiled ahead)."
    )


@lru_cache(maxsize=256)
def kinds_of(body: Body) -> Counter[Kind]:
    """How many charts of each kind a body has."""
    charts, n = int(body.ints[L.CHARTS]), int(body.ints[L.N_CHARTS])
    return Counter(_kind(body, charts + L.CHART_STRIDE * k) for k in range(n))


def _kind(body: Body, record: int) -> Kind:
    kind = int(body.ints[record + L.CHART_KIND])
    if kind != L.NURBS:
        return kind, 0
    data = int(body.ints[record + L.CHART_REALS]) + L.SURFACE_DATA
    p, q = int(body.reals[data]), int(body.reals[data + 1])
    return kind, p if p == q else MIXED


def main_kind(body: Body) -> Kind | None:
    """The most common kind of a body's charts, a flat one only if there is no other; None if no
    frame can be made for it."""
    kinds = Counter(kinds_of(body))
    for each in [kind for kind in kinds if kind[1] == MIXED or kind[0] == L.FORMULA]:
        del kinds[each]
    if not kinds:
        return None
    return max(kinds, key=lambda kind: (kind != PLANE, kinds[kind], kind))


def smooth_frame_of(a: Body, b: Body, specialise: bool | None) -> Any:
    """The entry of a pair's smooth frame; None if it should have none."""
    if specialise is False:
        return None
    kinds = main_kind(a), main_kind(b)
    if kinds[0] is None or kinds[1] is None:
        return None
    of_a, of_b = kinds[0], kinds[1]
    ahead = COMPILED_AHEAD.get((of_a, of_b))
    if specialise is None and max(len(kinds_of(a)), len(kinds_of(b))) > 1:
        return None
    if ahead is not None or specialise is None:
        return ahead
    return smooth.made_for(*of_a, *of_b)


def address_of(frame: Any) -> int:
    """Where a compiled frame lies in memory, ready to be called; 0 for none."""
    if frame is None or not CAN_CALL:
        return 0
    frame.prepare()
    return address_in_memory(frame)
