"""Surfaces of OpenCASCADE as the library's own: analytic kinds stay what they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from standoff.bodies.tolerances import DOMAIN_SPARE
from standoff.cad.curves import NoExactForm, converted, repeated
from standoff.cad.opencascade import coordinates, frame_of
from standoff.cad.tolerances import FITTED_TRIM, OFF_PLANE_PROFILE
from standoff.geometry.bernstein import basis as bernstein
from standoff.geometry.bernstein import segment
from standoff.geometry.curves import FULL_TURN, ConicArc, Curve, Line
from standoff.geometry.knots import GREATEST_DEGREE, KnotVector, bezier_spans
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.quadrics import Cone, Cylinder, Plane, Sphere
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution
from standoff.geometry.torus import Torus
from standoff.typing import Array

# How far beyond its trimming curves' ends a spline goes on, and at most, in its last span.
GROWTH, MOST_GROWTH = 1.5, 0.02

Range = tuple[float, float, float, float]
Angles = tuple[bool, bool]
IDENTITY = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class Carrier:
    """A face's surface.

    Attributes
    ----------
    kind : str
        "plane", "cylinder", "cone", "sphere", "torus", "revolution", "extrusion" or "spline".
    surface : Surface
    to_own : (2, 3) array
        Own (u, v) as an affine map of the file's.
    inverse : function or None
        (n, 3) points near the surface to (n, 2) parameters, angles within (-pi, pi]; None for kinds
        without a closed form.
    angles : (bool, bool)
        Which of u and v is an angle.
    moved : float
        How far the surface is from the file's, length.
    """

    kind: str
    surface: Surface
    to_own: Array
    inverse: Callable[[Array], Array] | None = None
    angles: Angles = (False, False)
    moved: float = 0.0

    def own(self, uv: Array) -> Array:
        """Own parameters of the file's, (n, 2)."""
        return np.asarray(uv @ self.to_own[:, :2].T + self.to_own[:, 2])


def basis_surface(geometry: Any) -> Any:
    """A surface without its trims."""
    while geometry.DynamicType().Name() == "Geom_RectangularTrimmedSurface":
        geometry = geometry.BasisSurface()
    return geometry


def carrier(geometry: Any, over: Range) -> Carrier:
    """The surface of a face with these ranges of the file's parameters.

    Raises NoExactForm: an offset surface, a profile that is not in a plane of its axis, a spline of
    too high a degree.
    """
    geometry = basis_surface(geometry)
    kind = geometry.DynamicType().Name().removeprefix("Geom_")
    made = MAKERS.get(kind)
    if made is None:
        raise NoExactForm(f"a surface of the kind {kind} has no exact form here")
    return made(geometry, over)


def _plane(geometry: Any, over: Range) -> Carrier:
    axes, origin = frame_of(geometry.Position())
    surface = Plane.through(origin, axes[:, 0], axes[:, 1])
    return Carrier("plane", surface, IDENTITY, lambda p: (p - origin) @ axes[:, :2])


def _cylinder(geometry: Any, over: Range) -> Carrier:
    axes, origin = frame_of(geometry.Position())
    radius = geometry.Radius()

    def inverse(points: Array) -> Array:
        y = (points - origin) @ axes / radius
        return np.column_stack([np.arctan2(y[:, 1], y[:, 0]), y[:, 2]])

    to_own = np.array([[1.0, 0.0, 0.0], [0.0, 1.0 / radius, 0.0]])
    surface = Cylinder(radius * axes, origin)
    return Carrier("cylinder", surface, to_own, inverse, (True, False))


def _cone(geometry: Any, over: Range) -> Carrier:
    """Own v is the distance from the axis over a scale; the nappe on which it is negative is
    turned half about the axis."""
    axes, origin = frame_of(geometry.Position())
    angle, radius = geometry.SemiAngle(), geometry.RefRadius()
    sine, slope = np.sin(angle), 1.0 / np.tan(angle)
    nappe = 1.0 if radius + 0.5 * (over[2] + over[3]) * sine >= 0.0 else -1.0
    scale = max(abs(radius + v * sine) for v in over[2:])
    apex = origin - radius * slope * axes[:, 2]
    linear = nappe * scale * axes * [1.0, 1.0, slope]
    back = np.linalg.inv(linear)

    def inverse(points: Array) -> Array:
        y = (points - apex) @ back.T
        # the foot of the perpendicular on the generator, whose direction is (1, slope)
        along = (np.hypot(y[:, 0], y[:, 1]) + slope**2 * y[:, 2]) / (1.0 + slope**2)
        return np.column_stack([np.arctan2(y[:, 1], y[:, 0]), along])

    to_own = np.array([[1.0, 0.0, 0.0], [0.0, nappe * sine / scale, nappe * radius / scale]])
    return Carrier("cone", Cone(linear, apex), to_own, inverse, (True, False))


