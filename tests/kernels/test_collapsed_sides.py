"""Certificates beside a collapsed side, where a patch's normal is a quotient of roundoff."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import standoff as so
from draws import draws
from standoff.kernels.body import layout as L
from standoff_studies.paper.bodies import lens_of_patches

LENS = lens_of_patches()
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
BODIES = {
    "lens of patches": LENS,
    "lens of patches, moved": LENS.transformed((3.0 * TURN, [20.0, -5.0, 8.0])),
    "spindle": so.shapes.spindle(0.6, 2.0),
    "cone": so.shapes.cone(0.5, 1.0),
}
POINT = so.shapes.point()
AT_POINT = (("vertex", 0), ())
REST = np.eye(4)
BESIDE = (0.0, 5e-324, 1e-17, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
"""Parameters from the collapsed side on."""


def around(body: so.Body, n: int) -> NDArray[np.float64]:
    rng = np.random.default_rng(8)
    ways = rng.normal(size=(n, 3))
    middle = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
    return middle + body.size * rng.uniform(0.6, 1.5, (n, 1)) * ways / np.linalg.norm(
        ways, axis=1, keepdims=True
    )


def held(body: so.Body, pose: so.Pose, kind: str, index: int, place: tuple[float, ...]) -> float:
    """lower_bound of an answer whose witness point is held at a place, right or wrong."""
    tracker = so.Tracker(body, POINT, law=so.PaperLaw())
    state = tracker.start_from(REST, pose, ((kind, index), place), AT_POINT, settle=False)
    return state.proximity.lower_bound


@pytest.mark.parametrize("name", ["lens of patches", "lens of patches, moved"])
def test_bounds_hold_where_a_witness_is_held_beside_the_tip(name: str) -> None:
    body = BODIES[name]
    for x in around(body, draws(25)):
        pose = so.Pose(np.eye(3), x)
        true = so.distance(body, POINT, REST, pose).distance
        for v in (w for s in BESIDE for w in (s, 1.0 - s)):
            for u in (0.0, 1e-15, 0.3, 1.0):
                for face in range(3):
                    assert held(body, pose, "face", face, (u, v)) <= true + 1e-12 * body.size
        for edge, s in ((edge, s) for edge in range(3) for s in BESIDE):
            curve = body.edge_parts[edge].curve
            for t in (curve.first + s, curve.last - s):
                if curve.first <= t <= curve.last:
                    assert held(body, pose, "edge", edge, (t,)) <= true + 1e-12 * body.size


@pytest.mark.parametrize("name", ["lens of patches", "gore", "cone"])
def test_bounds_hold_where_a_witness_is_past_the_tip_by_roundoff(name: str) -> None:
    """There the tangent along the side, and so the normal, has the other sign."""
    body = so.shapes.gore(0.5, 2.0, 5) if name == "gore" else BODIES[name]
    taken = 0
    for x in around(body, 12):
        pose = so.Pose(np.eye(3), x)
        true = so.distance(body, POINT, REST, pose).distance
        for s in (1e-18, 1e-16, 1e-14, 1e-13, 4e-13, 8e-13):
            for u, v in ((0.0, -s), (1.0, -s), (0.3, -s), (0.0, 1.0 + s), (1.0, 1.0 + s)):
                try:
                    bound = held(body, pose, "face", 0, (u, v))
                except so.StandoffError:  # no place on the face
                    continue
                taken += 1
                assert bound <= true + 1e-12 * body.size
    assert taken > 50


@pytest.mark.parametrize("name", BODIES)
def test_answers_beside_the_tip_are_still_certified(name: str) -> None:
    """The bound's allowance for roundoff costs no certificate where the answer itself is near."""
    body = BODIES[name]
    tip = body.vertex_points[np.argmax(body.vertex_points[:, 2])]
    rng = np.random.default_rng(4)
    for scale in (1e-3, 1e-2, 1e-1, 1.0):
        for _ in range(25):
            x = tip + scale * body.size * np.abs(rng.normal(size=3)) * np.sign(
                tip - around(body, 1)[0]
            )
            found = so.distance(body, POINT, REST, so.Pose(np.eye(3), x))
            assert found.status in (so.Status.CONVERGED, so.Status.GLOBAL, so.Status.LOCAL)
