"""Moments of solids that owe nothing to the library: formulas, sections, tetrahedra."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.spatial
from numpy.typing import NDArray
from scipy.special import beta

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solid:
    """Volume, centre, and central second moments ∫ (x - c)(x - c)ᵀ dV."""

    volume: float
    centre: Array
    second: Array

    @property
    def inertia(self) -> Array:
        """About the centre, at density 1."""
        return np.asarray(np.trace(self.second) * np.eye(3) - self.second)


def diagonal(volume: float, squares: tuple[float, float, float], height: float = 0.0) -> Solid:
    """∫ x², ∫ y², ∫ z² about a centre on the axis z."""
    return Solid(volume, np.array([0.0, 0.0, height]), np.diag(squares))


def box(a: float, b: float, c: float) -> Solid:
    v = a * b * c
    return diagonal(v, (v * a * a / 12, v * b * b / 12, v * c * c / 12))


def ellipsoid(a: float, b: float, c: float) -> Solid:
    v = 4.0 / 3.0 * np.pi * a * b * c
    return diagonal(v, (v * a * a / 5, v * b * b / 5, v * c * c / 5))


def cylinder(r: float, h: float) -> Solid:
    v = np.pi * r * r * h
    return diagonal(v, (v * r * r / 4, v * r * r / 4, v * h * h / 12))


def cone(r: float, h: float) -> Solid:
    """Base at -h/2, apex at +h/2."""
    v = np.pi * r * r * h / 3
    return diagonal(v, (v * 3 * r * r / 20, v * 3 * r * r / 20, v * 3 * h * h / 80), -h / 4)


def superellipsoid(a: float, b: float, c: float, e1: float, e2: float) -> Solid:
    """By Beta functions (A. Jaklič, A. Leonardis, F. Solina, Segmentation and Recovery of
    Superquadrics, 2000, section 2.4)."""
    k = a * b * c * e1 * e2
    v = 2 * k * beta(e1 / 2 + 1, e1) * beta(e2 / 2, e2 / 2)
    across = k / 2 * beta(3 * e2 / 2, e2 / 2) * beta(e1 / 2, 2 * e1 + 1)
    along = 2 * k * beta(e2 / 2, e2 / 2 + 1) * beta(3 * e1 / 2, e1 + 1)
    return diagonal(v, (across * a * a, across * b * b, along * c * c))


def polytope(points: Array) -> Solid:
    """The convex hull of points, by tetrahedra."""
    hull = scipy.spatial.ConvexHull(points)
    middle = points.mean(axis=0)
    corners = points[hull.simplices] - middle
    sums = corners.sum(axis=1)
    weights = np.abs(np.linalg.det(corners))
    volume = float(weights.sum() / 6)
    first = weights @ sums / 24
    outer = np.einsum("ki,kj->kij", sums, sums) + np.einsum("kai,kaj->kij", corners, corners)
    second = np.einsum("k,kij->ij", weights, outer) / 120
    return Solid(volume, middle + first / volume, second - np.outer(first, first) / volume)


Curve = Callable[[Array], tuple[Array, Array, Array]]


def revolved(*curves: tuple[Curve, float, float]) -> Solid:
    """A meridian from below upwards, in pieces (t -> r, z, dz/dt; first, last), turned about z."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    totals = np.zeros(4)
    for curve, first, last in curves:
        t = first + 0.5 * (last - first) * (nodes + 1.0)
        r, z, dz = (np.asarray(x) * np.ones_like(t) for x in curve(t))
        w = 0.5 * (last - first) * weights * dz * np.pi * r * r
        totals += [w.sum(), (w * z).sum(), (w * z * z).sum(), (w * r * r).sum() / 4]
    volume, first_z, second_z, across = (float(x) for x in totals)
    height = first_z / volume
    return diagonal(volume, (across, across, second_z - volume * height**2), height)


def arc(radius: float, r: float, z: float) -> Curve:
    """A circle about (r, z) by its angle from the plane z."""
    return lambda t: (
        r + radius * np.cos(t),
        z + radius * np.sin(t),
        radius * np.cos(t),
    )


def straight(r0: float, z0: float, r1: float, z1: float) -> Curve:
    return lambda t: (r0 + t * (r1 - r0), z0 + t * (z1 - z0), np.full_like(t, z1 - z0))


def rounded_box(a: float, b: float, c: float, r: float) -> Solid:
    """Its sections z = const are rounded rectangles; sides a, b, c of the core."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = 0.25 * np.pi * (nodes + 1.0)
    half = np.array([a, b, c]) / 2

    def section(rho: Array) -> Array:
        """Area, ∫ x², ∫ y² of a rectangle grown by rho."""
        rows = []
        for p, q in ((half[0], half[1]), (half[1], half[0])):
            strips = 4 * q / 3 * ((p + rho) ** 3 - p**3) + 2 * rho * (2 * p) ** 3 / 12
            quarter = p * p * np.pi * rho**2 / 4 + 2 * p * rho**3 / 3 + np.pi * rho**4 / 16
            rows.append(2 * q * (2 * p) ** 3 / 12 + strips + 4 * quarter)
        p, q = half[0], half[1]
        return np.array([4 * p * q + 4 * (p + q) * rho + np.pi * rho**2, *rows])

    ends = section(r * np.cos(t))
    w = 0.25 * np.pi * weights * r * np.cos(t)
    height = half[2] + r * np.sin(t)
    full = section(np.array([r]))[:, 0]
    volume, xx, yy = full * c + 2 * ends @ w
    zz = full[0] * c**3 / 12 + 2 * ends[0] @ (w * height**2)
    return diagonal(float(volume), (float(xx), float(yy), float(zz)))


def lens(r: float, c: float) -> Solid:
    """Three balls: every section z = const is three arcs, in polar coordinates."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    top = np.sqrt(r * r - c * c)
    # z = top sin(t) takes away the root at the tips
    t = 0.5 * np.pi * nodes
    z, dz = top * np.sin(t), 0.5 * np.pi * weights * top * np.cos(t)
    angle, da = np.pi / 3 * nodes, np.pi / 3 * weights
    square = (r * r - z * z)[:, None] - (c * np.sin(angle)) ** 2
    rho = np.sqrt(square) - c * np.cos(angle)
    volume = 3 * float(dz @ (rho**2 / 2) @ da)
    polar = 3 * float(dz @ (rho**4 / 4) @ da)  # ∫ x² + y², evenly shared by three turns
    return diagonal(volume, (polar / 2, polar / 2, 3 * float((dz * z * z) @ (rho**2 / 2) @ da)))


def grown_spheroid(a: float, c: float, r: float) -> Solid:
    """The spheroid of semi-axes a, a, c with a ball of radius r swept over it."""

    def meridian(t: Array) -> tuple[Array, Array, Array]:
        length = np.sqrt((c * np.cos(t)) ** 2 + (a * np.sin(t)) ** 2)
        x = a * np.cos(t) + r * c * np.cos(t) / length
        z = c * np.sin(t) + r * a * np.sin(t) / length
        rate = (a * a - c * c) * np.sin(t) * np.cos(t) / length
        dz = c * np.cos(t) + r * a * (np.cos(t) / length - np.sin(t) * rate / length**2)
        return x, z, dz

    return revolved((meridian, -np.pi / 2, 0.0), (meridian, 0.0, np.pi / 2))


def moved(solid: Solid, linear: Array, shift: Array) -> Solid:
    """The image under x -> linear x + shift."""
    scale = abs(float(np.linalg.det(linear)))
    return Solid(
        solid.volume * scale,
        linear @ solid.centre + shift,
        scale * linear @ solid.second @ linear.T,
    )