def _sphere(geometry: Any, over: Range) -> Carrier:
    axes, origin = frame_of(geometry.Position())
    axes = np.column_stack([axes[:, 0], axes[:, 1], np.cross(axes[:, 0], axes[:, 1])])
    surface = Sphere(geometry.Radius() * axes, origin)
    return Carrier("sphere", surface, IDENTITY)


def _torus(geometry: Any, over: Range) -> Carrier:
    axes, origin = frame_of(geometry.Position())
    major, minor = geometry.MajorRadius(), geometry.MinorRadius()
    v0, v1 = over[2], min(over[3], over[2] + FULL_TURN)
    if major + minor * np.cos(0.5 * (v0 + v1)) < 0.0:
        return _lemon(axes, origin, major, minor, v0, v1)
    surface = Torus(major, minor, 0.0, FULL_TURN, v0, v1).transformed(axes, origin)

    def inverse(points: Array) -> Array:
        y = (points - origin) @ axes
        out = np.hypot(y[:, 0], y[:, 1]) - major
        return np.column_stack([np.arctan2(y[:, 1], y[:, 0]), np.arctan2(y[:, 2], out)])

    return Carrier("torus", surface, IDENTITY, inverse, (True, True))


def _lemon(axes: Array, origin: Array, major: float, minor: float, v0: float, v1: float) -> Carrier:
    """The inner part of a torus that meets its axis: its arc rotated, half a turn on."""
    x, z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    surface = Revolution(ConicArc(-major * x, -minor * x, minor * z, v0, v1))
    to_own = np.array([[1.0, 0.0, np.pi], [0.0, 1.0, 0.0]])

    def inverse(points: Array) -> Array:
        y = (points - origin) @ axes
        out = np.hypot(y[:, 0], y[:, 1]) + major
        return np.column_stack([np.arctan2(y[:, 1], y[:, 0]), np.arctan2(y[:, 2], -out)])

    return Carrier("torus", surface.transformed(axes, origin), to_own, inverse, (True, True))


def _spline(geometry: Any, over: Range) -> Carrier:
    if geometry.DynamicType().Name() == "Geom_BezierSurface":
        from OCP.GeomConvert import GeomConvert

        geometry = GeomConvert.SurfaceToBSplineSurface_s(geometry)
    geometry = geometry.Copy()
    whole = list(geometry.Bounds())
    periods = [0.0, 0.0]
    for k, periodic in enumerate((geometry.IsUPeriodic(), geometry.IsVPeriodic())):
        if periodic:
            periods[k] = whole[2 * k + 1] - whole[2 * k]
            whole[2 * k : 2 * k + 2] = over[2 * k : 2 * k + 2]
    if any(periods):
        geometry.CheckAndSegment(*whole)
    if geometry.IsUPeriodic():
        geometry.SetUNotPeriodic()
    if geometry.IsVPeriodic():
        geometry.SetVNotPeriodic()
    points, weights, knots_u, knots_v = _net(geometry)
    for k, (period, knots) in enumerate(zip(periods, (knots_u, knots_v), strict=True)):
        if period:  # what is cut out may be told a period further on than was asked
            knots -= period * np.round((knots[0] - over[2 * k]) / period)
    moved = 0.0
    if max(geometry.UDegree(), geometry.VDegree()) > GREATEST_DEGREE:
        points, weights, knots_u, knots_v, moved = lowered(points, weights, knots_u, knots_v)
    surface = NurbsSurface(points, knots_u, knots_v, weights)
    return Carrier("spline", surface, IDENTITY, moved=moved)


def _net(geometry: Any) -> tuple[Array, Array | None, Array, Array]:
    n, m = geometry.NbUPoles(), geometry.NbVPoles()
    us, vs = range(1, n + 1), range(1, m + 1)
    points = np.array([[coordinates(geometry.Pole(i, j)) for j in vs] for i in us])
    weights = None
    if geometry.IsURational() or geometry.IsVRational():
        weights = np.array([[geometry.Weight(i, j) for j in vs] for i in us])
    us, vs = range(1, geometry.NbUKnots() + 1), range(1, geometry.NbVKnots() + 1)
    knots_u = repeated([geometry.UKnot(k) for k in us], [geometry.UMultiplicity(k) for k in us])
    knots_v = repeated([geometry.VKnot(k) for k in vs], [geometry.VMultiplicity(k) for k in vs])
    return points, weights, knots_u, knots_v


