"""Numbers of twice the digits, beside fractions."""

from fractions import Fraction

import numpy as np

from draws import draws
from standoff.kernels.algebra.doubled import (
    difference_of,
    doubled_cross,
    doubled_dot,
    product_of,
    step_between,
)


def exactly(x):
    return sum(Fraction(part) for part in x)


def test_a_difference_and_a_product_lose_nothing(rng):
    for a, b in rng.normal(size=(draws(200), 2)) * 10.0 ** rng.uniform(-9, 9, (draws(200), 2)):
        assert exactly(difference_of(a, b)) == Fraction(a) - Fraction(b)
        assert exactly(product_of(a, b)) == Fraction(a) * Fraction(b)


def test_the_height_of_a_point_over_a_plane_of_three(rng):
    """Points in the plane but for 1e-15: of their heights no digit but the last ones is lost."""
    for _ in range(draws(100)):
        a, b, c = rng.normal(size=(3, 3))
        s, t = rng.normal(size=2)
        x = a + s * (b - a) + t * (c - a) + 1e-15 * rng.normal(size=3)
        u, v, w = (step_between(tuple(a), tuple(y)) for y in (b, c, x))
        (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = ([exactly(k) for k in y] for y in (u, v, w))
        right = (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
        most = float(np.abs(np.array([u, v, w])).max())
        assert abs(doubled_dot(doubled_cross(u, v), w) - float(right)) <= 1e-29 * most**3
