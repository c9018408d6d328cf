"""Random convex bodies of patches given by formulas, each with an oracle's shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.shapes import Rng, Twin, random_lengths
from oracles.exact_pairs import random_rotation
from oracles.formulas import FormulaShape, sum_of_ellipsoids
from standoff.geometry import FormulaSurface
from standoff_studies.oracles import Egg, Superellipsoid

Array = NDArray[np.float64]

CUBE = tuple(
    tuple(np.roll([f"{sign}1", "u", "v"], axis)) for axis in range(3) for sign in ("", "-")
)
"""The six sides of the cube as formulas in u and v, each in [-1, 1]."""


def _number(x: float) -> str:
    return f"({float(x)!r})"


def _linear(row: Array, vector: tuple[str, ...]) -> str:
    return " + ".join(f"{_number(x)}*({v})" for x, v in zip(row, vector, strict=True))


def sum_of_two_ellipsoids(rng: Rng) -> Twin:
    """Points by their normals n on a cube: ``sum A_i A_i^T n / |A_i^T n|``. No quadric."""
    maps = [
        random_rotation(rng) @ np.diag(random_lengths(rng, 3, 0.4, 1.2)) @ random_rotation(rng)
        for _ in range(2)
    ]
    patches = []
    for n in CUBE:
        rows = ["0", "0", "0"]
        for a in maps:
            square = a @ a.T
            lengths = [_linear(square[k], n) for k in range(3)]
            norm = f"sqrt({' + '.join(f'({x})*({v})' for x, v in zip(lengths, n, strict=True))})"
            rows = [f"{row} + ({x})/{norm}" for row, x in zip(rows, lengths, strict=True)]
        patches.append(FormulaSurface(*rows, (-1, 1, -1, 1)))
    return Twin(sum_of_ellipsoids(maps), so.Body.from_patches(patches))


def power_ball(rng: Rng) -> Twin:
    """``|x/a|^4 + |y/b|^4 + |z/c|^4 = 1``: its curvature vanishes in six points and on curves."""
    axes = random_lengths(rng, 3, 0.4, 2.0)
    patches = [
        FormulaSurface(
            *(
                f"{_number(a)}*({n})*(1 + u**4 + v**4)**(-1/4)"
                for a, n in zip(axes, side, strict=True)
            ),
            (-1, 1, -1, 1),
        )
        for side in CUBE
    ]
    return Twin(Superellipsoid(*axes, 0.5, 0.5), so.Body.from_patches(patches))


def egg(rng: Rng) -> Twin:
    """Longitude and polar angle, in three sectors that collapse to smooth poles."""
    radius, length = random_lengths(rng, 2, 0.4, 2.0)
    k = float(rng.uniform(-0.6, 0.6))
    r = f"w*sin(v)/(1 + {_number(k)}*cos(v))"
    width = {"w": radius * float(np.sqrt(1 - k * k)), "h": length / 2}
    patches = [
        FormulaSurface(
            f"{r}*cos(u)", f"{r}*sin(u)", "h*cos(v)",
            (2 * np.pi * j / 3, 2 * np.pi * (j + 1) / 3, 0, np.pi),
            width,
        )
        for j in range(3)
    ]  # fmt: skip
    return Twin(Egg(radius, length, k), so.Body.from_patches(patches))


def paraboloid(rng: Rng) -> Twin:
    """``0 <= z <= h (1 - r²/R²)``: a smooth dome, a sharp rim, a flat floor."""
    radius, height = random_lengths(rng, 2, 0.4, 2.0)
    sides = {"R": radius, "h": height}
    sectors = [(2 * np.pi * j / 3, 2 * np.pi * (j + 1) / 3, 0, 1) for j in range(3)]
    patches = [
        FormulaSurface("R*v*cos(u)", "R*v*sin(u)", z, sector, sides)
        for sector in sectors
        for z in ("h*(1 - v**2)", "0")
    ]

    def support(normals: Array) -> Array:
        across = np.sqrt((normals[:, :2] ** 2).sum(axis=1))
        up = np.maximum(normals[:, 2], 0)
        steep = across * radius >= 2 * height * up
        v = np.where(steep, 1, across * radius / np.where(up > 0, 2 * height * up, 1))
        safe = np.where(across > 0, across, 1)
        found = normals * (radius * v / safe)[:, None]
        found[:, 2] = height * (1 - v * v)
        return found

    shape = FormulaShape(support, float(np.hypot(radius, height)))
    return Twin(shape, so.Body.from_patches(patches))


MAKERS = (power_ball, egg, paraboloid)


def any_formula(rng: Rng) -> Twin:
    """One of the kinds above."""
    return MAKERS[rng.integers(len(MAKERS))](rng)
