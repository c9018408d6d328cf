"""Surfaces swept by a profile curve: about an axis, or along a direction."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from standoff.checks.numbers import LEAST, number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.geometry.bernstein import segment
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line, RationalBezier
from standoff.geometry.hulls import tight_box
from standoff.geometry.interval_vectors import by_generator, mapped, stacked
from standoff.geometry.intervals import Interval, interval
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.rotational import Rotational
from standoff.geometry.surfaces import Surface
from standoff.geometry.tolerances import ALONG_PROFILE, PROFILE_ROUNDOFF, ROUND_POLE
from standoff.geometry.torus import checked_turn, full_turn
from standoff.geometry.validation import Domain, affine_map, inside, vector3
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.formulas.compiled import Formula
    from standoff.geometry.patch_bounds import PatchBounds

# Points of a profile that are examined.
PROFILE_SAMPLES = 65


class Swept(Surface):
    """What both kinds have in common: a profile, swept in its own frame, and an affine map."""

    projection = None
    part_of = None
    proof = "swept"
    bulge = None

    profile: Curve

    @property
    def formulas(self) -> tuple[Formula, ...]:
        return self.profile.formulas

    @abstractmethod
    def _with(self, domain: Domain, linear: Array, shift: Array) -> Self:
        """The same sweep over another domain, mapped by x -> linear x + shift."""

    @abstractmethod
    def _reach(self, direction: Array) -> float:
        """A bound of direction @ x over the domain."""

    def transformed(self, linear: Array, shift: Array) -> Self:
        """The exact image under x -> linear x + shift; parameters stay the same."""
        linear, shift = affine_map(linear, shift)
        return self._with(self.domain, linear @ self.linear, linear @ self.shift + shift)

    def restricted(self, u0: float, u1: float, v0: float, v1: float) -> Self:
        """The same surface on a smaller domain; parameters stay the same."""
        return self._with(self.smaller_domain(u0, u1, v0, v1), self.linear, self.shift)

    @property
    def moved(self) -> float:
        """How far removing redundant knots of the profile may have moved the surface, length."""
        return float(np.linalg.norm(self.linear, 2)) * self.profile.moved

    def box(self) -> tuple[Array, Array]:
        """(low, high), each (3,), body frame, guaranteed to contain the surface over its domain."""
        return box_of(self._reach)

    def highest(self, direction: Array) -> None:
        """None: its `box` is used instead."""
        return


class Revolution(Swept, Rotational):
    """(r(v) cos u, r(v) sin u, z(v)): a profile (r, 0, z) rotated about the axis z.

    Raises ValueError: the profile leaves the plane y = 0, or meets the axis between its ends; more
    than a turn.

    Parameters
    ----------
    profile : Curve in the half-plane y = 0, x >= 0: x is the radius, z the height, lengths.
        It may touch the axis only at its ends: poles, where a side is collapsed.
    first, last : angles, radians; a full turn, the default, is periodic in u.

    Notes
    -----
    u is the angle, v the profile's parameter. A full turn without a pole makes a face between two
    closed rims.
    """

    kind = L.REVOLUTION
    periodic = False
    ruled = False

    def __init__(self, profile: Curve, first: Any = 0.0, last: Any = FULL_TURN) -> None:
        first, last = checked_turn(first, last, "Revolution")
        points = _profile_points(profile, "Revolution")
        size = float(np.ptp(points, axis=0).max())
        worst = int(np.abs(points[:, 1]).argmax())
        if abs(points[worst, 1]) > PROFILE_ROUNDOFF * size:
            raise StandoffError(
                f"Revolution: the profile leaves the plane y = 0 at {points[worst]}: give radii as "
                "x and heights as z.",
                "profile",
                profile,
            )
        inner = 1 + int(points[1:-1, 0].argmin())
        if min(points[0, 0], points[-1, 0]) < -PROFILE_ROUNDOFF * size or points[inner, 0] <= 0.0:
            raise StandoffError(
                f"Revolution: the profile meets or crosses the axis at {points[inner]}; only its "
                "ends may touch the axis: keep x > 0 between them.",
                "profile",
                profile,
            )
        domain = (first, last, profile.first, profile.last)
        self._set(profile, domain, np.eye(3), np.zeros(3))

    def _set(self, profile: Curve, domain: Domain, linear: Array, shift: Array) -> None:
        object.__setattr__(self, "profile", profile)
        object.__setattr__(self, "periodic", full_turn(*domain[:2]))
        super().__init__(linear, shift, domain)

    def _data(self) -> Array:
        return np.concatenate([[float(self.profile.kind)], self.profile.data])

    def _with(self, domain: Domain, linear: Array, shift: Array) -> Self:
        surface = object.__new__(type(self))
        surface._set(self.profile, domain, linear, shift)
        return surface

    def breaks(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Knots of the profile where it is not C², as v."""
        return (), curve_breaks(self.profile, *self.domain[2:])

    def pieces(self) -> tuple[Array, Array]:
        """Those of the profile, as v."""
        return np.zeros(0), inside(self.profile.spans(), *self.domain[2:])

    def meridian(self, v: Interval) -> Interval:
        return self.profile.jets_over(v)[[0, 2]]

    def meridian_heights(self, rho: Interval, z: Interval, v: Interval) -> Interval:
        none = interval(np.zeros_like(rho.lo))
        directions = by_generator([rho, none, z + none])
        return self.profile.heights_over(directions, v)

    def meridian_normals(self, v: Interval) -> list[Interval]:
        """(z', -rho') at the middle, and its change from there."""
        middle = interval(v.middle)
        away, half = v - middle, interval(v.radius)
        over, at = self.meridian(v), self.meridian(middle)
        slope = stacked([over[1, 2], -over[0, 2]])
        amid = interval(stacked([at[1, 2], -at[0, 2]]).middle)
        value = stacked([at[1, 1], -at[0, 1]]) + (slope - amid) * away
        return [value + amid * half, value - amid * half]

    def over_radius(self, v: Interval) -> Interval:
        """At a round pole, where both are 0, z'' / rho' bounds it (Cauchy's mean-value theorem)."""
        meridian = self.meridian(v)
        with np.errstate(all="ignore"):
            found = meridian[1, 1] / meridian[0, 0]
            limit = meridian[1, 2] / meridian[0, 1]
        touches = np.zeros(len(v.lo), dtype=bool)
        for end in (self.profile.first, self.profile.last):
            if self._round_pole(end):
                touches |= (v.lo <= end) & (end <= v.hi)
        return Interval(
            np.where(touches, limit.lo, found.lo), np.where(touches, limit.hi, found.hi)
        )

    def _round_pole(self, end: float) -> bool:
        """Does the profile meet the axis at a right angle there, up to roundoff?"""
        x, slope, _ = self.profile.jet(end)
        size = float(np.linalg.norm(slope)) * (self.profile.last - self.profile.first)
        square = abs(float(slope[2])) <= ROUND_POLE * abs(float(slope[0]))
        return bool(abs(float(x[0])) <= PROFILE_ROUNDOFF * size) and square

    def _reach(self, direction: Array) -> float:
        """A bound of direction @ x over the domain."""
        u0, u1, v0, v1 = self.domain
        y = self.linear.T @ direction
        ahead = float(np.arctan2(y[1], y[0]))
        inside = u0 + (ahead - u0) % FULL_TURN <= u1
        cosine = 1.0 if inside else max(np.cos(u0 - ahead), np.cos(u1 - ahead))
        along = np.array([np.hypot(y[0], y[1]) * cosine, 0.0, y[2]])
        return curve_reach(self.profile, along, v0, v1) + float(direction @ self.shift)


