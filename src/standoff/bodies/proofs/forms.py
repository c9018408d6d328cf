"""The polynomials behind the convexity of a rational Bezier patch.

With homogeneous points H = (X, w) = w (f, 1) and T = H ^ H_u ^ H_v (whose first three components
are w^3 f_u x f_v), the fundamental forms are quotients of polynomials:
    I = J^T J / w^4,         J = w X_* - w_* X  (two columns, by u and by v)
    II = P / (w |T|),        P = T . (H_uu, H_uv, H_vv),  a 2x2 matrix polynomial,
and a patch is convex where P is semidefinite. On a collapsed side f_u (or f_v) vanishes, and with
it T and P; the known powers of the distance to that side are divided out of all three. This is the
congruence a_u = a'/(1 - v) of the parameter directions and does not change any sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.proofs.tolerances import COLLAPSED_SIDE, SMOOTH_POLE
from standoff.geometry import bernstein
from standoff.typing import Array

# Products are computed in the widest floating-point type of the platform, so that cancellation
# amplifies only the rounding of the control points themselves.
Wide = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Forms:
    """Bernstein coefficients on the unit square, of a patch scaled to size one.

    Attributes
    ----------
    second : (3, ., .) P's entries uu, uv, vv.
    normal : (3, ., .) T / the powers divided out, along f_u x f_v.
    jacobian : (2, 3, ., .) the columns of J.
    weight : (., .) w.
    noise : (2,) by how much rounding of the control points may change P: noise[0] |normal| +
        noise[1].
    poles : collapsed sides (0 u = 0, 1 u = 1, 2 v = 0, 3 v = 1): there f_u (f_v for the first
        two) is the column of J times the distance from that side.
    sharp : those that end in a sharp apex: II = second / (w |normal| distance).
    """

    second: Array
    normal: Array
    jacobian: Array
    weight: Array
    noise: tuple[float, float]
    poles: tuple[int, ...]
    sharp: tuple[int, ...]


def forms_of(points: Array, reach: float) -> Forms:
    """The forms of a Bezier patch, (4, p + 1, q + 1) homogeneous points, of size about one.

    Poles must be single points (`with_poles`). The control points were rounded at the distance
    `reach` from the origin, in units of the size.
    """
    h = points.astype(np.longdouble)
    jacobian, normal, second = _rational(h) if np.ptp(points[3]) > 0.0 else _polynomial(h)
    noise = _noise(points, reach)
    poles, sharp = [], []
    for side in range(4):
        if _width(points, side) <= COLLAPSED_SIDE:
            poles.append(side)
            jacobian, normal, second, smooth = _freed(jacobian, normal, second, side, noise)
            if not smooth:
                sharp.append(side)
    p, q = (max(c.shape[-2] for c in second), max(c.shape[-1] for c in second))
    return Forms(
        np.stack([_raised(c, p, q) for c in second]).astype(np.float64),
        normal.astype(np.float64),
        _stacked(jacobian),
        points[3],
        noise,
        tuple(poles),
        tuple(sharp),
    )


def _stacked(jacobian: list[Wide]) -> Array:
    p = max(c.shape[-2] for c in jacobian)
    q = max(c.shape[-1] for c in jacobian)
    return np.stack([_raised(c, p, q) for c in jacobian]).astype(np.float64)


def _raised(c: Wide, rows: int, columns: int) -> Wide:
    raised: Wide = bernstein.elevate(c, rows - 1, columns - 1)
    return raised


def _polynomial(h: Wide) -> tuple[list[Wide], Wide, list[Wide]]:
    """J, T and P if all weights are equal: of lower degrees than the rational ones."""
    x = h[:3]
    w = h[3, 0, 0]
    xu, xv = bernstein.along_u(x), bernstein.along_v(x)
    normal = _cross(bernstein.scaled(xu), bernstein.scaled(xv)) * w
    second = [_dot(normal, s) for s in _seconds(x)]
    return [xu * w, xv * w], bernstein.unscaled(normal), second


def _rational(h: Wide) -> tuple[list[Wide], Wide, list[Wide]]:
    hu, hv = bernstein.along_u(h), bernstein.along_v(h)
    s, su, sv = (bernstein.scaled(c) for c in (h, hu, hv))
    x, xu, xv = s[:3], su[:3], sv[:3]
    w, wu, wv = s[3:], su[3:], sv[3:]
    columns = [
        bernstein.convolve(xu, w) - bernstein.convolve(x, wu),
        bernstein.convolve(xv, w) - bernstein.convolve(x, wv),
    ]
    cross = _cross(xu, xv)
    normal = (
        bernstein.convolve(cross, w)
        + bernstein.convolve(_cross(x, xu), wv)
        - bernstein.convolve(_cross(x, xv), wu)
    )
    last = -bernstein.convolve(cross, x).sum(axis=0, keepdims=True)
    trivector = np.concatenate([normal, last])
    second = [_dot(trivector, c) for c in _seconds(h)]
    return (
        [bernstein.unscaled(c) for c in columns],
        bernstein.unscaled(normal),
        second,
    )


def _seconds(h: Wide) -> list[Wide | None]:
    """H_uu, H_uv, H_vv; None for one for which the degree is too low."""
    hu, hv = bernstein.along_u(h), bernstein.along_v(h)
    return [
        bernstein.along_u(hu) if hu.shape[-2] > 1 else None,
        bernstein.along_v(hu),
        bernstein.along_v(hv) if hv.shape[-1] > 1 else None,
    ]


def _cross(a: Wide, b: Wide) -> Wide:
    """Cross product of two scaled vector polynomials."""
    y, z = [1, 2, 0], [2, 0, 1]
    crossed: Wide = bernstein.convolve(a[y], b[z]) - bernstein.convolve(a[z], b[y])
    return crossed


def _dot(a: Wide, b: Wide | None) -> Wide:
    """Plain dot product of a scaled and a plain vector polynomial; zero for None."""
    if b is None:
        return np.zeros((1, 1), dtype=a.dtype)
    dotted: Wide = bernstein.unscaled(bernstein.convolve(a, bernstein.scaled(b)).sum(axis=0))
    return dotted


def _noise(points: Array, reach: float) -> tuple[float, float]:
    """The effect on P of half a unit of roundoff in every control point, as in Forms.noise."""
    eps = 0.5 * float(np.finfo(np.float64).eps) * max(reach, 1.0)
    p, q = points.shape[1] - 1, points.shape[2] - 1
    hu, hv = bernstein.along_u(points), bernstein.along_v(points)
    size = float(np.abs(points).max())
    greatest = [0.0 if c is None else float(np.abs(c).max()) for c in _seconds(points)]
    # second differences of four rounded points; products of six terms
    bend = 4.0 * eps * size * max(p * (p - 1), p * q, q * (q - 1))
    turn = 6.0 * eps * size**2 * 2.0 * (p * float(np.abs(hv).max()) + q * float(np.abs(hu).max()))
    return bend, turn * max(greatest)


def with_poles(points: Array) -> tuple[Array, float]:
    """The points with every collapsed side made a single point, and how far they moved, length."""
    points, moved = points.copy(), 0.0
    for side in range(4):
        width = _width(points, side)
        if 0.0 < width <= COLLAPSED_SIDE:
            row = _edge(points, side)
            pole = (row[:3] / row[3]).mean(axis=1)
            row[:3] = pole[:, None] * row[3]
            moved = max(moved, width)
    return points, moved


def _width(points: Array, side: int) -> float:
    """Extent of a side's control points."""
    row = _edge(points, side)
    return float(np.linalg.norm(np.ptp(row[:3] / row[3], axis=1)))


