"""The least curvature of a body: what its shape adds to the Hessian, whatever the mode."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import scipy

from standoff.bodies.body import Body
from standoff.bodies.features import charts_of
from standoff.bodies.tessellation import coedge_range, packed_pcurve
from standoff.checks.numbers import number
from standoff.checks.real_numbers import shown
from standoff.control.tolerances import POLE_AREA, SEARCH_TOLERANCE
from standoff.errors import StandoffError
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.entries.queries import coedge_parameters, on_face
from standoff.tracking.inputs import check_body
from standoff.typing import Array

# Points along every side of a face, and along a planar curve, at which a search begins.
SIDE_POINTS = 33
# Local searches from the best starts.
SEARCHES = 3


class LeastCurvature(NamedTuple):
    """A body's least normal curvature.

    Attributes
    ----------
    value : float
        1/length; 0 for a body that is flat or straight somewhere, inf for a point.
    proven : bool
        True where it is a bound by theorem; False where it was searched for by sampling and
        descent, which may miss a flatter spot.
    """

    value: float
    proven: bool


def least_curvature(body: Body) -> LeastCurvature:
    """The least normal curvature of a body's core over all its faces (planar: its curves).

    On an edge between faces the curvature that counts, -n.x_ss with n in the edge's normal cone,
    is not below that of the flatter face: n is a combination of the faces' normals with weights
    that sum to 1 or more. So the faces tell for all modes. A vertex has no parameter, hence no
    curvature to count.

    Raises TypeError: not a body.

    Parameters
    ----------
    body : Body
        Its swept radius is left out: witness points are tracked on the core.

    Returns
    -------
    LeastCurvature
        Planes, cylinders, cones, straight edges: 0. An ellipsoid of semi-axes a >= b >= c: c/a²,
        an ellipse likewise. Other kinds are searched.
    """
    check_body(body)
    found = [_of_face(body, k) for k in range(body.n_faces)]
    if not body.n_faces:
        found = [_of_edge(body, e.curve) for e in body.edge_parts]
    if not found:
        return LeastCurvature(math.inf, True)
    return min(found, key=lambda least: least.value)


def principal_curvatures(surface: Surface, u: float, v: float) -> tuple[float, float] | None:
    """(least, greatest) curvature towards f_u x f_v, 1/length; None at a pole of the surface.

    A sphere whose f_u x f_v points outwards has (-1/r, -1/r).

    Raises ValueError: not a surface, or a parameter that is not a finite number.

    Parameters
    ----------
    surface : Surface
    u, v : float
        Its parameters; angles in radians.

    Returns
    -------
    (float, float) or None
    """
    if not isinstance(surface, Surface):
        raise StandoffError(f"surface is {shown(surface)}: give a Surface.", "surface", surface)
    return _curvatures(surface, number(u, "u"), number(v, "v"))


def _curvatures(surface: Surface, u: float, v: float) -> tuple[float, float] | None:
    _, xu, xv, xuu, xuv, xvv = surface.jet(u, v)
    normal = np.cross(xu, xv)
    area = float(np.linalg.norm(normal))
    across = [float(np.linalg.norm(t)) * w for t, w in zip((xu, xv), _widths(surface), strict=True)]
    lengths = float(np.linalg.norm(xu) * np.linalg.norm(xv))
    if area <= POLE_AREA * lengths or min(across) <= POLE_AREA * max(across):
        return None
    first = np.array([[xu @ xu, xu @ xv], [xu @ xv, xv @ xv]])
    second = np.array([[xuu @ normal, xuv @ normal], [xuv @ normal, xvv @ normal]]) / area
    factor = np.linalg.inv(np.linalg.cholesky(first))
    low, high = np.linalg.eigvalsh(factor @ second @ factor.T)
    return float(low), float(high)


def _widths(surface: Surface) -> tuple[float, float]:
    """Ranges of u and v of a patch; 1 where they have no end."""
    u0, u1, v0, v1 = surface.domain
    return (u1 - u0, v1 - v0) if np.isfinite(surface.domain).all() else (1.0, 1.0)


def _of_face(body: Body, face: int) -> LeastCurvature:
    charts = body.face_parts[face].charts
    known = charts[0].least_curvature()
    if known is not None:
        return LeastCurvature(known, True)
    first = charts_of(body, face)[0]
    least = min(_search_chart(body, first + k, chart) for k, chart in enumerate(charts))
    return LeastCurvature(max(0.0, least), False)


def _search_chart(body: Body, number: int, surface: Surface) -> float:
    """The least curvature found on one packed chart, 1/length; inf where it has no sample."""
    row = int(body.ints[L.CHARTS]) + L.CHART_STRIDE * number
    outward = float(body.reals[int(body.ints[row + L.CHART_REALS]) + L.OUTWARD])

    def curvature(at: Array) -> float:
        if not on_face(body.ints, body.reals, number, at[0], at[1]):
            return math.inf
        both = _curvatures(surface, at[0], at[1])
        return math.inf if both is None else min(-outward * both[0], -outward * both[1])

    inside = _samples(body, number)
    boundary = [
        min(-outward * k for k in both)
        for both in (_curvatures(surface, *at) for at in _sides(body, number))
        if both is not None
    ]
    best = min(boundary, default=math.inf)
    if not len(inside):
        return best
    return min(best, _descend(curvature, inside))


def _samples(body: Body, chart: int) -> Array:
    """Parameters (n, 2) of a chart's boundary samples."""
    n, at = int(body.ints[L.N_SAMPLES]), int(body.ints[L.SAMPLES])
    owners = body.ints[at : at + 2 * n].reshape(n, 2)
    start = int(body.ints[L.SAMPLE_REALS])
    rows = body.reals[start : start + L.SAMPLE_STRIDE * n].reshape(n, L.SAMPLE_STRIDE)
    return np.asarray(rows[owners[:, 1] == chart][:, 6:8])