def grown(on: Carrier, low: Array, high: Array) -> Carrier:
    """The same with a spline that goes on beyond its domain as what it is there, up to the lowest
    and highest parameters, (2,) each, that its trimming curves have."""
    made = on.surface
    if not isinstance(made, NurbsSurface):
        return on
    for axis, last in ((0, False), (0, True), (1, False), (1, True)):
        vector = (made.vector_u, made.vector_v)[axis]
        a, b = (float(t) for t in (vector.breaks[-2:] if last else vector.breaks[:2]))
        beyond = float(high[axis] - b if last else a - low[axis])
        if not DOMAIN_SPARE * (b - a) < beyond < MOST_GROWTH * (b - a):
            continue
        degree, inner = vector.degree, a if last else b
        times = 0 if len(vector.breaks) == 2 else degree - int(np.sum(vector.knots == inner))
        made = made.refined(**{("knots_u", "knots_v")[axis]: [inner] * times})
        weights = made.weights[..., None]
        net = np.moveaxis(np.concatenate([made.control_points * weights, weights], 2), axis, 0)
        knots = [made.knots_u.copy(), made.knots_v.copy()]
        share = GROWTH * beyond / (b - a)
        rows = slice(-degree - 1, None) if last else slice(degree + 1)
        matrix = segment(degree, 0.0, 1.0 + share) if last else segment(degree, -share, 1.0)
        net[rows] = np.tensordot(matrix, net[rows], 1)
        knots[axis][rows] = b + share * (b - a) if last else a - share * (b - a)
        net = np.moveaxis(net, 0, axis)
        made = NurbsSurface(net[..., :3] / net[..., 3:], knots[0], knots[1], net[..., 3])
    return replace(on, surface=made)


def _extrusion(geometry: Any, over: Range) -> Carrier:
    profile = converted(geometry.BasisCurve(), over[0], over[1])
    if not profile.affine:
        raise NoExactForm("an extruded hyperbola or parabola")
    direction = coordinates(geometry.Direction())
    surface = Extrusion(profile.curve, direction, over[2], over[3])
    to_own = np.array([[profile.scale, 0.0, profile.shift], [0.0, 1.0, 0.0]])
    return Carrier("extrusion", surface, to_own, angles=(surface.periodic, False))


def _revolution(geometry: Any, over: Range) -> Carrier:
    profile = converted(geometry.BasisCurve(), over[2], over[3])
    if not profile.affine:
        raise NoExactForm("a rotated hyperbola or parabola")
    axis = geometry.Axis()
    z, origin = coordinates(axis.Direction()), coordinates(axis.Location())
    curve = profile.curve
    ts = np.linspace(curve.first, curve.last, 33)
    points = np.array([curve.point(float(t)) for t in ts]) - origin
    out = points - np.outer(points @ z, z)
    far = out[int(np.linalg.norm(out, axis=1).argmax())]
    x = far / np.linalg.norm(far)
    axes = np.column_stack([x, np.cross(z, x), z])
    flat = curve.transformed(axes.T, -axes.T @ origin)
    extent = float(np.ptp(points, axis=0).max())
    flat, moved = _into_plane(flat, extent)
    surface = Revolution(flat).transformed(axes, origin)
    to_own = np.array([[1.0, 0.0, 0.0], [0.0, profile.scale, profile.shift]])
    return Carrier("revolution", surface, to_own, angles=(True, False), moved=moved)


def _into_plane(curve: Curve, extent: float) -> tuple[Curve, float]:
    """A profile moved into y = 0, and how far at most.

    A curve stays within the hull of its control points, and a line or arc within the sum of its
    frame's lengths.
    """
    if isinstance(curve, NurbsCurve):
        points = curve.control_points.copy()
        moved = float(np.abs(points[:, 1]).max())
        points[:, 1] = 0.0
        made: Curve = NurbsCurve(points, curve.knots, curve.weights)
    elif isinstance(curve, Line):
        ends = np.array([curve.point(0.0), curve.point(1.0)])
        moved = float(np.abs(ends[:, 1]).max())
        ends[:, 1] = 0.0
        made = Line(*ends)
    else:
        a, b, centre = curve.basis().T
        moved = float(abs(a[1]) + abs(b[1]) + abs(centre[1]))
        flat = [v * [1.0, 0.0, 1.0] for v in (centre, a, b)]
        made = ConicArc(flat[0], flat[1], flat[2], curve.first, curve.last)
    if moved > OFF_PLANE_PROFILE * extent:
        raise NoExactForm(
            f"a surface of revolution whose profile leaves the plane of its axis by {moved:.3g}"
        )
    return made, moved


KINDS = {
    "Plane": "plane",
    "CylindricalSurface": "cylinder",
    "ConicalSurface": "cone",
    "SphericalSurface": "sphere",
    "ToroidalSurface": "torus",
    "BSplineSurface": "spline",
    "BezierSurface": "spline",
    "SurfaceOfLinearExtrusion": "extrusion",
    "SurfaceOfRevolution": "revolution",
    "OffsetSurface": "offset",
}


