"""Machines of solids keep their kinematics: gears their ratio, a nut its pitch, a key its way."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

import standoff as so
from standoff.motion import ConstantTwist
from standoff.simulation import HuntCrossley, Operator, RigidBody, System, SystemRun
from standoff.solids import Solid
from standoff.tracking import Status
from standoff_studies.machines import nut_ripple
from standoff_studies.machines.keys import (
    ASIDE,
    FRICTION,
    STIFFNESS,
    WITHIN,
    key,
    lock,
    pushed,
)
from standoff_studies.machines.prisms import extruded
from standoff_studies.machines.threads import THREAD, bolt, nut
from standoff_studies.soak import solid_parts

GEARS = Path(__file__).parents[2] / "examples" / "planar" / "gears.py"


def turned(run: SystemRun) -> np.ndarray:
    """(n,) radians by which body 1 has turned about the z-axis."""
    turns = run.rotations(1)
    angles = np.unwrap(np.arctan2(turns[:, 1, 0], turns[:, 0, 0]))
    return angles - angles[0]


def test_gears_keep_their_ratio() -> None:
    """Through more than a tooth, on a pin with friction that slows the driven one."""
    drawn = runpy.run_path(str(GEARS))
    teeth, thin, play, speed = 12, 2e-3, 2e-5, 20.0
    outline, base = drawn["involute_gear"](teeth, 1e-3, np.radians(25.0), thin)
    gear = extruded(outline, 0.0, 5e-3, 4e-3 + play)
    centres = 1e-3 * teeth
    turn = drawn["in_mesh"](0.0, teeth, teeth, centres)[1].rotation
    pin = Solid(solid_parts.bolt(4e-3, 5e-3, 6e-3, 8e-3).boundary)
    over = so.Pose(so.Pose.exp([np.pi, 0.0, 0.0]).rotation, [centres, 0.0, 6e-3])
    lifted = so.Pose(np.eye(3), [0.0, 0.0, 5e-4])
    bodies = [
        RigidBody.driven(gear, ConstantTwist(lifted, so.Twist([0, 0, 0], [0, 0, speed]))),
        RigidBody.free(
            gear, density=7800.0, pose=so.Pose(turn, [centres, 1.5e-5, 1e-6]),
            twist=so.Twist([0, 0, 0], [0, 0, -speed]),
        ),
        RigidBody.fixed(pin, over),
    ]  # fmt: skip
    law = HuntCrossley(stiffness=5e5, damping=5.0, friction=0.1, slip_speed=0.05, depth=2e-5)
    operator = Operator(System(bodies, law, pairs=[(0, 1), (2, 1)]), 1e-4)
    run = operator.run(operator.start(), 250)
    behind = base * (turned(run) + speed * run.times)
    # on the line of action: both flanks' thinning, the play of the bore, and what is pressed
    assert np.abs(behind).max() < 2.0 * thin * base + play + run.deepest
    assert run.deepest < 4e-5
    # as it lands level on the pin's head there are more spots than room, for a tick or two; and a
    # tick in which a flank goes farther than its gap might have crossed the next tooth
    crossed = sum(each.ticks for each in run.crossings)
    assert run.uncertified - crossed <= 5
    assert crossed <= 20
    assert run.jumps == 0
    assert (run.spots[:, 0] > 0).any()
    assert np.ptp(run.energy.balance) < 0.05 * np.ptp(run.energy.supplied)


def test_a_key_slides_into_its_lock() -> None:
    """A hand pushes it down and aside: two walls carry what is aside, and it rubs along them."""
    play, speed, dt = 3e-5, 0.1, 5e-5
    middle = so.Pose(np.eye(3), (0.0, 0.0, -WITHIN))
    away = so.solids.distance(lock(play, 0.02, 0.012), key(0.025), so.Pose.identity(), middle)
    assert away.distance == pytest.approx(play, abs=1e-9)
    assert away.status is Status.CONTINUUM
    operator, hand = pushed(play, speed, 1200, dt)
    run = operator.run(operator.start().engage(), 1200, device=hand)
    settled = slice(2 * len(run.times) // 3, None)
    # its walls are plane: what is aside leaves play and depth, for all of the blade's teeth
    assert np.abs(run.positions(1)[:, :2]).max() < 2.0 * (play + run.deepest)
    assert run.positions(1)[-1, 2] == pytest.approx(-WITHIN - speed * run.times[-1], abs=2e-4)
    hand_at = np.array(ASIDE) + np.array([1e-6, 0.0])
    aside = hand_at - run.positions(1)[settled, :2].mean(axis=0)
    force = run.forces[settled, 0].mean(axis=0)
    np.testing.assert_allclose(force[:2], -STIFFNESS * aside, rtol=0.02)
    assert run.uncertified == run.jumps == 0
    assert run.deepest < play
    depths = -run.distances[settled, 0]
    assert np.ptp(depths) < 0.15 * depths.mean()
    assert run.spots[settled].min() >= 8
    # no less than friction on what presses it, no more than on two walls that are square
    rubbed = force[2] / FRICTION
    assert np.linalg.norm(force[:2]) * 0.98 < rubbed < np.abs(force[:2]).sum() * 1.02


@pytest.mark.soak
def test_a_nut_runs_down_its_bolt() -> None:
    """By its own weight, without friction: its pitch in a turn, as fast as the helix lets it."""
    play = 5e-5
    start = so.Pose(np.eye(3), [1e-6, 0.0, THREAD.pitch])
    bodies = [
        RigidBody.fixed(bolt(THREAD, 4, 0.004)),
        RigidBody.free(nut(THREAD, 2, 0.015, play), density=7800.0, pose=start),
    ]
    law = HuntCrossley(stiffness=1e6, damping=20.0, depth=2e-5)
    operator = Operator(System(bodies, law), 1e-4)
    run = operator.run(operator.start(), 4500, 50)
    turn, moved = turned(run), run.positions(1)[:, 2] - THREAD.pitch
    lean = np.hypot(1.0, THREAD.slope)
    rise = THREAD.pitch / (2.0 * np.pi)
    steep = np.sqrt(1.0 + THREAD.slope**2 + (rise / (THREAD.radius - THREAD.height)) ** 2)
    assert turn[-1] < -2.5
    off = moved - THREAD.climb(turn)
    assert np.abs(off).max() < lean * play + steep * run.deepest
    assert run.deepest < 4e-5
    assert run.uncertified == run.jumps == 0
    mass = bodies[1].mass_properties
    assert mass is not None
    force = mass.mass * 9.81 * rise
    inertia = mass.inertia[2, 2] + mass.mass * rise**2
    spin = run.angular_velocities(1)[-1, 2]
    assert 0.5 * inertia * spin**2 == pytest.approx(-force * turn[-1], rel=0.02)
    # a spot has more of a spring as it is pressed deeper than those beside it: no force gives that
    moved = np.ptp(run.energy.potential)
    assert np.ptp(run.energy.balance) < 0.01 * moved
    assert np.abs(run.energy.shared).max() < 0.02 * moved


def test_the_force_on_an_exact_nut_hardly_ripples() -> None:
    """As it turns in an overlap that is the same all the time; a mesh's chords reach deeper into
    the bolt, as far as they are from their helix."""
    exact = nut_ripple.turned(*nut_ripple.exact_parts(), runs=1)
    assert exact.uncertified == exact.jumps == 0
    assert np.abs(exact.distance + nut_ripple.OVERLAP).max() < nut_ripple.OFF
    assert nut_ripple.ripple(exact.force[:, 2]) < 5e-3
    part = 1e-2
    deepest = nut_ripple.OVERLAP + nut_ripple.chord_reach(part)
    mesh = nut_ripple.turned(*nut_ripple.meshed_parts(part), deepest, runs=1)
    assert mesh.uncertified == mesh.jumps == 0
    assert 0.8 * deepest < -mesh.distance.min() < deepest
    assert nut_ripple.ripple(mesh.force[:, 2]) > 1.0
