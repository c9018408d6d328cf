"""Surfaces: a canonical form behind an affine map x = A y + shift.

Every kind is one jet function in ``standoff.kernels.jets`` and one validated, immutable class
here. Lengths in the body's frame.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from standoff.geometry.validation import Array, finite, matrix3, vector3
from standoff.kernels import layout as L
from standoff.kernels.jets import surface_jet


@dataclass(frozen=True, eq=False)
class Surface(ABC):
    """A parametric surface, x(u, v) = linear @ canonical(u, v) + shift.

    Parameters
    ----------
    linear : (3, 3) array, regular
    shift : (3,) array, length
    """

    linear: Array
    shift: Array
    kind: ClassVar[int]
    periodic: ClassVar[bool] = False  # u is an angle
    reals: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        linear = matrix3(self.linear, f"{type(self).__name__}.linear")
        shift = vector3(self.shift, f"{type(self).__name__}.shift")
        scale = np.abs(linear).max()
        if scale == 0.0 or abs(np.linalg.det(linear / scale)) < 1e-30:
            raise ValueError(
                f"{type(self).__name__}.linear is singular:\n{linear}\n"
                "Give three independent columns."
            )
        object.__setattr__(self, "linear", linear)
        object.__setattr__(self, "shift", shift)
        reals = np.zeros(L.SURFACE_DATA)
        reals[0:9] = linear.ravel()
        reals[9:12] = shift
        reals[L.INVERSE : L.INVERSE + 9] = np.linalg.inv(linear).ravel()
        reals[L.OUTWARD] = 1.0
        reals[L.LIMIT] = np.inf
        reals.flags.writeable = False
        object.__setattr__(self, "reals", reals)

    def jet(self, u: float, v: float) -> tuple[Array, ...]:
        """(x, x_u, x_v, x_uu, x_uv, x_vv), each (3,), body frame."""
        return tuple(np.array(c) for c in surface_jet(self.reals, self.kind, 0, u, v))

    def transformed(self, linear: Array, shift: Array) -> Surface:
        """The exact image under x -> linear x + shift; parameters stay the same."""
        return type(self)(linear @ self.linear, linear @ self.shift + shift)

    @abstractmethod
    def highest(self, direction: Array) -> tuple[float, float] | None:
        """(u, v) where direction @ x is greatest on the whole surface; direction (3,), body frame.

        None where it has no greatest value inside: a face is then highest on its boundary. The
        body's box, so the certificate, rests on it.
        """

    def canonical(self, points: Array) -> Array:
        """Body points, (..., 3), in the canonical frame."""
        return (np.asarray(points) - self.shift) @ np.linalg.inv(self.linear).T


class Plane(Surface):
    """(u, v, 0): the plane through `shift` spanned by the first two columns of `linear`."""

    kind = L.PLANE

    @staticmethod
    def through(origin: Array, along_u: Array, along_v: Array) -> Plane:
        """The plane x = origin + u along_u + v along_v."""
        along_u, along_v = vector3(along_u, "along_u"), vector3(along_v, "along_v")
        normal = np.cross(along_u, along_v)
        length = np.linalg.norm(normal)
        if length == 0.0:
            raise ValueError(f"along_u {along_u} and along_v {along_v} are parallel: no plane.")
        # the third column plays no part in the jet; unit size keeps the inverse well scaled
        third = normal / length * np.sqrt(length)
        return Plane(np.column_stack([along_u, along_v, third]), vector3(origin, "origin"))

    def highest(self, direction: Array) -> None:
        return None


class Sphere(Surface):
    """The gnomonic chart (u, v, 1)/sqrt(1 + u² + v²): the half of an ellipsoid about `linear` e_z.

    The columns of `linear` are the semi-axes; any orthogonal matrix on its right gives another
    chart of the same ellipsoid. Every plane section is a conic in (u, v).
    """

    kind = L.SPHERE

    def highest(self, direction: Array) -> tuple[float, float] | None:
        y = self.linear.T @ direction
        return (float(y[0] / y[2]), float(y[1] / y[2])) if y[2] > 0.0 else None


class Cylinder(Surface):
    """(cos u, sin u, v); u needs no seam."""

    kind = L.CYLINDER
    periodic = True

    def highest(self, direction: Array) -> None:
        return None


class Cone(Surface):
    """(v cos u, v sin u, v), v >= 0: the apex is at `shift`."""

    kind = L.CONE
    periodic = True

    def highest(self, direction: Array) -> None:
        return None


__all__ = ["Cone", "Cylinder", "Plane", "Sphere", "Surface", "finite"]
