"""Random B-splines of all degrees, and SciPy's B-splines as an oracle of NURBS jets."""

import numpy as np
from scipy.interpolate import BSpline, NdBSpline

from standoff.geometry import NurbsCurve, NurbsSurface

# Lengths of spans against each other.
UNEVEN = (0.05, 1.0, 3.0)


def random_knots(rng, degree, clamped, lengths=UNEVEN):
    """Uneven knots with interior multiplicities of 1 to the degree; two to four spans."""
    inside, t = [], 0.0
    for _ in range(rng.integers(1, 4)):
        t += rng.choice(lengths) * rng.uniform(0.5, 1.0)
        inside += [t] * int(rng.integers(1, degree + 1))
    last = t + rng.uniform(0.5, 1.0)
    if clamped:
        return np.array([0.0] * (degree + 1) + inside + [last] * (degree + 1))
    before = -np.sort(rng.uniform(0.1, 1.0, degree))[::-1]
    after = last + np.sort(rng.uniform(0.1, 1.0, degree))
    return np.concatenate([before, [0.0], inside, [last], after])


def random_surface(rng, p, q, clamped=True, lengths=UNEVEN):
    knots_u, knots_v = (random_knots(rng, degree, clamped, lengths) for degree in (p, q))
    shape = (len(knots_u) - p - 1, len(knots_v) - q - 1)
    points = rng.normal(size=(*shape, 3))
    return NurbsSurface(points, knots_u, knots_v, np.exp(rng.uniform(-0.7, 0.7, shape)))


def random_curve(rng, degree, clamped=True):
    knots = random_knots(rng, degree, clamped)
    n = len(knots) - degree - 1
    return NurbsCurve(rng.normal(size=(n, 3)), knots, np.exp(rng.uniform(-0.7, 0.7, n)))


def homogeneous(shape):
    w = shape.weights[..., None]
    return np.concatenate([shape.control_points * w, w], axis=-1)


def surface_jet(surface, u, v):
    """SciPy's jet of a NURBS surface: homogeneous partials, then the quotient rule."""
    spline = NdBSpline((surface.knots_u, surface.knots_v), homogeneous(surface), surface.degrees)
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    h, hu, hv, huu, huv, hvv = (np.array(spline([[u, v]], nu=n)[0]) for n in orders)
    w = h[3]
    x = h[:3] / w
    xu, xv = (hu[:3] - hu[3] * x) / w, (hv[:3] - hv[3] * x) / w
    xuu = (huu[:3] - 2.0 * hu[3] * xu - huu[3] * x) / w
    xuv = (huv[:3] - hu[3] * xv - hv[3] * xu - huv[3] * x) / w
    xvv = (hvv[:3] - 2.0 * hv[3] * xv - hvv[3] * x) / w
    return x, xu, xv, xuu, xuv, xvv


def curve_jet(curve, t):
    """SciPy's jet of a NURBS curve."""
    spline = BSpline(curve.knots, homogeneous(curve), curve.degree)
    h, ht, htt = (spline(t, nu=k) for k in range(3))
    x = h[:3] / h[3]
    xt = (ht[:3] - ht[3] * x) / h[3]
    return x, xt, (htt[:3] - 2.0 * ht[3] * xt - htt[3] * x) / h[3]


def scales(surface, u, v):
    """The size of the six jet components of a unit surface: one over the span's lengths."""
    lengths = []
    for breaks, t in ((surface.vector_u.breaks, u), (surface.vector_v.breaks, v)):
        i = min(int(np.searchsorted(breaks, t, side="right")) - 1, len(breaks) - 2)
        lengths.append(float(breaks[i + 1] - breaks[i]))
    p, q = (degree / length for degree, length in zip(surface.degrees, lengths, strict=True))
    return 1.0, p, q, p * p, p * q, q * q
