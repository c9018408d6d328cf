"""Addresses of compiled formulas in packed bodies: of this process only.

The kernels reach a formula by its address, which stands in the packed body. A body that goes to
another process, and a digest that is the same in every one, must tell these numbers from the
others. Addresses are integers above 2^32, so no length is taken for one in practice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from standoff.bodies.topology import Edge, Face
from standoff.geometry.curves import Curve
from standoff.geometry.formulas import FormulaCurve, FormulaSurface
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution
from standoff.geometry.validation import Array


def formulas_of(edges: Iterable[Edge], faces: Iterable[Face]) -> list[Any]:
    """The formulas of a body's parts, in the order of the parts."""
    found = [f for edge in edges for f in _in_curve(edge.curve)]
    return found + [f for face in faces for chart in face.charts for f in _in_surface(chart)]


def _in_curve(curve: Curve) -> Iterator[Any]:
    if isinstance(curve, FormulaCurve):
        yield curve.formula
    elif isinstance(curve, SurfaceCurve):
        yield from _in_surface(curve.surface)


def _in_surface(surface: Surface) -> Iterator[Any]:
    if isinstance(surface, FormulaSurface):
        yield surface.formula
    elif isinstance(surface, Revolution | Extrusion):
        yield from _in_curve(surface.profile)


def readdressed(reals: Array, old: Sequence[float], new: Sequence[float]) -> Array:
    """A read-only copy of a packed body's numbers with other addresses."""
    changed = reals.copy()
    for before, after in dict(zip(old, new, strict=True)).items():
        changed[reals == before] = after
    changed.flags.writeable = False
    return changed