def _freed(
    jacobian: list[Wide],
    normal: Wide,
    second: list[Wide],
    side: int,
    noise: tuple[float, float],
) -> tuple[list[Wide], Wide, list[Wide], bool]:
    """J, T and P without the powers of the distance to a collapsed side, and whether it is
    smooth."""
    across = 0 if side >= 2 else 1  # the column of J that vanishes there
    jacobian = list(jacobian)
    jacobian[across] = _divided(jacobian[across], side, 1)
    uu, uv, vv = second
    # for the congruence: P's entry of the vanishing direction twice, its mixed entry once
    first, mixed, other = (uu, uv, vv) if across == 0 else (vv, uv, uu)
    first, mixed = _divided(first, side, 2), _divided(mixed, side, 1)
    normal = _divided(normal, side, 1)
    limit = SMOOTH_POLE * (noise[0] * float(np.abs(_edge(normal, side)).max()) + noise[1])
    smooth = float(np.abs(_edge(first, side)).max()) <= limit
    if smooth:
        # and one more power from all entries, for that of T
        first, mixed, other = (_divided(c, side, 1) for c in (first, mixed, other))
    order = (first, mixed, other) if across == 0 else (other, mixed, first)
    return jacobian, normal, list(order), smooth


def _edge(c: Wide, side: int) -> Wide:
    edge: Wide = (c[..., 0, :], c[..., -1, :], c[..., :, 0], c[..., :, -1])[side]
    return edge


def _divided(c: Wide, side: int, times: int) -> Wide:
    """c divided by a power of the distance to a side, where it vanishes to that order."""
    for _ in range(times):
        axis = -2 if side < 2 else -1
        n = c.shape[axis] - 1
        if n == 0:
            return c
        # c_i of degree n against q_i of degree n - 1: (1 - t) q has (n - i)/n q_i, t q has i/n q
        factors = n / np.arange(n, 0, -1)
        shape = (-1, 1) if axis == -2 else (-1,)
        if side % 2 == 0:
            kept = c[..., 1:, :] if axis == -2 else c[..., 1:]
            c = kept * factors[::-1].reshape(shape)
        else:
            kept = c[..., :-1, :] if axis == -2 else c[..., :-1]
            c = kept * factors.reshape(shape)
    return c
