"""The greatest value of a potential over a part of a face, trimmed or not: what is proven holds for
every sample, whatever the part, the potential and the limit."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from draws import draws
from families.solid_shapes import bolt, prism, ring, taper_bore, tube
from families.threads import flanks
from standoff.bodies import Edge, Face
from standoff.bodies.tessellation import chart_row
from standoff.geometry import ConicArc, Cylinder, Line, Plane, Revolution
from standoff.kernels.body import layout as L
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.entries.queries import coedge_parameters, on_face
from standoff.kernels.entries.solids import side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.spatial_bounds import along_trim, proven
from standoff.kernels.solids.spatial_heights import wave_rise
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    SCREW_OF,
    TORUS_THROUGH,
    Potential,
    potential_jet,
)
from standoff.solids import Solid
from standoff.solids.spatial.minimum import IDENTITY, leaf_jet_of


@cache
def turned_lines() -> Solid:
    """A tapered bore and a foot that slopes, of straight lines that are turned."""
    corners = np.array([[0.4, 0.0, 0.0], [0.9, 0.0, -0.2], [0.8, 0.0, 0.7], [0.5, 0.0, 0.7]])
    lines = [Line(p, q) for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    return Solid.from_patches([Revolution(line) for line in lines], name="turned lines")


@cache
def oval() -> Solid:
    """A pin of elliptic section, so that no trimming curve is a circle."""
    x, y, z = np.eye(3)
    edges = [Edge(ConicArc(h * z, 0.8 * x, 0.5 * y)) for h in (0.0, 1.0)]
    ends = [Face((Plane.through(k * z, x, y),), ((k, 1),)) for k in (0, 1)]
    wall = Face((Cylinder(np.diag([0.8, 0.5, 1.0]), np.zeros(3)),), ((0, 1), (1, 1)))
    return Solid.from_brep(edges=edges, faces=[*ends, wall], name="oval")


STAR = [(0, 0), (2, 1), (4, 0), (3, 2), (4, 4), (2, 3), (0, 4), (1, 2)]
SOLIDS = {
    "star": lambda: prism(STAR, 1.0),
    "ring": lambda: tube(0.5, 0.8, -0.6, 0.6),
    "bolt": bolt,
    "taper": lambda: taper_bore(0.3, -1.0, 2.0, 0.0, 1.5),
    "torus": lambda: ring(0.8, 0.3),
    "turned": turned_lines,
    "oval": oval,
    "thread": lambda: flanks()[0],
}
ACROSS = 24
ROUNDED = 1e-13
"""Length, of parts of about 1: what less than a sample may be by its rounding."""
DRAWS = draws(400)
RIM_BOXES = 20
TURN = 2.0 * np.pi


@njit
def is_proven(solid, pose, leaf, box, phi, sign, most, at, counts):
    side = side_at(solid, pose, S.OUTSIDE)
    part = S.Part(side, leaf, S.Box(box[0], box[1], box[2], box[3]))
    return proven(phi, sign, most, part, (at[0], at[1]), 200, pointer(counts, 0))


def unit(rng) -> np.ndarray:
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def about_the_axis(rng) -> Potential:
    """One that turns about nearly z, the axis of the solids here."""
    if rng.random() < 0.2:
        return through_the_middle(rng)
    kind = int(rng.choice([AXIS_OF, CONE_OF, CIRCLE_OF]))
    off, tilt = rng.normal(size=(2, 3)) * 10.0 ** rng.choice(
        [-12.0, -6.0, -3.0, -1.0, -0.5], (2, 1)
    )
    n = np.array([0.0, 0.0, 1.0]) + tilt * (rng.random() < 0.7)
    k1, k2 = rng.uniform(0.2, 1.0, 2)
    if kind == CONE_OF:
        k1, k2 = np.array([k1, k2]) / np.hypot(k1, k2) * rng.choice([-1.0, 1.0], 2)
    o, n = off * (rng.random() < 0.7) + [0.0, 0.0, rng.normal()], n / np.linalg.norm(n)
    zero, sign = (0.0, 0.0, 0.0), float(rng.choice([-1.0, 1.0]))
    return Potential(kind, tuple(o.tolist()), zero, zero, tuple(n.tolist()), k1, k2, sign)


def through_the_middle(rng) -> Potential:
    """Of a circle that goes along z where it is near the axis, as through a ring: those of which a
    ring's own circle is the same distance all round, and others."""
    off, tilt = rng.normal(size=(2, 3)) * 10.0 ** rng.choice([-12.0, -6.0, -3.0, -1.0], (2, 1))
    radius, angle = 10.0 ** rng.uniform(-0.3, 1.0), rng.uniform(0.0, 2.0 * np.pi)
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    n = np.array([-out[1], out[0], 0.0]) + tilt
    o, n = radius * out + off, n / np.linalg.norm(n)
    zero, sign = (0.0, 0.0, 0.0), float(rng.choice([-1.0, 1.0]))
    k2 = float(rng.uniform(0.1, 1.0))
    return Potential(CIRCLE_OF, tuple(o), zero, zero, tuple(n), float(radius), k2, sign)


