"""Boxes, cones of normals and curvatures of sub-patches, against dense samples and closed forms."""

from __future__ import annotations

from inspect import isabstract, isclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patches import KINDS, ORIGIN, affine, part, sampled

import standoff.geometry as g
from draws import draws
from shares import share
from standoff.bodies.tolerances import DOMAIN_SPARE
from standoff.errors import StandoffError
from standoff.geometry.intervals import Interval
from standoff.geometry.patch_bounds import (
    PatchBounds,
    between,
    checked_rectangles,
    cone_round,
    cut,
)

SEEDS = st.integers(0, 2**32 - 1)
ROUNDED = 1e-10
"""Of a sampled normal (radians) or curvature (relative), more than the jets' roundoff."""
EPS = np.finfo(float).eps


def drawn(name: str, seed: int, width: float) -> tuple[Any, np.ndarray]:
    rng = np.random.default_rng(seed)
    surface = KINDS[name].make(rng).transformed(*affine(rng, bool(rng.integers(2))))
    return surface, part(KINDS[name].domain, width, rng)


def excess(bounds: PatchBounds, surface: Any, rectangle: np.ndarray) -> tuple[float, float, float]:
    """How far bounds go beyond samples: a box, over its size; a cone's angle, radians; a curvature,
    over the greatest. Minus one where they do not hold them."""
    found = sampled(surface, rectangle)
    low, high = found.points.min(axis=0), found.points.max(axis=0)
    beyond = np.concatenate([low - bounds.low[0], bounds.high[0] - high])
    box = float(beyond.max() / np.linalg.norm(high - low)) if beyond.min() >= 0.0 else -1.0
    normals = found.normals.T
    reach = between(np.broadcast_to(bounds.axis[0][:, None], normals.shape), normals).max()
    mean = np.broadcast_to(normals.sum(axis=1)[:, None], normals.shape)
    spread = between(mean, normals).max()
    cone = float(bounds.angle[0] - spread) if reach <= bounds.angle[0] + ROUNDED else -1.0
    few, many = found.curvatures.min(), found.curvatures.max()
    size = max(abs(few), abs(many), 1e-9)
    inside = bounds.least[0] <= few + ROUNDED * size and many - ROUNDED * size <= bounds.greatest[0]
    curvature = float(max(few - bounds.least[0], bounds.greatest[0] - many) / size)
    return box, cone, curvature if inside else -1.0


@pytest.mark.parametrize("name", KINDS)
def test_cones_alone_are_those_of_all_bounds(name: str) -> None:
    """Those of nets are found from the normals' nets alone, and are no wider by much."""
    for seed, width in ((3, 0.05), (4, 0.7)):
        surface, _ = drawn(name, seed, width)
        rng = np.random.default_rng(seed)
        rectangles = np.array([part(KINDS[name].domain, width, rng) for _ in range(4)])
        whole = surface.bounds(rectangles)
        axis, angle = surface.normal_cones(rectangles)
        if name in ("bezier", "nurbs"):
            assert (angle <= 1.05 * whole.angle).all()
            for k, rectangle in enumerate(rectangles):
                normals = sampled(surface, rectangle).normals.T
                away = between(np.broadcast_to(axis[k][:, None], normals.shape), normals)
                assert away.max() <= angle[k] + ROUNDED
        else:
            np.testing.assert_array_equal(axis, whole.axis)
            np.testing.assert_array_equal(angle, whole.angle)


