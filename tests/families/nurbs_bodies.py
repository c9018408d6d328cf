"""Random convex bodies of rational patches, each with an oracle's shape.

Their convexity is a theorem: images of balls, eggs and lenses, and hypographs of concave
polynomials, under projective maps, which keep convexity. Elevated degrees, knots and turned
parameters change the patches and not the body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.shapes import Rng, Twin, random_lengths
from oracles.exact_pairs import random_normal, random_rotation
from oracles.patches import BezierBody
from standoff.geometry import BezierPatch, NurbsSurface, ellipsoid_octants, ellipsoid_patches
from standoff.geometry.bernstein import elevate, product
from standoff_studies.oracles import Affine, Ellipsoid, Lens

Array = NDArray[np.float64]
Net = Array
"""Homogeneous control points (p + 1, q + 1, 4): (w x, w y, w z, w)."""

PERSPECTIVE = 0.4
"""Greatest change of the fourth coordinate over a body of radius 1."""
HIGHEST = 9
"""Greatest degree."""


def net(points: Array, weights: Array) -> Net:
    """Return homogeneous control points from points (p + 1, q + 1, 3) and weights."""
    w = np.asarray(weights, dtype=float)[..., None]
    return np.concatenate([points * w, w], axis=2)


def net_of(patch: NurbsSurface) -> Net:
    """Return the homogeneous control points of a patch without inner knots."""
    return net(patch.control_points, patch.weights)


def _components(net: Net) -> tuple[Array, ...]:
    return tuple(np.moveaxis(net, 2, 0))


def projective(rng: Rng, reach: float, *, perspective: float = PERSPECTIVE) -> Array:
    """Return a random (4, 4) map whose fourth coordinate stays positive within ``reach``."""
    matrix = np.eye(4)
    matrix[:3, :3] = random_rotation(rng) @ np.diag(random_lengths(rng, 3, 0.5, 2.0))
    matrix[3, :3] = perspective * rng.uniform(0, 1) / reach * random_normal(rng)
    return matrix


def varied(net: Net, rng: Rng) -> NurbsSurface:
    """Return the patch with a higher degree, knots, or its parameters turned or exchanged."""
    patch: NurbsSurface = BezierPatch(net[..., :3] / net[..., 3:], net[..., 3])
    degrees = [
        int(rng.integers(d, HIGHEST + 1)) if rng.random() < 0.3 else d for d in patch.degrees
    ]
    if degrees != list(patch.degrees):
        patch = patch.elevated(*degrees)
    if rng.random() < 0.3:
        knots = np.sort(rng.uniform(0.1, 0.9, int(rng.integers(1, 3))))
        patch = patch.refined(knots_u=list(knots)) if rng.random() < 0.5 else patch
        patch = patch.refined(knots_v=[float(rng.uniform(0.2, 0.8))])
    if rng.random() < 0.5:
        patch = patch.swapped()
    return patch.reversed_u() if rng.random() < 0.5 else patch


def sewn(nets: Sequence[Net], rng: Rng) -> so.Body:
    return so.Body.from_patches([varied(net, rng) for net in nets])


def ellipsoid(rng: Rng) -> Twin:
    """The projective image of an ellipsoid in six or eight patches: another ellipsoid."""
    axes = random_lengths(rng, 3, 0.3, 1.5)
    tiles = ellipsoid_octants if rng.random() < 0.3 else ellipsoid_patches
    matrix = projective(rng, max(axes))
    nets = [net_of(patch) @ matrix.T for patch in tiles(*axes)]
    dual = matrix @ np.diag([*np.square(axes), -1.0]) @ matrix.T
    dual = dual / -dual[3, 3]
    centre = -dual[:3, 3]
    spread = np.linalg.cholesky(dual[:3, :3] + np.outer(centre, centre))
    return Twin(Affine(Ellipsoid(1, 1, 1), spread, centre), sewn(nets, rng))


def egg_nets(width: float, half: float, taper: float) -> list[Net]:
    """Six patches of degree (8, 8): the partial perspective of the sphere's six."""
    nets = []
    for patch in ellipsoid_patches(1, 1, 1):
        x, y, z, w = _components(net_of(patch))
        shrunk = w + taper * z
        rows = (width * product(x, w), width * product(y, w), half * product(z, shrunk))
        nets.append(np.stack([*rows, product(w, shrunk)], axis=2))
    return nets


def projective_egg(rng: Rng) -> Twin:
    """No quadric and no body of revolution: the projective image of an egg."""
    width, half = random_lengths(rng, 2, 0.4, 1.2)
    nets = egg_nets(width, half, float(rng.uniform(-0.5, 0.5)))
    matrix = projective(rng, 1.5)
    nets = [net @ matrix.T for net in nets]
    return Twin(BezierBody(nets), sewn(nets, rng))


