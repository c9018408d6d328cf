"""Surfaces and curves moved out by a radius, where the moved one is of an exact kind too."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from standoff.bodies.tolerances import EXACT_KIND
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.quadrics import Cone, Cylinder
from standoff.geometry.roundness import alike, round_arc, square
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Revolution
from standoff.geometry.torus import Torus
from standoff.kernels.body import layout as L
from standoff.typing import Array


class MovedSurface(NamedTuple):
    """A surface at a distance outside another.

    Attributes
    ----------
    surface : Surface
        A point of it has the parameters (u, v + `raised`) of the one that it was moved from.
    raised : float
        Of a cone, whose apex moves; 0 of all others.
    """

    surface: Surface
    raised: float = 0.0


def moved_surface(surface: Surface, outward: float, r: float) -> MovedSurface | None:
    """The surface at the distance r outside a convex face; None where it has no exact kind.

    outward : +1 where x_u × x_v points outward, else -1.
    """
    a, shift = surface.linear, surface.shift
    lengths = np.linalg.norm(a, axis=0)
    if surface.kind == L.PLANE:
        normal = np.cross(a[:, 0], a[:, 1])
        return MovedSurface(
            surface.transformed(np.eye(3), outward * r * normal / np.linalg.norm(normal))
        )
    if not (alike(lengths[0], lengths[1], EXACT_KIND) and square(a, EXACT_KIND)):
        return None
    if surface.kind == L.CYLINDER:
        grown = 1.0 + r / lengths[0]
        return MovedSurface(Cylinder(a * [grown, grown, 1.0], shift, surface.domain))
    if surface.kind == L.CONE:
        return _moved_cone(surface, r)
    if not alike(lengths[0], lengths[2], EXACT_KIND):
        return None
    scale = float(lengths[0])
    if surface.kind == L.SPHERE:
        grown = 1.0 + r / scale
        return MovedSurface(surface.transformed(grown * np.eye(3), (1.0 - grown) * shift))
    if isinstance(surface, Torus) and surface.bulge == 1:
        grown_torus = Torus(surface.major, surface.minor + r / scale, *surface.domain)
        return MovedSurface(grown_torus.transformed(a, shift))
    if isinstance(surface, Revolution):
        own = outward * float(np.sign(np.linalg.det(a)))
        profile = _moved_profile(surface, own, r / scale)
        if profile is not None:
            turned = Revolution(profile, *surface.domain[:2]).transformed(a, shift)
            return MovedSurface(turned.restricted(*surface.domain))
    return None


def _moved_cone(surface: Surface, r: float) -> MovedSurface:
    """With the same opening: its apex moves back by r / sin, where sin is that of half of it."""
    a, (u0, u1, v0, v1) = surface.linear, surface.domain
    radius, height = float(np.linalg.norm(a[:, 0])), float(np.linalg.norm(a[:, 2]))
    slant = float(np.hypot(radius, height))
    raised = r * height / (slant * radius)
    back = a[:, 2] / height * (r * slant / radius)
    return MovedSurface(
        Cone(a, surface.shift - back, (u0, u1, max(v0 + raised, 0.0), v1 + raised)), raised
    )


def _moved_profile(surface: Revolution, side: float, r: float) -> Curve | None:
    """A profile (x, 0, z) moved by r to its side along side * (z', 0, -x')."""
    profile, (_, _, v0, v1) = surface.profile, surface.domain
    middle = 0.5 * (v0 + v1)
    x, rate, _ = profile.jet(middle)
    out = side * np.array([rate[2], 0.0, -rate[0]]) / np.hypot(rate[0], rate[2])
    if isinstance(profile, Line):
        return Line(profile.point(0.0) + r * out, profile.point(1.0) + r * out)
    if isinstance(profile, ConicArc) and round_arc(profile, EXACT_KIND):
        p, q, centre = profile.basis().T
        radius = float(np.linalg.norm(p))
        grown = 1.0 + r * float(np.sign(out @ (x - centre))) / radius
        return ConicArc(centre, grown * p, grown * q, v0, v1) if grown > 1.0 else None
    return None


def moved_edge(curve: Curve, normals: Array, spots: Array, r: float) -> Curve | None:
    """A curve of a face moved out by r, with the same parameter; None where the face's unit
    normals (n, 3) at its parameters `spots` do not make the moved one a line or an arc."""
    if isinstance(curve, Line):
        n = normals[len(normals) // 2]
        if np.abs(normals - n).max() > EXACT_KIND:
            return None
        return Line(curve.point(0.0) + r * n, curve.point(1.0) + r * n)
    if not (isinstance(curve, ConicArc) and round_arc(curve, EXACT_KIND)):
        return None
    a, b, centre = curve.basis().T
    radius = float(np.linalg.norm(a))
    axis = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    radial = (np.outer(np.cos(spots), a) + np.outer(np.sin(spots), b)) / radius
    out, up = np.einsum("ij,ij->i", normals, radial), normals @ axis
    if max(np.ptp(out), np.ptp(up), np.abs(np.hypot(out, up) - 1.0).max()) > EXACT_KIND:
        return None
    grown = 1.0 + r * float(out.mean()) / radius
    centre = centre + r * float(up.mean()) * axis
    return ConicArc(centre, grown * a, grown * b, curve.first, curve.last)
