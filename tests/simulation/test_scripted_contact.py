"""Energy in scripted contact: what bodies have, less what they were given, never grows."""

from __future__ import annotations

import numpy as np
import pytest
from scenes_with_contact import FLOOR, upright

import standoff as so
from shares import only
from standoff import simulation as sim
from standoff.motion import Helix

PASSIVE = sim.HuntCrossley(stiffness=1e6, damping=0.5, friction=0.4, slip_speed=0.05, depth=8e-3)


STIRRED = Helix(radius=0.3, pitch=0.0, rate=4.0, centre=(0.0, 0.0, 0.12), axis=(0.2, 0.0, 1.0))
"""An ellipsoid's way round, up and down, as a hand's script may say. A function of one's own would
take Python a quarter of a millisecond a tick."""


def stirring(tracker: str, method: str, contact: sim.HuntCrossley, dt: float) -> sim.SystemRun:
    """A script pushes an egg and a ball about on a floor for 1 s: five pairs, in and out."""
    spoon = sim.RigidBody.driven(so.shapes.ellipsoid([0.2, 0.06, 0.1]), STIRRED)
    egg = sim.RigidBody.free(
        so.shapes.ellipsoid([0.08, 0.08, 0.1]), density=1000.0, pose=upright(0.1)
    )
    ball = sim.RigidBody.free(
        so.shapes.sphere(0.08), density=1000.0, pose=so.Pose(np.eye(3), [-0.3, 0.1, 0.08])
    )
    bodies = [sim.RigidBody.fixed(FLOOR), spoon, egg, ball]
    pairs = [(0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    operator = sim.Operator(sim.System(bodies, contact, pairs), dt, method, tracker)
    ticks = round(1.0 / dt)
    return operator.run(operator.start(), ticks, every=ticks // 500)


@pytest.mark.parametrize("tracker", ["inside", "beside"])
def test_energy_never_grows_in_scripted_contact(tracker: str) -> None:
    run = stirring(tracker, "semi-implicit", PASSIVE, 2e-5)
    own = run.energy.mechanical - run.energy.supplied
    lost = run.energy.dissipated
    # the script does work both ways, and its contacts come and go
    assert lost[-1] > 1.0
    assert (np.diff(run.spots[:, 2:].sum(axis=1) > 0) != 0).sum() > 4
    assert np.diff(lost).min() >= 0.0
    # the method's own error, of first order in the step
    assert np.diff(own).max() < 1e-3 * lost[-1]
    assert np.abs(run.energy.balance - run.energy.balance[0]).max() < 5e-3 * lost[-1]
    assert run.deepest < 8e-3
    assert run.uncertified == 0


@pytest.mark.parametrize(
    "steps", only([(8e-5, 4e-5)], [(8e-5, 4e-5), (4e-5, 2e-5), (2e-5, 1e-5)]), ids=str
)
def test_what_is_left_of_the_balance_shrinks_with_the_step(steps: tuple[float, float]) -> None:
    """It is the method's error, not a leak: without friction, half the step leaves half."""
    smooth = sim.HuntCrossley(stiffness=1e6, damping=0.5, depth=8e-3)
    left = []
    for dt in steps:
        run = stirring("inside", "semi-implicit", smooth, dt)
        balance = run.energy.balance
        left.append(np.abs(balance - balance[0]).max())
    assert left[0] / left[1] == pytest.approx(2.0, rel=0.05)