@settings(max_examples=draws(120))
@given(SEEDS, st.integers(1, 5), st.integers(1, 5), st.sampled_from([1.0, 0.1, 1e-3, 1e-6]))
def test_cones_of_nets_hold_all_normals(seed: int, p: int, q: int, width: float) -> None:
    """Of bent nets, polynomial and rational, also far from the origin, some with a side that is one
    point."""
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(p + 1.0), np.arange(q + 1.0), indexing="ij"), axis=-1)
    net = np.concatenate([grid, np.zeros((p + 1, q + 1, 1))], axis=2)
    net = net + rng.uniform(0.0, 0.45) * rng.normal(size=net.shape)
    collapsed = rng.uniform() < 0.3
    if collapsed:
        net[0] = net[0].mean(axis=0)
    far = rng.choice([0.0, 1e3])
    weights = np.exp(rng.choice([0.0, 0.3, 1.0]) * rng.normal(size=(p + 1, q + 1)))
    surface = g.BezierPatch(net + far * rng.normal(size=3), weights)
    u, v = rng.uniform(0.0, 1.0 - width, 2) * [0.0 if collapsed else 1.0, 1.0]
    rectangle = np.array([u, u + width, v, v + width])
    axis, angle = (found[0] for found in surface.normal_cones(rectangle))
    if angle > 0.5 * np.pi:
        return
    spots = rng.uniform(size=(40, 2))
    spots[:4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
    exact = g.BezierPatch(net, weights)  # without the rounding of what is far away
    for s, t in spots if not collapsed else spots[np.abs(spots[:, 0]) > 1e-3]:
        jet = exact.jet(u + s * width, v + t * width)
        normal = np.cross(jet[1], jet[2])
        assert between(axis, normal / np.linalg.norm(normal)) <= angle + ROUNDED + 1e-12 * far


@pytest.mark.parametrize("far", [0.0, 1e3])
@pytest.mark.parametrize("uneven", [0.0, 0.3])
def test_cones_of_nets_over_lines_and_points(uneven: float, far: float) -> None:
    """A side without width, as beside an edge along a parameter, is known as a narrow one is."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij"), axis=-1)
    net = np.concatenate([grid, np.zeros((4, 4, 1))], axis=2) + 0.2 * rng.normal(size=(4, 4, 3))
    weights = np.exp(uneven * rng.normal(size=(4, 4)))
    surface = g.BezierPatch(net + far, weights)
    axes, angles = surface.normal_cones(
        [[0.5, 0.5, 0.2, 0.3], [0.2, 0.3, 0.4, 0.4], [1.0, 1.0, 0.2, 0.3], [0.5, 0.5, 0.5, 0.5]]
    )
    near = surface.normal_cones(
        [[0.5, 0.501, 0.2, 0.3], [0.2, 0.3, 0.4, 0.401], [0.999, 1.0, 0.2, 0.3], [0.5, 0.501] * 2]
    )[1]
    assert (angles <= near).all()
    assert angles[3] < 1e-9
    jet = surface.jet(0.5, 0.5)
    normal = np.cross(jet[1], jet[2])
    assert between(axes[3], normal / np.linalg.norm(normal)) < 1e-9


def test_every_class_of_surface_is_here() -> None:
    classes = {each for name in g.__all__ if isclass(each := getattr(g, name))}
    every = {each for each in classes if issubclass(each, g.Surface) and not isabstract(each)}
    assert {type(kind.make(np.random.default_rng(0))) for kind in KINDS.values()} == every


@pytest.mark.parametrize(("name", "width"), share(2, KINDS, [1.0, 0.2, 1e-2, 1e-5]))
@settings(max_examples=draws(10))
@given(SEEDS)
def test_they_hold_every_sample(name: str, width: float, seed: int) -> None:
    surface, rectangle = drawn(name, seed, width)
    bounds = surface.bounds(rectangle)
    box, cone, curvature = excess(bounds, surface, rectangle)
    assert box >= 0.0
    assert cone > -0.5
    assert curvature >= -ROUNDED
    np.testing.assert_allclose(np.linalg.norm(bounds.axis[0]), 1.0, atol=8 * EPS)


@pytest.mark.parametrize(("name", "width"), share(2, KINDS, [0.3, 1e-3]))
def test_jets_are_held_and_nearly_so(name: str, width: float) -> None:
    """All six rows at a grid of each of some boxes that nothing divides."""
    loose = []
    for seed in range(draws(6)):
        rng = np.random.default_rng(seed)
        surface = KINDS[name].make(rng)
        rectangle = part(KINDS[name].domain, width, rng)
        boxes, _ = cut(checked_rectangles(rectangle), surface.analytic_breaks())
        held = surface.body_jets(boxes)
        for k in range(len(boxes)):
            (u0, v0), (u1, v1) = boxes.low[k], boxes.high[k]
            grid = [(u, v) for u in np.linspace(u0, u1, 7) for v in np.linspace(v0, v1, 7)]
            jets = np.array([surface.jet(float(u), float(v)) for u, v in grid])
            if len(boxes) > 1:  # a jet on a knot is that of the piece above it
                jets = jets.reshape(7, 7, 6, 3)[1:-1, 1:-1].reshape(-1, 6, 3)
            low, high = jets.min(axis=0).T, jets.max(axis=0).T
            known = held[:, :, k].known
            spare = 1e-11 * (1.0 + np.abs(jets).max())
            assert (held.lo[:, :, k] <= low + spare)[known].all()
            assert (held.hi[:, :, k] >= high - spare)[known].all()
            wide = (held.hi - held.lo)[:, :, k] - (high - low)
            loose.append((wide / np.abs(jets).max())[known].max(initial=0.0))
    if width < 0.1:
        assert np.median(loose) <= 0.1


@pytest.mark.parametrize("name", KINDS)
def test_they_sharpen_as_rectangles_halve(name: str) -> None:
    """A box with the square of the width, cones and curvatures with the width: a cone is then some
    percent wider than its normals, as its axis is nearly that of the least."""
    steps, angles = [], []
    for seed in range(draws(12)):
        rng = np.random.default_rng(seed)
        surface = KINDS[name].make(rng).transformed(*affine(rng, similar=True))
        if name in ("pole chart", "side chart"):  # away from the coordinate planes
            start = np.array([0.3, 0.3])
        else:
            start = part(KINDS[name].domain, 0.05, rng)[[0, 2]]
        size = 0.04 * np.diff(np.reshape(KINDS[name].domain, (2, 2)), axis=1).ravel()
        for step in (size, size / 32.0):
            rectangle = np.column_stack([start, start + step]).ravel()
            bounds = surface.bounds(rectangle)
            steps.append(excess(bounds, surface, rectangle))
            angles.append(bounds.angle[0])
    coarse, fine = np.median(np.reshape(steps, (-1, 2, 3)), axis=0)
    # samples at 9 points a side miss 1/64 of what bends within a link: 0.002 of a sagitta
    assert fine[0] <= max(coarse[0] / 20.0, 1e-4)
    if name not in ("pole chart", "side chart"):  # whose normals turn by powers
        assert fine[1] <= 0.1 * np.median(angles[1::2]) + 1e-12
    assert fine[2] <= max(coarse[2] / 8.0, 1e-6)


@pytest.mark.parametrize("name", KINDS)
def test_small_ones_are_tight(name: str) -> None:
    for seed in range(draws(6)):
        surface, rectangle = drawn(name, seed, 1e-4)
        box, cone, curvature = excess(surface.bounds(rectangle), surface, rectangle)
        angle = surface.bounds(rectangle).angle[0]
        assert box <= 2e-3
        if name not in ("pole chart", "side chart"):  # whose curvatures vary by powers
            assert cone <= 0.06 * angle + 1e-12
            assert curvature <= 0.05


@pytest.mark.parametrize("name", KINDS)
@settings(max_examples=draws(6))
@given(SEEDS)
def test_extents_hold_samples_along_any_direction(name: str, seed: int) -> None:
    surface, rectangle = drawn(name, seed, 0.3)
    rng = np.random.default_rng(seed)
    directions = np.vstack([np.eye(3), rng.normal(size=(5, 3))])
    low, high = surface.extents(rectangle, directions)
    points = sampled(surface, rectangle).points
    spare = 16 * EPS * (np.abs(points).max() + np.linalg.norm(surface.shift))
    heights = directions @ points.T
    assert (low[:, 0] <= heights.min(axis=1) + spare).all()
    assert (high[:, 0] >= heights.max(axis=1) - spare).all()
    own = np.repeat(directions[:, :, None], 2, axis=2)
    twice = surface.extents([rectangle, rectangle], own)
    np.testing.assert_array_equal(twice[0], np.repeat(low, 2, axis=1))


@pytest.mark.parametrize("name", KINDS)
@settings(max_examples=draws(6))
@given(SEEDS)
def test_bounds_go_on_beyond_the_domain(name: str, seed: int) -> None:
    """As trimming curves may, by a small share of it: there surfaces are what they are within."""
    rng = np.random.default_rng(seed)
    surface = KINDS[name].make(rng).transformed(*affine(rng, bool(rng.integers(2))))
    sides = np.reshape(surface.domain, (2, 2))
    if not np.isfinite(sides).all():
        return
    grown = sides + DOMAIN_SPARE * np.ptp(sides, axis=1)[:, None] * [-1.0, 1.0]
    at_end = rng.integers(2, size=2)
    for wide in (1e-5, 0.1):
        part = grown.copy()
        for axis, end in enumerate(at_end):
            part[axis, 1 - end] = grown[axis, end] + (0.5 - end) * 2.0 * wide * np.ptp(grown[axis])
        rectangle = part.ravel()
        low, high = surface.extents(rectangle, np.eye(3))
        points = sampled(surface, rectangle).points
        spare = 16 * EPS * (np.abs(points).max() + np.linalg.norm(surface.shift))
        assert (low[:, 0] <= points.min(axis=0) + spare).all()
        assert (high[:, 0] >= points.max(axis=0) - spare).all()
        if name in ("bezier", "nurbs"):
            assert min(excess(surface.bounds(rectangle), surface, rectangle)) > -1.0


def test_boxes_of_quadrics_and_tori_are_exact() -> None:
    """Over ranges that hold, and that do not hold, the highest points."""
    half = np.sqrt(0.5)
    ball = g.Sphere(np.diag([3.0, 2.0, 1.0]), ORIGIN)
    low, high = ball.extents([-1.0, 1.0, -1.0, 1.0], np.eye(3))
    corner = np.sqrt(1.0 / 3.0)
    np.testing.assert_allclose(high[:, 0], [3.0 * half, 2.0 * half, 1.0], rtol=64 * EPS)
    np.testing.assert_allclose(low[:, 0], [-3.0 * half, -2.0 * half, corner], rtol=64 * EPS)
    pipe = g.Cylinder(np.diag([2.0, 2.0, 5.0]), ORIGIN)
    low, high = pipe.extents([[0.25 * np.pi, 1.5 * np.pi, -1.0, 3.0]], np.eye(3))
    np.testing.assert_allclose(low[:, 0], [-2.0, -2.0, -5.0], rtol=64 * EPS)
    np.testing.assert_allclose(high[:, 0], [2.0 * half, 2.0, 15.0], rtol=64 * EPS)
    hat = g.Cone(np.eye(3), ORIGIN)
    low, high = hat.extents([0.0, np.pi, 1.0, 2.0], [[0, 1, 0], [1, 0, 1]])
    np.testing.assert_allclose(low[:, 0], [0.0, 0.0], atol=1e-14)
    np.testing.assert_allclose(high[:, 0], [2.0, 4.0], rtol=64 * EPS)
    ring = g.Torus(2.0, 0.5)
    low, high = ring.extents([0.0, 6.3, -0.5, 1.5], [[1, 0, 0], [1, 0, 1]])
    np.testing.assert_allclose(high[:, 0], [2.5, 2.0 + 0.5 * np.sqrt(2.0)], rtol=64 * EPS)
    wide, bottom = 2.0 + 0.5, 2.0 + 0.5 * np.cos(-0.5)
    np.testing.assert_allclose(low[0, 0], -wide, rtol=64 * EPS)
    best = -(bottom - 0.5 * np.sin(-0.5))
    # along -x + z a torus is lowest on the circle at u = pi, at v = -0.5 or where it bulges
    angles = np.linspace(-0.5, 1.5, 10001)
    lowest = (-(2.0 + 0.5 * np.cos(angles)) + 0.5 * np.sin(angles)).min()
    np.testing.assert_allclose(low[1, 0], min(lowest, best), rtol=1e-7)


def test_curvatures_of_round_kinds_are_exact_over_any_range() -> None:
    rng = np.random.default_rng(7)
    for _ in range(10):
        linear, shift = affine(rng, similar=True)
        if np.linalg.det(linear) < 0.0:
            linear = -linear
        scale = np.linalg.norm(linear, 2)
        pipe = g.Cylinder(np.diag([0.5, 0.5, 3.0]), ORIGIN).transformed(linear, shift)
        found = pipe.bounds([0.0, 6.0, -1.0, 2.0])
        np.testing.assert_allclose(found.least, -2.0 / scale, rtol=1e-13)
        np.testing.assert_allclose(found.greatest, 0.0, atol=1e-13 / scale)
        ball = g.Sphere(np.eye(3), ORIGIN).transformed(linear, shift)
        found = ball.bounds([-3.0, 2.0, 0.0, 5.0])
        np.testing.assert_allclose([found.least, found.greatest], -1.0 / scale, rtol=1e-13)
        plane = g.Plane(np.eye(3), ORIGIN).transformed(linear, shift)
        found = plane.bounds([-3.0, 2.0, 0.0, 5.0])
        np.testing.assert_allclose([found.least, found.greatest], 0.0, atol=1e-13)
        assert found.angle[0] <= 1e-14
        ring = g.Torus(2.0, 0.5).transformed(linear, shift)
        found = ring.bounds([0.0, 6.0, -1.0, 1.5])
        np.testing.assert_allclose(found.least, -2.0 / scale, rtol=0.15)
        outer = np.cos(1.5) / (2.0 + 0.5 * np.cos(1.5))
        assert -outer / scale <= found.greatest[0] <= 0.0


def test_cones_of_quadrics_are_those_of_their_arcs() -> None:
    pipe = g.Cylinder(np.diag([2.0, 2.0, 5.0]), ORIGIN)
    found = pipe.bounds([0.3, 1.9, -1.0, 3.0])
    np.testing.assert_allclose(found.angle, 0.8, rtol=1e-14)
    np.testing.assert_allclose(found.axis[0], [np.cos(1.1), np.sin(1.1), 0.0], atol=1e-14)
    assert pipe.bounds([0.0, 3.2, 0.0, 1.0]).angle[0] == np.pi
    chart = g.Sphere(np.eye(3), ORIGIN)
    np.testing.assert_allclose(
        chart.bounds([-1.0, 1.0, -1.0, 1.0]).angle, np.arccos(1 / np.sqrt(3.0)), rtol=1e-12
    )
    ring = g.Torus(2.0, 0.5)
    found = ring.bounds([-0.4, 0.4, 1.2, 0.5 * np.pi])
    assert 0.5 * (0.5 * np.pi - 1.2) <= found.angle[0] <= 0.5 * np.pi - 1.2


def test_poles() -> None:
    """Round ones have normals; curvatures where the kind gives them; an apex has none."""
    rng = np.random.default_rng(1)
    linear, shift = affine(rng, similar=True)
    scale = np.linalg.norm(linear, 2)
    hemisphere = KINDS["turned quarter"].make(rng).transformed(linear, shift)
    found = hemisphere.bounds([0.0, 0.5, 0.0, 0.05])
    assert found.angle[0] < 0.2
    np.testing.assert_allclose(np.abs([found.least, found.greatest]), 1.0 / scale, rtol=0.4)
    octant = g.ellipsoid_octants(1.0, 1.0, 1.0)[0].transformed(linear, shift)
    found = octant.bounds([0.0, 1.0, 0.9, 1.0])
    assert found.angle[0] < 0.3
    assert found.least[0] == -np.inf
    hat = g.Cone(np.eye(3), ORIGIN)
    found = hat.bounds([0.0, 1.0, 0.0, 1.0])
    assert found.angle[0] < 0.6
    assert (found.least[0], found.greatest[0]) == (-np.inf, np.inf)
    ball = g.FormulaSurface(
        "cos(u)*cos(v)", "sin(u)*cos(v)", "sin(v)", (0, 1, 1, 1.5707963267948966)
    )
    assert ball.bounds([0.0, 1.0, 1.4, 1.5707963267948966]).angle[0] == np.pi


def test_a_point_of_a_crease_and_what_spans_divide() -> None:
    """A polyline moved along a direction: each part has one normal, both together a wedge."""
    corner = g.NurbsCurve([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [0, 0, 1, 2, 2])
    bent = g.Extrusion(corner, [0, 0, 1])
    found = bent.bounds([[0, 1, 0, 1], [1, 2, 0, 1], [0.5, 1.5, 0, 1]])
    assert (found.angle[:2] <= 1e-14).all()
    np.testing.assert_allclose(found.angle[2], 0.25 * np.pi, rtol=1e-12)
    np.testing.assert_allclose(found.high[2], [1.0, 0.5, 1.0], atol=1e-14)
    np.testing.assert_allclose(found.low[2], [0.5, 0.0, 0.0], atol=1e-14)
    flat = bent.bounds([0.25, 0.25, 0.5, 0.5])
    np.testing.assert_allclose([flat.low[0], flat.high[0]], [[0.25, 0, 0.5]] * 2, atol=1e-14)


def test_many_at_once_are_the_same_as_each() -> None:
    for name in KINDS:
        surface, _ = drawn(name, 3, 0.1)
        rng = np.random.default_rng(3)
        rows = np.array([part(KINDS[name].domain, 0.1, rng) for _ in range(5)])
        every = surface.bounds(rows)
        for k, row in enumerate(rows):
            one = surface.bounds(row)
            np.testing.assert_allclose(one.low[0], every.low[k], rtol=1e-13, atol=1e-13)
            np.testing.assert_allclose(one.angle[0], every.angle[k], rtol=1e-9, atol=1e-13)
            np.testing.assert_allclose(one.least[0], every.least[k], rtol=1e-9, atol=1e-13)


def test_a_part_of_merged_bounds_is_within_them() -> None:
    surface, rectangle = drawn("bezier", 5, 0.5)
    u0, u1, v0, v1 = rectangle
    middle = 0.5 * (u0 + u1)
    halves = surface.bounds([[u0, middle, v0, v1], [middle, u1, v0, v1]])
    whole = halves.merged(np.array([0, 0]), 1)
    assert (whole.low <= halves.low).all()
    assert (whole.high >= halves.high).all()
    assert whole.least[0] == halves.least.min()
    assert (between(whole.axis.T, halves.axis.T) + halves.angle <= whole.angle[0] + 1e-14).all()
    alone = halves.merged(np.array([1, 0]), 2)
    np.testing.assert_array_equal(alone.axis, halves.axis[::-1])
    np.testing.assert_array_equal(alone.angle, halves.angle[::-1])


def test_a_cone_holds_what_its_vectors_span() -> None:
    rng = np.random.default_rng(9)
    for _ in range(50):
        middle = rng.normal(size=3) + 0.5 * rng.normal(size=(6, 3))
        off = 0.1 * rng.uniform(size=(6, 1)) * np.ones(3)
        vectors = Interval((middle - off).T[..., None], (middle + off).T[..., None])
        axis, angle = cone_round(vectors)
        if angle[0] == np.pi:
            continue
        shares = rng.uniform(size=(200, 6))
        inner = middle + off * rng.uniform(-1, 1, (200, 6, 3))
        spanned = np.einsum("ni,nij->jn", shares, inner)
        assert between(np.broadcast_to(axis[0][:, None], spanned.shape), spanned).max() <= angle[0]


@pytest.mark.parametrize(
    ("given_", "told"),
    [
        ([0.0, 1.0, 0.0], "shape"),
        ([[0.0, np.nan, 0.0, 1.0]], "NaN"),
        ([[0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]], r"rectangles\[1\]"),
    ],
)
def test_bad_rectangles_are_refused(given_: Any, told: str) -> None:
    with pytest.raises(StandoffError, match=told):
        g.Plane(np.eye(3), ORIGIN).bounds(given_)
