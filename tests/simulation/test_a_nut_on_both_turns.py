"""What a nut's ticks have found of its contacts is what is found where each pair of its pieces is
asked anew. Along a thread a common normal runs far for a small motion."""

from __future__ import annotations

import numpy as np

import standoff as so
from standoff.simulation import HuntCrossley, Operator, RigidBody, System
from standoff.solids import Solid
from standoff_studies.machines.threads import THREAD, bolt, nut

PLAY, DEPTH = 5e-5, 2e-5
SAME = 1e-10
"""m, of the depths of one place."""


def falling(nut_: Solid, bolt_: Solid) -> Operator:
    """The nut falls by half of its play, and bounces on its thread."""
    start = so.Pose(np.eye(3), [1e-6, 0.0, THREAD.pitch])
    bodies = [RigidBody.fixed(bolt_), RigidBody.free(nut_, density=7800.0, pose=start)]
    return Operator(System(bodies, HuntCrossley(stiffness=1e6, damping=20.0, depth=DEPTH)), 1e-4)


def test_what_presses_on_both_turns_is_found() -> None:
    """All but what has come up within the last ticks, of which one in four tries all pieces."""
    bolt_, nut_ = bolt(THREAD, 3, 0.004), nut(THREAD, 2, 0.015, PLAY)
    operator = falling(nut_, bolt_)
    state = operator.run(operator.start(), 110).final
    found, missed = 0, 0
    for _ in range(10):
        state = operator.run(state, 8).final
        told = np.array([place.distance for place in state.contact(0).places])
        asked = so.solids.distance(bolt_, nut_, state.pose(0), state.pose(1), minima=2.0 * DEPTH)
        pressed = [each.distance for each in asked.minima if each.distance < -SAME]
        known = [len(told) > 0 and np.abs(told - each).min() < SAME for each in pressed]
        found, missed = found + sum(known), missed + len(known) - sum(known)
    assert found > 25
    assert missed < 0.1 * found
