"""The set of witness points of polytopes against linear programs."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

import standoff as so
from tracking.made_answers import convex_mix, made_answer, random_pose

Array = NDArray[np.float64]


def test_polytopes_against_linear_programs(rng):
    seen = set()
    for trial in range(24):
        kinds = rng.choice(["face", "edge", "vertex"], 2)
        sides = [flat_side(rng, kind) for kind in kinds]
        (va, fa), (vb, fb) = sides
        if trial % 2 and len(fa) > 1 and len(fb) > 1:
            vb, fb = aligned(fa, vb, fb)  # an edge of each along the same line
        gap = float(rng.choice([0.5, 1e-3, 0.0, -1e-3]))
        # A's flat side is up, B's down: both in the plane z = 0 of their own
        shift = convex_mix(fa, rng) - convex_mix(fb, rng) * [1, 1, -1] + [0, 0, gap]
        x = convex_mix_of_overlap(fa, fb * [1, 1, -1] + shift)
        if x is None:
            continue
        world = random_pose(rng, 1.0)
        a, b = so.shapes.polytope(va), so.shapes.polytope(vb * [1, 1, -1])
        answer = made_answer(a, b, world.apply(x), world.rotation[:, 2], gap)
        found = so.witness_set(answer, world, world @ so.Pose(np.eye(3), shift))
        upper_b = fb * [1, 1, -1] + shift
        extents = []
        for angle in np.linspace(0, np.pi, 6, endpoint=False):
            u = np.array([np.cos(angle), np.sin(angle), 0])
            most = [reach(fa, upper_b, gap, sign * u) for sign in (1, -1)]
            inner = (found.points_a - world.translation) @ world.rotation
            assert (inner @ u).max() == pytest.approx(most[0], abs=1e-6)
            assert (inner @ -u).max() == pytest.approx(most[1], abs=1e-6)
            extents.append(sum(most))
        if max(extents) > 1e-5:
            assert found.dimension >= 1
            long = np.ptp(found.points_a, axis=0)
            assert np.linalg.norm(long) >= max(extents) - 1e-6
        seen.add(found.dimension)
    assert seen == {0, 1, 2}


def flat_side(rng: np.random.Generator, kind: str) -> tuple[Array, Array]:
    """Return vertices of a random polytope below z = 0 and those of its face, edge or corner."""
    count = {"face": int(rng.integers(3, 8)), "edge": 2, "vertex": 1}[kind]
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    if kind == "face":
        angle = 2 * np.pi * (np.arange(count) + rng.uniform(-0.2, 0.2, count)) / count
    flat = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    deep = rng.normal(size=(8, 3))
    deep[:, 2] = -0.2 - np.abs(deep[:, 2])
    deep[:, :2] *= 0.8
    return np.vstack([flat, deep]), flat


def aligned(fa: Array, vb: Array, fb: Array) -> tuple[Array, Array]:
    """Turn B about z so that its first edge is parallel to A's first."""
    (p, q), (u, v) = fa[:2], (fb * [1, 1, 1])[:2]
    angle = np.arctan2(*(q - p)[[1, 0]]) - np.arctan2(*(v - u)[[1, 0]])
    turn = so.Pose.exp([0, 0, angle]).rotation
    return vb @ turn.T, fb @ turn.T


def program(fa: Array, fb: Array, gap: float, cost: Array) -> tuple[float, Array] | None:
    """Least cost @ x over x in conv(fa), x + gap e_z in conv(fb); None where there is no x."""
    rows = np.hstack([fa.T, -fb.T])
    sums = np.zeros((2, len(fa) + len(fb)))
    sums[0, : len(fa)] = sums[1, len(fa) :] = 1.0
    equal = np.vstack([rows, sums])
    right = np.array([0, 0, -gap, 1, 1])
    c = np.concatenate([fa @ cost, np.zeros(len(fb))])
    found = linprog(c, A_eq=equal, b_eq=right)
    return (found.fun, found.x[: len(fa)] @ fa) if found.success else None


def convex_mix_of_overlap(fa: Array, fb: Array) -> Array | None:
    gap = float(fb[0, 2] - fa[0, 2])
    found = program(fa, fb, gap, np.zeros(3))
    return None if found is None else found[1]


def reach(fa: Array, fb: Array, gap: float, u: Array) -> float:
    found = program(fa, fb, gap, -u)
    assert found is not None
    return -found[0]