def drawn(rng, points: np.ndarray) -> Potential:
    """Any potential near some points; one of a screw serves on one side of its axis."""
    if rng.random() < 0.5:
        return about_the_axis(rng)
    kind = int(rng.choice([TORUS_THROUGH, TORUS_THROUGH, AXIS_OF, CENTRE_OF, SCREW_OF]))
    middle, n = points.mean(axis=0), unit(rng)
    e1 = np.cross(n, unit(rng))
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(n, e1)
    o = middle + rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.5)
    k1, k2 = rng.normal(size=2) * rng.choice([0.0, 0.3])
    if kind == SCREW_OF:
        o = middle - e1 * rng.uniform(1.5, 4.0) * np.ptp(points, axis=0).max()
        least = 0.9 * ((points - o) @ e1).min()
        k1, k2 = rng.uniform(-0.5, 0.5), least
        s, t = unit(rng)[:2]
        steepest = np.hypot(s * np.hypot(1.0, k1 / least), t)
        e2 = np.array([s, t, 0.0]) / steepest
    numbers = [tuple(float(c) for c in v) for v in (o, e1, e2, n)]
    sign = 1.0 if kind == TORUS_THROUGH else float(rng.choice([-1.0, 1.0]))
    return Potential(kind, *numbers, float(k1), float(k2), sign)


def is_on(solid, chart, u, v) -> bool:
    """Of an edge, which has no chart, every place is on the solid."""
    return chart < 0 or on_face(solid.boundary.ints, solid.boundary.reals, chart, u, v)


@cache
def trimming_curves(solid, chart, count=97) -> list[list[tuple[float, float]]]:
    """Parameters of places along each of a chart's trimming curves."""
    if chart < 0:
        return []
    ints, reals = solid.boundary.ints, solid.boundary.reals
    row, found = chart_row(solid.boundary, chart), []
    for coedge in range(row[L.CHART_COEDGE], row[L.CHART_COEDGE] + row[L.CHART_N_COEDGES]):
        o = ints[ints[L.COEDGES] + L.COEDGE_STRIDE * coedge + L.COEDGE_REALS]
        ts = np.linspace(reals[o + L.PCURVE_FIRST], reals[o + L.PCURVE_LAST], count)
        found.append([coedge_parameters(ints, reals, coedge, t)[:2] for t in ts])
    return found


def trimming(solid, chart) -> list[tuple[float, float]]:
    return [place for curve in trimming_curves(solid, chart) for place in curve]


@pytest.mark.parametrize("name", SOLIDS)
def test_no_sample_has_more_than_is_proven(name, rng) -> None:
    solid = SOLIDS[name]()
    parts = [k for k, leaf in enumerate(solid.leaves) if leaf.dim]
    told = cut = 0
    for _ in range(DRAWS):
        leaf = int(rng.choice(parts))
        u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
        a, b = np.sort(rng.uniform(u0, u1, 2))
        c, d = np.sort(rng.uniform(v0, v1, 2))
        if rng.random() < 0.3:
            a, b, c, d = u0, u1, v0, v1
        chart = solid.leaves[leaf].chart
        places = [(u, v) for u in np.linspace(a, b, ACROSS) for v in np.linspace(c, d, ACROSS)]
        on = [is_on(solid, chart, u, v) for u, v in places]
        cut += 0 < sum(on) < len(on)
        on_trims = [(u, v) for u, v in trimming(solid, chart) if a <= u <= b and c <= v <= d]
        places, on = places + on_trims, on + [True] * len(on_trims)
        points = np.array([leaf_jet_of(solid.packed, leaf, u, v)[0] for u, v in places])
        phi = drawn(rng, points)
        sign = float(rng.choice([-1.0, 1.0]))
        values = np.array([sign * potential_jet(phi, tuple(p), 0.0)[0] for p in points])
        greatest = values[np.array(on)].max() if any(on) else -np.inf
        width = max(np.ptp(values), 1e-9)
        most = (greatest if any(on) else values.max()) + width * rng.choice(
            [-0.3, -1e-2, -1e-3, -1e-6, 1e-3, 0.05, 0.3]
        )
        at = places[int(np.argmax(values))]
        counts = np.zeros(8, dtype=np.int64)
        box = np.array([a, b, c, d])
        if is_proven(solid.packed, IDENTITY, leaf, box, phi, sign, most, np.array(at), counts):
            told += 1
            assert greatest <= most + 1e-12 * (1.0 + abs(most))
    assert told > 0.3 * DRAWS
    assert name in ("thread", "torus", "turned") or cut > 0.05 * DRAWS


