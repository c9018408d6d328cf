"""Ellipsoids as rational Bezier patches, exact.

The cube form follows Cobb's tiling of the sphere ("Tiling the sphere with rational Bezier
patches", 1988): a complex form of degree (2, 2) whose sides are arcs of great circles, mapped to
the sphere by stereographic projection, gives degree (4, 4). The octant form rotates a quarter arc
about the axis: degree (2, 2), with one side collapsed to the pole.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff.checks.numbers import magnitude
from standoff.geometry.bernstein import product
from standoff.geometry.nurbs import BezierPatch
from standoff.typing import Array


def ellipsoid_patches(a: Any, b: Any, c: Any) -> tuple[BezierPatch, ...]:
    """Six rational patches of degree (4, 4) that tile the ellipsoid, f_u x f_v outward.

    Raises ValueError: a semi-axis that is not finite or not positive.

    Parameters
    ----------
    a, b, c : float
        Semi-axes along x, y, z, length, positive.

    Returns
    -------
    tuple of BezierPatch
    """
    axes = _semi_axes(a, b, c)
    points, weights = _cube_tile()
    x, y, z = np.eye(3)
    frames = ((y, z, x), (z, x, y), (x, y, z), (z, y, -x), (x, z, -y), (y, x, -z))
    return tuple(BezierPatch((points @ np.array(frame)) * axes, weights) for frame in frames)


def ellipsoid_octants(a: Any, b: Any, c: Any) -> tuple[BezierPatch, ...]:
    """Eight rational patches of degree (2, 2), one per octant, each with v = 1 at a pole.

    f_u x f_v points outward; the poles lie on z.

    Raises ValueError: a semi-axis that is not finite or not positive.

    Parameters
    ----------
    a, b, c : float
        Semi-axes along x, y, z, length, positive.

    Returns
    -------
    tuple of BezierPatch
    """
    axes = _semi_axes(a, b, c)
    round_ = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    arc = np.array([1.0, np.sqrt(0.5), 1.0])
    patches = []
    for turn in range(4):
        cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
        plane = round_ @ np.array([[cosine, sine], [-sine, cosine]], dtype=np.float64)
        points = np.empty((3, 3, 3))
        points[:, :, :2] = plane[:, None, :] * round_[None, :, :1]
        points[:, :, 2] = round_[:, 1]
        weights = np.outer(arc, arc)
        patches.append(BezierPatch(points * axes, weights))
        # the lower octant: mirrored, and u reversed so that f_u x f_v stays outward
        patches.append(BezierPatch(points[::-1] * axes * [1.0, 1.0, -1.0], weights))
    return tuple(patches)


def _semi_axes(a: Any, b: Any, c: Any) -> Array:
    return np.array([magnitude(a, "a"), magnitude(b, "b"), magnitude(c, "c")])


def _cube_tile() -> tuple[Array, Array]:
    """Control points (5, 5, 3) and weights of the tile of the unit sphere about +z."""
    # stereographic images of the cube's corners, and the phase that makes the sides great circles
    radius = np.tan(0.5 * np.arccos(np.sqrt(1.0 / 3.0)))
    half = np.arctan(1.0 - np.sqrt(2.0) * np.tan(np.pi / 8.0) / radius)
    corner = radius * np.exp(1j * (0.25 * np.pi + 0.5 * np.pi * np.arange(4)))
    order = ((2, 2), (0, 2), (0, 0), (2, 0))
    form: NDArray[np.complex128] = np.zeros((2, 3, 3), dtype=np.complex128)
    for k in range(4):
        this, after = np.array([corner[k], 1.0]), np.array([corner[(k + 1) % 4], 1.0])
        i, j = order[k], order[(k + 1) % 4]
        middle = (i[0] + j[0]) // 2, (i[1] + j[1]) // 2
        form[:, i[0], i[1]] = this
        turn = np.exp(2j * half)
        form[:, middle[0], middle[1]] = 0.5 * (this / turn + after * turn)
    # the middle one is real, so that the centre maps to the pole; its size makes u and v more even
    form[1, 1, 1] = np.real(form[1, 0, 1])
    return _on_sphere(form)


def _on_sphere(form: NDArray[np.complex128]) -> tuple[Array, Array]:
    """The spherical patch of the stereographic image form[0] / form[1], from the pole -z."""
    ar, ai, br, bi = form[0].real, form[0].imag, form[1].real, form[1].imag
    aa = product(ar, ar) + product(ai, ai)
    bb = product(br, br) + product(bi, bi)
    x = 2.0 * (product(ar, br) + product(ai, bi))
    y = 2.0 * (product(ai, br) - product(ar, bi))
    w = aa + bb
    return np.stack([x, y, bb - aa], axis=2) / w[..., None], w
