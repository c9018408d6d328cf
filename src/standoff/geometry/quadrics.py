"""Planes and quadrics: a plane, an ellipsoid's gnomonic chart, a cylinder, a cone, and their affine
images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from standoff.errors import StandoffError
from standoff.geometry.rotational import Rotational
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import matrix3, vector3
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.intervals import Interval
    from standoff.geometry.patch_bounds import PatchBounds
    from standoff.geometry.series import Series

# Rotations that take e_z to the six axes: the charts of an ellipsoid's atlas.
_AXES = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
        [[0, 0, -1], [-1, 0, 0], [0, 1, 0]],
        [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
    ],
    dtype=np.float64,
)


class Plane(Surface):
    """(u, v, 0): the plane through `shift` spanned by the first two columns of `linear`.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its first two columns are the derivatives by u and v, length; the third, out of the plane,
        has no effect on the surface.
    shift : (3,) array_like
        The point of u = v = 0, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters, dimensionless; the whole surface by default.
    """

    kind = L.PLANE
    periodic = False
    projection = "parallel"
    part_of = None
    ruled = True
    proof = "theorem"
    bulge = 0

    def within_hemisphere(self) -> bool:
        """It has one normal."""
        return True

    @staticmethod
    def through(origin: Array, along_u: Array, along_v: Array) -> Plane:
        """The plane x = origin + u along_u + v along_v.

        Raises ValueError: a wrong shape, a number that is not finite, parallel directions.

        Parameters
        ----------
        origin, along_u, along_v : (3,) array_like
            Lengths; the last two not parallel.

        Returns
        -------
        Plane
        """
        along_u, along_v = vector3(along_u, "along_u"), vector3(along_v, "along_v")
        normal = np.cross(along_u, along_v)
        length = np.linalg.norm(normal)
        if length == 0.0:
            raise StandoffError(f"along_u {along_u} and along_v {along_v} are parallel: no plane.")
        # the third column has no effect on the jet; unit length keeps the inverse well scaled
        third = normal / length * np.sqrt(length)
        return Plane(np.column_stack([along_u, along_v, third]), vector3(origin, "origin"))

    def highest(self, direction: Array) -> None:
        return None

    def jets_over(self, boxes: Boxes) -> Interval:
        from standoff.geometry.jet_bounds import series_jets

        return series_jets(boxes, lambda u, v: (u, v, 0.0))


class Sphere(Surface):
    """The gnomonic chart (u, v, 1)/sqrt(1 + u² + v²): the half of an ellipsoid about `linear` e_z.

    Every plane section is a conic in (u, v).

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its columns are the ellipsoid's semi-axes, length; multiplied by any orthogonal matrix on
        its right it gives another chart of the same ellipsoid.
    shift : (3,) array_like
        The ellipsoid's centre, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters, tangents of angles from the centre of the chart; the whole chart
        by default.
    """

    kind = L.SPHERE
    periodic = False
    projection = "central"
    part_of = "ellipsoid"
    ruled = False
    proof = "theorem"
    bulge = 1

    def within_hemisphere(self) -> bool:
        """A gnomonic chart covers less than half a sphere."""
        return True

    def least_curvature(self) -> float:
        """c/a² of an ellipsoid with semi-axes a >= b >= c."""
        axes = np.linalg.svd(self.linear, compute_uv=False)
        return float(axes[2] / axes[0] ** 2)

    def farthest(self) -> float:
        return float(np.linalg.norm(self.shift) + np.linalg.norm(self.linear, ord=2))

    def highest(self, direction: Array) -> tuple[float, float] | None:
        y = self.linear.T @ direction
        return (float(y[0] / y[2]), float(y[1] / y[2])) if y[2] > 0.0 else None

    def jets_over(self, boxes: Boxes) -> Interval:
        from standoff.geometry.jet_bounds import series_jets
        from standoff.geometry.series import power

        def form(u: Series, v: Series) -> tuple[Series, Series, Series]:
            s = power(u**2 + v**2 + 1.0, -0.5)
            return u * s, v * s, s

        return series_jets(boxes, form)

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """Exact up to rounding."""
        from standoff.geometry.gnomonic import ellipsoid_extents

        return ellipsoid_extents(self, boxes, directions)

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        """Boxes are exact up to rounding, and so are the curvatures of a sphere."""
        from standoff.geometry.gnomonic import ellipsoid_bounds

        return ellipsoid_bounds(self, boxes)

    def cones_over(self, boxes: Boxes) -> tuple[Array, Array]:
        """Those of `bounds_over`, which knows more than the jets."""
        from standoff.geometry.gnomonic import ellipsoid_cones

        return ellipsoid_cones(self, boxes)


class Cylinder(Rotational):
    """(cos u, sin u, v); u needs no seam.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its first two columns are the semi-axes of the section, the third the derivative by v;
        length.
    shift : (3,) array_like
        The point of the axis at v = 0, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters: u in radians; all of the surface by default.
    """

    kind = L.CYLINDER
    periodic = True
    projection = "axial"
    part_of = None
    ruled = True
    proof = "theorem"
    bulge = 1

    def within_hemisphere(self) -> bool:
        """If it is less than half of the cylinder."""
        return bool(self.domain[1] - self.domain[0] < np.pi)

    def highest(self, direction: Array) -> None:
        return None

    def meridian(self, v: Interval) -> Interval:
        from standoff.geometry.interval_vectors import stacked
        from standoff.geometry.intervals import interval

        one, zero = interval(np.ones_like(v.lo)), interval(np.zeros_like(v.lo))
        return stacked([stacked([one, zero, zero]), stacked([v, one, zero])])

    def meridian_heights(self, rho: Interval, z: Interval, v: Interval) -> Interval:
        return rho + z * v

    def meridian_normals(self, v: Interval) -> list[Interval]:
        from standoff.geometry.interval_vectors import stacked
        from standoff.geometry.intervals import interval

        return [stacked([interval(np.ones_like(v.lo)), interval(np.zeros_like(v.lo))])]


class Cone(Rotational):
    """(v cos u, v sin u, v), v >= 0: the apex is at `shift`.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Its first two columns are the semi-axes of the section at v = 1, the third leads from the
        apex to that section's centre; length.
    shift : (3,) array_like
        The apex, length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters: u in radians; all of the surface by default.
    """

    kind = L.CONE
    periodic = True
    projection = "axial"
    part_of = None
    ruled = True
    proof = "theorem"
    bulge = 1

    def within_hemisphere(self) -> bool:
        """Its normals lean away from its axis."""
        return True

    def highest(self, direction: Array) -> None:
        return None

    def meridian(self, v: Interval) -> Interval:
        from standoff.geometry.interval_vectors import stacked
        from standoff.geometry.intervals import interval

        one, zero = interval(np.ones_like(v.lo)), interval(np.zeros_like(v.lo))
        return stacked([stacked([v, one, zero]), stacked([v, one, zero])])

    def meridian_heights(self, rho: Interval, z: Interval, v: Interval) -> Interval:
        return (rho + z) * v

    def meridian_normals(self, v: Interval) -> list[Interval]:
        from standoff.geometry.interval_vectors import stacked
        from standoff.geometry.intervals import interval

        one = interval(np.ones_like(v.lo))
        return [stacked([one, -one])]


def sphere_atlas(linear: Array, centre: Array) -> tuple[Sphere, ...]:
    """Six overlapping gnomonic charts of the ellipsoid linear @ (unit sphere) + centre.

    Raises ValueError: a wrong shape, a number that is not finite, or a singular map.

    Parameters
    ----------
    linear : (3, 3) array_like
        Its columns are semi-axes, or any three vectors that map the unit sphere to it; length.
    centre : (3,) array_like
        Length.

    Returns
    -------
    tuple of six Sphere
        The charts of one `Face`.
    """
    axes = matrix3(linear, "linear")
    return tuple(Sphere(axes @ turn, centre) for turn in _AXES)
