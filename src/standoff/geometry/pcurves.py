"""Trimming curves in (u, v): homogeneous (u, v) as an affine image of a line or a unit circle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from standoff.checks.real_numbers import real_array, shown
from standoff.errors import StandoffError
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import pcurve_jet, pcurve_jets
from standoff.read_only import KeepsReadOnly
from standoff.typing import Array


@dataclass(frozen=True, eq=False)
class Pcurve(KeepsReadOnly):
    """A trimming curve: homogeneous (u, v) as an affine image of a line or a unit circle.

    Raises ValueError: another kind, a wrong shape, or a number that is not finite.

    Parameters
    ----------
    kind : int
        LINE or CONIC of `standoff.kernels.body.layout`. Usually `pcurve_of` makes pcurves; for
        others use `NurbsPcurve`.
    matrix : (3, 3) array_like
        P in P (t, 0, 1) for a line, or in P (cos t, sin t, 1) for a conic, t in radians.
    """

    kind: int
    matrix: Array

    def __post_init__(self) -> None:
        given: Any = self.kind
        if isinstance(given, bool) or not isinstance(given, int) or given not in (L.LINE, L.CONIC):
            raise StandoffError(
                f"Pcurve of kind {shown(given)}: give {L.LINE} (line) or {L.CONIC} (conic).",
                "kind",
                given,
            )
        try:
            matrix = real_array(self.matrix)
        except (TypeError, ValueError) as error:
            raise StandoffError(
                f"Pcurve.matrix is not numeric: {shown(self.matrix)}", "matrix", self.matrix
            ) from error
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
            raise StandoffError(
                f"Pcurve.matrix = {shown(self.matrix)}: give a (3, 3) array of finite numbers.",
                "matrix",
                self.matrix,
            )
        object.__setattr__(self, "matrix", matrix)

    @property
    def data(self) -> Array:
        """What the kernels read."""
        return self.matrix.flatten()

    def homogeneous(self, t: float) -> tuple[Array, Array, Array]:
        """(h, h_t, h_tt), each (3,): homogeneous (u, v) and its derivatives."""
        h, ht, htt = pcurve_jet(self.data, self.kind, 0, t)
        return np.array(h), np.array(ht), np.array(htt)

    def point(self, t: float) -> tuple[float, float, float]:
        """(u, v, depth): depth > 0 if the chart sees the point; otherwise u and v are nan."""
        h = self.homogeneous(t)[0]
        if h[2] <= 0.0:
            return np.nan, np.nan, float(h[2])
        return float(h[0] / h[2]), float(h[1] / h[2]), float(h[2])

    def homogeneous_at(self, ts: Array) -> Array:
        """(n, 3, 3): `homogeneous` at (n,) parameters."""
        found = np.empty((len(ts), 9))
        pcurve_jets(self.data, self.kind, 0, np.ascontiguousarray(ts), found)
        return found.reshape(-1, 3, 3)

    def places(self, ts: Array) -> Array:
        """(n, 2) parameters (u, v) at (n,) parameters; nan where the chart does not see them."""
        h = self.homogeneous_at(ts)[:, 0]
        return np.asarray(h[:, :2] / np.where(h[:, 2] > 0.0, h[:, 2], np.nan)[:, None])

    def pieces(self, first: float, last: float) -> list[tuple[Pcurve, float, float]]:
        """(pcurve, first, last) of the parts that a straight line meets at most twice."""
        return [(self, first, last)]

    def turned(self, angle: float, k: int = 0) -> Pcurve:
        """The same curve with u (k = 0) or v greater by an angle, radians."""
        if angle == 0.0:
            return self
        matrix = self.matrix.copy()
        matrix[k] += angle * matrix[2]
        return Pcurve(self.kind, matrix)
