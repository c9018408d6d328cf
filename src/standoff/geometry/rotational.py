"""Surfaces of revolution of a meridian, followed by an affine map."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from standoff.geometry.surfaces import Surface
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.intervals import Interval
    from standoff.geometry.patch_bounds import PatchBounds


class Rotational(Surface):
    """A surface whose canonical form is a meridian rotated about the axis z."""

    angles = (True, False)

    @abstractmethod
    def meridian(self, v: Interval) -> Interval:
        """(2, 3, n) bounds of rho and z, and of their first and second derivatives by v."""

    @abstractmethod
    def meridian_heights(self, rho: Interval, z: Interval, v: Interval) -> Interval:
        """(m, n) bounds of rho rho(v) + z z(v)."""

    @abstractmethod
    def meridian_normals(self, v: Interval) -> Sequence[Interval]:
        """(2, n) each: vectors in (e_r, e_z) whose positive combinations include (z', -rho')."""

    def over_radius(self, v: Interval) -> Interval:
        """(n,) bounds of z' / rho, unknown at an apex."""
        meridian = self.meridian(v)
        return meridian[1, 1] / meridian[0, 0]

    def speed_and_bend(self, v: Interval) -> tuple[Interval, Interval]:
        """(n,) bounds of rho'² + z'² and of z' rho'' - rho' z''."""
        (_, r1, r2), (_, z1, z2) = ([self.meridian(v)[k, n] for n in range(3)] for k in (0, 1))
        return r1**2 + z1**2, z1 * r2 - r1 * z2

    def jets_over(self, boxes: Boxes) -> Interval:
        from standoff.geometry.interval_vectors import stacked
        from standoff.geometry.intervals import cos, interval, sin

        u, v = boxes.sides
        (r, r1, r2), (z, z1, z2) = ([self.meridian(v)[k, n] for n in range(3)] for k in (0, 1))
        c, s, none = cos(u), sin(u), interval(np.zeros(len(boxes)))
        rows = (
            (r * c, r * s, z),
            (-(r * s), r * c, none),
            (r1 * c, r1 * s, z1),
            (-(r * c), -(r * s), none),
            (-(r1 * s), r1 * c, none),
            (r2 * c, r2 * s, z2),
        )
        return stacked([stacked([row[k] for row in rows]) for k in range(3)])

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """Exact up to rounding if the meridian's heights are."""
        from standoff.geometry.interval_vectors import mapped, wave
        from standoff.geometry.intervals import Interval, interval

        u, v = boxes.sides
        with np.errstate(all="ignore"):
            a, b, c = (mapped(directions, interval(col[:, None])) for col in self.linear.T)
            reach = wave(a, b, u)
            first, last = (self.meridian_heights(interval(w), c, v) for w in (reach.lo, reach.hi))
            held = Interval(np.minimum(first.lo, last.lo), np.maximum(first.hi, last.hi))
            return held + mapped(directions, interval(self.shift[:, None]))

    def cones_over(self, boxes: Boxes) -> tuple[Array, Array]:
        """Cones of normals."""
        from standoff.geometry.rotational_bounds import turned_normals

        u, v = boxes.sides
        with np.errstate(all="ignore"):
            return turned_normals(self.linear, u, self.meridian_normals(v))

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        """Boxes, cones of normals and curvatures."""
        from standoff.geometry.jet_bounds import widened
        from standoff.geometry.patch_bounds import PatchBounds
        from standoff.geometry.rotational_bounds import Bends, turned_curvatures

        u, v = boxes.sides
        extents = self.extents_over(boxes, np.eye(3)[..., None])
        with np.errstate(all="ignore"):
            bends = Bends(self.meridian(v)[:, 1], *self.speed_and_bend(v), self.over_radius(v))
            least, greatest = turned_curvatures(self.linear, u, bends)
        reach = np.linalg.norm(self.shift)
        return PatchBounds(*widened(extents, reach), *self.cones_over(boxes), least, greatest)
