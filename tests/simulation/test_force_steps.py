"""No step of the force that stiffness and motion do not explain, over face, edge and vertex."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks import facets

import standoff as so
from standoff import simulation as sim
from standoff.motion import PoseFunction

SLOW = 1e9
"""kg: a free lens of this mass stays where it is, to some nanometres."""


@pytest.mark.parametrize("dt", [1e-3, 2.5e-4])
def test_the_trackers_force_has_no_step_across_features(dt: float) -> None:
    led = facets.way(dt)
    ride, features = facets.exact_ride(led)
    assert list(dict.fromkeys(features)) == ["face 0", "edge 0", "vertex 1", "edge 1", "face 2"]
    assert facets.steps(ride).max() < facets.explained(dt)
    # by construction the depth and the normal are known to roundoff
    assert ride.depths == pytest.approx(facets.DEPTH, abs=1e-15)
    wanted = facets.CONTACT.force(facets.DEPTH) * led.normals
    assert np.abs(ride.forces - wanted).max() < 1e-7


def test_steps_of_the_force_shrink_with_the_frame() -> None:
    """A jump would stay as large as it is, however short the frames are."""
    largest = [
        facets.steps(facets.exact_ride(facets.way(dt))[0]).max() for dt in (1e-3, 5e-4, 2.5e-4)
    ]
    assert np.array(largest[:-1]) / largest[1:] == pytest.approx(2.0, rel=0.02)


def test_facets_make_steps_that_nothing_explains() -> None:
    """The same ride over hulls: what Coal says of them is right, and the hulls are to blame."""
    led = facets.way()
    for fineness in facets.FINENESS:
        vertices = facets.meshes(fineness)
        ride = facets.coal_ride(led, vertices)
        assert facets.steps(ride).max() > 4.0 * facets.explained()
        # short frames do not help
        quick = facets.way(2.5e-4)
        assert facets.steps(facets.coal_ride(quick, vertices)).max() > 0.3
        if fineness == 1e-2:
            true = facets.hull_depths(led, vertices)
            assert ride.depths[true > 0.0] == pytest.approx(true[true > 0.0], abs=1e-12)


@pytest.mark.parametrize("tracker", ["beside", "inside"])
def test_the_operators_force_has_no_step_across_features(tracker: str) -> None:
    led = facets.way()
    lens, tool = facets.bodies()

    def pose(t: float) -> so.Pose:
        at = [np.interp(t, led.times, led.positions[:, k]) for k in range(3)]
        return so.Pose(np.eye(3), at)

    def twist(t: float) -> so.Twist:
        k = int(np.clip(np.searchsorted(led.times, t, side="right") - 1, 0, len(led.times) - 2))
        return so.Twist((led.positions[k + 1] - led.positions[k]) / facets.DT, np.zeros(3))

    moved = sim.RigidBody.driven(tool, PoseFunction(pose, twist=twist))
    heavy = sim.RigidBody.free(lens, mass=SLOW)
    contact = sim.HuntCrossley(stiffness=facets.CONTACT.stiffness, depth=2.0 * facets.DEPTH)
    operator = sim.Operator(
        sim.System([heavy, moved], contact, gravity=[0, 0, 0]), facets.DT, tracker=tracker
    )
    run = operator.run(operator.start(allow_overlap=True), len(led.times) - 2)
    changes = np.linalg.norm(np.diff(run.forces[:, 0], axis=0), axis=1)
    assert changes.max() < facets.explained()
    assert np.linalg.norm(run.forces[:, 0], axis=1) == pytest.approx(
        facets.CONTACT.force(facets.DEPTH), rel=1e-5
    )
    assert run.uncertified == 0
