"""The paper's system as a result: its derivatives by differences, rows of edges and vertices."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff_studies.paper.bodies import planar_body

LENS = so.shapes.lens(1.0, 0.45)
BOX = so.shapes.box(0.6, 0.8, 1.0)
POSE_A = so.Pose(Rotation.from_rotvec([0.2, -0.4, 0.1]).as_matrix(), [0.3, 0.1, -0.2])
POSE_B = so.Pose(Rotation.from_rotvec([-0.5, 0.3, 0.7]).as_matrix(), [2.3, 0.4, 0.5])
TWIST_A = so.Twist(np.array([0.3, -0.2, 0.5]), np.array([0.4, 0.1, -0.6]))
TWIST_B = so.Twist(np.array([-0.1, 0.4, 0.2]), np.array([-0.3, 0.7, 0.2]))

PLACES = {
    "face - face": (("face", 0), (0.1, -0.05), ("face", 1), (0.1, 0.2)),
    "face - edge": (("face", 1), (0.05, 0.1), ("edge", 2), (0.3,)),
    "edge - face": (("edge", 1), None, ("face", 2), (0.1, -0.1)),
    "edge - vertex": (("edge", 0), None, ("vertex", 3), ()),
}


def places(name: str) -> tuple[tuple, tuple]:
    feature_a, q_a, feature_b, q_b = PLACES[name]
    if q_a is None:
        curve = LENS.edge_parts[feature_a[1]].curve
        q_a = (0.4 * curve.first + 0.6 * curve.last,)
    return (feature_a, q_a), (feature_b, q_b)


def moved(pose: so.Pose, twist: so.Twist, h: float) -> so.Pose:
    turn = Rotation.from_rotvec(h * twist.omega).as_matrix()
    return so.Pose(turn @ pose.rotation, pose.translation + h * twist.v)


def psi(place_a: tuple, place_b: tuple, dq: np.ndarray, h: float) -> np.ndarray:
    n = len(place_a[1])
    a = (place_a[0], tuple(np.asarray(place_a[1]) + dq[:n]))
    b = (place_b[0], tuple(np.asarray(place_b[1]) + dq[n:]))
    poses = moved(POSE_A, TWIST_A, h), moved(POSE_B, TWIST_B, h)
    return so.tracking.pair_system(LENS, BOX, *poses, a, b).Psi


@pytest.mark.parametrize("name", PLACES)
def test_errors_change_by_m_and_b(name: str) -> None:
    """Psi' = M w + b, Eqs. (9), (10), by central differences in parameters and in time."""
    a, b = places(name)
    system = so.tracking.pair_system(LENS, BOX, POSE_A, POSE_B, a, b, TWIST_A, TWIST_B)
    n = len(system.Psi)
    assert n == len(a[1]) + len(b[1])
    zero, h = np.zeros(n), 1e-6
    for k in range(n):
        step = h * np.eye(n)[k]
        slope = (psi(a, b, step, 0.0) - psi(a, b, -step, 0.0)) / (2 * h)
        np.testing.assert_allclose(system.M[:, k], slope, atol=2e-9)
    rate = (psi(a, b, zero, h) - psi(a, b, zero, -h)) / (2 * h)
    np.testing.assert_allclose(system.b, rate, atol=2e-9)


@pytest.mark.parametrize("name", PLACES)
def test_parts_fit_together(name: str) -> None:
    """Psi from the tangents, Eqs. (1)-(4); g, H, g_t are S Psi, S M, S b and H is symmetric."""
    a, b = places(name)
    system = so.tracking.pair_system(LENS, BOX, POSE_A, POSE_B, a, b, TWIST_A, TWIST_B)
    tangents = np.hstack([system.F, system.G])
    np.testing.assert_allclose(system.Psi, tangents.T @ system.dR, atol=1e-14)
    sign = np.r_[np.ones(system.F.shape[1]), -np.ones(system.G.shape[1])]
    np.testing.assert_array_equal(system.g, sign * system.Psi)
    np.testing.assert_array_equal(system.g_t, sign * system.b)
    np.testing.assert_allclose(system.H, sign[:, None] * system.M, atol=0)
    np.testing.assert_allclose(system.H, system.H.T, atol=0)


def test_errors_vanish_at_the_witness_points() -> None:
    found = so.distance(LENS, BOX, POSE_A, POSE_B)
    system = so.tracking.pair_system(
        LENS,
        BOX,
        POSE_A,
        POSE_B,
        (found.feature_a, found.parameters_a),
        (found.feature_b, found.parameters_b),
    )
    np.testing.assert_allclose(system.dR, found.point_a - found.point_b, atol=1e-14)
    np.testing.assert_allclose(system.Psi, 0.0, atol=1e-12)


def test_a_place_outside_its_feature_is_refused() -> None:
    with pytest.raises(ValueError, match="outside face 0"):
        so.tracking.pair_system(
            LENS, BOX, POSE_A, POSE_B, (("face", 0), (9.0, 9.0)), (("face", 0), (0.0, 0.0))
        )


def test_what_is_no_pose_or_twist_is_refused() -> None:
    places = (("face", 0), (0.0, 0.0)), (("vertex", 0), ())
    with pytest.raises(ValueError, match="rotation"):
        so.tracking.pair_system(LENS, BOX, np.diag([2.0, 2.0, 2.0, 1.0]), POSE_B, *places)
    holed = np.eye(4)
    holed[0, 3] = np.nan
    with pytest.raises(ValueError, match="nan"):
        so.tracking.pair_system(LENS, BOX, POSE_A, holed, *places)
    with pytest.raises(ValueError, match="six finite"):
        so.tracking.pair_system(
            LENS, BOX, POSE_A, POSE_B, *places, (np.full(3, np.nan), np.zeros(3))
        )


def test_a_planar_pair_stays_in_its_plane() -> None:
    loop = planar_body()
    above = so.Pose(np.eye(3), [2.0, 0.0, 0.1])
    with pytest.raises(ValueError, match="out of z = 0"):
        so.tracking.pair_system(
            loop, loop, np.eye(4), above, (("edge", 0), (0.3,)), (("edge", 1), (0.3,))
        )