def kind_of(face: Any) -> str:
    """The kind of a face's surface, as reports name it."""
    from OCP.BRep import BRep_Tool

    name: str = basis_surface(BRep_Tool.Surface_s(face)).DynamicType().Name()
    return KINDS.get(name.removeprefix("Geom_"), name)


MAKERS: dict[str, Callable[[Any, Range], Carrier]] = {
    "Plane": _plane,
    "CylindricalSurface": _cylinder,
    "ConicalSurface": _cone,
    "SphericalSurface": _sphere,
    "ToroidalSurface": _torus,
    "BSplineSurface": _spline,
    "BezierSurface": _spline,
    "SurfaceOfLinearExtrusion": _extrusion,
    "SurfaceOfRevolution": _revolution,
}


# Spline surfaces of too high a degree, as near ones of a lower degree with a proven bound.

LOWER = 8
"""The degree in place of one that is too high."""
MOST_PARTS = 16
"""Parts of each span at most."""

Net = tuple[Array, Array | None, Array, Array, float]


def lowered(points: Array, weights: Array | None, knots_u: Array, knots_v: Array) -> Net:
    """(points, weights, knots_u, knots_v, moved) of a spline of degrees that the kernels have.

    Each span is cut into as many equal parts as it needs and interpolated at Chebyshev points,
    sides included, so that neighbours keep their common side. `moved` is a bound of how far it is
    from the given one, length: from the differences of the Bernstein coefficients, which enclose
    that of the surfaces.
    """
    w = np.ones(points.shape[:2]) if weights is None else weights
    h = np.concatenate([points * w[..., None], w[..., None]], axis=2)
    size = float(np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0)))
    moved = 0.0
    knots = [knots_u, knots_v]
    for axis in (0, 1):
        degree = len(knots[axis]) - h.shape[axis] - 1
        if degree <= GREATEST_DEGREE:
            continue
        net = np.moveaxis(h, axis, 0)
        vector = KnotVector(knots[axis], degree)
        parts = np.ones(len(vector.breaks) - 1, dtype=np.int64)
        while True:
            found, own, off = _lowered(net, vector, parts)
            far = np.array([_distance(away, found, points) for away in off])
            again = (far > FITTED_TRIM * size) & (parts < MOST_PARTS)
            if not again.any():
                break
            parts[again] *= 2
        h, knots[axis], moved = np.moveaxis(found, 0, axis), own, moved + float(far.max())
    polynomial = weights is None
    return h[..., :3] / h[..., 3:], None if polynomial else h[..., 3], knots[0], knots[1], moved


def _lowered(
    net: Array, vector: KnotVector, parts: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """(net, knots, off) along the first axis, each span in so many parts; off: of each span, the
    greatest differences of the components of homogeneous coefficients, (spans, 4)."""
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(LOWER + 1) / LOWER)
    nodes[0], nodes[-1] = 0.0, 1.0
    solve = np.linalg.inv(bernstein(LOWER, nodes)) @ bernstein(vector.degree, nodes)
    solve[0], solve[-1] = np.eye(vector.degree + 1)[[0, -1]]
    raised = _elevation(LOWER, vector.degree)
    rows: list[Array] = []
    breaks, off = [], np.zeros((len(parts), 4))
    spans = zip(bezier_spans(vector), pairwise(vector.breaks), strict=True)
    for k, ((start, matrix), (a, b)) in enumerate(spans):
        whole = np.tensordot(matrix, net[start : start + vector.degree + 1], 1)
        for first, last in pairwise(np.linspace(0.0, 1.0, int(parts[k]) + 1)):
            part = np.tensordot(segment(vector.degree, float(first), float(last)), whole, 1)
            low = np.tensordot(solve, part, 1)
            away = np.abs(np.tensordot(raised, low, 1) - part)
            off[k] = np.maximum(off[k], away.reshape(-1, 4).max(axis=0))
            rows.append(low if not rows else low[1:])
            breaks.append(a + first * (b - a))
    breaks.append(float(vector.breaks[-1]))
    ends = np.array(breaks)
    knots = np.concatenate([ends[:1], np.repeat(ends, LOWER), ends[-1:]])
    return np.concatenate(rows), knots, off


def _elevation(low: int, high: int) -> Array:
    """(high + 1, low + 1): Bernstein coefficients of a higher degree from those of a lower one."""
    i, j = np.arange(high + 1)[:, None], np.arange(low + 1)
    comb = scipy.special.comb
    return np.asarray(comb(low, j) * comb(high - low, i - j) / comb(high, i))


def _distance(off: Array, net: Array, points: Array) -> float:
    """How far points may move if their homogeneous coordinates change by `off`, length."""
    reach = float(np.linalg.norm(points.reshape(-1, 3), axis=1).max())
    least = float(net[..., 3].min()) - float(off[3])
    return (float(np.linalg.norm(off[:3])) + reach * float(off[3])) / least
