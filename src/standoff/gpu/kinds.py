"""Which kernels answer two bodies: by the kinds of their faces, as on the processor."""

from __future__ import annotations

from standoff.bodies.body import Body
from standoff.kernels.body import layout as L
from standoff.tracking.specialised import SPHERE, Kind, main_kind

NAMES: dict[Kind | None, str] = {
    SPHERE: "sphere",
    **{(L.NURBS, degree): f"nurbs_{degree}" for degree in (2, 3, 4, 5)},
}
"""Of the kinds in ``threads.SEES``."""

THERE_ARE = "patches of spheres, or of NURBS of one degree from 2 to 5"


def kind_of(a: Body, b: Body) -> str | None:
    """The name of the kind of both bodies' faces, None where there are no kernels for them."""
    of_a, of_b = main_kind(a), main_kind(b)
    return NAMES.get(of_a) if of_a == of_b else None
