"""What systems and operators refuse, and what they say."""

from __future__ import annotations

import pickle
import re

import numpy as np
import pytest
from scenes_with_contact import FLOOR, on_floor, upright

import standoff as so
from standoff import simulation as sim
from standoff.kernels.dynamics import arrays as K
from standoff.simulation.stability import largest_stable_stiffness

BALL = so.shapes.sphere(0.1)
SOFT = sim.HuntCrossley(stiffness=1e4)


@pytest.mark.parametrize("mass", [0.0, -1.0, np.nan])
def test_a_mass_is_positive(mass: float) -> None:
    with pytest.raises(so.StandoffError, match="mass"):
        sim.RigidBody.free(BALL, mass=mass)


def test_an_inertia_obeys_the_triangle_inequality() -> None:
    with pytest.raises(so.StandoffError, match="violates the triangle inequality by 1"):
        sim.RigidBody.free(BALL, mass=1.0, inertia=np.diag([1.0, 1.0, 3.0]))


def test_a_body_without_volume_needs_an_inertia() -> None:
    point = so.shapes.point()
    with pytest.raises(so.StandoffError, match="no volume"):
        sim.RigidBody.free(point, density=1.0)
    free = sim.RigidBody.free(point, mass=1.0, inertia=np.eye(3))
    assert free.mass_properties is not None
    assert free.mass_properties.mass == 1.0


def test_too_stiff_a_contact_names_the_largest_stable_stiffness() -> None:
    hard = sim.HuntCrossley(stiffness=1e12, damping=0.1, depth=1e-3)
    for method in ("semi-implicit", "rk4", "heun", "midpoint", "euler"):
        with pytest.raises(so.StandoffError, match="largest stable one is") as refused:
            sim.Operator(on_floor(BALL, hard), 1e-4, method=method)
        found = re.search(r"stable one is ([\d.e+-]+\d)", str(refused.value))
        assert found is not None
        largest = float(found[1])
        given = {"damping": 0.1, "depth": 1e-3}
        sim.Operator(
            on_floor(BALL, sim.HuntCrossley(stiffness=0.99 * largest, **given)), 1e-4, method=method
        )
        with pytest.raises(so.StandoffError, match="stiffness"):
            sim.Operator(
                on_floor(BALL, sim.HuntCrossley(stiffness=1.01 * largest, **given)),
                1e-4,
                method=method,
            )


def test_the_largest_stiffness_is_that_of_an_oscillator() -> None:
    system = on_floor(BALL, SOFT)
    limit = largest_stable_stiffness(SOFT, "semi-implicit", 1e-3, system.give(0), 1e-3)
    # omega dt = 2
    mass = system.bodies[1].mass_properties
    assert mass is not None
    assert 1.5 * limit * np.sqrt(1e-3) * system.give(0) == pytest.approx(4.0 / 1e-6, rel=1e-4)
    assert system.give(0) > 1.0 / mass.mass


def test_a_gain_beyond_its_limit_is_refused() -> None:
    with pytest.raises(so.StandoffError, match="gain"):
        sim.Operator(on_floor(BALL, SOFT), 1e-3, tracker="inside", gain=3000.0)
    with pytest.raises(so.StandoffError, match="law inside"):
        sim.Operator(on_floor(BALL, SOFT), 1e-3, gain=10.0)


def test_an_overlap_at_the_start_is_told_and_allowed_on_request() -> None:
    operator = sim.Operator(on_floor(BALL, SOFT, pose=upright(0.09)), 1e-4)
    with pytest.raises(so.StandoffError, match=r"overlap at the start, by 0\.01"):
        operator.start()
    assert operator.start(allow_overlap=True).distance(0) == pytest.approx(-0.01)


def test_a_slip_speed_too_small_for_the_step_is_refused() -> None:
    rough = sim.HuntCrossley(stiffness=1e4, friction=0.5, slip_speed=1e-6)
    with pytest.raises(so.StandoffError, match="Give at least"):
        sim.Operator(on_floor(BALL, rough), 1e-3)
    with pytest.raises(so.StandoffError, match="needs a slip_speed"):
        sim.HuntCrossley(stiffness=1e4, friction=0.5)


def test_pairs_are_checked() -> None:
    bodies = [sim.RigidBody.fixed(FLOOR), sim.RigidBody.free(BALL, mass=1.0)]
    for pairs in ([(0, 0)], [(0, 2)], [(0, 1), (1, 0)], [(0.0, 1)], 7, [3]):
        with pytest.raises(so.StandoffError):
            sim.System(bodies, SOFT, pairs=pairs)  # type: ignore[arg-type]
    with pytest.raises(so.StandoffError, match="None of the bodies is free"):
        sim.System(bodies[:1], SOFT)
    with pytest.raises(so.StandoffError, match="Neither body"):
        sim.System([bodies[0], sim.RigidBody.fixed(BALL), bodies[1]], SOFT, pairs=[(0, 1)])


def test_a_run_that_leaves_all_bounds_says_at_which_tick() -> None:
    operator = sim.Operator(on_floor(BALL, SOFT, pose=upright(1.0)), 1e-3)
    state = operator.start()
    endless = state.data.copy()
    endless[K.STATE_HEADER + K.N_BODY + K.X_VELOCITY] = np.inf
    with pytest.raises(so.StandoffError, match="After tick 1 "):
        operator.run(sim.SystemState(state.system, endless), 10)


def test_a_stored_operator_goes_on_the_same() -> None:
    operator = sim.Operator(on_floor(BALL, SOFT, pose=upright(0.11)), 1e-3)
    wanted = operator.run(operator.start(), 100)
    start = operator.start()
    # what the kernels read is made anew: formulas have other addresses in another process
    operator.packed = ()
    again, state = pickle.loads(pickle.dumps((operator, start)))
    found = again.run(state, 100)
    assert np.array_equal(found.states, wanted.states)
    assert not again.packed[3].flags.writeable


def test_a_state_belongs_to_its_system() -> None:
    first, second = (sim.Operator(on_floor(BALL, SOFT, pose=upright(1.0)), 1e-3) for _ in range(2))
    with pytest.raises(so.StandoffError, match="another system"):
        first.run(second.start(), 1)
    with pytest.raises(so.StandoffError, match="multiple"):
        first.run(first.start(), 3, every=2)
