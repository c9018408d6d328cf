"""The egg: a sphere in a partial perspective."""

from __future__ import annotations

import numpy as np

from standoff.bodies.body import Body
from standoff.bodies.shapes.isolines import along_u
from standoff.bodies.topology import Edge, Face
from standoff.checks.numbers import magnitude, magnitude_or_zero, number
from standoff.errors import BodyError
from standoff.geometry.bernstein import product
from standoff.geometry.curves import ConicArc, RationalBezier
from standoff.geometry.nurbs import BezierPatch
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.swept import Revolution
from standoff.kernels.body import layout as L
from standoff.typing import Array

# Greatest |taper|: from sqrt(1/2) on an egg is hollow near its pointed end.
GREATEST_TAPER = 0.7
# A polar cap extends to this stereographic radius, tan(30°), 60° from its pole, and less at the
# blunt end, where the perspective enlarges it, so that its weights stay positive.
CAP_REACH = float(np.sqrt(1.0 / 3.0))
# The square patches of the caps extend a little farther, so that the rim is well inside.
CAP_MARGIN = 1.1


def egg(radius: float, length: float, taper: float = 0.4, *, rounding: float = 0.0) -> Body:
    """An egg about the axis z, pointed towards +z for taper > 0; exact, smooth everywhere.

    A projective image of a sphere is again a quadric, and so an ellipsoid. An egg is the image of
    the unit sphere under a *partial* perspective, in which only the sections perpendicular to the
    axis shrink: (x, y, z) -> (b x / (1 + k z), b y / (1 + k z), c z), where k is the taper and c
    half the length. It is a rational surface of degree 4: two polar caps of degree (4, 4) and a
    revolved curve of degree 4 between them.

    Raises BodyError: |taper| above 0.7. Raises ValueError: a number that is not finite, a length
    that is not positive, a negative rounding.

    Parameters
    ----------
    radius : float
        The greatest radius, at z = -taper length / 2; length, positive.
    length : float
        From pole to pole, centred; length, positive.
    taper : float
        Dimensionless, -0.7 to 0.7; 0 is an ellipsoid.
    rounding : float
        Radius of a ball swept over it, length, zero or above: the body grows by it all round.

    Returns
    -------
    Body

    Notes
    -----
    With r(z) = sqrt(1 - z²)/(1 + k z), r'' has the sign of 2k² - 1 - 3k²z² - 2kz³, which is
    negative on [-1, 1] as long as k² < 1/2. r is greatest at z = -k, 1/sqrt(1 - k²).
    """
    radius, half = magnitude(radius, "radius"), 0.5 * magnitude(length, "length")
    k, rounding = number(taper, "taper"), magnitude_or_zero(rounding, "rounding")
    if abs(k) > GREATEST_TAPER:
        raise BodyError(
            f"egg with taper = {k}: give -{GREATEST_TAPER} to {GREATEST_TAPER}; from sqrt(1/2) on "
            "an egg is not convex."
        )
    scale = np.array([radius * np.sqrt(1.0 - k * k)] * 2 + [half])
    low, high = _cap_reach(k, -1.0), _cap_reach(k, 1.0)
    edges = [
        Edge(_parallel(scale, k, -(1.0 - low**2) / (1.0 + low**2))),
        Edge(_parallel(scale, k, (1.0 - high**2) / (1.0 + high**2))),
    ]
    # the meridian runs down from the upper rim, v = 0, to the lower one
    band = Revolution(_meridian(scale, k, high, 1.0 / low))
    faces = [
        Face((band,), ((0, 1), (1, -1)), (), (along_u(1.0), along_u(0.0))),
        Face((_cap(scale, k, -1.0),), ((0, -1),), (), (_rim(),)),
        Face((_cap(scale, k, 1.0),), ((1, 1),), (), (_rim(),)),
    ]
    return Body.from_brep(edges=edges, faces=faces, rounding=rounding, name="egg")


def _cap_reach(k: float, side: float) -> float:
    return CAP_REACH * min(1.0, float(np.sqrt((1.0 + side * k) / (1.0 - side * k))))


def _parallel(scale: Array, k: float, z: float) -> ConicArc:
    r = float(scale[0] * np.sqrt((1.0 - z) * (1.0 + z)) / (1.0 + k * z))
    return ConicArc([0.0, 0.0, scale[2] * z], [r, 0.0, 0.0], [0.0, r, 0.0])


def _meridian(scale: Array, k: float, t0: float, t1: float) -> RationalBezier:
    """The image of the circle (2 t, 1 - t²)/(1 + t²), from t0 (v = 0) to t1."""
    t = np.array([t0, t1])  # the Bernstein coefficients of t, degree 1
    one = np.array([1.0, 1.0])
    sphere_w = _product(one, one) + _product(t, t)
    sphere_z = _product(one, one) - _product(t, t)
    shrink = sphere_w + k * sphere_z
    w = _product(sphere_w, shrink)
    x = scale[0] * _product(_product(2.0 * t, one), sphere_w)
    z = scale[2] * _product(sphere_z, shrink)
    return RationalBezier(np.column_stack([x / w, np.zeros(5), z / w]), w)


def _cap(scale: Array, k: float, side: float) -> BezierPatch:
    """The polar cap about +z (side 1) or -z (side -1), stereographic from the other pole.

    With (p, q) in a square CAP_MARGIN times as wide as the cap, the sphere is
    (2p, 2q, side (1 - p² - q²))/(1 + p² + q²).
    """
    reach = _cap_reach(k, side) * CAP_MARGIN
    line = np.array([-reach, reach])
    p, q = np.outer(line, [1.0, 1.0]), np.outer([1.0, 1.0], line)
    one = np.ones((2, 2))
    squares = _product(p, p) + _product(q, q)
    sphere_w, sphere_z = _product(one, one) + squares, side * (_product(one, one) - squares)
    shrink = sphere_w + k * sphere_z
    w = _product(sphere_w, shrink)
    rows = [
        scale[0] * _product(_product(2.0 * p, one), sphere_w),
        scale[1] * _product(_product(2.0 * q, one), sphere_w),
        scale[2] * _product(sphere_z, shrink),
    ]
    return BezierPatch(np.stack([row / w for row in rows], axis=2), w)


def _rim() -> Pcurve:
    """A cap's rim in its unit square, parametrised by the angle."""
    h = 0.5 / CAP_MARGIN
    return Pcurve(L.CONIC, np.array([[h, 0.0, 0.5], [0.0, h, 0.5], [0.0, 0.0, 1.0]]))


def _product(a: Array, b: Array) -> Array:
    """The product of two polynomials in Bernstein form, of one or two variables."""
    return product(a, b) if a.ndim == 2 else product(a[None], b[None])[0]
