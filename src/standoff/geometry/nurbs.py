"""NURBS surfaces and rational Bezier patches of degree 1 to 9.

The kernels read a NURBS as its grid of Bezier patches, computed once and exactly (to roundoff) by
knot insertion; in any span the jet is then that of one rational Bezier patch. Redundant knots do
not make spans (``knot_removal``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from standoff.checks.arrays import finite
from standoff.errors import StandoffError
from standoff.geometry.bernstein import segment
from standoff.geometry.hulls import tight_box
from standoff.geometry.knot_removal import essential_net
from standoff.geometry.knots import (
    GREATEST_DEGREE,
    KnotVector,
    bezier_spans,
    elevate_knots,
    knot_vector,
    refine,
)
from standoff.geometry.surfaces import Surface
from standoff.geometry.validation import Domain, affine_map, check_alike, inside
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.boxes import Boxes
    from standoff.geometry.intervals import Interval
    from standoff.geometry.net_bounds import CutNets
    from standoff.geometry.patch_bounds import PatchBounds


@dataclass(frozen=True, eq=False)
class NurbsSpan:
    """A Bezier patch of a NURBS: its part of the domain and its homogeneous points.

    Attributes
    ----------
    domain : (u0, u1, v0, v1)
    points : (4, p + 1, q + 1), components (w x, w y, w z, w), body frame.
    """

    domain: Domain
    points: Array


class NurbsSurface(Surface):
    """A rational B-spline surface of degrees 1 to 9 with positive weights, clamped or not.

    Raises ValueError: a NaN, a wrong shape, unsorted or too many equal knots, counts that disagree,
    a degree outside 1 .. 9, a weight that is not positive, or control points without extent.

    Parameters
    ----------
    control_points : (n, m, 3) array, length, body frame; n along u, m along v.
    knots_u, knots_v : (n + p + 1,), (m + q + 1,) arrays, ascending. The degrees p and q follow
        from the counts. The domain runs from knot p to knot n (q to m); inside it a knot may
        occur at most p (q) times.
    weights : (n, m) positive array; ones by default.

    Notes
    -----
    A redundant knot (for instance, an inserted one) does not make a span: `essential_u` and
    `essential_v` are the knot vectors without these.
    """

    kind = L.NURBS
    periodic = False
    projection = None
    part_of = None
    ruled = False
    proof = "bernstein"
    bulge = None

    control_points: Array
    weights: Array
    vector_u: KnotVector
    vector_v: KnotVector
    essential_u: KnotVector
    essential_v: KnotVector
    blocks: Array
    _moved: float

    def __init__(
        self, control_points: Any, knots_u: Any, knots_v: Any, weights: Any = None
    ) -> None:
        points = finite(control_points, "control_points", (-1, -1, 3))
        n, m = points.shape[:2]
        vector_u = knot_vector(knots_u, n, "knots_u", "rows of control points")
        vector_v = knot_vector(knots_v, m, "knots_v", "columns of control points")
        w = checked_weights(weights, points)
        self._set(points, w, vector_u, vector_v, (*vector_u.domain, *vector_v.domain))

    def _set(
        self, points: Array, w: Array, vector_u: KnotVector, vector_v: KnotVector, domain: Domain
    ) -> None:
        h = np.concatenate([points * w[..., None], w[..., None]], axis=2)
        essential_u, essential_v, net, moved = essential_net(vector_u, vector_v, h)
        values = {
            "control_points": points,
            "weights": w,
            "vector_u": vector_u,
            "vector_v": vector_v,
            "essential_u": essential_u,
            "essential_v": essential_v,
            "blocks": _bezier_blocks(net, essential_u, essential_v),
            "_moved": moved,
        }
        for name, value in values.items():
            if isinstance(value, np.ndarray) and value.flags.writeable:
                value.flags.writeable = False
            object.__setattr__(self, name, value)
        # the affine map stays the identity: maps are applied to the control points
        super().__init__(np.eye(3), np.zeros(3), domain)

    def _data(self) -> Array:
        nu, nv, rows, columns = self.blocks.shape[:4]
        head = [rows - 1.0, columns - 1.0, float(nu), float(nv)]
        breaks = (self.essential_u.breaks, self.essential_v.breaks)
        return np.concatenate([head, *breaks, self.blocks.ravel()])

    @property
    def moved(self) -> float:
        """A bound on how far the removal of redundant knots moved the surface, length."""
        return self._moved

    @property
    def degrees(self) -> tuple[int, int]:
        return self.vector_u.degree, self.vector_v.degree

    @property
    def knots_u(self) -> Array:
        return self.vector_u.knots

    @property
    def knots_v(self) -> Array:
        return self.vector_v.knots

    def breaks(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Knots inside the domain where the surface may be less than C2."""
        u0, u1, v0, v1 = self.domain
        return (
            tuple(t for t in self.essential_u.rough() if u0 < t < u1),
            tuple(t for t in self.essential_v.rough() if v0 < t < v1),
        )

    def pieces(self) -> tuple[Array, Array]:
        """Its essential knots."""
        u0, u1, v0, v1 = self.domain
        return inside(self.essential_u.breaks, u0, u1), inside(self.essential_v.breaks, v0, v1)

    def spare_knots(self) -> tuple[Array, Array]:
        """(us, vs) inside the domain: knots at which no span ends."""
        u0, u1, v0, v1 = self.domain
        us = np.setdiff1d(self.vector_u.breaks, self.essential_u.breaks)
        vs = np.setdiff1d(self.vector_v.breaks, self.essential_v.breaks)
        return inside(us, u0, u1), inside(vs, v0, v1)

    def restricted(self, u0: float, u1: float, v0: float, v1: float) -> Self:
        """The same surface on a smaller domain; parameters stay the same.

        Raises ValueError: the domain is empty or leaves the present one.
        """
        smaller = self.smaller_domain(u0, u1, v0, v1)
        surface = object.__new__(type(self))
        for name, value in vars(self).items():
            object.__setattr__(surface, name, value)
        object.__setattr__(surface, "domain", smaller)
        return surface

    def transformed(self, linear: Array, shift: Array) -> Self:
        """The exact image under x -> linear x + shift; parameters stay the same."""
        linear, shift = affine_map(linear, shift)
        points = self.control_points @ linear.T + shift
        surface = object.__new__(type(self))
        surface._set(points, self.weights, self.vector_u, self.vector_v, self.domain)
        return surface

    def spans(self, spare: bool = False) -> list[NurbsSpan]:
        """The Bezier patches of the domain, u major, cut to it at its rim.

        spare : also cut them at redundant knots.
        """
        u0, u1, v0, v1 = self.domain
        us, vs = self.spare_knots() if spare else (np.zeros(0), np.zeros(0))
        parts_u = _cuts(self.essential_u, np.array([u0, *us, u1]))
        parts_v = _cuts(self.essential_v, np.array([v0, *vs, v1]))
        return [
            NurbsSpan(
                (low_u, high_u, low_v, high_v),
                cut_u @ np.moveaxis(self.blocks[i, j], 2, 0) @ cut_v.T,
            )
            for i, low_u, high_u, cut_u in parts_u
            for j, low_v, high_v, cut_v in parts_v
        ]

    def box(self) -> tuple[Array, Array]:
        """(low, high) corners of a tight box that is guaranteed to contain the surface."""
        return tight_box(np.array([span.points for span in self.spans()]))

    def highest(self, direction: Array) -> None:
        """None: its `box` is used instead."""
        return

    def nets_over(self, boxes: Boxes) -> CutNets:
        """Its Bezier patches, cut to boxes that no knot crosses."""
        from standoff.geometry.net_bounds import CutNets

        return CutNets(self.blocks, (self.essential_u.breaks, self.essential_v.breaks), boxes)

    def jets_over(self, boxes: Boxes) -> Interval:
        return self.nets_over(boxes).jets()

    def extents_over(self, boxes: Boxes, directions: Array) -> Interval:
        """From the control points."""
        return self.nets_over(boxes).heights(directions)

    def bounds_over(self, boxes: Boxes) -> PatchBounds:
        from standoff.geometry.net_bounds import net_bounds

        return net_bounds(self.nets_over, boxes)

    def cones_over(self, boxes: Boxes) -> tuple[Array, Array]:
        """From the control nets of the normals."""
        return self.nets_over(boxes).normal_cones()

    def refined(self, knots_u: Sequence[float] = (), knots_v: Sequence[float] = ()) -> NurbsSurface:
        """The same surface with further knots inserted inside its domain."""
        vector_u, rows = refine(self.vector_u, knots_u, "knots_u")
        vector_v, columns = refine(self.vector_v, knots_v, "knots_v")
        return self._mapped(rows, columns, vector_u, vector_v)

    def elevated(self, degree_u: int, degree_v: int) -> NurbsSurface:
        """The same surface with clamped ends and higher degrees, at most 9.

        Raises ValueError: a degree below the present one or above 9.
        """
        p, q = self.degrees
        vector_u, rows = elevate_knots(self.vector_u, degree_u - p)
        vector_v, columns = elevate_knots(self.vector_v, degree_v - q)
        return self._mapped(rows, columns, vector_u, vector_v)

    def _mapped(
        self, rows: Array, columns: Array, vector_u: KnotVector, vector_v: KnotVector
    ) -> NurbsSurface:
        h = np.concatenate(
            [self.control_points * self.weights[..., None], self.weights[..., None]], axis=2
        )
        h = np.einsum("ia,abc,jb->ijc", rows, h, columns)
        return _new(h[..., :3] / h[..., 3:], h[..., 3], vector_u, vector_v, self.domain)

    def reversed_u(self) -> NurbsSurface:
        """The same points with -u for u, which reverses the normal f_u x f_v."""
        u0, u1, v0, v1 = self.domain
        mirrored = KnotVector(_read_only(-self.knots_u[::-1]), self.degrees[0])
        points, w = self.control_points[::-1], self.weights[::-1]
        return _new(points, w, mirrored, self.vector_v, (-u1, -u0, v0, v1))

    def reversed_v(self) -> NurbsSurface:
        """The same points with -v for v, which reverses the normal f_u x f_v."""
        return self.swapped().reversed_u().swapped()

    def swapped(self) -> NurbsSurface:
        """The same points with u and v exchanged, which reverses the normal f_u x f_v."""
        u0, u1, v0, v1 = self.domain
        points, w = self.control_points.swapaxes(0, 1), self.weights.T
        return _new(points, w, self.vector_v, self.vector_u, (v0, v1, u0, u1))


