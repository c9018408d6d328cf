"""How far trimming curves miss their edges: bounds of all kinds beside dense samples."""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

pytest.importorskip("OCP", reason="OpenCASCADE comes with the extra 'cad'")

from standoff.cad.miss_bounds import miss_bound, misses
from standoff.geometry.bernstein import basis
from standoff.geometry.curves import ConicArc, Curve, Line
from standoff.geometry.nurbs import NurbsSurface
from standoff.geometry.nurbs_curves import NurbsCurve
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.quadrics import Cone, Cylinder, Plane, Sphere
from standoff.geometry.surfaces import Surface
from standoff.geometry.swept import Extrusion, Revolution
from standoff.geometry.torus import Torus
from standoff.kernels.body import layout as L

SIZE = 5.0
KNOTS = np.array([0.0] * 4 + [0.3, 0.3, 0.55, 0.8] + [1.0] * 4)


@cache
def surfaces() -> dict[str, Surface]:
    rng = np.random.default_rng(7)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    grid = np.stack(np.meshgrid(np.linspace(0, 2, 8), np.linspace(0, 2, 8), indexing="ij"), -1)
    net = np.concatenate([grid, 0.4 * rng.normal(size=(8, 8, 1))], axis=2)
    profile = np.column_stack([1.0 + 0.3 * rng.uniform(size=8), np.zeros(8), np.linspace(0, 2, 8)])
    weights = rng.uniform(0.5, 1.5, 8)
    line = Line((1.0, 0.0, 0.0), (1.4, 0.0, 2.0))
    arc = ConicArc((3.0, 0.0, 0.0), (0.8, 0.0, 0.1), (-0.1, 0.0, 0.9), 0.0, 1.2)
    found: dict[str, Surface] = {
        "plane": Plane(turn * [0.7, 1.0, 1.0], turn[0]),
        "cylinder": Cylinder(turn * 1.3, turn[0]),
        "oval": Cylinder(turn @ np.diag([2.0, 0.5, 1.0]), turn[0]),
        "cone": Cone(turn * [0.6, 0.6, 1.1], turn[1]),
        "torus": Torus(2.0, 1.7).transformed(turn, turn[2]),
        "sphere": Sphere(turn * 1.5, turn[0]),
        "ellipsoid": Sphere(turn @ np.diag([1.5, 1.0, 0.8]), turn[0]),
        "spline": NurbsSurface(net, KNOTS, KNOTS),
        "rational": NurbsSurface(net, KNOTS, KNOTS, np.outer(weights, weights[::-1])),
    }
    profiles = {"line": line, "arc": arc, "spline": NurbsCurve(profile, KNOTS)}
    profiles["rational"] = NurbsCurve(profile, KNOTS, weights)
    for name, curve in profiles.items():
        found[f"turned {name}"] = Revolution(curve).transformed(turn, turn[1])
        found[f"drawn {name}"] = Extrusion(curve, (0.2, 1.0, 0.1)).transformed(turn, turn[1])
    return found


def trims(rng: Generator, surface: Surface) -> list[Pcurve]:
    """A slanted line, one along u or v, a polynomial and a rational spline, across knots."""
    low, high = (0.15, 0.15), (0.85, 0.85)
    a, b = rng.uniform(low, high), rng.uniform(low, high)
    along = np.array([b[0], a[1]])
    lines = [
        Pcurve(L.LINE, np.vstack([np.column_stack([end - a, np.zeros(2), a]), [0.0, 0.0, 1.0]]))
        for end in (b, along)
    ]
    s = np.linspace(0.0, 1.0, 6)[:, None]
    points = a + s * (b - a) + 0.1 * rng.normal(size=(6, 2)) * s * (1.0 - s)
    knots = [0.0] * 4 + [0.35, 0.6] + [1.0] * 4
    return [
        *lines,
        NurbsPcurve(points, knots),
        NurbsPcurve(points, knots, rng.uniform(0.6, 1.4, 6)),
    ]


def edges(rng: Generator, pcurve: Pcurve, surface: Surface) -> list[Curve]:
    """Near the trimming curve's image: splines that take points of it, a line and an arc."""
    degree = 5
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
    points = np.linalg.solve(basis(degree, nodes), surface.points(pcurve.places(nodes)))
    knots = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    one, other = surface.points(pcurve.places(np.array([0.0, 1.0])))
    far = 1e-3 * rng.normal(size=points.shape)
    return [
        NurbsCurve(points, knots),
        NurbsCurve(points + far, knots, rng.uniform(0.8, 1.2, degree + 1)),
        Line(one, other),
        ConicArc(one - (other - one), other - one, rng.normal(size=3), 0.0, 1.0),
    ]


@pytest.mark.parametrize("name", sorted(surfaces()))
def test_a_bound_is_above_all_samples_and_near_the_greatest(name: str, rng: Generator) -> None:
    surface = surfaces()[name]
    ts = np.linspace(0.0, 1.0, 4001)
    for pcurve in trims(rng, surface):
        for curve in edges(rng, pcurve, surface):
            at = float(misses(pcurve, curve, surface, ts).max())
            bound = miss_bound(pcurve, curve, surface, SIZE)
            case = f"{type(pcurve).__name__} {type(curve).__name__}: {at:.3g}, {bound:.3g}"
            assert bound >= at - 1e-14, case
            # an ellipsoid's is stretched by its axes, and what is far from one has none
            loose = 2.0 if name == "ellipsoid" else 1.15
            if isinstance(surface, Sphere) and isinstance(curve, Line | ConicArc):
                loose = np.inf
            assert bound <= loose * at + 4e-10 * SIZE, case


@pytest.mark.parametrize(("degree", "place"), list(product([3, 9], [0.07, 0.5, 0.93])))
def test_a_narrow_bump_is_seen(degree: int, place: float) -> None:
    """A spline that leaves a plane within a span of 1e-4 only."""
    half = 5e-5
    inner = np.linspace(place - half, place + half, degree + 3)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    count = len(knots) - degree - 1
    greville = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(count)])
    points = np.column_stack([greville, np.zeros_like(greville), np.zeros_like(greville)])
    points[len(points) // 2, 2] = 1e-5
    curve = NurbsCurve(points, knots)
    plane = Plane(np.eye(3), np.zeros(3))
    line = Pcurve(L.LINE, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    ts = np.linspace(place - half, place + half, 2001)
    at = float(misses(line, curve, plane, ts).max())
    assert at > 1e-6
    assert at <= miss_bound(line, curve, plane, 1.0) <= 1.15 * at


def test_what_has_no_bound_says_so() -> None:
    conic = Pcurve(L.CONIC, np.array([[0.1, 0.0, 0.5], [0.0, 0.1, 0.5], [0.0, 0.0, 1.0]]))
    curve: Any = ConicArc((0, 0, 0), (1, 0, 0), (0, 1, 0), 0.0, 1.0)
    assert miss_bound(conic, curve, surfaces()["spline"], SIZE) == np.inf
