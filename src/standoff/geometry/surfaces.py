"""Surfaces: a canonical form y followed by an affine map x = A y + shift.

Every kind has a jet function in ``standoff.kernels.body.jets`` and a validated, immutable class in
this package. Lengths are in the body's frame.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.tolerances import DEPENDENT_COLUMNS
from standoff.geometry.validation import (
    UNBOUNDED,
    Domain,
    affine_map,
    checked_domain,
    matrix3,
    vector3,
)
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import surface_jet, surface_jets
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.formulas.compiled import Formula
    from standoff.geometry.intervals import Interval
    from standoff.geometry.patch_bounds import PatchBounds


@dataclass(frozen=True, eq=False)
class Surface(KeepsReadOnly, ABC):
    """A parametric surface, x(u, v) = linear @ canonical(u, v) + shift.

    Everything about a kind of surface is in its class: in the attributes below, which every class
    sets, and in its methods. Other modules do not test for the class itself.

    Raises ValueError: a wrong shape, a number that is not finite, a singular map, an empty domain.

    Parameters
    ----------
    linear : (3, 3) array_like, regular
        Lengths of the body's frame.
    shift : (3,) array_like
        Length.
    domain : (u0, u1, v0, v1)
        Ranges of the parameters; a *patch* is a surface whose domain is finite.
    """

    linear: Array
    shift: Array
    domain: Domain = UNBOUNDED
    kind: ClassVar[int]
    """Its number in ``standoff.kernels.body.layout``, which also says whether it is `noisy`."""
    periodic: ClassVar[bool]
    """Is u a periodic angle? For some kinds it depends on the domain, and is set per surface."""
    angles: ClassVar[tuple[bool, bool]] = (False, False)
    """Are u and v angles, after a turn of which the surface repeats?"""
    projection: ClassVar[Literal["parallel", "central", "axial"] | None]
    """How lines and conic arcs of the surface are projected to (u, v): "parallel" if u and v are
    two of the canonical coordinates, "central" from the origin, "axial" about the axis z, if u is
    the angle and v the height; None if they have no exact trimming curve."""
    part_of: ClassVar[Literal["ellipsoid", "superellipsoid"] | None]
    """The closed surface about `shift` of which it is a gnomonic chart; several make an atlas."""
    ruled: ClassVar[bool]
    """Does a straight line in the surface run through every point?"""
    proof: ClassVar[Literal["theorem", "bernstein", "interval", "swept"]]
    """How a patch is proven convex (``standoff.bodies.proofs``)."""
    bulge: ClassVar[int | None]
    """By theorem: 0 flat, +1 convex and bulging along x_u × x_v of the canonical form, -1 against
    it; None if a patch must be proven convex."""
    reals: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "domain", checked_domain(self.domain, type(self).__name__))
        linear = matrix3(self.linear, f"{type(self).__name__}.linear")
        shift = vector3(self.shift, f"{type(self).__name__}.shift")
        # by columns, which may differ in scale: a cylinder's are its radii and a length
        lengths = np.abs(linear).max(axis=0)
        if lengths.min() == 0.0 or abs(np.linalg.det(linear / lengths)) < DEPENDENT_COLUMNS:
            raise StandoffError(
                f"{type(self).__name__}.linear is singular:\n{linear}\n"
                "Give three independent columns.",
                "linear",
                linear,
            )
        object.__setattr__(self, "linear", linear)
        object.__setattr__(self, "shift", shift)
        data = self._data()
        reals = np.zeros(L.SURFACE_DATA + len(data))
        reals[L.SURFACE_DATA :] = data
        reals[0:9] = linear.ravel()
        reals[9:12] = shift
        reals[L.INVERSE : L.INVERSE + 9] = np.linalg.inv(linear).ravel()
        reals[L.OUTWARD] = 1.0
        reals[L.LIMIT] = np.inf
        reals[L.INNER : L.INNER + 4] = L.NO_INNER
        reals.flags.writeable = False
        object.__setattr__(self, "reals", reals)

    def _data(self) -> Array:
        """What the kind's kernel reads after the affine map."""
        return np.zeros(0)

    def __setstate__(self, stored: Any) -> None:
        super().__setstate__(stored)
        # a profile's formula is compiled again in another process, at another address
        reals = self.reals.copy()
        reals[L.SURFACE_DATA :] = self._data()
        reals.flags.writeable = False
        object.__setattr__(self, "reals", reals)

    @property
    def data(self) -> Array:
        """What the kind's kernel reads after the affine map (see ``kernels.body.layout``)."""
        return self.reals[L.SURFACE_DATA :]

    def jet(self, u: float, v: float) -> tuple[Array, ...]:
        """(x, x_u, x_v, x_uu, x_uv, x_vv), each (3,), body frame."""
        return tuple(np.array(c) for c in surface_jet(self.reals, self.kind, 0, u, v))

    def jets(self, parameters: Array) -> Array:
        """(n, 6, 3) rows (x, x_u, x_v, x_uu, x_uv, x_vv) at (n, 2) parameters, body frame."""
        found = np.empty((len(parameters), 18))
        surface_jets(self.reals, self.kind, 0, np.ascontiguousarray(parameters), found)
        return found.reshape(-1, 6, 3)

    def points(self, parameters: Array) -> Array:
        """(n, 3) points at (n, 2) parameters, body frame."""
        return self.jets(parameters)[:, 0]

    def transformed(self, linear: Array, shift: Array) -> Self:
        """The exact image under x -> linear x + shift; parameters stay the same."""
        linear, shift = affine_map(linear, shift)
        return replace(self, linear=linear @ self.linear, shift=linear @ self.shift + shift)

    def restricted(self, u0: float, u1: float, v0: float, v1: float) -> Self:
        """The same surface on a smaller domain; parameters stay the same.

        Raises ValueError: the domain is empty or leaves the present one.
        """
        return replace(self, domain=self.smaller_domain(u0, u1, v0, v1))

    def smaller_domain(self, u0: float, u1: float, v0: float, v1: float) -> Domain:
        """The four numbers as a domain; ValueError if it is empty or leaves the present one."""
        smaller = checked_domain((u0, u1, v0, v1), type(self).__name__)
        a, b, c, d = self.domain
        if not (a <= smaller[0] and smaller[1] <= b and c <= smaller[2] and smaller[3] <= d):
            raise StandoffError(f"The domain {smaller} leaves the surface's own, {self.domain}.")
        return smaller

    @property
    def flat(self) -> bool:
        """Is it a plane, by its kind?"""
        return self.bulge == 0

    @property
    def noisy(self) -> bool:
        """May roundoff turn its normal near a collapsed side?"""
        return bool(L.noisy(self.kind))

    @property
    def formulas(self) -> tuple[Formula, ...]:
        """The compiled formulas whose addresses are in `reals`."""
        return ()

    def breaks(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Parameters (us, vs) inside the domain where the surface is not C²."""
        return (), ()

    def pieces(self) -> tuple[Array, Array]:
        """Parameters (us, vs) inside the domain at which one analytic piece ends and another, which
        may be flat or straight, begins."""
        return np.zeros(0), np.zeros(0)

    def analytic_breaks(self) -> tuple[Array, Array]:
        """Parameters (us, vs) between which the surface is analytic."""
        return self.pieces()

    def within_hemisphere(self) -> bool | None:
        """Do all normals make less than 90 degrees with one axis? None if no theorem says so."""
        return None

    def least_curvature(self) -> float | None:
        """The least normal curvature, 1/length, of any convex patch of the surface; None if no
        theorem gives it."""
        return 0.0 if self.ruled else None

    def farthest(self) -> float | None:
        """A bound on the distance from the body's origin to the closed surface of which this is a
        part, length; None if it is not part of one, or has no bound other than its box."""
        return None

    def box(self) -> tuple[Array, Array] | None:
        """(low, high), each (3,), body frame, guaranteed to contain the surface over its domain.

        None if `highest` is used instead.
        """
        return None

    @property
    def moved(self) -> float:
        """How far the surface may lie from the given one, length: 0 except for splines, whose
        redundant knots are removed (``knot_removal``)."""
        return 0.0

    @abstractmethod
    def highest(self, direction: Array) -> tuple[float, float] | None:
        """(u, v) where direction @ x is greatest on the whole surface; direction (3,), body frame.

        None if it has no greatest value inside: a face is then highest on its boundary. The body's
        box, and so the certificate, depends on it.
        """

    def extents(self, rectangles: Any, directions: Any) -> tuple[Array, Array]:
        """How far the surface extends along directions, over rectangles of parameters.

        Raises StandoffError: a wrong shape, a number that is not finite, u0 > u1 or v0 > v1.

        Parameters
        ----------
        rectangles : (n, 4) array_like
            Rows (u0, u1, v0, v1) within the domain; a side may have no width.
        directions : (m, 3) or (m, 3, n) array_like
            Body frame; the same for all rectangles, or one set for each.

        Returns
        -------
        low, high : (m, n) arrays
            Bounds of direction . x, in the unit of the product.
        """
        from standoff.geometry.patch_bounds import checked_rectangles, cut

        boxes = checked_rectangles(rectangles)
        shape = (-1, 3) if np.ndim(directions) == 2 else (-1, 3, len(boxes))
        given = finite(directions, "directions", shape)
        each = given if given.ndim == 3 else given[..., None]
        parts, owners = cut(boxes, self.analytic_breaks())
        every = np.broadcast_to(each, (*each.shape[:2], len(boxes)))[..., owners]
        found = self.extents_over(parts, every)
        low, high = (np.full((len(each), len(boxes)), x) for x in (np.inf, -np.inf))
        for row in range(len(each)):
            np.minimum.at(low[row], owners, found.lo[row])
            np.maximum.at(high[row], owners, found.hi[row])
        return low, high

    def bounds(self, rectangles: Any) -> PatchBounds:
        """Boxes, cones of normals and curvatures over rectangles of parameters.

        They are guaranteed, and become sharper as rectangles shrink: boxes with the square of the
        width, cones and curvatures with the width. Next to a crease they are those of the
        rectangle's own side.

        Raises StandoffError: a wrong shape, a number that is not finite, u0 > u1 or v0 > v1.

        Parameters
        ----------
        rectangles : (n, 4) array_like
            Rows (u0, u1, v0, v1) within the domain; a side may have no width.

        Returns
        -------
        PatchBounds
        """
        from standoff.geometry.patch_bounds import checked_rectangles, cut

        boxes = checked_rectangles(rectangles)
        parts, owners = cut(boxes, self.analytic_breaks())
        found = self.bounds_over(parts)
        return found if len(parts) == len(boxes) else found.merged(owners, len(boxes))

    def normal_cones(self, rectangles: Any) -> tuple[Array, Array]:
        """The cones of `bounds` alone, for less than half of its time.

        Raises StandoffError: a wrong shape, a number that is not finite, u0 > u1 or v0 > v1.

        Parameters
        ----------
        rectangles : (n, 4) array_like
            Rows (u0, u1, v0, v1) within the domain; a side may have no width.

        Returns
        -------
        axis : (n, 3) array
            Around the normals x_u × x_v, unit vectors, body frame.
        angle : (n,) array
            Half angles, radians, below pi/2; pi if no cone is known.
        """
        from standoff.geometry.patch_bounds import checked_rectangles, cut, merged_cones

        boxes = checked_rectangles(rectangles)
        parts, owners = cut(boxes, self.analytic_breaks())
        cones = self.cones_over(parts)
        return cones if len(parts) == len(boxes) else merged_cones(*cones, owners, len(boxes))

    @abstractmethod
    def jets_over(self, boxes: Boxes) -> Interval:
        """(3, 6, n) bounds of the canonical jet over boxes that no analytic break crosses."""

    def body_jets(self, boxes: Boxes) -> Interval:
        """The same in the body's frame."""
        from standoff.geometry.jet_bounds import affine_jets

        return affine_jets(self.jets_over(boxes), self.linear, self.shift)

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """(m, n) bounds of direction . x over such boxes; directions (m, 3, n)."""
        from standoff.geometry.jet_bounds import JetBounds

        return JetBounds(boxes, self.body_jets).extents(directions)

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        """`bounds` over such boxes."""
        from standoff.geometry.jet_bounds import JetBounds

        jets = JetBounds(boxes, self.body_jets)
        return jets.bounds(jets.extents(np.eye(3)[..., None]))

    def cones_over(self, boxes: Boxes) -> tuple[Array, Array]:
        """`normal_cones` over such boxes."""
        from standoff.geometry.jet_bounds import JetBounds

        return JetBounds(boxes, self.body_jets).normals()

    def canonical(self, points: Array) -> Array:
        """Points of the body frame, (..., 3), in the canonical frame."""
        return (np.asarray(points) - self.shift) @ np.linalg.inv(self.linear).T