class BezierPatch(NurbsSurface):
    """A rational Bezier patch on u, v in [0, 1], of degrees 1 to 9 with positive weights.

    Raises ValueError as for `NurbsSurface`.

    Parameters
    ----------
    control_points : (p + 1, q + 1, 3) array, length, body frame.
    weights : (p + 1, q + 1) positive array; ones by default.
    """

    def __init__(self, control_points: Any, weights: Any = None) -> None:
        points = finite(control_points, "control_points", (-1, -1, 3))
        for count, axis in zip(points.shape[:2], "uv", strict=True):
            if not 2 <= count <= GREATEST_DEGREE + 1:
                raise StandoffError(
                    f"Bezier patch with {count} control points along {axis}, so degree "
                    f"{count - 1}: give 2 to {GREATEST_DEGREE + 1}.",
                    "control_points",
                    points,
                )
        ends_u, ends_v = (np.repeat([0.0, 1.0], count) for count in points.shape[:2])
        super().__init__(points, ends_u, ends_v, weights)


def _new(
    points: Array, w: Array, vector_u: KnotVector, vector_v: KnotVector, domain: Domain
) -> NurbsSurface:
    """A surface from numbers that are known to be valid."""
    surface = object.__new__(NurbsSurface)
    surface._set(_read_only(points), _read_only(w), vector_u, vector_v, domain)
    return surface


