"""Curves of edges: line, conic arc (open or closed), rational Bezier."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.numbers import number
from standoff.checks.real_numbers import shape_of
from standoff.errors import StandoffError
from standoff.geometry.tolerances import PARALLEL_AXES, WHOLE_CONIC
from standoff.geometry.validation import affine_map, check_alike, vector3
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import curve_jet, curve_jets
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.formulas.compiled import Formula
    from standoff.geometry.intervals import Interval
    from standoff.geometry.net_bounds import CutNets
    from standoff.geometry.pcurves import Pcurve
    from standoff.geometry.surfaces import Surface

FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class Curve(KeepsReadOnly):
    """A parametric curve on [first, last], lengths in the body's frame.

    Parameters
    ----------
    data : array
        What its kernel reads. Make curves with the subclasses, which check their arguments.
    first, last : float
        Range of the parameter t.
    """

    data: Array = field(repr=False)
    first: float
    last: float
    kind: ClassVar[int]

    def jet(self, t: float) -> tuple[Array, Array, Array]:
        """(x, x_t, x_tt), each (3,), body frame."""
        x, xt, xtt = curve_jet(self.data, self.kind, 0, t)
        return np.array(x), np.array(xt), np.array(xtt)

    def point(self, t: float) -> Array:
        return self.jet(t)[0]

    def jets(self, ts: Array) -> Array:
        """(n, 3, 3) rows (x, x_t, x_tt) at (n,) parameters, body frame."""
        found = np.empty((len(ts), 9))
        curve_jets(self.data, self.kind, 0, np.ascontiguousarray(ts), found)
        return found.reshape(-1, 3, 3)

    def points(self, ts: Array) -> Array:
        """(n, 3) points at (n,) parameters, body frame."""
        return self.jets(ts)[:, 0]

    @property
    def closed(self) -> bool:
        return False

    @property
    def formulas(self) -> tuple[Formula, ...]:
        """The compiled formulas whose addresses are in its data or in that of its surface."""
        return ()

    @property
    def moved(self) -> float:
        """How far the curve may lie from the given one, length: 0 except for splines, whose
        redundant knots are removed (``knot_removal``)."""
        return 0.0

    def pcurve_on(self, surface: Surface) -> Pcurve | None:
        """The trimming curve on a surface that the curve was made on, else None."""
        return None

    def spans(self) -> Array:
        """Ends of the intervals, ascending, on which the curve is a single smooth piece."""
        return np.array([self.first, self.last])

    def box(self) -> tuple[Array, Array] | None:
        """(low, high), each (3,), guaranteed to contain the curve; None if its kind has none."""
        return None

    def jets_over(self, t: Interval) -> Interval:
        """(3, 3, n) bounds of (x, x_t, x_tt) over ranges of t, none across the end of a span.

        Raises StandoffError: a kind of curve without bounds.
        """
        raise StandoffError(f"{type(self).__name__} has no bounds: it cannot be a profile.")

    def heights_over(self, directions: Interval, t: Interval) -> Interval:
        """(m, n) bounds of direction . x over such ranges, by a second-order Taylor expansion;
        directions (m, 3, n)."""
        from standoff.geometry.interval_vectors import mapped
        from standoff.geometry.intervals import interval

        middle = interval(t.middle)
        with np.errstate(all="ignore"):
            over = mapped(directions, self.jets_over(t))
            at = mapped(directions, self.jets_over(middle))
            away = t - middle
            total = at[:, 0] + at[:, 1] * away + over[:, 2] * away**2 * 0.5
        return total.within(over[:, 0])

    def transformed(self, linear: Array, shift: Array) -> Curve:
        """The exact image under x -> linear x + shift; the parameter stays the same."""
        linear, shift = affine_map(linear, shift)
        data = self.data.copy()
        data[0:9] = (linear @ data[0:9].reshape(3, 3)).ravel()
        data[9:12] = linear @ data[9:12] + shift
        return _curve(type(self), data, self.first, self.last)

    def basis(self) -> Array:
        """(3, 3) matrix B: x(t) = B (t, 0, 1) for a line, B (cos t, sin t, 1) for a conic arc."""
        linear = self.data[0:9].reshape(3, 3)
        return np.column_stack([linear[:, 0], linear[:, 1], self.data[9:12]])


def _curve(kind: type[Curve], data: Array, first: float, last: float) -> Curve:
    curve = object.__new__(kind)
    data.flags.writeable = False
    object.__setattr__(curve, "data", data)
    object.__setattr__(curve, "first", float(first))
    object.__setattr__(curve, "last", float(last))
    return curve


def _affine(linear: Array, shift: Array) -> Array:
    return np.concatenate([np.asarray(linear).ravel(), shift])


class Line(Curve):
    """The segment from p (t = 0) to q (t = 1).

    Raises ValueError: a wrong shape, a number that is not finite, or twice the same point.

    Parameters
    ----------
    p, q : (3,) array_like, or (2,) in the plane z = 0
        Two different points, length.
    """

    kind = L.LINE

    def jets_over(self, t: Interval) -> Interval:
        from standoff.geometry.interval_vectors import mapped, stacked
        from standoff.geometry.intervals import interval

        one, zero = interval(np.ones_like(t.lo)), interval(np.zeros_like(t.lo))
        rows = [[t, one, zero], [one, zero, zero]]
        return mapped(self.basis()[:, [0, 2]], stacked([stacked(row) for row in rows]))

    def __init__(self, p: Any, q: Any) -> None:
        p, q = vector3(_planar(p), "p"), vector3(_planar(q), "q")
        if np.array_equal(p, q):
            raise StandoffError(f"Line from {p} to itself: give two different points.", "p", p)
        linear = np.zeros((3, 3))
        linear[:, 0] = q - p
        fill_curve(self, _affine(linear, p), 0.0, 1.0)


class ConicArc(Curve):
    """The elliptic arc centre + a cos t + b sin t, t from first to last; closed for a full turn.

    Arcs of parabolas and hyperbolas are rational Bezier curves of degree 2.

    Raises ValueError: a wrong shape, a number that is not finite, parallel or zero axes, a wrong
    range.

    Parameters
    ----------
    centre, a, b : (3,) array_like, or (2,) in the plane z = 0
        Centre and two conjugate semi-axes, not parallel; length.
    first, last : float
        Eccentric angles, radians, with 0 < last - first <= 2 pi.
    """

    kind = L.CONIC

    def jets_over(self, t: Interval) -> Interval:
        from standoff.geometry.interval_vectors import mapped, stacked
        from standoff.geometry.intervals import cos, interval, sin

        c, s = cos(t), sin(t)
        one, zero = interval(np.ones_like(t.lo)), interval(np.zeros_like(t.lo))
        rows = [[c, -s, -c], [s, c, -s], [one, zero, zero]]
        return mapped(self.basis(), stacked([stacked(row) for row in rows]))

    def heights_over(self, directions: Interval, t: Interval) -> Interval:
        """Exact up to rounding."""
        from standoff.geometry.interval_vectors import mapped, wave
        from standoff.geometry.intervals import interval

        a, b, c = (mapped(directions, interval(col[:, None])) for col in self.basis().T)
        return wave(a, b, t) + c

    def __init__(
        self, centre: Any, a: Any, b: Any, first: float = 0.0, last: float = FULL_TURN
    ) -> None:
        centre = vector3(_planar(centre), "centre")
        a, b = vector3(_planar(a), "a"), vector3(_planar(b), "b")
        first, last = number(first, "first"), number(last, "last")
        if np.linalg.norm(np.cross(a, b)) <= PARALLEL_AXES * np.linalg.norm(a) * np.linalg.norm(b):
            raise StandoffError(f"Conic arc with parallel or zero axes a = {a}, b = {b}.")
        if not 0.0 < last - first <= FULL_TURN * (1.0 + WHOLE_CONIC):
            raise StandoffError(
                f"Conic arc from t = {first} to {last}: give 0 < last - first <= 2 pi.",
                "last",
                last,
            )
        linear = np.zeros((3, 3))
        linear[:, 0], linear[:, 1] = a, b
        fill_curve(self, _affine(linear, centre), first, last)

    @property
    def closed(self) -> bool:
        return self.last - self.first >= FULL_TURN * (1.0 - WHOLE_CONIC)


class RationalBezier(Curve):
    """A rational Bezier curve on [0, 1].

    Raises ValueError: a wrong shape, a number that is not finite, a single point, repeated end
    points, weights that are not positive or differ too much.

    Parameters
    ----------
    control_points : (n + 1, 3) array_like, or (n + 1, 2) in the plane z = 0
        At least two, length; the first two differ, and the last two.
    weights : (n + 1,) array_like, optional
        Positive, within a factor of 1e12, dimensionless; ones by default.
    """

    kind = L.BEZIER

    def nets_over(self, t: Interval) -> CutNets:
        """Its control points, cut to ranges of t."""
        from standoff.geometry.net_bounds import curve_nets

        return curve_nets(self.data[1:].reshape(1, -1, 4), np.array([0.0, 1.0]), t)

    def jets_over(self, t: Interval) -> Interval:
        return self.nets_over(t).jets()[:, [0, 1, 3]]

    def heights_over(self, directions: Interval, t: Interval) -> Interval:
        """From the control points."""
        return self.nets_over(t).heights(directions)

    def __init__(self, control_points: Any, weights: Any = None) -> None:
        if (shape_of(control_points) or ())[1:] == (2,):
            flat = finite(control_points, "control_points", (-1, 2))
            control_points = np.column_stack([flat, np.zeros(len(flat))])
        points = finite(control_points, "control_points", (-1, 3))
        if len(points) < 2:
            raise StandoffError(
                f"Bezier curve with {len(points)} control point: give at least two.",
                "control_points",
                control_points,
            )
        w = finite(np.ones(len(points)) if weights is None else weights, "weights", (len(points),))
        if (w <= 0.0).any():
            raise StandoffError(f"Bezier weights must be positive: {w}", "weights", weights)
        check_alike(w)
        if np.ptp(points, axis=0).max() == 0.0:
            raise StandoffError(
                f"Bezier curve of a single point {points[0]}: give different points.",
                "control_points",
                control_points,
            )
        for a, b, end in ((points[0], points[1], "first"), (points[-1], points[-2], "last")):
            if np.array_equal(a, b):
                raise StandoffError(
                    f"Bezier curve whose {end} two control points are the same, {a}: it has no "
                    "tangent there; remove one of them.",
                    "control_points",
                    control_points,
                )
        homogeneous = np.column_stack([points * w[:, None], w])
        fill_curve(self, np.concatenate([[float(len(points) - 1)], homogeneous.ravel()]), 0.0, 1.0)

    @property
    def degree(self) -> int:
        return int(self.data[0])

    def transformed(self, linear: Array, shift: Array) -> Curve:
        linear, shift = affine_map(linear, shift)
        data = self.data.copy()
        h = data[1:].reshape(-1, 4)
        h[:, :3] = h[:, :3] @ linear.T + h[:, 3:] * shift
        return _curve(RationalBezier, data, self.first, self.last)


def _planar(point: Any) -> Any:
    """A point with z = 0 added if it is 2-D."""
    return [*point, 0.0] if shape_of(point) == (2,) else point


def fill_curve(curve: Curve, data: Array, first: float, last: float) -> None:
    """Set a curve's fields, and make its data read-only."""
    data.flags.writeable = False
    object.__setattr__(curve, "data", data)
    object.__setattr__(curve, "first", float(first))
    object.__setattr__(curve, "last", float(last))
