"""Superellipsoids: smooth ones as an atlas, those with creases as eight octants."""

from __future__ import annotations

from itertools import product
from typing import Any, overload

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.arguments import by_position, positive_numbers
from standoff.bodies.topology import Edge, Face
from standoff.checks.arrays import finite
from standoff.checks.numbers import magnitude_or_zero
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.superellipsoids import (
    SuperellipsoidPole,
    SuperellipsoidSide,
    checked_exponent,
)
from standoff.geometry.surface_curves import SurfaceCurve
from standoff.kernels.body import layout as L
from standoff.typing import Array

Signs = tuple[int, int, int]


@overload
def superellipsoid(
    a: float, b: float, c: float, e1: float, e2: float, /, *, rounding: float = ...
) -> Body: ...


@overload
def superellipsoid(semi_axes: Any, exponents: Any, *, rounding: float = ...) -> Body: ...


def superellipsoid(
    *numbers: Any, semi_axes: Any = None, exponents: Any = None, rounding: float = 0.0
) -> Body:
    """A superellipsoid about the origin, with exponents e1 (along z) and e2 (about z).

    ``(|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) = 1``: an ellipsoid for e1 = e2 = 1,
    towards 0 a box (e1 and e2) or a cylinder (only e1), towards 2 an octahedron. With exponents up
    to 1 the surface is one smooth face. Above 1 its curvature is infinite on coordinate planes, and
    it is made of eight octants, whose seams are edges of two halves each.

    Raises TypeError: Semi-axes or exponents that are missing, or given twice. Raises ValueError: a
    number that is not finite, a semi-axis that is not positive, an exponent out of range, a
    rounding that is negative.

    Parameters
    ----------
    *numbers : float
        Semi-axes and exponents, one by one: ``superellipsoid(a, b, c, e1, e2)``.
    semi_axes : (3,) array_like
        Along x, y, z, length, positive.
    exponents : (2,) array_like
        e1 and e2, dimensionless, 0.1 to 1.8.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body
    """
    counts = {"semi_axes": 3, "exponents": 2}
    named = {"semi_axes": semi_axes, "exponents": exponents}
    given = by_position("superellipsoid", numbers, counts, named)
    axes = positive_numbers(given["semi_axes"], "semi_axes", 3)
    powers = finite(given["exponents"], "exponents", (2,))
    e1, e2 = (checked_exponent(e, f"exponents[{k}]") for k, e in enumerate(powers))
    return _of_charts(axes, e1, e2, magnitude_or_zero(rounding, "rounding"))


def _of_charts(axes: Array, e1: float, e2: float, rounding: float) -> Body:
    """One face of six charts; or eight octants with creases between them."""
    if max(e1, e2) <= 1.0:
        charts = [chart for sign in (1, -1) for chart in _charts(axes, (sign, sign, sign), e1, e2)]
        return Body.from_brep(faces=[Face(tuple(charts))], rounding=rounding, name="superellipsoid")
    octants: list[Signs] = [(i, j, k) for i, j, k in product((1, -1), repeat=3)]
    charts_of = {signs: _charts(axes, signs, e1, e2) for signs in octants}
    vertices = [sign * axes[k] * np.eye(3)[k] for sign in (1, -1) for k in range(3)]
    edges: list[Edge] = []
    loops: dict[Signs, list[tuple[int, int]]] = {signs: [] for signs in octants}
    for missing in range(3):
        i, j = (missing + 1) % 3, (missing + 2) % 3
        for si, sj in product((1, -1), repeat=2):
            middle = len(vertices)
            for start, end, s_start, turn in ((i, j, si, 1), (j, i, sj, -1)):
                seen = []
                for side in (1, -1):
                    signs = _signs({missing: side, i: si, j: sj})
                    loops[signs].append((len(edges), si * sj * side * turn))
                    pcurves = [_pcurve(k, start, end) for k in range(3)]
                    seen += list(zip(charts_of[signs], pcurves, strict=True))
                (surface, pcurve), *others = seen
                curve = SurfaceCurve(surface, pcurve, 0.0, 1.0, others)
                first = start + (0 if s_start > 0 else 3)
                edges.append(Edge(curve, first, middle, smooth=False, creased=True))
            vertices.append(edges[-1].curve.point(1.0))
    faces = [Face(charts_of[signs], tuple(loops[signs])) for signs in octants]
    return Body.from_brep(
        np.array(vertices), edges, faces, rounding=rounding, name="superellipsoid"
    )


def _signs(by_axis: dict[int, int]) -> Signs:
    return by_axis[0], by_axis[1], by_axis[2]


# The coordinates towards u, v and the centre of an octant's charts.
_COORDINATES = ((0, 1, 2), (1, 2, 0), (0, 2, 1))


def _charts(axes: Array, signs: Signs, e1: float, e2: float) -> tuple[SuperellipsoidPole, ...]:
    """The charts centred on the three half-axes of an octant."""
    scaled = np.diag(axes * signs)
    kinds = (SuperellipsoidPole, SuperellipsoidSide, SuperellipsoidSide)
    return tuple(
        kind(scaled[:, list(order)], np.zeros(3), e1=e1, e2=e2)
        for kind, order in zip(kinds, _COORDINATES, strict=True)
    )


def _pcurve(chart: int, start: int, end: int) -> Pcurve:
    """Half a seam, with directions e_start + t e_end up to their signs: straight in every chart.

    It begins at the tip, where t can resolve orders of magnitude.
    """
    matrix = np.zeros((3, 3))
    for row, axis in enumerate(_COORDINATES[chart]):
        if axis == start:
            matrix[row] = (0.0, 0.0, 1.0)
        elif axis == end:
            matrix[row] = (1.0, 0.0, 0.0)
    return Pcurve(L.LINE, matrix)