def checked_weights(weights: Any, points: Array) -> Array:
    """Positive weights, one per control point; raises too if the points have no extent."""
    shape = points.shape[:-1]
    w = finite(np.ones(shape) if weights is None else weights, "weights", shape)
    if (w <= 0.0).any():
        at = tuple(int(i) for i in np.argwhere(w <= 0.0)[0])
        place = at[0] if len(at) == 1 else at
        raise StandoffError(
            f"weights[{place}] = {w[at]}: every weight must be positive.", "weights", weights
        )
    check_alike(w)
    if np.ptp(points.reshape(-1, points.shape[-1]), axis=0).max() == 0.0:
        raise StandoffError(
            f"All control points are {points.reshape(-1, points.shape[-1])[0]}: give different "
            "ones, for a point is no surface or curve.",
            "control_points",
            points,
        )
    return w


def _bezier_blocks(h: Array, vector_u: KnotVector, vector_v: KnotVector) -> Array:
    """(nu, nv, p + 1, q + 1, 4) homogeneous Bezier points of every span, from (n, m, 4)."""
    p, q = vector_u.degree, vector_v.degree
    rows, columns = bezier_spans(vector_u), bezier_spans(vector_v)
    blocks = np.empty((len(rows), len(columns), p + 1, q + 1, 4))
    for i, (a, left) in enumerate(rows):
        for j, (b, right) in enumerate(columns):
            part = h[a : a + p + 1, b : b + q + 1]
            blocks[i, j] = np.einsum("ia,abc,jb->ijc", left, part, right)
    return blocks


def _cuts(vector: KnotVector, places: Array) -> list[tuple[int, float, float, Array]]:
    """Parts of spans between places, ascending: the span's number, the part's ends, and the
    matrix that cuts the span's Bezier points."""
    cuts = []
    for i, (a, b) in enumerate(pairwise(vector.breaks.tolist())):
        inside = places[(a < places) & (places < b)].tolist()
        for low, high in pairwise([max(a, places[0]), *inside, min(b, places[-1])]):
            if low < high:
                whole = low == a and high == b
                matrix = (
                    np.eye(vector.degree + 1)
                    if whole
                    else segment(vector.degree, (low - a) / (b - a), (high - a) / (b - a))
                )
                cuts.append((i, float(low), float(high), matrix))
    return cuts


def _read_only(array: Array) -> Array:
    array = np.array(array)
    array.flags.writeable = False
    return array
