"""Convex shapes as sets of quadratic inequalities ``g(x) = x.Qx/2 + q.x + c <= 0``.

Every face of these shapes lies on one quadric, so activity (``g = 0`` at a point) names the
faces that meet there, and the nearest points of two shapes solve the Kuhn-Tucker conditions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from standoff_studies.oracles import (
    Affine,
    Cap,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    Lens,
    Placed,
    Point,
    Polytope,
    Segment,
    Shape,
    SharpBox,
    Sphere,
    Swept,
)

Array = NDArray[Any]


@dataclass(frozen=True)
class Quadrics:
    """The inequalities of a shape, in some frame.

    ``names`` (m), ``hessians`` (m, 3, 3), ``slopes`` (m, 3), ``constants`` (m); ``equality``
    (m,) marks the ones that hold with ``g = 0`` (shapes without volume).
    """

    names: tuple[str, ...]
    hessians: Array
    slopes: Array
    constants: Array
    equality: Array

    def values(self, point: Array) -> Array:
        """Return g (m,) at one point."""
        return 0.5 * (self.hessians @ point) @ point + self.slopes @ point + self.constants

    def gradients(self, point: Array) -> Array:
        """Return the gradients (m, 3) at one point."""
        return self.hessians @ point + self.slopes

    def distances(self, point: Array) -> Array:
        """Return first-order signed distances (m,) of one point to the surfaces."""
        length = np.linalg.norm(self.gradients(point), axis=1)
        return self.values(point) / np.where(length > 0, length, 1.0)

    def mapped(self, matrix: Array, shift: Array) -> Quadrics:
        """Return the inequalities of the image ``x -> matrix x + shift``."""
        inverse = np.linalg.inv(matrix)
        back = -inverse @ shift
        hessians = inverse.T @ self.hessians @ inverse
        slopes = self.gradients(back) @ inverse
        return Quadrics(self.names, hessians, slopes, self.values(back), self.equality)


def _planes(names: list[str], normals: Array, offsets: Array, equality: int = 0) -> Quadrics:
    """Return the planes ``n.x <= offset``; the first ``equality`` of them hold exactly."""
    rows = np.asarray(normals, dtype=float)
    fixed = np.arange(len(rows)) < equality
    constants = -np.asarray(offsets, dtype=float)
    return Quadrics(tuple(names), np.zeros((len(rows), 3, 3)), rows, constants, fixed)


def _join(first: Quadrics, second: Quadrics) -> Quadrics:
    return Quadrics(
        first.names + second.names,
        np.concatenate([first.hessians, second.hessians]),
        np.concatenate([first.slopes, second.slopes]),
        np.concatenate([first.constants, second.constants]),
        np.concatenate([first.equality, second.equality]),
    )


def _round(name: str, centre: Array, axes: Array) -> Quadrics:
    """Return the quadric ``sum ((x - centre)/axes)^2 <= 1`` (an infinite axis is a cylinder)."""
    scale = axes[np.isfinite(axes)].min()
    hessian = np.diag(scale / axes**2)
    constant = 0.5 * (centre @ hessian @ centre - scale)
    return Quadrics(
        (name,),
        hessian[None],
        -(hessian @ centre)[None],
        np.array([constant]),
        np.zeros(1, dtype=bool),
    )


@singledispatch
def quadrics(shape: Shape) -> Quadrics:
    """Return the inequalities of a shape in its body frame; TypeError where there are none.

    Swept shapes give those of their core.
    """
    raise TypeError(f"{type(shape).__name__} is not a set of quadratic inequalities")


@quadrics.register
def _(shape: Point) -> Quadrics:
    del shape
    return _planes(["x", "y", "z"], np.eye(3), np.zeros(3), equality=3)


@quadrics.register
def _(shape: Segment) -> Quadrics:
    normals = np.array([[1, 0, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
    half = shape.length / 2
    return _planes(["x", "y", "z-", "z+"], normals, np.array([0, 0, half, half]), equality=2)


@quadrics.register
def _(shape: SharpBox) -> Quadrics:
    names = [axis + sign for sign in "-+" for axis in "xyz"]
    normals = np.vstack([-np.eye(3), np.eye(3)])
    return _planes(names, normals, np.concatenate([shape.half, shape.half]))


@quadrics.register
def _(shape: Polytope) -> Quadrics:
    names = [f"plane{i}" for i in range(len(shape.facets.normals))]
    return _planes(names, shape.facets.normals, shape.facets.offsets)


@quadrics.register
def _(shape: HalfSpace) -> Quadrics:
    del shape
    return _planes(["plane"], np.array([[0.0, 0.0, 1.0]]), np.zeros(1))


@quadrics.register
def _(shape: Ellipsoid) -> Quadrics:
    return _round("surface", np.zeros(3), shape.axes)


@quadrics.register
def _(shape: Sphere) -> Quadrics:
    return _planes(["x", "y", "z"], np.eye(3), np.zeros(3), equality=3)


@quadrics.register
def _(shape: Swept) -> Quadrics:
    return quadrics(shape.core)


@quadrics.register
def _(shape: Cylinder) -> Quadrics:
    ends = np.array([[0, 0, -1], [0, 0, 1]])
    half = shape.length / 2
    side = _round("side", np.zeros(3), np.array([shape.radius, shape.radius, np.inf]))
    return _join(side, _planes(["bottom", "top"], ends, np.array([half, half])))


@quadrics.register
def _(shape: Cap) -> Quadrics:
    ball = _round("sphere", np.zeros(3), np.full(3, shape.radius))
    return _join(ball, _planes(["plane"], np.array([[0, 0, -1]]), np.array([-shape.offset])))


@quadrics.register
def _(shape: Lens) -> Quadrics:
    axes = np.full(3, shape.radius)
    result = _round("ball0", shape.centres[0], axes)
    for index, centre in enumerate(shape.centres[1:], start=1):
        result = _join(result, _round(f"ball{index}", centre, axes))
    return result


@quadrics.register
def _(shape: Affine) -> Quadrics:
    if sweep_of(shape.shape) > 0:
        raise TypeError("the affine image of a swept shape is not a swept shape")
    return quadrics(shape.shape).mapped(shape.matrix, shape.shift)


def sweep_of(shape: Shape) -> float:
    """Return the radius of the ball swept over the core (0 for an unswept shape)."""
    return shape.sweep


def placed_quadrics(body: Placed, origin: Array) -> Quadrics:
    """Return the inequalities of a placed shape in world axes, measured from ``origin``."""
    return quadrics(body.shape).mapped(body.rotation, body.position - origin)
