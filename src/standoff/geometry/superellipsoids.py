"""Charts of superellipsoids: (|x|^(2/e2) + |y|^(2/e2))^(e2/e1) + |z|^(2/e1) = 1."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from standoff.checks.numbers import number
from standoff.errors import StandoffError
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.intervals import Interval
    from standoff.geometry.patch_bounds import PatchBounds

# Range of exponents that passed tests with random poses. Beyond it the round parts are edges in
# float64 (a box, an octahedron), and near 2 a few descents in a thousand end uncertified.
LEAST_EXPONENT = 0.1
GREATEST_EXPONENT = 1.8


def checked_exponent(value: object, name: str) -> float:
    """A convex superellipsoid's exponent; raises ValueError if it is out of range."""
    e = number(value, name)
    if not LEAST_EXPONENT <= e <= GREATEST_EXPONENT:
        raise StandoffError(
            f"{name} = {e}: a superellipsoid's exponents must be from {LEAST_EXPONENT} to "
            f"{GREATEST_EXPONENT}; near 0 it is a box or a cylinder, at 2 an octahedron, above 2 "
            "not convex.",
            name,
            value,
        )
    return e


@dataclass(frozen=True, eq=False)
class SuperellipsoidPole(Surface):
    """Gnomonic chart (u, v, 1) F(u, v)^(-e1/2) of a superellipsoid, about its axis.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain,
    an exponent out of range.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its columns are the semi-axes towards u, v and the chart's centre, length.
    shift : (3,) array_like
        The superellipsoid's centre, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters, dimensionless; all of the chart by default.
    e1, e2 : float
        Exponents along and about the axis, dimensionless, 0.1 to 1.8.
    """

    e1: float = 1.0
    e2: float = 1.0
    kind = L.SUPERELLIPSOID_POLE
    periodic = False
    projection = None
    part_of = "superellipsoid"
    ruled = False
    proof = "theorem"
    bulge = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "e1", checked_exponent(self.e1, "e1"))
        object.__setattr__(self, "e2", checked_exponent(self.e2, "e2"))
        super().__post_init__()

    def _data(self) -> Array:
        return np.array([2.0 / self.e1, 2.0 / self.e2])

    def within_hemisphere(self) -> bool:
        """By symmetry, if it lies on one side of a plane of symmetry, its normals do too."""
        return True

    def analytic_breaks(self) -> tuple[Array, Array]:
        """The coordinate planes."""
        return np.zeros(1), np.zeros(1)

    def jets_over(self, boxes: Boxes) -> Interval:
        from standoff.geometry.superellipsoid_bounds import superellipsoid_jets

        return superellipsoid_jets(self, boxes)

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """Between the corners' hull and a supporting plane."""
        from standoff.geometry.superellipsoid_bounds import superellipsoid_extents

        return superellipsoid_extents(self, boxes, directions)

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        """Curvatures are unknown next to the coordinate planes, where they may be infinite."""
        from standoff.geometry.superellipsoid_bounds import superellipsoid_bounds

        return superellipsoid_bounds(self, boxes)

    def cones_over(self, boxes: Boxes) -> tuple[Array, Array]:
        """Those of `bounds_over`, which knows more than the jets."""
        found = self.bounds_over(boxes)
        return found.axis, found.angle

    def highest(self, direction: Array) -> None:
        return None

    def box(self) -> tuple[Array, Array]:
        """The box of the whole superellipsoid."""
        reach = np.abs(self.linear).sum(axis=1)
        return self.shift - reach, self.shift + reach


class SuperellipsoidSide(SuperellipsoidPole):
    """The same about a point of the equator, with u along the equator and v along the axis.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain,
    an exponent out of range.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its columns are the semi-axes towards u, v and the chart's centre, length.
    shift : (3,) array_like
        The superellipsoid's centre, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters, dimensionless; all of the chart by default.
    e1, e2 : float
        Exponents along and about the axis, dimensionless, 0.1 to 1.8.
    """

    kind = L.SUPERELLIPSOID_SIDE
