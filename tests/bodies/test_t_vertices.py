"""A vertex in the middle of a straight edge, where a seam of the other side ends."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry import Plane

FLAT = so.Pose(np.eye(3))


def rectangle(corner, along_u, along_v, parts=1):
    """A rectangle cut into equal parts along v."""
    plane = Plane.through(np.array(corner, float), np.array(along_u, float), np.array(along_v))
    cuts = np.linspace(0.0, 1.0, parts + 1)
    return [plane.restricted(0.0, 1.0, a, b) for a, b in pairwise(cuts)]


@pytest.fixture(scope="module")
def box():
    """A box 2 x 3 x 1 whose top is cut across its length: vertices amid two of its edges."""
    x, y, z = np.diag([2.0, 3.0, 1.0])
    sides = [
        *rectangle([0, 0, 1], x, y, parts=2),
        *rectangle([0, 0, 0], y, x),
        *rectangle([0, 0, 0], x, z),
        *rectangle([0, 3, 0], z, x),
        *rectangle([0, 0, 0], z, y),
        *rectangle([2, 0, 0], y, z),
    ]
    return so.Body.from_patches(sides)


def test_a_start_at_such_a_vertex_gets_away(box, rng):
    amid = [
        k
        for k, v in enumerate(box.vertex_points)
        if np.allclose(v[1:], [1.5, 1.0]) and v[0] in (0.0, 2.0)
    ]
    assert len(amid) == 2
    for k in amid * 20:
        # turned anyhow, the directions of edges and faces agree but for roundoff
        turn = Rotation.random(random_state=rng).as_matrix()
        tracker = so.Tracker(box.transformed(turn), so.shapes.point())
        out = np.array([np.sign(box.vertex_points[k][0] - 1.0), 0.0, 1.0])
        on_edge = box.vertex_points[k] * [1, 0, 1] + [0.0, rng.uniform(0.01, 2.99), 0.0]
        gap = 10.0 ** rng.uniform(-3, 0)
        at = on_edge + gap * (out + rng.uniform(-0.6, 0.6) * np.array([out[0], 0.0, -1.0]))
        state = tracker.start_from(
            FLAT, so.Pose(np.eye(3), turn @ at), (("vertex", k), ()), (("vertex", 0), ())
        )
        answer = state.proximity
        assert answer.certified
        assert answer.counts.restarts == 0
        np.testing.assert_allclose(answer.point_a, turn @ on_edge, atol=1e-12)