class Extrusion(Swept):
    """c(u) + v d: a profile moved along a direction.

    Raises ValueError: a zero direction, one along the profile, or an empty range.

    Parameters
    ----------
    profile : Curve.
    direction : (3,) array, not zero, length: the displacement at v = 1.
    first, last : range of v (dimensionless).

    Notes
    -----
    A closed conic arc makes an elliptic cylinder, periodic in u.
    """

    kind = L.EXTRUSION
    periodic = False
    ruled = True

    direction: Array

    def __init__(self, profile: Curve, direction: Any, first: Any = 0.0, last: Any = 1.0) -> None:
        direction = vector3(direction, "direction")
        first, last = number(first, "first"), number(last, "last")
        if not first < last:
            raise StandoffError(f"Extrusion from v = {first} to {last}: give first < last.")
        length = float(np.linalg.norm(direction))
        if length == 0.0:
            raise StandoffError(
                "Extrusion along the direction (0, 0, 0): give a vector that is not zero.",
                "direction",
                direction,
            )
        _profile_points(profile, "Extrusion")
        for t in np.linspace(profile.first, profile.last, PROFILE_SAMPLES):
            tangent = profile.jet(float(t))[1]
            across = float(np.linalg.norm(np.cross(tangent, direction)))
            if across <= ALONG_PROFILE * length * float(np.linalg.norm(tangent)):
                raise StandoffError(
                    f"Extrusion: the direction {direction} runs along the profile at its "
                    f"parameter {t:.6g}; there is no surface.",
                    "direction",
                    direction,
                )
        domain = (profile.first, profile.last, first, last)
        self._set(profile, direction, domain, np.eye(3), np.zeros(3))

    def _set(
        self, profile: Curve, direction: Array, domain: Domain, linear: Array, shift: Array
    ) -> None:
        object.__setattr__(self, "profile", profile)
        object.__setattr__(self, "direction", direction)
        angle = profile.kind == L.CONIC and full_turn(*domain[:2])
        object.__setattr__(self, "periodic", angle)
        super().__init__(linear, shift, domain)

    def _data(self) -> Array:
        return np.concatenate([[float(self.profile.kind)], self.direction, self.profile.data])

    def _with(self, domain: Domain, linear: Array, shift: Array) -> Self:
        surface = object.__new__(type(self))
        surface._set(self.profile, self.direction, domain, linear, shift)
        return surface

    def breaks(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Knots of the profile where it is not C², as u."""
        return curve_breaks(self.profile, *self.domain[:2]), ()

    def pieces(self) -> tuple[Array, Array]:
        """Those of the profile, as u."""
        return inside(self.profile.spans(), *self.domain[:2]), np.zeros(0)

    def jets_over(self, boxes: Boxes) -> Interval:
        u, v = boxes.sides
        jets = self.profile.jets_over(u)
        x, xu, xuu = jets[:, 0], jets[:, 1], jets[:, 2]
        along = interval(self.direction[:, None])
        none = interval(np.zeros((3, len(boxes))))
        return by_generator([x + along * v, xu, along + none, xuu, none, none])

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """Exact up to rounding if the profile's are."""
        u, v = boxes.sides
        every = interval(np.broadcast_to(directions, (*directions.shape[:2], len(boxes))))
        y = by_generator([mapped(every, interval(column[:, None])) for column in self.linear.T])
        held = self.profile.heights_over(y, u) + mapped(y, interval(self.direction[:, None])) * v
        return held + mapped(every, interval(self.shift[:, None]))

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        from standoff.geometry.jet_bounds import JetBounds

        extents = self.extents_over(boxes, np.eye(3)[..., None])
        return JetBounds(boxes, self.body_jets).bounds(extents)

    def _reach(self, direction: Array) -> float:
        """A bound of direction @ x over the domain."""
        u0, u1, v0, v1 = self.domain
        y = self.linear.T @ direction
        along = float(y @ self.direction)
        moved = max(v0 * along, v1 * along)
        return curve_reach(self.profile, y, u0, u1) + moved + float(direction @ self.shift)


def _profile_points(profile: Any, name: str) -> Array:
    if not isinstance(profile, Curve):
        raise StandoffError(
            f"{name} of {shown(profile)}: give a Curve as its profile.", "profile", profile
        )
    spots = np.linspace(profile.first, profile.last, PROFILE_SAMPLES)
    points = np.array([profile.point(float(t)) for t in spots])
    extent = float(np.ptp(points, axis=0).max())
    if extent < LEAST:
        raise StandoffError(
            f"{name}: the profile's extent is {extent:.3g}, below {LEAST:g}; choose a "
            "smaller unit.",
            "profile",
            profile,
        )
    return points


# How far curves extend: bounds for boxes around curves and around what they sweep.


def curve_reach(curve: Curve, direction: Array, first: float, last: float) -> float:
    """An upper bound of direction @ x on a curve from parameter first to last.

    It is exact for lines and conic arcs, from the subdivided control points of the piece for
    rational curves, and from the whole curve's box for formulas.

    Raises ValueError: a kind of curve without bounds.
    """
    if isinstance(curve, Line | ConicArc):
        ends = [float(direction @ curve.point(t)) for t in (first, last)]
        if isinstance(curve, ConicArc):
            a, b, _ = direction @ curve.basis()
            top = first + (float(np.arctan2(b, a)) - first) % (2.0 * np.pi)
            if top <= last:
                ends.append(float(direction @ curve.point(top)))
        return max(ends)
    if isinstance(curve, RationalBezier | NurbsCurve):
        return max(
            float(tight_box((part @ _reading(direction)).T[None, ..., None])[1][0])
            for part in rational_parts(curve, first, last)
        )
    box = curve.box()
    if box is not None:
        return float(np.where(direction > 0.0, box[1], box[0]) @ direction)
    raise StandoffError(
        f"{type(curve).__name__} has no bounds: it cannot be a profile.", "profile", curve
    )


def _reading(direction: Array) -> Array:
    """The matrix (4, 2) from homogeneous points to homogeneous heights along a direction."""
    matrix = np.zeros((4, 2))
    matrix[:3, 0], matrix[3, 1] = direction, 1.0
    return matrix


def rational_parts(curve: RationalBezier | NurbsCurve, first: float, last: float) -> list[Array]:
    """Homogeneous Bezier points (p + 1, 4) of the pieces of a rational curve from first to last."""
    if isinstance(curve, RationalBezier):
        breaks, blocks = np.array([0.0, 1.0]), curve.data[1:].reshape(1, -1, 4)
    else:
        breaks, blocks = curve.essential.breaks, curve.blocks
    found = []
    for a, b, block in zip(breaks[:-1], breaks[1:], blocks, strict=True):
        low, high = max(float(a), first), min(float(b), last)
        if low <= high:
            part: Array = segment(len(block) - 1, (low - a) / (b - a), (high - a) / (b - a)) @ block
            found.append(part)
    return found


def curve_breaks(curve: Curve, first: float, last: float) -> tuple[float, ...]:
    """Parameters inside a range where a curve is not C²."""
    if not isinstance(curve, NurbsCurve):
        return ()
    return tuple(t for t in curve.breaks() if first < t < last)


def box_of(reach: Callable[[Array], float]) -> tuple[Array, Array]:
    """(low, high), each (3,), from a bound of direction @ x for any direction."""
    axes = np.eye(3)
    return np.array([-reach(-axis) for axis in axes]), np.array([reach(axis) for axis in axes])
