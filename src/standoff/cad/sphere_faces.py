"""Faces of spheres: one gnomonic chart where trimming curves must be fitted, else an atlas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from standoff.cad.measures import area_of
from standoff.cad.opencascade import forward, frame_of
from standoff.cad.surfaces import IDENTITY, Carrier
from standoff.cad.tolerances import SPHERE_DEPTH
from standoff.cad.trims import fit, near_enough
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.quadrics import Sphere, sphere_atlas
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Revolution
from standoff.typing import Array

# Points of each edge that a chart must see.
SEEN = 17


def sphere_charts(
    sphere: Surface, curves: Sequence[Curve], face: Any, size: float
) -> tuple[tuple[Surface, ...], list[Pcurve | None]]:
    """The charts of a face, and its trimming curves; none for a face of about a hemisphere or
    more with edges that are not circles."""
    if all(isinstance(curve, ConicArc | Line) for curve in curves):
        return sphere_atlas(sphere.linear, sphere.shift), [None] * len(curves)
    chart = _chart(sphere, curves, face)
    if chart is None:
        return (), []
    back = np.linalg.inv(chart.linear)

    def inverse(points: Array) -> Array:
        y = (points - chart.shift) @ back.T
        return np.asarray(y[:, :2] / y[:, 2:])

    on = Carrier("sphere", chart, IDENTITY, inverse)

    def fitted(curve: Curve) -> Pcurve:
        def places(ts: Array) -> Array:
            return inverse(curve.points(ts))

        return fit(curve, on, places, None, near_enough(curve, chart, places, size))

    return (chart,), [None if isinstance(c, ConicArc | Line) else fitted(c) for c in curves]


def sphere_by_angles(geometry: Any, over: tuple[float, ...]) -> Carrier:
    """A sphere as an arc rotated: longitude and latitude, as the file has them."""
    axes, origin = frame_of(geometry.Position())
    radius = geometry.Radius()
    x, z = radius * np.eye(3)[0], radius * np.eye(3)[2]
    surface = Revolution(ConicArc(np.zeros(3), x, z, over[2], over[3])).transformed(axes, origin)

    def inverse(points: Array) -> Array:
        y = (points - origin) @ axes
        out = np.hypot(y[:, 0], y[:, 1])
        return np.column_stack([np.arctan2(y[:, 1], y[:, 0]), np.arctan2(y[:, 2], out)])

    return Carrier("sphere", surface, IDENTITY, inverse, (True, False))


def _chart(sphere: Surface, curves: Sequence[Curve], face: Any) -> Sphere | None:
    """The chart about the middle of a face, if it sees all of it."""
    radius = float(np.linalg.norm(sphere.linear[:, 0]))
    if area_of(face) >= 2.0 * np.pi * radius**2:
        return None
    ts = np.linspace(0.0, 1.0, SEEN)
    rim = np.array([c.point(c.first + s * (c.last - c.first)) for c in curves for s in ts])
    rim = (rim - sphere.shift) / radius
    axis = rim.mean(axis=0)
    length = float(np.linalg.norm(axis))
    if length == 0.0 or (rim @ axis).min() < SPHERE_DEPTH * length:
        return None
    z = axis / length
    x = np.cross(z, np.eye(3)[int(np.abs(z).argmin())])
    x = x / np.linalg.norm(x)
    return Sphere(radius * np.column_stack([x, np.cross(z, x), z]), sphere.shift)


def sphere_sense(geometry: Any, face: Any) -> int:
    """+1 if a face's outside is away from the centre."""
    direct = 1 if geometry.Position().Direct() else -1
    return direct if forward(face) else -direct


__all__ = ["sphere_charts", "sphere_sense"]
