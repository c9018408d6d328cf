"""Bounds of sub-patches of surfaces of revolution behind an affine map.

In canonical coordinates x = rho(v) e_r(u) + z(v) e_z. Heights are linear in the wave a . e_r(u), so
extreme at its ends; normals are those of the meridian turned; products of tangents behind the map
are waves in u and 2 u, constant where the map keeps the surface round. So nothing is lost by a wide
range of u.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from standoff.geometry.interval_vectors import (
    by_generator,
    cofactors,
    determinant,
    mapped,
    stacked,
    wave,
)
from standoff.geometry.intervals import cos, interval, sin, sqrt
from standoff.geometry.patch_bounds import cone_round, framed, normal_curvatures
from standoff.geometry.validation import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.rotational import Rotational

# An arc of less than this part of half a turn is held by the triangle of its ends and tangents.
WIDEST_ARC = 0.95


def turned_normals(surface: Rotational, boxes: Boxes) -> tuple[Array, Array]:
    """(axis, angle) of cones round the normals."""
    u, v = boxes.sides
    middle = interval(u.middle)
    half = u.radius
    # an arc lies between its chord and its end tangents, which meet over its middle
    stretch = 1.0 / cos(interval(np.where(half < WIDEST_ARC * 0.5 * np.pi, half, np.nan)))
    spots = [(cos(u_), sin(u_)) for u_ in (interval(u.lo), interval(u.hi))]
    spots.append((cos(middle) * stretch, sin(middle) * stretch))
    normals = surface.meridian_normals(v)
    rows = [stacked([n[0] * c, n[0] * s, n[1]]) for n in normals for c, s in spots]
    return cone_round(mapped(cofactors(surface.linear), by_generator(rows)))


def turned_curvatures(surface: Rotational, boxes: Boxes) -> tuple[Array, Array]:
    """(least, greatest), in the tangents e_t = x_u / rho and x_v.

    With N = e_t × x_v, II = det (-z'/rho, 0, z' rho'' - rho' z'') / |C N|, C the map's cofactors.
    """
    u, v = boxes.sides
    meridian = surface.meridian(v)
    r1, z1 = meridian[0, 1], meridian[1, 1]
    speed, bend = surface.speed_and_bend(v)
    gram = mapped(surface.linear.T, interval(surface.linear))
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
        speed * gram[2, 2] + r1**2 * (along - gram[2, 2]) + r1 * z1 * up_along * 2.0,
    )
    size = determinant(surface.linear)
    none = interval(np.zeros(len(boxes)))
    second = (-surface.over_radius(v) * size, none, bend * size)
    area = sqrt(first[0] * first[2] - first[1] ** 2)
    metric, bends = framed(first, second)
    return normal_curvatures(metric, bends, area)
