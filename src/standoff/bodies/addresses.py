"""Addresses of compiled formulas in packed bodies, which are valid in this process only.

The kernels call a formula by its address, which is stored in the packed body. Sending a body to
another process, or computing a digest that is the same in every process, needs to find these
numbers among the others. Addresses are integers above 2^32, so in practice no length is mistaken
for one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from standoff.bodies.made_parts import MadeParts
from standoff.bodies.topology import Edge, Face
from standoff.geometry.validation import Array

if TYPE_CHECKING:
    from standoff.geometry.formulas.compiled import Formula


def formulas_of(edges: Iterable[Edge], faces: Iterable[Face]) -> list[Formula]:
    """The formulas of a body's parts, in the order of the parts."""
    if isinstance(edges, MadeParts) and isinstance(faces, MadeParts):
        return []  # planes and lines, which are not made for this
    found = [f for edge in edges for f in edge.curve.formulas]
    return found + [f for face in faces for chart in face.charts for f in chart.formulas]


def readdressed(reals: Array, old: Sequence[float], new: Sequence[float]) -> Array:
    """A read-only copy of a packed body's numbers with other addresses."""
    changed = reals.copy()
    for before, after in dict(zip(old, new, strict=True)).items():
        changed[reals == before] = after
    changed.flags.writeable = False
    return changed
