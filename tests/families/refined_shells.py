"""Exact shells of NURBS patches, and the same surfaces with knots inserted or other parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from families import nurbs_bodies
from families import patch_shells as shells
from standoff.geometry import (
    BezierPatch,
    NurbsSurface,
    ellipsoid_octants,
    ellipsoid_patches,
)

Array = NDArray[np.float64]
R = np.sqrt(0.5)
SPACINGS = (0.3, 0.038, 1e-2, 1e-3, 1e-4, 1e-5)
"""Between inserted knots, parts of the domain."""


def _bezier(net: Array) -> BezierPatch:
    return BezierPatch(net[..., :3] / net[..., 3:], net[..., 3])


def lens_prism() -> list[NurbsSurface]:
    """A lens between two rational curves, extruded: knife edges at its tips."""
    x = np.linspace(-0.9, 0.9, 4)
    nets = []
    for side in (1.0, -1.0):
        points = np.column_stack([x, side * 1.1 * (1.0 - (x / 0.9) ** 2), 0.0 * x])
        w = np.array([1.0, 0.83, 1.1, 1.0])
        rows = np.stack([points, points + np.array([0.2, -0.3, 1.2])], axis=1)
        nets.append(nurbs_bodies.net(rows, np.stack([w, w], axis=1)))
    caps = [np.stack([net[:, end] for net in nets], axis=1) for end in (0, 1)]
    return [_bezier(net) for net in (*nets, *caps)]


def quadratic_prism() -> list[NurbsSurface]:
    """A lens between two parabolas, extruded straight."""
    x = np.array([-1.0, 0.0, 1.0])
    nets = []
    for side in (1.0, -1.0):
        points = np.column_stack([x, side * np.array([0.0, 1.0, 0.0]), 0.0 * x])
        rows = np.stack([points, points + np.array([0.0, 0.0, 1.0])], axis=1)
        nets.append(nurbs_bodies.net(rows, np.ones((3, 2))))
    caps = [np.stack([net[:, end] for net in nets], axis=1) for end in (0, 1)]
    return [_bezier(net) for net in (*nets, *caps)]


def fillet_box(half: Sequence[float] = (0.5, 0.4, 0.3), r: float = 0.07) -> list[NurbsSurface]:
    """A box with rounded edges and corners: planes, quarter cylinders, octants of a sphere."""
    half = np.asarray(half)
    inner = half - r
    arc = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    weights = np.array([1.0, R, 1.0])
    patches: list[NurbsSurface] = []
    for axis, sign in product(range(3), (-1.0, 1.0)):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        points = np.empty((2, 2, 3))
        points[..., axis] = sign * half[axis]
        for i, j in product((0, 1), repeat=2):
            points[i, j, b], points[i, j, c] = (2 * i - 1) * inner[b], (2 * j - 1) * inner[c]
        patches.append(BezierPatch(points))
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        for sb, sc in product((-1.0, 1.0), repeat=2):
            points = np.empty((3, 2, 3))
            points[:, 0, axis], points[:, 1, axis] = -inner[axis], inner[axis]
            points[..., b] = sb * (inner[b] + r * arc[:, :1])
            points[..., c] = sc * (inner[c] + r * arc[:, 1:])
            patches.append(BezierPatch(points, np.stack([weights, weights], axis=1)))
    for signs in product((-1.0, 1.0), repeat=3):
        points = np.empty((3, 3, 3))
        for i, j in product(range(3), repeat=2):
            ball = np.array([arc[i, 0] * arc[j, 0], arc[i, 1] * arc[j, 0], arc[j, 1]])
            points[i, j] = np.array(signs) * (inner + r * ball)
        patches.append(BezierPatch(points, np.outer(weights, weights)))
    return patches


def spline_cushion() -> list[NurbsSurface]:
    """A C2 bicubic spline with knots of its own over a square, four walls and a floor."""
    knots = np.array([-1, -1, -1, -1, -0.4, 0.1, 0.55, 1, 1, 1, 1.0])
    # control values of x^2 and of (x + y)^2 are blossoms
    one = np.array([knots[i + 1 : i + 4].mean() for i in range(7)])
    triples = [knots[i + 1 : i + 4] for i in range(7)]
    two = np.array([(a * b + b * c + c * a) / 3.0 for a, b, c in triples])
    x, y = np.meshgrid(one, one, indexing="ij")
    z = 1.5 - 0.3 * two[:, None] - 0.2 * two[None, :] - 0.1 * x * y
    z = z - 0.1 * np.abs(one) ** 3  # no polynomial: its knots are needed
    lid = NurbsSurface(np.stack([x, y, z], axis=-1), knots, knots)
    patches = [lid, BezierPatch([[(-1, -1, 0), (-1, 1, 0)], [(1, -1, 0), (1, 1, 0)]])]
    for rim in (np.s_[0, :], np.s_[-1, :], np.s_[:, 0], np.s_[:, -1]):
        top = lid.control_points[rim]
        patches.append(NurbsSurface(np.stack([top * [1, 1, 0], top], 1), knots, [0, 0, 1, 1]))
    return patches


def one_patch_ball() -> list[NurbsSurface]:
    """An ellipsoid as one patch of a full turn with two poles, of double knots that it needs."""
    corners = np.array(
        [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    )
    profile = np.array([[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]])
    points = np.array(
        [[[0.5 * r * x, 0.8 * r * y, 0.6 * z] for r, z in profile] for x, y in corners]
    )
    one = np.array([1, R, 1, R, 1, R, 1, R, 1])
    ku = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4.0
    kv = np.array([0, 0, 0, 1, 1, 2, 2, 2]) / 2.0
    return [NurbsSurface(points, ku, kv, np.outer(one, one[:5]))]


def cone() -> list[NurbsSurface]:
    """Both patches turn once, and collapse at an end."""
    return [shells.turned(((0.0, 1.0), (0.6, -0.5))), shells.turned(((0.6, -0.5), (0.0, -0.5)))]


def cylinder() -> list[NurbsSurface]:
    rims = ((0.0, -0.5), (0.4, -0.5)), ((0.4, -0.5), (0.4, 0.5)), ((0.4, 0.5), (0.0, 0.5))
    return [shells.turned(pair) for pair in rims]


def bicubic_cushion() -> list[NurbsSurface]:
    """A bicubic lid on plane walls."""
    return [_bezier(net) for net in nurbs_bodies.cushion_nets(np.random.default_rng(5), 3, 3)]


def egg() -> list[NurbsSurface]:
    """Six patches of degree (8, 8)."""
    return [_bezier(net) for net in nurbs_bodies.egg_nets(0.7, 1.0, 0.3)]


SHELLS: dict[str, Callable[[], list[NurbsSurface]]] = {
    "lens prism": lens_prism,
    "quadratic prism": quadratic_prism,
    "fillet box": fillet_box,
    "ellipsoid": lambda: list(ellipsoid_patches(0.3, 0.2, 0.1)),
    "octants": lambda: list(ellipsoid_octants(0.3, 0.2, 0.1)),
    "egg": egg,
    "lens": lambda: [_bezier(net) for net in nurbs_bodies.lens_nets(1.0, 0.45)],
    "bicubic": bicubic_cushion,
    "spline": spline_cushion,
    "cylinder": cylinder,
    "cone": cone,
    "ball": one_patch_ball,
}


def cluster(
    domain: tuple[float, float], spacing: float, count: int, at: float = 0.41
) -> list[float]:
    """`count` knots about a place, parts of the domain, `spacing` apart."""
    first, last = domain
    shares = at + spacing * (np.arange(count) - 0.5 * (count - 1))
    return [float(first + s * (last - first)) for s in shares if 0.0 < s < 1.0]


def refined(patch: NurbsSurface, spacing: float, way: str, count: int = 2) -> NurbsSurface:
    """With knots inserted along "u", "v" or both ("uv")."""
    u0, u1, v0, v1 = patch.domain
    return patch.refined(
        cluster((u0, u1), spacing, count) if "u" in way else [],
        cluster((v0, v1), spacing, count, 0.63) if "v" in way else [],
    )
