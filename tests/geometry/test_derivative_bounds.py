"""Bounds of derivatives over pieces, against the jets at samples and their differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patches import KINDS, affine, part

import standoff.geometry as g
from draws import draws
from standoff.solids.spatial.derivative_bounds import curve_derivatives, surface_derivatives

SEEDS = st.integers(0, 2**32 - 1)
STEP = 1e-3
"""Of a rectangle's sides, between samples whose second derivatives give the third ones."""


def lengths(surface: g.Surface, u: float, v: float, du: float, dv: float) -> np.ndarray:
    """Of the first and second derivatives at a place, and of the third by differences."""
    jet = np.asarray(surface.jet(u, v))
    along = (np.asarray(surface.jet(u + du, v)) - np.asarray(surface.jet(u - du, v))) / (2.0 * du)
    across = (np.asarray(surface.jet(u, v + dv)) - np.asarray(surface.jet(u, v - dv))) / (2.0 * dv)
    thirds = [along[3], along[4], across[4], across[5]]
    return np.linalg.norm([*jet[1:], *thirds], axis=1)


@pytest.mark.parametrize("name", KINDS)
@settings(max_examples=draws(8))
@given(SEEDS, st.sampled_from([0.7, 0.1, 1e-2]))
def test_no_derivative_of_a_surface_is_longer(name: str, seed: int, width: float) -> None:
    rng = np.random.default_rng(seed)
    surface = KINDS[name].make(rng).transformed(*affine(rng, bool(rng.integers(2))))
    u0, u1, v0, v1 = part(KINDS[name].domain, width, rng)
    for level in np.asarray(surface.analytic_breaks()[0]).tolist():
        u0, u1 = (u0, level) if u0 < level < u1 else (u0, u1)
    for level in np.asarray(surface.analytic_breaks()[1]).tolist():
        v0, v1 = (v0, level) if v0 < level < v1 else (v0, v1)
    bounds = surface_derivatives(surface, np.array([[u0, u1, v0, v1]]))[0]
    du, dv = STEP * (u1 - u0), STEP * (v1 - v0)
    for s, t in rng.uniform(2.0 * STEP, 1.0 - 2.0 * STEP, (20, 2)):
        found = lengths(surface, u0 + s * (u1 - u0), v0 + t * (v1 - v0), du, dv)
        known = bounds[:5] > 0.0
        assert (found[:5][known] <= bounds[:5][known] * (1.0 + 1e-9) + 1e-12).all()
        if bounds[9:].any():
            continue  # a kind whose third ones are not known
        # differences are wrong by the fourth ones and by rounding
        spare = 1e-2 * found[5:].max() + 1e-9 * found[2:5].max() / min(du, dv)
        assert (found[5:] <= bounds[5:9] + spare).all()


@settings(max_examples=draws(60))
@given(SEEDS, st.integers(1, 5), st.sampled_from([1.0, 0.1, 1e-3]), st.booleans())
def test_no_derivative_of_a_spline_is_longer(
    seed: int, degree: int, width: float, rounded: bool
) -> None:
    """Also of one whose weights are one number but for roundoff; and the bounds are near."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(degree + 1, 3)) + rng.choice([0.0, 1e3]) * rng.normal(size=3)
    weights = 1.0 + 2e-16 * rng.integers(-1, 2, degree + 1) if rounded else None
    curve = g.curves.RationalBezier(points, weights)
    first = rng.uniform(0.0, 1.0 - width)
    bounds = curve_derivatives(curve, [(first, first + width)])[0]
    jets = np.array([curve.jet(t) for t in first + width * rng.uniform(size=40)])
    for k in (1, 2):
        longest = np.linalg.norm(jets[:, k], axis=1).max()
        assert longest <= bounds[k - 1] * (1.0 + 1e-12) + 1e-12
        if width < 0.01 and degree > k:
            near = 1.1 * longest + 1e-2 * np.abs(points - points.mean(axis=0)).max()
            assert bounds[k - 1] <= near
