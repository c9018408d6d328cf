"""Trimming curves where u is an angle: wherever loops lie, the face is what one period shows."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from numpy.random import Generator

from standoff.bodies.packing import Assembled, Chart, Coedge, pack
from standoff.bodies.periods import PERIOD, in_one_period, is_rim
from standoff.bodies.topology import Edge, Face
from standoff.errors import BodyError
from standoff.geometry import (
    ConicArc,
    Cylinder,
    Extrusion,
    NurbsCurve,
    NurbsSurface,
    Revolution,
    Torus,
)
from standoff.geometry.nurbs_pcurves import NurbsPcurve
from standoff.geometry.pcurves import Pcurve
from standoff.geometry.surfaces import Surface
from standoff.kernels.body import layout as L
from standoff.kernels.body import trimming
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.entries.queries import on_face
from standoff.typing import Array

CYLINDER = Cylinder(np.eye(3), np.zeros(3))
CIRCLE = ConicArc(np.zeros(3), *np.eye(3)[:2])
EDGE, WALKS = 0.8, 20
# Holes (u, v, half axis along u, along v): in the middle, over the ends of the usual periods, some
# turns away, nearly all round, and so many that no angle is free.
HOLES: dict[str, list[tuple[float, float, float, float]]] = {
    "none": [],
    "in the middle": [(2.0, 0.1, 0.7, 0.3)],
    "across 0": [(0.0, 0.0, 0.5, 0.4)],
    "across pi": [(np.pi, 0.2, 0.9, 0.2)],
    "two turns away": [(12.0, -0.1, 0.6, 0.3), (-9.0, 0.3, 0.4, 0.2)],
    "nearly all round": [(1.0, 0.0, 3.0, 0.4)],
    "no angle free": [(k * 1.2, -0.3 if k % 2 else 0.3, 0.7, 0.2) for k in range(6)],
}


at: Any = pointer
walked: Any = trimming.walk_face


@numba.njit
def walk_face(ints: Any, reals: Any, u: float, v: float, du: float, dv: float) -> Any:
    return walked(at(ints, 0), at(reals, 0), 0, u, v, du, dv)


def ring(u: float, v: float, a: float, b: float) -> NurbsPcurve:
    """An ellipse about (u, v), in (u, v)."""
    corners = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    weights = [1.0, np.sqrt(0.5)] * 4 + [1.0]
    knots = np.repeat(np.arange(5.0), [3, 2, 2, 2, 3])
    return NurbsPcurve(np.array([u, v]) + np.array(corners) * [a, b], knots, weights)


def wave(start: float, gap: float = 0.0) -> NurbsPcurve:
    """A rim near v = EDGE that goes up and down, once round from `start` on but for a gap."""
    rises = EDGE + 0.15 * np.array([0.0, 1.0, 0.0, -1.0, 0.0])
    along = np.linspace(start + 0.5 * gap, start + PERIOD - 0.5 * gap, 5)
    points = np.column_stack([along, rises])
    return NurbsPcurve(points, [0.0] * 4 + [0.5] + [1.0] * 4)


def level(v: float, start: float) -> Pcurve:
    return Pcurve(L.LINE, np.array([[1.0, 0.0, start], [0.0, 0.0, v], [0.0, 0.0, 1.0]]))


def banded(
    holes: list[tuple[float, float, float, float]], upper: Pcurve, lower: float = 0.3
) -> Chart:
    """A band from v = -EDGE, a rim that begins at u = lower, to another rim, with holes."""
    pcurves = [(level(-EDGE, lower), 1, (0.0, PERIOD))]
    pcurves += [(upper, -1, (0.0, PERIOD if upper.kind == L.LINE else 1.0))]
    pcurves += [(ring(*hole), -1, (0.0, 4.0)) for hole in holes]
    coedges = [
        Coedge(k, piece, first, last, side, k)
        for k, (pcurve, side, ends) in enumerate(pcurves)
        for piece, first, last in pcurve.pieces(*ends)
    ]
    return Chart(CYLINDER, 0, coedges=coedges)


def packed(chart: Chart) -> tuple[Any, Array]:
    edges = [Edge(CIRCLE)] * (1 + max(c.edge for c in chart.coedges))
    loop = tuple((k, 1) for k in range(len(edges)))
    parts = Assembled(3, np.zeros((0, 3)), edges, [Face((CYLINDER,), loop)], [chart])
    return pack(parts, [], (-np.ones(3), np.ones(3)), 0.0, 0.0)


def signed(holes: list[tuple[float, float, float, float]], upper: Pcurve, places: Array) -> Array:
    """Positive on the face, by about how much in (u, v); of places (n, 2)."""
    u, v = places.T
    top = np.full(len(u), EDGE)
    if upper.kind != L.LINE:
        spots = upper.homogeneous_at(np.linspace(0.0, 1.0, 2001))[:, 0, :2]
        top = np.interp((u - spots[0, 0]) % PERIOD + spots[0, 0], *spots.T)
    found = np.minimum(v + EDGE, top - v)
    for at, height, a, b in holes:
        off = (u - at + np.pi) % PERIOD - np.pi
        for turn in (-PERIOD, 0.0, PERIOD):
            found = np.minimum(found, np.hypot((off + turn) / a, (v - height) / b) - 1.0)
    return np.asarray(found)


UPPER = {"level": level(EDGE, 2.0), "wave": wave(0.0), "turned wave": wave(-1.0)}


@pytest.mark.parametrize("upper", UPPER)
@pytest.mark.parametrize("name", HOLES)
def test_a_face_is_the_same_in_every_period(name: str, upper: str, rng: Generator) -> None:
    holes, top = HOLES[name], UPPER[upper]
    chart = banded(holes, top)
    in_one_period(chart)
    ints, reals = packed(chart)
    repeats = all(is_rim(c) for c in chart.coedges)
    assert (chart.period is None) == repeats == (name == "none" and upper == "level")
    if not repeats:
        assert chart.period is not None
        for c in chart.coedges:
            us = [c.pcurve.point(t)[0] for t in np.linspace(c.first, c.last, 50)]
            assert chart.period - 1e-11 <= min(us) <= max(us) <= chart.period + PERIOD + 1e-11
    places = rng.uniform((-11.0, -1.0), (11.0, 1.0), (200, 2))
    true = signed(holes, top, places)
    for (u, v), by in zip(places.tolist(), true, strict=True):
        if abs(by) > 1e-4:
            assert on_face(ints, reals, 0, u, v) == (by > 0.0), (u, v)
    steps = np.linspace(0.0, 1.0, 801)
    starts = places[true > 1e-3][:WALKS]
    for (u, v), (du, dv) in zip(
        starts, rng.uniform(-1.0, 1.0, (WALKS, 2)) * [5.0, 1.0], strict=False
    ):
        way = np.column_stack([u + du * steps, v + dv * steps])
        by = signed(holes, top, way)
        off = np.flatnonzero(by < 0.0)
        s, hit, _, _ = walk_face(ints, reals, u, v, du, dv)
        if len(off):
            assert hit == trimming.HIT_COEDGE
            assert s == pytest.approx(steps[off[0]], abs=3e-3)
        elif by.min() > 1e-3:
            assert (s, hit) == (1.0, trimming.NO_HIT)


@pytest.mark.parametrize("start", [0.0, 2.0, 12.0])
@pytest.mark.parametrize("gap", [1e-11, 1e-9, 1e-7])
def test_ends_of_a_rim_that_miss_each_other(gap: float, start: float) -> None:
    """In the gap, too, a face is what lies below its rim; the other rim may end in the gap."""
    for lower in start + gap * np.linspace(-0.7, 0.7, 5):
        chart = banded([], wave(start, gap), lower)
        in_one_period(chart)
        ints, reals = packed(chart)
        for u in start + gap * np.linspace(-1.5, 1.5, 61):
            for v in (-0.95, -0.7, 0.0, 0.7, 0.9):
                assert on_face(ints, reals, 0, u, v) == (abs(v) < EDGE), (lower, u - start, v)


def test_what_fits_stays_as_it_is() -> None:
    chart = banded([], wave(0.0))
    chart.coedges[0].pcurve = level(-EDGE, 0.0)
    before = list(chart.coedges)
    in_one_period(chart)
    assert chart.coedges == before
    assert chart.period == pytest.approx(0.0, abs=1e-12)


def test_a_curve_that_can_not_be_cut_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    chart = banded(HOLES["across 0"], wave(0.0))
    monkeypatch.setattr("standoff.bodies.periods._parts", lambda c, start: [c])
    with pytest.raises(BodyError, match="leaves the period of u"):
        in_one_period(chart)


def square(surface: Surface, middle: tuple[float, float], half: float = 0.2) -> Chart:
    """A face with a circle about a place as its trim."""
    pieces = ring(*middle, half, half).pieces(0.0, 4.0)
    return Chart(surface, 0, coedges=[Coedge(0, p, a, b, 1, 0) for p, a, b in pieces])


NET = np.moveaxis(np.mgrid[0:3, 0:3, 0:1], 0, -1)[:, :, 0] * 1.0
ENDS = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
PROFILE = NurbsCurve([(1, 0, 0), (2, 0, 1), (1, 0, 2)], ENDS)
# A surface, the middle of what is on it, and what leads out of its domain.
DOMAINS: dict[str, tuple[Surface, tuple[float, float], tuple[float, float]]] = {
    "torus, v": (Torus(2.0, 0.5), (2.0, 1.2), (0.0, 0.3)),
    "torus, whole turn": (Torus(2.0, 0.5, v0=0.0, v1=PERIOD), (2.0, 6.0), (0.0, 0.3)),
    "part of a torus, u": (Torus(2.0, 0.5, 0.0, 1.0), (0.7, 0.0), (0.2, 0.0)),
    "narrow cylinder": (CYLINDER.restricted(0.0, 1.0, -1.0, 1.0), (0.7, 0.0), (0.2, 0.0)),
    "revolved spline": (Revolution(PROFILE), (2.0, 0.7), (0.0, 0.2)),
    "extruded spline": (Extrusion(PROFILE, (0, 1, 0)), (0.3, 0.5), (-0.2, 0.0)),
    "spline, u": (NurbsSurface(NET, ENDS, ENDS), (0.7, 0.5), (0.2, 0.0)),
    "spline, v": (NurbsSurface(NET, ENDS, ENDS), (0.5, 0.3), (0.0, -0.2)),
}


@pytest.mark.parametrize("name", DOMAINS)
def test_curves_lie_in_the_domain_of_their_surface(name: str) -> None:
    surface, (u, v), (du, dv) = DOMAINS[name]
    chart = square(surface, (u, v))
    before = [c.pcurve.point(c.first) for c in chart.coedges]
    in_one_period(chart)
    assert [c.pcurve.point(c.first) for c in chart.coedges] == before
    with pytest.raises(BodyError, match="leaves the surface's domain") as error:
        in_one_period(square(surface, (u + du, v + dv)))
    assert error.value.part == ("face", 0)
    for k, angle in enumerate(surface.angles):
        place = np.array([u, v]) + 3.0 * PERIOD * np.eye(2)[k]
        away = square(surface, (float(place[0]), float(place[1])))
        if not angle:
            with pytest.raises(BodyError, match="leaves the surface's domain"):
                in_one_period(away)
            continue
        in_one_period(away)
        if not (k == 0 and surface.periodic and surface.domain[1] > 6.0):
            turned = [c.pcurve.point(c.first)[k] for c in away.coedges]
            assert turned == pytest.approx([place[k] for place in before], abs=1e-12)