@pytest.mark.parametrize("name", ["ring", "bolt", "taper", "torus", "turned", "oval"])
def test_nothing_less_than_the_greatest_is_proven_about_the_axis(name, rng) -> None:
    """Of whole leaves that turn about nearly the potential's axis, so that third derivatives are
    small: a claim that misses the greatest sample by little is false."""
    solid = SOLIDS[name]()
    parts = [k for k, leaf in enumerate(solid.leaves) if leaf.dim]
    for _ in range(DRAWS):
        leaf = int(rng.choice(parts))
        box, chart = solid.leaves[leaf].reals[:4], solid.leaves[leaf].chart
        places = [
            (u, v) for u in np.linspace(*box[:2], ACROSS) for v in np.linspace(*box[2:], ACROSS)
        ]
        places = [(u, v) for u, v in places if is_on(solid, chart, u, v)]
        low, high = box[::2], box[1::2]
        places += [q for q in trimming(solid, chart) if np.all(low <= q) and np.all(q <= high)]
        if not places:
            continue
        phi, sign = about_the_axis(rng), float(rng.choice([-1.0, 1.0]))
        points = [leaf_jet_of(solid.packed, leaf, u, v)[0] for u, v in places]
        values = sign * np.array([potential_jet(phi, tuple(p), 0.0)[0] for p in points])
        less = np.ptp(values) * 10.0 ** rng.uniform(-7.0, -1.5)
        most = values.max() - max(less, ROUNDED)
        at, counts = np.array(places[int(np.argmax(values))]), np.zeros(8, dtype=np.int64)
        told = is_proven(solid.packed, IDENTITY, leaf, box, phi, sign, most, at, counts)
        assert not told, (phi, values.max(), values.max() - most, np.ptp(values))


def test_a_place_off_a_flat_face_tells_nothing_where_it_has_less() -> None:
    """In a corner of the box that is in the hole, nearest to where a slanted axis meets the plane,
    phi is less than at the side of the box where the face goes on: no curve has the greatest."""
    solid = SOLIDS["ring"]()
    box = np.array([0.2, 0.26, 0.45, 0.6])
    leaf = next(
        k
        for k, each in enumerate(solid.leaves)
        if each.kind == TORUS_THROUGH
        and (each.reals[[0, 2]] <= box[[0, 2]]).all()
        and (each.reals[[1, 3]] >= box[[1, 3]]).all()
    )
    height = leaf_jet_of(solid.packed, leaf, 0.2, 0.5)[0][2]
    along, steep = np.array([1.2, 0.55, 0.0]) / np.hypot(1.2, 0.55), np.radians(80.0)
    n = tuple((np.sin(steep) * along + [0.0, 0.0, np.cos(steep)]).tolist())
    zero = (0.0, 0.0, 0.0)
    phi = Potential(AXIS_OF, (-1.0, 0.0, height), zero, zero, n, 0.0, 0.0, 1.0)
    least = potential_jet(phi, (0.2, 0.55, height), 0.0)[0]
    counts = np.zeros(8, dtype=np.int64)
    at = np.array([0.2, 0.55])
    for beyond, true in ((5e-3, False), (-5e-3, True)):
        told = is_proven(solid.packed, IDENTITY, leaf, box, phi, -1.0, -least - beyond, at, counts)
        assert told is true


@pytest.mark.parametrize(("name", "half"), [("ring", (0.8, 0.8)), ("oval", (0.8, 0.5))])
def test_a_plane_is_closed_along_a_rim_at_once(name, half, rng) -> None:
    """A height is a wave along a rim, circle or not: where it is greatest is no matter of cuts."""
    solid = SOLIDS[name]()
    ends = [k for k, leaf in enumerate(solid.leaves) if leaf.dim == 2 and leaf.cut]
    ends = [k for k in ends if solid.leaves[k].kind == TORUS_THROUGH]
    zero, n, seen = (0.0, 0.0, 0.0), unit(rng), False
    for leaf in ends:
        box = np.array(solid.leaves[leaf].reals[:4])
        height = leaf_jet_of(solid.packed, leaf, box[0], box[2])[0][2]
        steep = np.hypot(half[0] * n[0], half[1] * n[1])
        u, v = np.square(half) * n[:2] / steep
        on_top = box[0] <= u <= box[1] and box[2] <= v <= box[3]
        phi = Potential(TORUS_THROUGH, zero, zero, zero, tuple(n.tolist()), 0.0, 0.0, 1.0)
        for spare in (1e-12, -1e-6):
            counts = np.zeros(8, dtype=np.int64)
            asked = (box, phi, 1.0, n[2] * height + steep + spare, box[:3:2], counts)
            told = is_proven(solid.packed, IDENTITY, leaf, *asked)
            assert told or spare < 0.0
            assert not (told and on_top and spare < 0.0)
            assert counts[0] <= RIM_BOXES
            seen |= on_top
    assert seen


