"""NURBS curves of degree 1 to 9."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.arrays import finite
from standoff.checks.real_numbers import shape_of
from standoff.geometry.curves import Curve
from standoff.geometry.hulls import tight_box
from standoff.geometry.knot_removal import essential_row
from standoff.geometry.knots import KnotVector, bezier_spans, elevate_knots, knot_vector, refine
from standoff.geometry.nurbs import checked_weights
from standoff.geometry.tolerances import SMOOTH_JOINT
from standoff.geometry.validation import affine_map
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.intervals import Interval
    from standoff.geometry.net_bounds import CutNets


class NurbsCurve(Curve):
    """A rational B-spline curve of degree 1 to 9 with positive weights, clamped or not.

    Raises ValueError as for `NurbsSurface`.

    Parameters
    ----------
    control_points : (n, 3) array, or (n, 2) in the plane z = 0; length, body frame.
    knots : (n + p + 1,) array, ascending; the degree p follows from the counts. The curve runs
        from knot p to knot n; inside, a knot may occur at most p times.
    weights : (n,) positive array; ones by default.

    Notes
    -----
    `essential` is the knot vector without redundant knots, as for `NurbsSurface`.
    """

    kind = L.NURBS_CURVE

    control_points: Array
    weights: Array
    vector: KnotVector
    essential: KnotVector
    blocks: Array
    _moved: float

    def __init__(self, control_points: Any, knots: Any, weights: Any = None) -> None:
        if (shape_of(control_points) or ())[1:] == (2,):
            flat = finite(control_points, "control_points", (-1, 2))
            control_points = np.column_stack([flat, np.zeros(len(flat))])
        points = finite(control_points, "control_points", (-1, 3))
        vector = knot_vector(knots, len(points), "knots", "control points")
        self._set(points, checked_weights(weights, points), vector)

    def _set(self, points: Array, w: Array, vector: KnotVector) -> None:
        h = np.column_stack([points * w[:, None], w])
        essential, row, moved = essential_row(vector, h)
        blocks = bezier_blocks(row, essential)
        head = [float(vector.degree), float(len(blocks))]
        first, last = vector.domain
        values = {
            "control_points": points,
            "weights": w,
            "vector": vector,
            "essential": essential,
            "blocks": blocks,
            "_moved": moved,
            "data": np.concatenate([head, essential.breaks, blocks.ravel()]),
            "first": first,
            "last": last,
        }
        for name, value in values.items():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def moved(self) -> float:
        """A bound on how far the removal of redundant knots moved the curve, length."""
        return self._moved

    @property
    def degree(self) -> int:
        return self.vector.degree

    @property
    def knots(self) -> Array:
        return self.vector.knots

    @property
    def closed(self) -> bool:
        """Do its ends meet smoothly?"""
        start, stop = self.blocks[0], self.blocks[-1]
        a, b = start[:, :3] / start[:, 3:], stop[:, :3] / stop[:, 3:]
        extent = float(np.ptp(self.control_points, axis=0).max())
        if np.abs(a[0] - b[-1]).max() > SMOOTH_JOINT * extent:
            return False
        out, back = a[1] - a[0], b[-1] - b[-2]
        size = float(np.linalg.norm(out) * np.linalg.norm(back))
        turn = float(np.linalg.norm(np.cross(out, back)))
        return bool(out @ back > 0.0) and turn <= SMOOTH_JOINT * size

    def box(self) -> tuple[Array, Array]:
        """(low, high) corners of a tight box that is guaranteed to contain the curve."""
        return tight_box(self.blocks.swapaxes(1, 2)[..., None])

    def nets_over(self, t: Interval) -> CutNets:
        """Its Bezier pieces, cut to ranges of t that no knot crosses."""
        from standoff.geometry.net_bounds import curve_nets

        return curve_nets(self.blocks, self.essential.breaks, t)

    def jets_over(self, t: Interval) -> Interval:
        return self.nets_over(t).jets()[:, [0, 1, 3]]

    def heights_over(self, directions: Interval, t: Interval) -> Interval:
        """From the control points."""
        return self.nets_over(t).heights(directions)

    def breaks(self) -> tuple[float, ...]:
        """Knots inside the domain where the curve may be less than C2."""
        return self.essential.rough()

    def spare_knots(self) -> Array:
        """Knots at which no polynomial piece ends."""
        return np.setdiff1d(self.vector.breaks, self.essential.breaks)

    def spans(self) -> Array:
        """Its distinct essential knots: one polynomial piece between each two."""
        return self.essential.breaks

    def transformed(self, linear: Array, shift: Array) -> NurbsCurve:
        """The exact image under x -> linear x + shift; the parameter stays the same."""
        linear, shift = affine_map(linear, shift)
        return self._new(self.control_points @ linear.T + shift, self.weights, self.vector)

    def refined(self, knots: Sequence[float]) -> NurbsCurve:
        """The same curve with further knots inserted inside its domain."""
        vector, matrix = refine(self.vector, knots, "knots")
        return self._mapped(matrix, vector)

    def elevated(self, degree: int) -> NurbsCurve:
        """The same curve with clamped ends and a higher degree, at most 9."""
        vector, matrix = elevate_knots(self.vector, degree - self.degree)
        return self._mapped(matrix, vector)

    def reversed(self) -> NurbsCurve:
        """The same points in reverse: t becomes -t."""
        knots = -self.knots[::-1]
        knots.flags.writeable = False
        return self._new(
            self.control_points[::-1], self.weights[::-1], KnotVector(knots, self.degree)
        )

    def _mapped(self, matrix: Array, vector: KnotVector) -> NurbsCurve:
        w = matrix @ self.weights
        return self._new(
            (matrix @ (self.control_points * self.weights[:, None])) / w[:, None], w, vector
        )

    def _new(self, points: Array, w: Array, vector: KnotVector) -> NurbsCurve:
        curve = object.__new__(NurbsCurve)
        curve._set(points.copy(), w.copy(), vector)
        return curve


def bezier_blocks(h: Array, vector: KnotVector) -> Array:
    """(spans, p + 1, 4) homogeneous Bezier points (w x, w) of every span, from (n, 4)."""
    p = vector.degree
    return np.array([matrix @ h[a : a + p + 1] for a, matrix in bezier_spans(vector)])
