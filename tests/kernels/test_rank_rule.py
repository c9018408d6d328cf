"""The rank rule on pairs made by hand: the plain solve, parallel planes, a slope, a saddle."""

import numpy as np
import pytest

from standoff.kernels.pair.newton import (
    law,
    ldl,
    metric_norm,
    pair_metric,
    plainly_definite,
    ranked_law,
)
from standoff.kernels.pair.system import gradient, hessian, projection_errors

ZERO = (0.0, 0.0, 0.0)
NOTHING = (0.0, 0.0, 0.0, 0.0)
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def plane(height: float, across: tuple[float, float] = (0.0, 0.0), tilt: float = 0.0):
    """Jet of a plane over (u, v), tilted about the y axis."""
    along = (float(np.cos(tilt)), 0.0, float(np.sin(tilt)))
    return (*across, height), along, Y, ZERO, ZERO, ZERO


def bowl(height: float, across: tuple[float, float], bend: float):
    """Jet of z = height + bend (u² + v²) / 2 at (u, v) = across."""
    u, v = across
    point = (u, v, height + 0.5 * bend * (u * u + v * v))
    up = (0.0, 0.0, bend)
    return point, (1.0, 0.0, bend * u), (0.0, 1.0, bend * v), up, ZERO, up


def full(H):
    """The symmetric matrix of an upper triangle by rows."""
    matrix = np.zeros((4, 4))
    matrix[np.triu_indices(4)] = H
    return matrix + np.triu(matrix, 1).T


def solve(jet_a, jet_b, g_t=NOTHING):
    """(p, w_ff, slope, regularised, flat) and the g and H that they are of."""
    g = gradient(projection_errors(jet_a, jet_b))
    H = hessian(jet_a, jet_b)
    metrics = pair_metric(jet_a, jet_b)
    p, w, regularised, flat, _ = law(metrics, jet_a, jet_b, g, H, g_t, 4.0)
    slope = metric_norm(metrics, g)
    return np.array(p), np.array(w), slope, regularised, flat, np.array(g), full(H)


def test_a_regular_pair_takes_the_plain_newton_step():
    below, above = bowl(0.0, (0.1, -0.2), -0.8), bowl(1.0, (-0.15, 0.05), 1.3)
    g_t = (0.3, -0.1, 0.2, 0.4)
    p, w, slope, regularised, flat, g, H = solve(below, above, g_t)
    assert (regularised, flat) == (0, 0)
    np.testing.assert_allclose(p, -np.linalg.solve(H, g), rtol=1e-13)
    np.testing.assert_allclose(w, -np.linalg.solve(H, g_t), rtol=1e-13)
    assert slope > 0.0


def test_parallel_planes_take_the_step_of_least_norm():
    """The offset along the planes is shared by both points; the flat directions are dropped."""
    p, w, _, regularised, flat, g, H = solve(plane(0.0), plane(1.0, (0.3, -0.2)))
    assert (regularised, flat) == (1, 1)
    np.testing.assert_allclose(p, -np.linalg.pinv(H, 1e-10) @ g, atol=1e-15)
    np.testing.assert_allclose(p, [0.15, -0.1, -0.15, 0.1], atol=1e-15)
    np.testing.assert_array_equal(w, 0.0)


def test_a_slope_in_a_flat_direction_is_walked_to_the_boundary():
    """A tilt of 1e-7 leaves a slope, and no curvature above the threshold."""
    p, _, _, regularised, flat, _, _ = solve(plane(0.0), plane(1.0, tilt=1e-7))
    assert (regularised, flat) == (1, 1)
    # REACH pair scales along the shared direction, down the slope
    assert np.linalg.norm(p[[0, 2]]) == pytest.approx(16.0, rel=1e-6)
    assert p[0] * p[2] > 0.0
    assert abs(p[1]) + abs(p[3]) < 1e-12


def test_a_negative_eigenvalue_takes_its_magnitude():
    """Beyond the centre of curvature the point is a maximum along u and v: the step goes down."""
    p, _, _, regularised, _, g, H = solve(bowl(0.0, (0.1, 0.0), 2.0), plane(2.0))
    assert np.linalg.eigvalsh(H)[0] < -0.1
    assert regularised == 1
    assert g @ p < 0.0


def test_what_does_not_exist_stays():
    """A vertex has no parameters, an edge one: their steps are zero."""
    vertex = ((0.2, 0.1, 0.0), ZERO, ZERO, ZERO, ZERO, ZERO)
    edge = ((0.0, 0.4, 1.0), X, ZERO, ZERO, ZERO, ZERO)
    p, _, _, regularised, _, _, _ = solve(vertex, edge)
    assert regularised == 0
    np.testing.assert_allclose(p, [0.0, 0.0, 0.2, 0.0], atol=1e-15)


def tilted_pair(rng):
    """Two shallow bowls, from parallel to tilted, with skew charts of any scale."""
    bends = 10.0 ** rng.uniform(-13, 3, 2) * rng.choice([-1.0, 1.0], 2)
    below = bowl(0.0, tuple(rng.uniform(-0.3, 0.3, 2)), bends[0])
    above = bowl(1.0, tuple(rng.uniform(-0.3, 0.3, 2)), bends[1])
    return rechart(below, rng), rechart(above, rng)


def rechart(jet, rng):
    """The same surface in linearly mapped parameters: scaled, and skew."""
    skew = np.array([[1.0, 1.0 - 10.0 ** rng.uniform(-1, 0)], [0.0, 1.0]])
    T = skew @ np.diag(10.0 ** rng.uniform(-4, 4, 2))
    x, xu, xv, xuu, xuv, xvv = np.asarray(jet, dtype=float)
    first = np.array([xu, xv]).T @ T
    second = np.einsum(
        "aij,ik,jl->akl", np.array([[xuu, xuv], [xuv, xvv]]).transpose(2, 0, 1), T, T
    )
    columns = (x, first[:, 0], first[:, 1], second[:, 0, 0], second[:, 0, 1], second[:, 1, 1])
    return tuple(tuple(column.tolist()) for column in columns)


def on_bodies(jet_a, jet_b, step):
    """How far a step of the parameters takes both points."""
    way_a = np.array(jet_a[1:3]).T @ step[:2]
    way_b = np.array(jet_b[1:3]).T @ step[2:]
    return np.hypot(np.linalg.norm(way_a), np.linalg.norm(way_b))


def test_the_pivots_of_H_itself_tell_no_more_than_the_rank_rule(rng):
    """Where `law` takes the plain factor of H the rule in the metric does too, with its step."""
    safe_seen = ruled_seen = 0
    for _ in range(3000):
        jet_a, jet_b = tilted_pair(rng)
        g, H = gradient(projection_errors(jet_a, jet_b)), hessian(jet_a, jet_b)
        metrics = pair_metric(jet_a, jet_b)
        safe, stiff = plainly_definite(metrics, H, ldl(H)[0])
        p, _, regularised, flat, _ = ranked_law(jet_a, jet_b, g, H, NOTHING, 4.0)
        if not safe:
            ruled_seen += regularised
            continue
        safe_seen += 1
        assert regularised == 0
        assert flat == (0 if stiff else 1)
        lean = np.array(law(metrics, jet_a, jet_b, g, H, NOTHING, 4.0)[0])
        # as lengths on the bodies; H may have factors 1e6 apart, the charts' tangents lose 1e2
        off, along = on_bodies(jet_a, jet_b, lean - p), on_bodies(jet_a, jet_b, p)
        assert off <= 1e-6 * along
    assert min(safe_seen, ruled_seen) > 300
