"""States are values: a copy of one, of whatever is simulated, goes on as the state itself."""

import copy
import pickle

import numpy as np
import pytest

import standoff as so
from standoff import simulation as sim
from standoff.errors import StandoffError

STORED = {
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
}
LAW = sim.HuntCrossley(stiffness=1e4, damping=1.0, depth=1e-2)


def ball():
    place = so.Pose.exp((0.0, 0.0, 0.0), (0.0, 0.0, 0.1502))
    return sim.RigidBody.free(so.shapes.sphere(0.1), mass=0.2, pose=place)


def convex():
    bodies = [sim.RigidBody.fixed(so.shapes.box(1, 1, 0.1)), ball()]
    return sim.Operator(sim.System(bodies, LAW), 1e-3)


def coupled():
    coupler = sim.VirtualCoupler(stiffness=400.0, damping=0.5, max_force=20.0, max_age=0.05)
    bodies = [sim.RigidBody.fixed(so.shapes.box(1, 1, 0.1)), ball()]
    return sim.Operator(sim.System(bodies, LAW, coupler=coupler, tool=1), 1e-3)


KINDS = {"convex": convex, "coupled": coupled}


@pytest.mark.parametrize("kind", KINDS)
def test_a_copied_state_goes_on_as_the_state(kind):
    operator = KINDS[kind]()
    for state in (operator.start(), operator.run(operator.start(), 5).final):
        after = operator.run(state, 5).final
        for how, stored in STORED.items():
            again = operator.run(stored(state), 5).final
            assert again.data.tobytes() == after.data.tobytes(), how
            # and an operator that was stored with it
            both = stored((operator, state))
            assert both[0].run(both[1], 5).final.data.tobytes() == after.data.tobytes(), how


def test_the_state_of_another_system_is_refused():
    one, other = convex(), convex()
    with pytest.raises(StandoffError, match="another system"):
        one.run(copy.deepcopy(other.start()), 1)


def test_a_copied_state_stays_read_only():
    state = convex().start()
    for stored in STORED.values():
        with pytest.raises(ValueError, match="read-only"):
            stored(state).data[0] = np.nan
