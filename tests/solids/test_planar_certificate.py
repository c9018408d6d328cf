"""Bounds over pieces of a planar boundary, attacked: no false claim may be proven."""

from __future__ import annotations

import math

import numpy as np
import pytest
from planar_drawn import star

import standoff as so
from standoff.geometry import ConicArc, FormulaCurve, Line
from standoff.kernels.compiler.decorators import kernel
from standoff.kernels.entries.planar_solids import outline_at
from standoff.kernels.solids import planar_layout as P
from standoff.kernels.solids.planar_layout import Piece, Potential
from standoff.kernels.solids.planar_pieces import apart, halves, jet_at, node_piece
from standoff.kernels.solids.planar_ranges import greatest, value_at
from standoff.kernels.solids.torus_potential import from_circle
from standoff.solids.planar.outline import PlanarOutline


def test_the_distance_from_a_circle_has_no_cancellation() -> None:
    for k in (-2.0, -1e-9, 0.0, 1e-12, 0.3, 5.0):
        for t, z in ((0.1, 0.05), (1e-8, -1e-8), (0.02, -0.03)):
            exact = z if k == 0.0 else _by_decimals(k, t, z)
            assert from_circle(k, t, z)[0] == pytest.approx(exact, rel=1e-14)


def _by_decimals(k: float, t: float, z: float) -> float:
    from decimal import Decimal, getcontext

    getcontext().prec = 60
    kk, tt, zz = Decimal(k), Decimal(t), Decimal(z)
    far = (tt * tt + (zz + 1 / kk) ** 2).sqrt()
    return float(far - 1 / kk if k > 0 else -far - 1 / kk)


@kernel
def bound_and_samples(arrays, node, potential, sign, parts, n):  # type: ignore[no-untyped-def]
    """(the bound over a part of a leaf, the greatest of n samples, how far samples leave the
    capsule)."""
    outline = outline_at(arrays, math.cos(0.3), math.sin(0.3), 0.2, -0.4)
    whole = node_piece(outline, node)
    piece = whole
    while parts > 0:
        one, two = halves(outline, piece)
        piece = one if parts % 2 else two
        parts //= 2
    leaf = outline.node_ints[P.N_NODE_INT * node + P.LEAF]
    phi = Potential(*potential)
    seen, out, best = -math.inf, -math.inf, piece.first
    for k in range(n):
        t = piece.first + (piece.last - piece.first) * k / (n - 1)
        x, y, _, _, _, _ = jet_at(outline, leaf, t)
        at = Piece(node, t, t, x, y, x, y, 0.0)
        out = max(out, apart(piece, at))
        value = sign * value_at(phi, x, y)
        if value > seen:
            seen, best = value, t
    return greatest(outline, piece, phi, sign, best), seen, out


def leaf_nodes(outline: PlanarOutline) -> list[int]:
    rows = outline.node_ints.reshape(-1, P.N_NODE_INT)
    return [int(k) for k in np.flatnonzero(rows[:, P.LEAF] >= 0)]


def attacked(rng: np.random.Generator, outline: PlanarOutline, tries: int) -> tuple[int, float]:
    """How many bounds are tight to 1 % of what the samples span, and the worst overshoot."""
    nodes, tight = leaf_nodes(outline), 0
    worst = -math.inf
    for _ in range(tries):
        node = nodes[rng.integers(len(nodes))]
        angle, k = rng.uniform(0.0, 7.0), float(rng.choice([0.0, 1.0, -1.0]) * rng.uniform(0, 8))
        at = rng.uniform(-1.5, 1.5, 2)
        phi = (bool(rng.random() < 0.3), *at, math.cos(angle), math.sin(angle), k)
        sign = float(rng.choice([-1.0, 1.0]))
        parts = int(rng.integers(1, 64))
        bound, seen, out = bound_and_samples(outline.arrays, node, phi, sign, parts, 40)
        worst = max(worst, seen - bound)
        tight += bound - seen < 1e-3
        assert out <= 0.0, "a point of the piece is outside of its capsule"
    return tight, worst


def solids(rng: np.random.Generator) -> list[so.PlanarSolid]:
    egg = FormulaCurve("cos(t) + 0.1*cos(2*t)", "0.7*sin(t)", "0", 0.0, 2.0 * np.pi)
    lens = [ConicArc((0, 0), (1, 0), (0, 0.4), 0.0, np.pi), Line((-1, 0), (1, 0))]
    return [
        so.PlanarSolid.from_loops(star(rng, 12, "labn")),
        so.PlanarSolid.from_loops([egg]),
        so.PlanarSolid.from_loops(lens),
    ]


def test_no_false_bound_is_proven(rng: np.random.Generator) -> None:
    for solid in solids(rng):
        tight, worst = attacked(rng, solid.outline, 400)
        assert worst <= 1e-14  # no bound is below what samples show, up to their rounding
        assert tight >= 300  # and most are close to it


@pytest.mark.soak
def test_no_false_bound_of_many(rng: np.random.Generator) -> None:
    for _ in range(30):
        for solid in solids(rng):
            assert attacked(rng, solid.outline, 3000)[1] <= 1e-14


def test_points_are_proven(rng: np.random.Generator) -> None:
    for solid in solids(rng):
        boundary = np.array(
            [
                curve.point(t)[:2]
                for curve in solid.edges
                for t in np.linspace(curve.first, curve.last, 400)
            ]
        )
        points = rng.uniform(-1.3, 1.3, (200, 2))
        distances, _, rows = solid.outline.foot(points, 1e-10)
        out = np.column_stack([rows[:, 0], distances])
        seen = np.linalg.norm(points[:, None] - boundary, axis=2).min(axis=1)
        assert (out[:, 1] <= seen + 1e-12).all()
        assert (out[:, 0] >= seen - 0.02).all()
        assert (out[:, 1] - out[:, 0] <= 1e-10).all()
        assert (out[:, 0] <= out[:, 1]).all()
