"""Support functions of the curved shapes against dense samples of their own definitions."""

import numpy as np
import pytest
from scipy.optimize import linprog

from oracles.exact_pairs import exact_pair, random_normal
from oracles.formulas import sum_of_ellipsoids
from oracles.loops import BezierCurve
from oracles.membership import outside
from oracles.patches import BezierBody, BezierPatch
from oracles.revolved import RevolvedHull
from standoff_studies.oracles import (
    Affine,
    Egg,
    Ellipsoid,
    Gore,
    RoundedPolytope,
    Spindle,
    Superellipsoid,
)

ROCK = np.random.default_rng(5).normal(size=(12, 3))
PROFILE = (
    BezierCurve([(0.3, -1), (1.5, -0.8), (0.2, 0.1), (0.9, 0.7)]),
    BezierCurve([(0.9, 0.7), (1.2, 1.3), (0, 1.2)], [1, 0.7, 1]),
)
A, B = np.diag([1.0, 0.4, 0.7]), np.array([[0.2, 0.1, 0], [0, 0.5, 0.3], [0.1, 0, 0.9]])


def homogeneous(points, weights):
    w = np.asarray(weights, dtype=float)[..., None]
    return np.concatenate([np.asarray(points, dtype=float) * w, w], axis=-1)


def ball_octants():
    """The unit ball as eight octants of degree (2, 2), each collapsed at a pole."""
    h = np.sqrt(0.5)
    arc, weights = np.array([(1, 0), (1, 1), (0, 1)], dtype=float), np.array([1, h, 1])
    patches = []
    for signs in np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]):
        points = [[(r * x, r * y, z) for (r, z) in arc] for (x, y) in arc]
        patches.append(homogeneous(signs * np.array(points), np.outer(weights, weights)))
    return patches


SHAPES = {
    "square superellipsoid": Superellipsoid(1, 0.5, 0.8, 0.2, 0.3),
    "pointed superellipsoid": Superellipsoid(1, 0.5, 0.8, 1.8, 1.7),
    "mixed superellipsoid": Superellipsoid(0.6, 1.5, 0.8, 0.3, 1.6),
    "rounded polytope": RoundedPolytope(ROCK, 0.15),
    "spindle": Spindle(0.4, 2.0),
    "gore": Gore(0.6, 2.0, 5),
    "gore of three": Gore(0.9, 2.0, 3),
    "egg": Egg(0.6, 2.0, 0.5),
    "blunt egg": Egg(1.6, 2.0, -0.7),
    "hull of revolution": RevolvedHull(PROFILE),
    "sum of ellipsoids": sum_of_ellipsoids([A, B]),
    "octants": BezierBody(ball_octants()),
    "affine egg": Affine(Egg(0.6, 2.0, 0.5), B, (0.1, -0.2, 0.05)),
}


def turned(r, z, count=181):
    """Points of revolution (n, 3) from radii and heights."""
    angle = np.linspace(0, 2 * np.pi, count)[:, None]
    return np.stack(
        [r * np.cos(angle), r * np.sin(angle), np.broadcast_to(z, (count, len(z)))], axis=-1
    ).reshape(-1, 3)


def surface(name):
    """Dense points of a shape's boundary (or between them), from its definition."""
    rng = np.random.default_rng(6)
    d = rng.normal(size=(40000, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    t = np.linspace(0, np.pi, 361)
    if "superellipsoid" in name:
        s = SHAPES[name]
        a, b, c = s.axes
        e1, e2 = 2 / s.outer, 2 / s.inner
        power = lambda x, e: np.sign(x) * np.abs(x) ** e  # noqa: E731
        u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 321), np.linspace(-np.pi / 2, np.pi / 2, 161))
        around = power(np.cos(v), e1)
        rows = [a * around * power(np.cos(u), e2), b * around * power(np.sin(u), e2)]
        return np.stack([*rows, c * power(np.sin(v), e1)], axis=-1).reshape(-1, 3)
    if name == "spindle":
        radius, centre = (1 + 0.16) / 0.8, 0.4 - (1 + 0.16) / 0.8
        z = np.linspace(-1, 1, 401)
        return turned(centre + np.sqrt(radius**2 - z**2), z)
    if name.startswith("gore"):
        bulge, count = (0.6, 5) if name == "gore" else (0.9, 3)
        radius = (1 + bulge**2) / (2 * bulge)
        z = np.linspace(-1, 1, 801)
        r = bulge - radius + np.sqrt(radius**2 - z**2)
        angle = 2 * np.pi * np.arange(count)[:, None] / count
        rows = [r * np.cos(angle), r * np.sin(angle), np.broadcast_to(z, (count, len(z)))]
        return np.stack(rows, axis=-1).reshape(-1, 3)
    if name == "egg":
        return turned(0.6 * np.sqrt(0.75) * np.sin(t) / (1 + 0.5 * np.cos(t)), np.cos(t))
    if name == "blunt egg":
        return turned(1.6 * np.sqrt(0.51) * np.sin(t) / (1 - 0.7 * np.cos(t)), np.cos(t))
    if name == "hull of revolution":
        rows = np.vstack([c.jet(np.linspace(0, 1, 301))[0] for c in PROFILE])
        return turned(rows[:, 0], rows[:, 1])
    if name == "sum of ellipsoids":
        ball = turned(np.sin(t[::3]), np.cos(t[::3]), 61)
        with_a, with_b = ball[::7] @ A.T, ball[::5] @ B.T
        return (with_a[:, None] + with_b).reshape(-1, 3)
    return d


EXACT = {"gore", "gore of three"}
SAMPLED = [name for name in SHAPES if "polytope" not in name and "affine" not in name]


