"""Derivatives of a potential that is nearly a piece's own are small: by 60 digits, at any place.

The bounds of `spatial_likeness` are compared with derivatives that mpmath takes of the potential's
plain formula over a surface that turns about the moved axis, or is the moved potential's own.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from standoff.kernels.solids.spatial_bounds import third_bounds
from standoff.kernels.solids.spatial_likeness import differences, to_axis
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    Potential,
)

DIGITS = 60
ORDERS = ((3, 0), (2, 1), (1, 2), (0, 3))
ROUNDED = 1e-15
"""Lengths are near 1: how far the offset and the tilt, computed from positions, may be off."""
KINDS = (AXIS_OF, CONE_OF, CIRCLE_OF, CENTRE_OF)


def rotation(rng, angle):
    """By an angle about any axis; numbers of mpmath."""
    x, y, z = (mp.mpf(c) for c in rng.normal(size=3))
    size = mp.sqrt(x * x + y * y + z * z)
    x, y, z = x / size, y / size, z / size
    c, s = mp.cos(angle), mp.sin(angle)
    cross = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + s * cross + (1 - c) * cross * cross


def value(phi, x):
    """The plain formula."""
    kind, o, n, k1, k2 = phi
    y = [x[i] - o[i] for i in range(3)]
    z = sum(y[i] * n[i] for i in range(3))
    rho = mp.sqrt(sum((y[i] - z * n[i]) ** 2 for i in range(3)))
    if kind == AXIS_OF:
        return rho
    if kind == CONE_OF:
        return rho * k1 - z * k2
    if kind == CIRCLE_OF:
        return mp.sqrt((rho - k1) ** 2 + z * z)
    return mp.sqrt(sum(c * c for c in y))


def floats(v):
    return tuple(float(c) for c in v)


class Case:
    """A potential, an axis that it is nearly turned about, and a surface about this."""

    def __init__(self, rng, kind):
        size = float(10.0 ** rng.uniform(-1.0, 1.0))
        angle = rng.uniform(0.2, 1.3)
        cone = float(np.cos(angle)), float(np.sin(angle))
        self.k1, self.k2 = cone if kind == CONE_OF else (size, 0.0)
        self.kind = kind
        small = 10.0 ** rng.uniform(-12.0, -1.0, 2) * (rng.uniform(size=2) < 0.9)
        self.offset, tilt = (float(each) for each in small)
        self.R = rotation(rng, mp.mpf(rng.uniform(0.0, 3.0)))
        self.p = mp.matrix(rng.normal(size=3).tolist())
        # the potential: the surface's frame, moved
        turn = rotation(rng, mp.mpf(tilt))
        way = mp.matrix(rng.normal(size=3).tolist())
        slid = way * (self.offset * size / mp.norm(way))
        self.n = turn * self.R * mp.matrix([0, 0, 1])
        self.o = self.p + slid
        # a curve (rho, z) beside the axis, at a place
        rho, z = size * 10.0 ** rng.uniform(-0.5, 0.5), size * rng.normal()
        own = rng.normal(size=(3, 2)) * size * 10.0 ** rng.uniform(-2.0, 0.0)
        self.net = [mp.matrix([mp.mpf(rho), mp.mpf(z)]), *(mp.matrix(r.tolist()) for r in own)]
        self.u = mp.mpf(rng.uniform(0.0, 6.0))

    def surface(self, u, v):
        """The curve turned about the axis."""
        rho = self.net[0][0] + v * self.net[1][0] + v**2 * self.net[2][0] + v**3 * self.net[3][0]
        z = self.net[0][1] + v * self.net[1][1] + v**2 * self.net[2][1] + v**3 * self.net[3][1]
        return self.p + self.R * mp.matrix([rho * mp.cos(u), rho * mp.sin(u), z])

    def own_surface(self, u, v):
        """That on which the moved potential is constant, through the curve's place."""
        rho, z = self.net[0]
        if self.kind == AXIS_OF:
            z = z + v * rho
        elif self.kind == CONE_OF:
            rho, z = rho + v * rho, z + v * rho * self.k1 / self.k2
        else:
            centre = self.k1 if self.kind == CIRCLE_OF else mp.mpf(0)
            away, at = mp.hypot(rho - centre, z), mp.atan2(z, rho - centre) + v
            rho, z = centre + away * mp.cos(at), away * mp.sin(at)
        return self.p + self.R * mp.matrix([rho * mp.cos(u), rho * mp.sin(u), z])

    @property
    def plain(self):
        return self.kind, self.o, self.n, self.k1, self.k2

    @property
    def potential(self):
        zero = (0.0, 0.0, 0.0)
        return Potential(
            self.kind, floats(self.o), zero, zero, floats(self.n), self.k1, self.k2, 1.0
        )

    def bounds_of(self, surface, moved):
        """Bounds of the third derivatives at the place, by the kernels."""
        sizes = [
            float(mp.norm(mp.matrix([mp.diff(lambda u, v, c=c: surface(u, v)[c],
                                             (self.u, mp.mpf(0)), order) for c in range(3)])))
            for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2), *ORDERS)
        ]  # fmt: skip
        x, reach = floats(surface(self.u, mp.mpf(0))), 0.0
        phi = self.potential
        axis = floats(self.R * mp.matrix([0, 0, 1]))
        e, w = to_axis(phi, floats(self.p), axis, x, reach)
        if moved and self.kind != AXIS_OF:
            # the kernel's rule for a leaf's own potential: its point goes to the leaf's
            away = float(mp.norm(self.o - self.p))
            e = away + w * float(mp.norm(mp.matrix(x) - self.o)) if w else away
        numbers = np.zeros(32)
        numbers[4:13] = sizes
        long = 1.0 + max(abs(each) for each in (*x, *phi.o, *floats(self.p)))
        told = differences(phi, x, reach, e + ROUNDED * long, w + ROUNDED)
        return np.array(third_bounds(numbers, 0, told))

    def derivatives(self, surface):
        """Third derivatives of the potential over the surface."""

        def along(u, v):
            return value(self.plain, surface(u, v))

        return np.array([float(abs(mp.diff(along, (self.u, mp.mpf(0)), n))) for n in ORDERS])


def shares(rng, count):
    """Of each case the greatest share of a bound that a derivative takes."""
    found = []
    with mp.workdps(DIGITS):
        for k in range(count):
            case = Case(rng, KINDS[k % 4])
            for surface, moved in ((case.surface, False), (case.own_surface, True)):
                bounds = case.bounds_of(surface, moved)
                last = 4 if moved else 3  # a curve that is turned may have any v
                if np.isfinite(bounds).all():
                    true = case.derivatives(surface)
                    found.append(float((true[:last] / bounds[:last]).max()))
    return np.array(found)


def test_bounds_hold(rng):
    found = shares(rng, 24)
    assert len(found) > 20
    assert found.max() <= 1.0
    assert found.max() > 1e-3


@pytest.mark.soak
def test_bounds_hold_anywhere(rng):
    found = shares(rng, 4000)
    assert found.max() <= 1.0
