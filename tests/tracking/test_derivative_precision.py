"""Derivatives against differences in 50 digits, for every pair of feature kinds."""

import mpmath as mp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from shares import share
from standoff.tracking import Smoothness
from standoff_studies.oracles.optima import (
    DIGITS,
    Feature,
    Pair,
    circle,
    ellipsoid,
    plane,
    point,
    segment,
)

SHAPES = so.shapes
AXES = (0.5, 0.3, 0.4)
BODIES = {
    "curved face": SHAPES.ellipsoid(*AXES),
    "flat face": SHAPES.box(1.0, 1.0, 1.0),
    "curved edge": SHAPES.cylinder(0.4, 1.0),
    "straight edge": SHAPES.box(1.0, 1.0, 1.0),
    "rounded edge": SHAPES.box(1.0, 1.0, 1.0, rounding=0.1),
    "vertex": SHAPES.box(1.0, 1.0, 1.0),
}
KINDS = {kind: kind.split()[-1] for kind in BODIES}
# parallel flats, and a flat with an edge along it, have no unique witness points
WITHOUT = {
    frozenset({"flat face"}),
    frozenset({"flat face", "straight edge"}),
    frozenset({"flat face", "rounded edge"}),
}
PAIRS = [
    (first, second)
    for k, first in enumerate(BODIES)
    for second in list(BODIES)[k:]
    if frozenset({first, second}) not in WITHOUT
]
# what can be a least depth: a point, or an edge, deep in an edge or a point slips off it
DEEP = [
    pair
    for pair in PAIRS
    if "curved face" in pair or ("flat face" in pair and "straight" not in pair)
]
GAPS = (1.0, 1e-3, 1e-6)
HALF_SPACE = "unbounded face"
BEFORE_IT = {
    "curved face": BODIES["curved face"],
    "curved edge": BODIES["curved edge"],
    "vertex": BODIES["vertex"],
    "capsule's vertex": SHAPES.capsule(0.2, 1.0),
    "sphere's vertex": SHAPES.sphere(0.3),
}
ROUNDINGS = {"capsule's vertex": 0.2, "sphere's vertex": 0.3}
BODIES |= {HALF_SPACE: SHAPES.halfspace(), **BEFORE_IT}
KINDS |= {kind: kind.split()[-1] for kind in BODIES}


def drawn_feature(kind: str, rng: np.random.Generator):
    """(feature, its point, an outward unit normal there that is no other feature's), body frame."""
    if kind == "curved face":
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        s = np.square(AXES) * n
        return ellipsoid(AXES, n), s / np.sqrt(s @ n), n
    if kind in ("flat face", HALF_SPACE):
        u, v = rng.uniform(-0.4, 0.4, size=2)
        x = u, v, (0.0 if kind == HALF_SPACE else 0.5)
        return plane(x, (1, 0, 0), (0, 1, 0)), x, (0.0, 0.0, 1.0)
    if kind == "curved edge":
        angle, tilt = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.3, 1.2)
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        n = np.cos(tilt) * out + np.sin(tilt) * np.array([0.0, 0.0, 1.0])
        return circle(0.4, 0.5, angle), 0.4 * out + [0.0, 0.0, 0.5], n
    if kind in ("straight edge", "rounded edge"):
        radius = 0.1 if kind == "rounded edge" else 0.0
        u, tilt, half = rng.uniform(-0.3, 0.3), rng.uniform(0.3, 1.2), 0.5 - radius
        n = np.array([0.0, np.cos(tilt), np.sin(tilt)])
        feature = segment((u, half, half), (1.0, 0.0, 0.0))
        return Feature(*feature[:2], radius), (u, half, half) + radius * n, n
    n = rng.uniform(0.3, 1.0, size=3)
    n /= np.linalg.norm(n)
    if kind in ROUNDINGS:
        end, radius = np.array([0.0, 0.0, 0.5 * (kind[0] == "c")]), ROUNDINGS[kind]
        return Feature(*point(end)[:2], radius), end + radius * n, n
    return point((0.5, 0.5, 0.5)), (0.5, 0.5, 0.5), n


def placed(rng: np.random.Generator, x, n, there, towards) -> np.ndarray:
    """A pose that puts the point x at `there` and its normal n along `towards`."""
    turn, _ = Rotation.align_vectors([towards], [n])
    spin = Rotation.from_rotvec(rng.uniform(0.5, 2.5) * np.asarray(towards))
    pose = np.eye(4)
    pose[:3, :3] = (spin * turn).as_matrix()
    pose[:3, 3] = there - pose[:3, :3] @ np.asarray(x)
    return pose


def compared(first: str, second: str, gap: float, rng: np.random.Generator) -> None:
    (a, x, n_a), (b, y, n_b) = drawn_feature(first, rng), drawn_feature(second, rng)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    pose_a = placed(rng, x, n_a, rng.uniform(-1.0, 1.0, size=3), n)
    pose_b = placed(rng, y, n_b, pose_a[:3, :3] @ np.asarray(x) + pose_a[:3, 3] + gap * n, -n)
    answer = so.distance(BODIES[first], BODIES[second], pose_a, pose_b)
    assert answer.distance == pytest.approx(gap, abs=1e-12)
    assert (answer.feature_a.kind, answer.feature_b.kind) == (KINDS[first], KINDS[second])
    found = answer.derivatives()
    assert found.smoothness is Smoothness.SMOOTH, found.reason
    with mp.workdps(DIGITS):
        pair = Pair((a, b), (pose_a, pose_b), n, gap)
        gradient, *others = pair.derivatives()
    assert float(pair.start[-1]) == pytest.approx(gap + a.radius + b.radius, abs=1e-12)
    assert np.abs(found.gradient - gradient).max() <= 1e-9
    given = found.hessian, found.normal_jacobian, *found.point_jacobians
    for got, true in zip(given, others, strict=True):
        assert np.abs(got - true).max() <= 1e-6 * np.abs(true).max()


@pytest.mark.parametrize(
    ("pair", "gap"),
    share(3, PAIRS, GAPS),
    ids=lambda value: " - ".join(value) if isinstance(value, tuple) else None,
)
def test_derivatives_in_fifty_digits(pair, gap: float, rng: np.random.Generator) -> None:
    compared(*pair, gap, rng)


@pytest.mark.parametrize("pair", DEEP, ids=" - ".join)
def test_derivatives_in_penetration(pair, rng: np.random.Generator) -> None:
    compared(*pair, -0.01, rng)


@pytest.mark.parametrize(("kind", "gap"), share(2, BEFORE_IT, [1.0, 1e-6, -0.01, -3.0]))
def test_derivatives_against_a_half_space(kind: str, gap: float, rng: np.random.Generator) -> None:
    """The half-space first and second; deeper than the body is long it is the same formula."""
    compared(HALF_SPACE, kind, gap, rng)
    compared(kind, HALF_SPACE, gap, rng)
