"""NURBS jets against OpenCASCADE's, an independent implementation (the extra `peers`)."""

import numpy as np
import pytest
import splines
from OCP.collections import Array1_double, Array1_int, Array2_double, Array2_gp_Pnt
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt, gp_Vec

# Relative to the size of the control points and, for derivatives, of the span.
ORACLE = 1e-12
# OpenCASCADE's own rounding grows with the degree, to 1.5e-12 at 9 (SciPy and Standoff agree to
# 3e-15 there), and in spans much shorter than their neighbours.
ORACLE_HIGH = 1e-11
LENGTHS = (0.5, 1.0, 2.0)


def filled(array, values):
    """An OpenCASCADE array, which counts from 1, with a NumPy array's values."""
    for index, value in np.ndenumerate(values):
        array.SetValue(*(i + 1 for i in index), value)
    return array


def open_cascade(surface):
    n, m = surface.weights.shape
    points = Array2_gp_Pnt(1, n, 1, m)
    for i in range(n):
        for j in range(m):
            points.SetValue(i + 1, j + 1, gp_Pnt(*map(float, surface.control_points[i, j])))
    knots = []
    for vector in (surface.knots_u, surface.knots_v):
        values, counts = np.unique(vector, return_counts=True)
        k = len(values)
        knots.append((filled(Array1_double(1, k), values), filled(Array1_int(1, k), counts)))
    (knots_u, counts_u), (knots_v, counts_v) = knots
    weights = filled(Array2_double(1, n, 1, m), surface.weights)
    return Geom_BSplineSurface(
        points, weights, knots_u, knots_v, counts_u, counts_v, *surface.degrees
    )


def jet(surface, u, v):
    point, first_u, first_v = gp_Pnt(), gp_Vec(), gp_Vec()
    uu, vv, uv = gp_Vec(), gp_Vec(), gp_Vec()
    surface.D2(u, v, point, first_u, first_v, uu, vv, uv)
    return [np.array([a.X(), a.Y(), a.Z()]) for a in (point, first_u, first_v, uu, uv, vv)]


@pytest.mark.parametrize("p", range(1, 10))
def test_surface_jets_are_open_cascades(p, rng):
    for q in rng.choice(np.arange(1, 10), 3):
        surface = splines.random_surface(rng, p, int(q), lengths=LENGTHS)
        other = open_cascade(surface)
        u0, u1, v0, v1 = surface.domain
        for u, v in zip(rng.uniform(u0, u1, 8), rng.uniform(v0, v1, 8), strict=True):
            scales = splines.scales(surface, u, v)
            pairs = zip(surface.jet(u, v), jet(other, float(u), float(v)), scales, strict=True)
            for found, want, scale in pairs:
                limit = (ORACLE if max(p, q) < 8 else ORACLE_HIGH) * max(
                    scale, float(np.abs(want).max())
                )
                assert np.abs(found - want).max() <= limit