@njit
def told_along(solid, pose, leaf, box, phi, sign, most, counts):
    part = S.Part(side_at(solid, pose, S.OUTSIDE), leaf, S.Box(box[0], box[1], box[2], box[3]))
    return along_trim(phi, sign, most, part, pointer(counts, 0))


@cache
def along_trims(solid, chart) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (m, n, 2) along a chart's trimming curves and their points (m, n, 3)."""
    curves = np.array(trimming_curves(solid, chart, 200))
    leaf = next(k for k, leaf in enumerate(solid.leaves) if leaf.chart == chart)
    return curves, np.array([[leaf_jet_of(solid.packed, leaf, *q)[0] for q in c] for c in curves])


@pytest.mark.parametrize("name", ["star", "ring", "bolt", "taper", "oval"])
def test_what_is_told_along_trims_is_true_of_their_samples(name, rng) -> None:
    """At most `most`: no sample in the box has more. More: one in the box or just beside it has, or
    a place next to it. What is clearly one or the other is told."""
    solid, told, missed = SOLIDS[name](), [], 0
    parts = [k for k, leaf in enumerate(solid.leaves) if leaf.dim == 2 and leaf.cut]
    for _ in range(DRAWS):
        leaf = int(rng.choice(parts))
        low, high = np.reshape(solid.leaves[leaf].reals[:4], (2, 2)).T
        drawn_box = np.sort(rng.uniform(low, high, (2, 2)), axis=0)
        first, last = (low, high) if rng.random() < 0.3 else drawn_box
        curves, points = along_trims(solid, solid.leaves[leaf].chart)
        phi, sign = drawn(rng, points.reshape(-1, 3)), float(rng.choice([-1.0, 1.0]))
        values = [[sign * potential_jet(phi, tuple(p), 0.0)[0] for p in c] for c in points]
        held = ((first <= curves) & (curves <= last)).all(axis=2)
        in_box = np.array(values)[held]
        share = rng.choice([-0.3, -1e-2, -1e-3, -1e-6, 1e-3, 0.05, 0.3])
        greatest = in_box.max(initial=-np.inf)
        most = (greatest if len(in_box) else np.median(values)) + share * np.ptp(values)
        counts = np.zeros(8, dtype=np.int64)
        box = np.array([first, last]).T.ravel()
        told.append(told_along(solid.packed, IDENTITY, leaf, box, phi, sign, most, counts))
        missed += told[-1] == 0 and abs(share) > 0.03
        if told[-1] == 1:
            assert greatest <= most + 1e-12 * (1.0 + abs(most))
        if told[-1] == -1:
            step = np.abs(np.diff(curves, axis=1)).max(axis=(0, 1))
            turned = curves[..., None, :] + np.array([(-TURN, 0.0), (0.0, 0.0), (TURN, 0.0)])
            beside = ((first - step <= turned) & (turned <= last + step)).all(axis=3).any(axis=2)
            gap = np.linalg.norm(np.diff(points, axis=1), axis=2).max()
            assert np.array(values)[beside].max(initial=-np.inf) + gap > most
    assert min(told.count(1), told.count(-1)) > 0.1 * DRAWS
    assert missed < 0.05 * DRAWS


@given(
    st.floats(-1.0, 1.0),
    st.sampled_from([0.0, 1e-12, 1e-6, 1e-3]) | st.floats(0.0, 7.0),
    st.integers(-9, 9),
    st.sampled_from([-1.0, 0.0, 1.0]),
)
def test_a_wave_rises_no_higher_than_is_told_and_as_high(b, wide, power, sign) -> None:
    """Of small and of large radius: within rounding of what is told, not of the radius."""
    c = sign * 10.0**power
    top = np.arctan2(b, -c)
    t = np.append(np.linspace(-wide, wide, 2001), [top] if abs(top) <= wide else [])
    values = b * np.sin(t) + 2.0 * c * np.sin(0.5 * t) ** 2
    told, spare = wave_rise(b, c, wide), 4e-16 * (abs(b) * min(wide, 1.0) + values.max())
    assert values.max() - spare <= told <= values.max() + spare
