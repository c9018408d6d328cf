"""Curves on surfaces: the images of pcurves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from standoff.checks.numbers import number
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.geometry.curves import Curve, fill_curve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.geometry.tolerances import WHOLE_TURN
from standoff.kernels.body import layout as L
from standoff.typing import Array

if TYPE_CHECKING:
    from standoff.geometry.formulas.compiled import Formula


class SurfaceCurve(Curve):
    """The image of a pcurve on a surface, for t from first to last: exact on any kind of surface.

    Its packed edge has no data: kernels evaluate the pcurve on the chart of the edge's first
    coedge, so one of the edge's two faces must have this surface as a chart.

    Raises ValueError: something other than a surface or a pcurve, a number that is not finite, an
    empty range.

    Parameters
    ----------
    surface : Surface
        A chart.
    pcurve : Pcurve
        The trimming curve in it.
    first, last : float
        Range of the pcurve's parameter t.
    others : sequence of pairs (Surface, Pcurve)
        The same curve in other charts. A point is evaluated in the chart in which it is most
        central.
    """

    kind = L.ON_SURFACE
    surface: Surface
    pcurve: Pcurve
    others: tuple[tuple[Surface, Pcurve], ...]

    def __init__(
        self,
        surface: Surface,
        pcurve: Pcurve,
        first: float,
        last: float,
        others: Sequence[tuple[Surface, Pcurve]] = (),
    ) -> None:
        first, last = number(first, "first"), number(last, "last")
        if not first < last:
            raise StandoffError(f"SurfaceCurve from t = {first} to {last}: give first < last.")
        _check_chart((surface, pcurve), "SurfaceCurve")
        listed: Any = others
        if not isinstance(listed, Sequence) or isinstance(listed, str | bytes):
            raise StandoffError(
                f"others = {shown(listed)}: give a list of (surface, pcurve).", "others", others
            )
        for k, one in enumerate(listed):
            _check_chart(one, f"others[{k}]")
        object.__setattr__(self, "surface", surface)
        object.__setattr__(self, "pcurve", pcurve)
        object.__setattr__(self, "others", tuple(others))
        fill_curve(self, np.zeros(0), first, last)

    @staticmethod
    def isoline(surface: Surface, *, u: Any = None, v: Any = None) -> SurfaceCurve:
        """The curve u = const (v its parameter) or v = const over the surface's domain.

        Raises ValueError: not a surface, both parameters or neither, a number that is not finite,
        an infinite domain.

        Parameters
        ----------
        surface : Surface
            A patch: its domain is finite.
        u, v : float, optional
            One of the two.

        Returns
        -------
        SurfaceCurve
        """
        if not isinstance(surface, Surface):
            raise StandoffError(f"surface is {shown(surface)}: give a Surface.", "surface", surface)
        if (u is None) == (v is None):
            raise StandoffError(f"isoline at u = {shown(u)}, v = {shown(v)}: give one of them.")
        u0, u1, v0, v1 = surface.domain
        if u is not None:
            u = number(u, "u")
            matrix = np.array([[0.0, 0.0, u], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            return SurfaceCurve(surface, Pcurve(L.LINE, matrix), v0, v1)
        v = number(v, "v")
        matrix = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, v], [0.0, 0.0, 1.0]])
        return SurfaceCurve(surface, Pcurve(L.LINE, matrix), u0, u1)

    @property
    def formulas(self) -> tuple[Formula, ...]:
        return self.surface.formulas

    def jet(self, t: float) -> tuple[Array, Array, Array]:
        surface, (h, ht, htt) = self._central(t)
        p = h[:2] / h[2]
        pt = (ht[:2] - p * ht[2]) / h[2]
        ptt = (htt[:2] - 2.0 * pt * ht[2] - p * htt[2]) / h[2]
        x, xu, xv, xuu, xuv, xvv = surface.jet(float(p[0]), float(p[1]))
        xtt = pt[0] ** 2 * xuu + 2.0 * pt[0] * pt[1] * xuv + pt[1] ** 2 * xvv
        return x, pt[0] * xu + pt[1] * xv, xtt + ptt[0] * xu + ptt[1] * xv

    def jets(self, ts: Array) -> Array:
        """(n, 3, 3) rows (x, x_t, x_tt) at (n,) parameters, body frame."""
        return np.reshape([self.jet(float(t)) for t in ts], (-1, 3, 3))

    @property
    def closed(self) -> bool:
        """Does it go once around a surface whose u is an angle?"""
        if not self.surface.periodic:
            return False
        turn = abs(self.pcurve.point(self.last)[0] - self.pcurve.point(self.first)[0])
        return bool(abs(turn - 2.0 * np.pi) <= WHOLE_TURN * turn)

    def _central(self, t: float) -> tuple[Surface, tuple[Array, Array, Array]]:
        """The surface in which the point at t is most central, and the pcurve there."""
        seen = [(s, p.homogeneous(t)) for s, p in ((self.surface, self.pcurve), *self.others)]
        if len(seen) == 1:
            return seen[0]
        return max(seen, key=lambda one: one[1][0][2] / np.abs(one[1][0]).max())

    def pcurve_on(self, surface: Surface) -> Pcurve | None:
        """The trimming curve on a surface that the curve was made on, else None.

        Of two parts of the same surface, the one with the same domain comes first: on a torus, for
        example, both may contain the curve, at parameters a full turn apart.
        """
        alike = [
            (s, p)
            for s, p in ((self.surface, self.pcurve), *self.others)
            if s.kind == surface.kind and np.array_equal(s.reals, surface.reals)
        ]
        same = (p for s, p in alike if s.domain == surface.domain)
        return next(same, alike[0][1] if alike else None)

    def transformed(self, linear: Array, shift: Array) -> Curve:
        return SurfaceCurve(
            self.surface.transformed(linear, shift),
            self.pcurve,
            self.first,
            self.last,
            [(s.transformed(linear, shift), p) for s, p in self.others],
        )


def _check_chart(one: Any, name: str) -> None:
    """Raise ValueError unless something given is a pair of a surface and a pcurve."""
    surface, pcurve = one if isinstance(one, tuple | list) and len(one) == 2 else (one, None)
    if not isinstance(surface, Surface):
        raise StandoffError(
            f"{name}: the surface is {shown(surface)}: give a Surface.", "surface", surface
        )
    if not isinstance(pcurve, Pcurve):
        raise StandoffError(
            f"{name}: the pcurve is {shown(pcurve)}: give a Pcurve.", "pcurve", pcurve
        )
