"""The peers' adaptors keep Standoff's conventions, on pairs whose answer is known."""

import sys

import numpy as np
import pytest
from benchmarks.peers import PEERS, coal_ellipsoids, mujoco_ellipsoids

from oracles.exact_pairs import exact_pair
from standoff_studies.oracles import Ellipsoid

ACCURACY = {
    "Coal, default": 2e-2,
    "Coal, tight": 1e-4,
    "MuJoCo, default": 5e-3,
    "MuJoCo, tight": 1e-4,
}
"""What each setting must reach here: about ten times its worst measured error."""


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("name", PEERS)
def test_spheres(name):
    query = PEERS[name](np.full(3, 0.7), np.full(3, 1.0))
    for angle in (0.0, 0.4):
        answer = query((turned(angle), np.array([1.0, 0, 0])), (np.eye(3), np.array([4.0, 4, 0])))
        normal = np.array([0.6, 0.8, 0.0])
        allowed = ACCURACY[name]
        assert answer.distance == pytest.approx(3.3, abs=allowed)
        np.testing.assert_allclose(answer.normal, normal, atol=allowed)
        np.testing.assert_allclose(answer.point_a, [1.42, 0.56, 0], atol=allowed)
        np.testing.assert_allclose(answer.point_b, [3.4, 3.2, 0], atol=allowed)


@pytest.mark.parametrize("name", PEERS)
def test_turned_ellipsoids(name):
    rng = np.random.default_rng(31)
    axes_a, axes_b = np.array([1.0, 0.5, 0.2]), np.array([0.3, 0.9, 0.4])
    query, allowed = PEERS[name](axes_a, axes_b), ACCURACY[name]
    for gap in (0.01, 0.1, 1.0):
        pair = exact_pair(
            Ellipsoid(*axes_a), Ellipsoid(*axes_b), gap, rng, position_a=rng.normal(size=3)
        )
        answer = query(pair.pose_a, pair.pose_b)
        assert answer.distance == pytest.approx(pair.distance, abs=allowed)
        np.testing.assert_allclose(answer.point_a, pair.point_a, atol=allowed)
        np.testing.assert_allclose(answer.point_b, pair.point_b, atol=allowed)
        np.testing.assert_allclose(answer.normal, pair.normal, atol=allowed)


@pytest.mark.parametrize(
    ("package", "adaptor"), [("coal", coal_ellipsoids), ("mujoco", mujoco_ellipsoids)]
)
def test_a_missing_peer_names_the_extra(monkeypatch, package, adaptor):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=rf"{package} .*standoff-studies\[peers\]"):
        adaptor(np.ones(3), np.ones(3))


def test_penetration_keeps_the_normal_from_a_to_b():
    for name, make in PEERS.items():
        query = make(np.ones(3), np.ones(3))
        answer = query((np.eye(3), np.zeros(3)), (np.eye(3), np.array([1.8, 0, 0])))
        assert answer.distance == pytest.approx(-0.2, abs=1e-2), name
        np.testing.assert_allclose(answer.normal, [1, 0, 0], atol=0.1, err_msg=name)