def lens_nets(radius: float, offset: float) -> list[Net]:
    """Three patches of degree (2, 2), each collapsed at both tips: arcs of circles between them.

    Lines through the image of one tip in the stereographic plane of the other become circles
    through both.
    """
    tip = np.sqrt((radius - offset) * (radius + offset))
    centre = np.array([-offset, 0, 0])
    pole = np.array([-offset, 0, tip]) / radius
    across = np.array([tip, 0, offset]) / radius
    other = np.array([0.0, 1.0, 0.0])
    start = offset / tip
    turn = np.pi / 3
    reach = np.sqrt(radius**2 - (offset * np.sin(turn)) ** 2) - offset * np.cos(turn)
    spot = (reach * np.array([np.cos(turn), np.sin(turn), 0]) - centre) / radius
    p, q = spot @ across / (1 + spot @ pole), spot @ other / (1 + spot @ pole)
    angle = np.arctan2(q, p - start)
    c, s = np.cos(angle), np.sin(angle)
    cos, sin, one = np.array([c, 1, c]), np.array([-s, 0, s]), np.array([1, c, 1])
    scale = tip / radius
    none = np.zeros(3)
    along = np.stack([2 * scale**2 * start * one, scale * cos, none], axis=1)
    aside = np.stack([none, scale * sin, none], axis=1)
    squares = np.stack([scale**2 * start**2 * one, scale * start * cos, one], axis=1)
    unit = np.stack([scale**2 * one, none, none], axis=1)
    weight = unit + squares
    local = along[..., None] * across + aside[..., None] * other
    local = centre * weight[..., None] + radius * (local + (unit - squares)[..., None] * pole)
    nets = []
    for k in range(3):
        t = 2 * np.pi * k / 3
        turned = np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
        nets.append(np.concatenate([local @ turned.T, weight[..., None]], axis=2))
    return nets


def lens(rng: Rng) -> Twin:
    (radius,) = random_lengths(rng, 1, 0.4, 2.0)
    offset = float(radius * rng.uniform(0.1, 0.9))
    nets = lens_nets(radius, offset)
    matrix = np.eye(4)
    matrix[:3, :3] = random_rotation(rng) @ np.diag(random_lengths(rng, 3, 0.5, 2.0))
    shape = Affine(Lens(radius, offset), matrix[:3, :3])
    return Twin(shape, sewn([net @ matrix.T for net in nets], rng))


def _power(corner_values: Array, exponent: int) -> Array:
    """Return the Bernstein coefficients of a power of an affine function on the square."""
    result = np.ones((1, 1))
    for _ in range(exponent):
        result = product(result, corner_values)
    return result


def concave_top(rng: Rng, p: int, q: int) -> Array:
    """Return the (p + 1, q + 1) coefficients of a positive concave polynomial on [-1, 1]²."""
    both = min(p, q)
    x, y = np.array([[-1.0, -1.0], [1.0, 1.0]]), np.array([[-1.0, 1.0], [-1.0, 1.0]])
    total = np.zeros((p + 1, q + 1))
    terms = [(2, rng.normal(size=2)), (both, rng.normal(size=2)), (2, rng.normal(size=2))]
    for exponent, slope in terms:
        affine = slope[0] * x + slope[1] * y
        affine = affine - affine.min() + 0.1 * rng.uniform()  # not negative: any power is convex
        total += rng.uniform(0.2, 1) * elevate(_power(affine / affine.max(), exponent), p, q)
    # powers of one coordinate, of the full degree along it
    total += rng.uniform(0.1, 0.5) * elevate(_power((x + 1.1) / 2.1, p)[:, :1], p, q)
    total += rng.uniform(0.1, 0.5) * elevate(_power((y + 1.1) / 2.1, q)[:1, :], p, q)
    height = total.max() * rng.uniform(1.1, 2.0)
    return np.asarray(height - total)


def cushion_nets(rng: Rng, p: int, q: int) -> list[Net]:
    """A concave top of degree (p, q), four plane walls of degrees (p, 1) and (q, 1), a floor."""
    top = concave_top(rng, p, q)
    x = np.broadcast_to(np.linspace(-1, 1, p + 1)[:, None], top.shape)
    y = np.broadcast_to(np.linspace(-1, 1, q + 1)[None, :], top.shape)
    lid = np.stack([x, y, top, np.ones_like(top)], axis=2)
    floor = lid * np.array([1, 1, 0, 1])
    nets = [lid, floor[::p, ::q]]
    sides = (np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1])
    return nets + [np.stack([floor[rows], lid[rows]], axis=1) for rows in sides]


def cushion(rng: Rng) -> Twin:
    """Degrees 2 to 9, rational through a projective map; twelve sharp edges."""
    p, q = (int(d) for d in rng.integers(2, HIGHEST + 1, 2))
    matrix = projective(rng, 2.5)
    nets = [net @ matrix.T for net in cushion_nets(rng, p, q)]
    return Twin(BezierBody(nets), sewn(nets, rng))


MAKERS = (ellipsoid, projective_egg, lens, cushion)


def any_nurbs(rng: Rng) -> Twin:
    """One of the kinds above."""
    return MAKERS[rng.integers(len(MAKERS))](rng)
