"""The covariant H: the same in every parametrisation, semidefinite anywhere, H at the minimum."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_system import SPATIAL, UPPER, Spot

from standoff.kernels.pair.system import covariant_hessian, gradient, hessian, projection_errors

PAIRS = [
    (SPATIAL[a], SPATIAL[b])
    for a, b in combinations_with_replacement(SPATIAL, 2)
    if (SPATIAL[a].kind, SPATIAL[b].kind) != ("vertex", "vertex")
]
ROUNDOFF = 1e-12
"""Relative to the greatest entry of a matrix, or eigenvalue."""


def jets_of(a: Spot, b: Spot, rng: np.random.Generator):
    """Both jets at any poses, in front of each other or not."""
    return tuple(
        spot.jet(spot.parameters, Rotation.random(random_state=rng).as_matrix(), position)
        for spot, position in ((a, np.zeros(3)), (b, rng.normal(size=3) * 2.0))
    )


def full(H):
    found = np.zeros((4, 4))
    found[UPPER] = H
    return np.maximum(found, found.T) + np.minimum(found, found.T) - np.diag(np.diag(found))


def second_form(jet, away):
    """max(s, 0) II in whichever parameters, by the heights over the tangent space: (2, 2)."""
    _, xu, xv, xuu, xuv, xvv = (np.array(each) for each in jet)
    tangents = [t for t in (xu, xv) if t.any()]
    if not tangents:
        return np.zeros((2, 2))
    basis = np.linalg.qr(np.column_stack(tangents))[0]
    off = np.eye(3) - basis @ basis.T
    form = np.array([[away @ off @ xuu, away @ off @ xuv], [away @ off @ xuv, away @ off @ xvv]])
    return form if np.trace(form) > 0.0 else np.zeros((2, 2))


@pytest.mark.parametrize(("a", "b"), PAIRS, ids=lambda spot: f"{spot.kind} {spot.number}")
def test_it_is_the_first_form_and_the_positive_part_of_the_second(a, b, rng):
    for _ in range(20):
        jet_a, jet_b = jets_of(a, b, rng)
        dR = np.subtract(jet_a[0], jet_b[0])
        J = np.column_stack([jet_a[1], jet_a[2], -np.array(jet_b[1]), -np.array(jet_b[2])])
        expected = J.T @ J
        expected[:2, :2] += second_form(jet_a, dR)
        expected[2:, 2:] += second_form(jet_b, -dR)
        missing = ~J.any(axis=0)
        expected[missing, missing] = 1.0
        found = full(covariant_hessian(jet_a, jet_b))
        assert np.abs(found - expected).max() <= ROUNDOFF * np.abs(expected).max()
        # semidefinite, wherever the points are: the lengths on both surfaces as the metric
        least = np.linalg.eigvalsh(found)[0]
        assert least >= -ROUNDOFF * np.abs(found).max()


def reparametrised(jet, A, B):
    """The jet in parameters p with q = A p + ½ p'Bp, at p = 0."""
    x, xu, xv, xuu, xuv, xvv = (np.array(each) for each in jet)
    F, second = np.column_stack([xu, xv]), np.array([[xuu, xuv], [xuv, xvv]])
    F_new = F @ A
    second_new = np.einsum("ia,jb,ijx->abx", A, A, second) + np.einsum("kab,xk->abx", B, F)
    rows = (x, F_new[:, 0], F_new[:, 1], second_new[0, 0], second_new[0, 1], second_new[1, 1])
    return tuple(tuple(row.tolist()) for row in rows)


def test_other_parameters_change_it_as_a_form_and_the_printed_one_otherwise(rng):
    a, b = SPATIAL["ellipsoid's face"], SPATIAL["lens's face"]
    alike = set()
    for _ in range(100):
        jets = jets_of(a, b, rng)
        A, B = rng.normal(size=(2, 2, 2)), rng.normal(size=(2, 2, 2, 2))
        B += B.transpose(0, 1, 3, 2)
        new = [reparametrised(jet, A[k], B[k]) for k, jet in enumerate(jets)]
        J = np.zeros((4, 4))
        J[:2, :2], J[2:, 2:] = A
        expected = J.T @ full(covariant_hessian(*jets)) @ J
        found = full(covariant_hessian(*new))
        assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()
        printed = J.T @ full(hessian(*jets)) @ J
        signs = [np.linalg.eigvalsh(H)[0] > 0.0 for H in (full(hessian(*new)), printed)]
        alike.add(bool(signs[0] == signs[1]))
    assert alike == {True, False}  # whether the printed H is definite does depend on them


def facing(spot: Spot, rng: np.random.Generator):
    """A unit vector of the spot's normal cone, but for its length across an edge's two faces."""
    x, xu, xv, xuu, _, _ = (np.array(e) for e in spot.jet(spot.parameters, np.eye(3), np.zeros(3)))
    if spot.kind == "face":
        n = np.cross(xu, xv)
        return n * np.sign(n @ x) / np.linalg.norm(n)  # the bodies have their origin inside
    n = rng.normal(size=3)
    if spot.kind == "edge":
        n -= (n @ xu) / (xu @ xu) * xu
        n *= -1.0 if n @ xuu > 0.0 else 1.0  # a supporting plane has the edge behind it
    return n / np.linalg.norm(n)


@pytest.mark.parametrize(("a", "b"), PAIRS, ids=lambda spot: f"{spot.kind} {spot.number}")
@pytest.mark.parametrize("gap", [1e-3, 1.0, 20.0])
def test_at_the_minimum_it_is_h(a, b, gap, rng):
    n, m = facing(a, rng), facing(b, rng)
    turn = Rotation.align_vectors(-n[None], m[None])[0].as_matrix()
    first = a.jet(a.parameters, np.eye(3), np.zeros(3))
    there = b.jet(b.parameters, turn, np.zeros(3))
    second = b.jet(b.parameters, turn, np.array(first[0]) + gap * n - np.array(there[0]))
    assert np.abs(gradient(projection_errors(first, second))).max() < 1e-12 * (1.0 + gap)
    printed = full(hessian(first, second))
    found = full(covariant_hessian(first, second))
    assert np.abs(found - printed).max() <= ROUNDOFF * np.abs(printed).max()