def _sides(body: Body, chart: int) -> Iterator[tuple[float, float]]:
    """Parameters along a chart's trimming curves."""
    for coedge in coedge_range(body, chart):
        curve = packed_pcurve(body, coedge)
        for t in np.linspace(curve.first, curve.last, SIDE_POINTS):
            u, v = coedge_parameters(body.ints, body.reals, coedge, t)[:2]
            yield float(u), float(v)


def _of_edge(body: Body, curve: Curve) -> LeastCurvature:
    """Of an edge without faces: a planar body's, or a core in space, whose normal may stand so
    that nothing of its curvature counts."""
    if body.dimension == 3 or isinstance(curve, Line):
        return LeastCurvature(0.0, True)
    if isinstance(curve, ConicArc):
        axes = np.linalg.svd(curve.basis()[:, :2], compute_uv=False)
        return LeastCurvature(float(axes[1] / axes[0] ** 2), True)

    def curvature(at: Array) -> float:
        t = float(np.clip(at[0], curve.first, curve.last))
        _, xt, xtt = curve.jet(t)
        return abs(float(xt[0] * xtt[1] - xt[1] * xtt[0])) / float(np.linalg.norm(xt)) ** 3

    starts = np.linspace(curve.first, curve.last, SIDE_POINTS)[:, None]
    return LeastCurvature(_descend(curvature, starts), False)


def _descend(function: Callable[[Array], float], starts: Array) -> float:
    """The least value found from the best of some starts, (n, 1 or 2)."""
    values = np.array([function(at) for at in starts])
    order = np.argsort(values)[:SEARCHES]
    scale = max(float(np.ptp(starts, axis=0).max()), SEARCH_TOLERANCE)
    options = {"xatol": SEARCH_TOLERANCE * scale, "fatol": 0.0, "maxiter": 200}
    least = float(values[order[0]])
    for k in order:
        shape = starts.shape[1]
        corners = np.vstack([np.zeros(shape), 0.1 * scale * np.eye(shape)])
        simplex = {**options, "initial_simplex": starts[k] + corners}
        found = scipy.optimize.minimize(function, starts[k], method="Nelder-Mead", options=simplex)
        least = min(least, float(found.fun))
    return least