@pytest.mark.parametrize("name", SAMPLED)
def test_support_bounds_samples_and_is_reached(name):
    shape, rng = SHAPES[name], np.random.default_rng(7)
    samples = surface(name)
    normals = np.vstack([rng.normal(size=(120, 3)), np.eye(3), -np.eye(3)])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    reached = np.array([(samples @ n).max() for n in normals])
    values = shape.support_many(normals)[0]
    assert (values - reached).min() >= -1e-14
    coarse = 0.02 if name in ("sum of ellipsoids", "octants") else 3e-3
    assert (values - reached).max() <= coarse * shape.bounding_radius


@pytest.mark.parametrize("name", SHAPES)
def test_support_points_belong_and_outside_is_signed(name):
    shape, rng = SHAPES[name], np.random.default_rng(8)
    middle = shape.support_many(np.vstack([np.eye(3), -np.eye(3)]))[1].mean(axis=0)
    for _ in range(15):
        n = random_normal(rng)
        value, x = shape.support(n)
        assert value == pytest.approx(n @ x, abs=1e-15)
        assert abs(outside(shape, x)) <= 1e-12
        assert 1e-8 < outside(shape, x + 1e-5 * n) < 3e-5
        assert outside(shape, x + 1e-3 * (middle - x)) <= 0
    assert np.linalg.norm(x) <= shape.bounding_radius


@pytest.mark.parametrize("name", SHAPES)
def test_support_points_are_extreme(name):
    shape, rng = SHAPES[name], np.random.default_rng(9)
    normals = rng.normal(size=(200, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    values, points = shape.support_many(normals)
    assert (normals @ points.T <= values[:, None] + 1e-14).all()


@pytest.mark.parametrize("name", SHAPES)
def test_flat_parts_are_found(name):
    shape, rng = SHAPES[name], np.random.default_rng(10)
    for n in shape.special_normals(rng):
        value = shape.support(n)[0]
        several = shape.maximisers(n, 1e-12)
        np.testing.assert_allclose(several @ n, value, atol=1e-11)
    pair = exact_pair(shape, Ellipsoid(1, 0.5, 0.2), 0.1, rng)
    assert pair.distance == pytest.approx(0.1, abs=1e-14)


def test_rounded_polytope_against_linear_programs():
    shape, rng = SHAPES["rounded polytope"], np.random.default_rng(12)
    sharp = RoundedPolytope(ROCK, 0.0).core.facets
    for n in rng.normal(size=(40, 3)):
        n = n / np.linalg.norm(n)
        core = linprog(-n, sharp.normals, sharp.offsets - 0.15, bounds=(None, None))
        assert shape.support(n)[0] == pytest.approx(-core.fun + 0.15, abs=1e-8)
        # A ball of the opening fits between the sharp planes.
        assert (sharp.normals @ shape.support(n)[1] <= sharp.offsets + 1e-12).all()


def test_octants_are_the_ball():
    body, rng = SHAPES["octants"], np.random.default_rng(13)
    normals = rng.normal(size=(300, 3))
    values, _ = body.support_many(normals)
    np.testing.assert_allclose(values, np.linalg.norm(normals, axis=1), rtol=0, atol=4e-15)
    wide = normals.astype(np.longdouble)
    exact = np.sqrt((wide**2).sum(axis=1))
    # As long as the platform's extended precision, up to the weights' rounding to doubles.
    assert np.abs(body.support_many(wide)[0] - exact).max() <= 2e-15


def test_patch_derivatives():
    rng = np.random.default_rng(14)
    net = homogeneous(rng.normal(size=(5, 4, 3)), rng.uniform(0.5, 2, (5, 4)))
    patch, step = BezierPatch(net), 1e-5
    u, v = rng.uniform(0.1, 0.9, (2, 20))
    jet = patch.jet(u, v)

    def slopes(du, dv):
        ends = patch.jet(u + du, v + dv), patch.jet(u - du, v - dv)
        return [(a - b) / (2 * step) for a, b in zip(*ends, strict=True)]

    by_u, by_v = slopes(step, 0), slopes(0, step)
    for found, expected in zip(jet[1:], (by_u[0], by_v[0], by_u[1], by_v[1], by_v[2]), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


def test_superellipsoid_of_exponents_one_is_the_ellipsoid():
    normals = np.random.default_rng(15).normal(size=(50, 3))
    found = Superellipsoid(1, 0.5, 0.2, 1, 1).points(normals)
    np.testing.assert_allclose(found, Ellipsoid(1, 0.5, 0.2).points(normals), atol=1e-15)


def test_eggs_are_convex_up_to_the_root_of_one_half():
    """r'' has the sign of 2k² - 1 - 3k²t² - 2kt³: at most 2k² - 1 inside, -(1 - k)² at t = -1."""
    t = np.linspace(-0.9999, 0.9999, 20001)
    for k, convex in ((0.3, True), (0.707, True), (0.7072, False), (0.9, False)):
        r = np.sqrt(1 - t * t) / (1 + k * t)
        bend = np.diff(r, 2) / (t[1] - t[0]) ** 2
        formula = r / ((1 - t * t) * (1 + k * t)) ** 2
        formula = formula * (2 * k * k - 1 - 3 * k * k * t * t - 2 * k * t**3)
        np.testing.assert_allclose(bend[2000:-2000], formula[2001:-2001], rtol=1e-4, atol=1e-4)
        assert (formula.max() < 0) == convex
    with pytest.raises(ValueError, match="exponents e1 = 2"):
        Superellipsoid(1, 1, 1, 2, 1)
    with pytest.raises(ValueError, match="bulge 1"):
        Spindle(1, 2)
