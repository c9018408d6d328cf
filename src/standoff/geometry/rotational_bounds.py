"""Bounds of sub-patches of surfaces of revolution followed by an affine map.

In canonical coordinates x = rho(v) e_r(u) + z(v) e_z. Heights are linear in the sinusoid
a . e_r(u), so extreme where it is; normals are the rotated normals of the meridian; products of
mapped tangents are sinusoids in u and 2 u, constant if the map keeps the surface round. So a wide
range of u does not make the bounds wide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from standoff.geometry.interval_vectors import (
    by_generator,
    cofactors,
    determinant,
    mapped,
    stacked,
    wave,
)
from standoff.geometry.intervals import Interval, cos, interval, sin, sqrt
from standoff.geometry.patch_bounds import cone_round, framed, normal_curvatures
from standoff.typing import Array

# An arc of less than this part of half a turn lies in the triangle of its chord and end tangents.
WIDEST_ARC = 0.95


def turned_normals(linear: Array, u: Interval, normals: Sequence[Interval]) -> tuple[Array, Array]:
    """(axis, angle) of cones around the normals, from vectors (2, n) that span the meridian's."""
    middle = interval(u.middle)
    half = u.radius
    # an arc lies between its chord and its end tangents, which meet over its middle
    stretch = 1.0 / cos(interval(np.where(half < WIDEST_ARC * 0.5 * np.pi, half, np.nan)))
    spots = [(cos(u_), sin(u_)) for u_ in (interval(u.lo), interval(u.hi))]
    spots.append((cos(middle) * stretch, sin(middle) * stretch))
    rows = [stacked([n[0] * c, n[0] * s, n[1]]) for n in normals for c, s in spots]
    return cone_round(mapped(cofactors(linear), by_generator(rows)))


@dataclass(frozen=True)
class Bends:
    """(n,) bounds of the quantities from which the curvatures are computed.

    slopes : (2, n), rho' and z'; speed, bend : rho'² + z'² and z' rho'' - rho' z''; over_radius :
    z' / rho.
    """

    slopes: Interval
    speed: Interval
    bend: Interval
    over_radius: Interval


def turned_curvatures(linear: Array, u: Interval, of: Bends) -> tuple[Array, Array]:
    """(least, greatest), in the tangents e_t = x_u / rho and x_v.

    With N = e_t × x_v, II = det (-z'/rho, 0, z' rho'' - rho' z'') / |C N|, where C are the map's
    cofactors.
    """
    r1, z1 = of.slopes[0], of.slopes[1]
    gram = mapped(linear.T, interval(linear))
    mean, gap = (gram[0, 0] + gram[1, 1]) * 0.5, (gram[0, 0] - gram[1, 1]) * 0.5
    double, minus = u * 2.0, gap * -1.0
    across = mean + wave(minus, gram[0, 1] * -1.0, double)  # e_t . G e_t
    along = mean + wave(gap, gram[0, 1], double)  # e_r . G e_r
    mixed = wave(gram[0, 1], minus, double)  # e_r . G e_t
    up_along = wave(gram[0, 2], gram[1, 2], u)  # e_z . G e_r
    up_across = wave(gram[1, 2], gram[0, 2] * -1.0, u)  # e_z . G e_t
    first = (
        across,
        r1 * mixed + z1 * up_across,
        of.speed * gram[2, 2] + r1**2 * (along - gram[2, 2]) + r1 * z1 * up_along * 2.0,
    )
    size = determinant(linear)
    none = interval(np.zeros_like(u.lo))
    second = (-of.over_radius * size, none, of.bend * size)
    area = sqrt(first[0] * first[2] - first[1] ** 2)
    metric, bends = framed(first, second)
    return normal_curvatures(metric, bends, area)
