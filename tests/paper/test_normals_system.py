"""The set of reference [28] against central differences, and its roots against Eqs. (1)-(4)."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.kernels.body import layout as L
from standoff.kernels.body.features import chart_record
from standoff.kernels.entries.queries import surface_jet
from standoff_studies.paper.normals_system import (
    evaluate_contact,
    evaluate_normals,
    evaluate_projection_errors,
)

TOLERANCE = 1e-7
"""Error of an entry, relative to the greatest of its matrix or vector."""
# Central differences of eighth order; the first term left out and the roundoff are below 1e-10.
OFFSETS = np.array([1, 2, 3, 4])
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
STEP = 0.004

PATCHES = {
    "ellipsoid": (so.shapes.ellipsoid(1.0, 0.7, 0.5), 3, 0.4, -0.3),
    "lens": (so.shapes.lens(1.0, 0.45).transformed(np.diag([0.8, 1.2, 1.0])), 1, 0.2, 0.1),
    "cone": (so.shapes.cone(0.6, 1.5), 0, -1.0, 0.6),
    "plane": (so.shapes.box(1, 2, 3), 2, 0.1, 0.3),
}


class Patch:
    """A face's chart at a pose, and the parameters about which it is differentiated."""

    def __init__(self, name, rng):
        body, chart, u, v = PATCHES[name]
        record = chart_record(body.ints, chart)
        self.reals = body.reals
        self.kind = body.ints[record + L.CHART_KIND]
        self.at = body.ints[record + L.CHART_REALS]
        self.parameters = np.array([u, v])
        self.rotation = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
        self.position = rng.normal(size=3)

    def jet(self, parameters, twist=None, time=0.0):
        """World jet, (6, 3), after `time` at a twist (v, omega)."""
        turn, shift = self.rotation, self.position
        if twist is not None:
            turn = Rotation.from_rotvec(twist[3:] * time).as_matrix() @ turn
            shift = shift + twist[:3] * time
        rows = np.array(surface_jet(self.reals, self.kind, self.at, *parameters)) @ turn.T
        rows[0] += shift
        return rows


def evaluate(a, b, q, twists=((0,) * 6, (0,) * 6), time=0.0, entry=evaluate_normals):
    """(r, J, r_t) of two patches at parameters q, after `time` at the twists."""
    twists = np.array(twists, float)
    jets = [
        patch.jet(part, twist, time)[None]
        for patch, part, twist in ((a, q[:2], twists[0]), (b, q[2:], twists[1]))
    ]
    motion = np.array([a.position, *twists[0].reshape(2, 3), b.position, *twists[1].reshape(2, 3)])
    r, J, r_t = np.empty((1, 4)), np.empty((1, 4, 4)), np.empty((1, 4))
    entry(*jets, motion[None], r, J, r_t)
    return r[0], J[0], r_t[0]


def difference(function):
    """Derivative at 0 of an array-valued function of one number."""
    total = 0.0
    for offset, weight in zip(OFFSETS, WEIGHTS, strict=True):
        step = offset * STEP
        total = total + weight * (function(step) - function(-step))
    return total / STEP


def assert_close(found, known):
    assert np.abs(found - known).max() <= TOLERANCE * max(np.abs(known).max(), 1e-3)


@pytest.mark.parametrize(("first", "second"), list(product(PATCHES, repeat=2)))
@pytest.mark.parametrize("entry", [evaluate_normals, evaluate_projection_errors])
def test_j_and_r_t_are_the_derivatives_of_r(first, second, entry):
    rng = np.random.default_rng(281)
    a, b = Patch(first, rng), Patch(second, rng)
    q = np.array([*a.parameters, *b.parameters])
    _, J, _ = evaluate(a, b, q, entry=entry)
    known = [
        difference(lambda s, e=e: evaluate(a, b, q + s * e, entry=entry)[0]) for e in np.eye(4)
    ]
    assert_close(J, np.stack(known, axis=1))
    for twist in np.eye(12).reshape(12, 2, 6):

        def residual(time, twist=twist):
            return evaluate(a, b, q, twist, time, entry)[0]

        assert_close(evaluate(a, b, q, twist, entry=entry)[2], difference(residual))


def test_of_two_spheres_everything_is_known():
    """Unit tangents at the witness points of spheres of radii 2 and 3, d apart: A = I/2, B = I/3.

    J = [[I + d A, -I], [s A, s B]] with s the sense of the chart's normal; det H = d² det J.
    """
    d = 0.25
    x, y, z = np.eye(3)
    jet_a = np.array([2 * z, x, y, -z / 2, 0 * z, -z / 2])
    jet_b = np.array([(2 + d) * z, x, y, z / 3, 0 * z, z / 3])
    r, J, r_t = np.empty((1, 4)), np.empty((1, 4, 4)), np.empty((1, 4))
    evaluate_normals(jet_a[None], jet_b[None], np.zeros((1, 6, 3)), r, J, r_t)
    one = np.eye(2)
    # x × y = z is inward of B, so here s = -1
    np.testing.assert_allclose(r[0], 0.0, atol=1e-15)
    np.testing.assert_allclose(
        J[0], np.block([[(1 + d / 2) * one, -one], [-one / 2, -one / 3]]), atol=1e-15
    )
    M = np.empty((1, 4, 4))
    evaluate_projection_errors(jet_a[None], jet_b[None], np.zeros((1, 6, 3)), r, M, r_t)
    H = np.diag([1, 1, -1, -1]) @ M[0]
    assert np.linalg.det(H) == pytest.approx(d**2 * np.linalg.det(J[0]), rel=1e-13)
    assert np.linalg.det(J[0]) == pytest.approx((1 / 2 + 1 / 3 + d / 6) ** 2, rel=1e-13)


def test_the_contact_form_of_two_spheres_vanishes_at_the_witness_points():
    """Two unit spheres 0.5 into each other: r = 0 and J symmetric at n = z, d = -0.5."""
    x, y, z = np.eye(3)
    jet_a = np.array([z, x, y, -z, 0 * z, -z])
    jet_b = np.array([0.5 * z, x, y, z, 0 * z, z])
    r, J, r_t = np.empty((1, 8)), np.empty((1, 8, 8)), np.empty((1, 8))
    motion = np.zeros((1, 6, 3))
    motion[0, 4] = 0.3 * z
    evaluate_contact(jet_a[None], jet_b[None], z[None], np.array([-0.5]), motion, r, J, r_t)
    np.testing.assert_allclose(r, 0.0, atol=1e-15)
    np.testing.assert_array_equal(J[0], J[0].T)
    # B leaves along n at 0.3
    np.testing.assert_allclose(r_t[0], [0, 0, 0, 0, 0, 0, 0.3, 0], atol=1e-15)
