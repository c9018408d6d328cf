"""A tick that searches for its near pairs moves the bodies as one that visits all, to the bit."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
import standoff.simulation as sim
from standoff.errors import StandoffError
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.state import arrays as T
from standoff.simulation import near_pairs

CONTACT = sim.HuntCrossley(stiffness=1e4, damping=0.3, friction=0.3, slip_speed=0.5, depth=5e-3)
FLOOR = sim.RigidBody.fixed(so.shapes.halfspace())
TABLE = sim.RigidBody.fixed(so.shapes.box((4.0, 4.0, 0.1)), (np.eye(3), [0.0, 0.0, -0.05]))
KINDS = (
    so.shapes.ellipsoid(0.05, 0.05, 0.04),
    so.shapes.box((0.08, 0.1, 0.06)),
    so.shapes.cylinder(0.04, 0.08),
    so.shapes.sphere(0.05),
    so.shapes.capsule(0.03, 0.06),
)


def free(k: int, at: object, speed: float = 0.0, mass: float = 0.3) -> sim.RigidBody:
    rng = np.random.default_rng(k)
    pose = so.Pose(Rotation.random(random_state=rng).as_matrix(), at)
    twist = so.Twist(speed * rng.normal(size=3), 3.0 * rng.normal(size=3))
    return sim.RigidBody.free(KINDS[k % len(KINDS)], mass=mass, pose=pose, twist=twist)


def grid(n: int, layers: int = 1, speed: float = 0.1) -> list[sim.RigidBody]:
    """n by n bodies of several kinds in layers."""
    rng = np.random.default_rng(4)
    return [
        free(k, [0.16 * i, 0.16 * j, 0.12 + 0.2 * z + 0.05 * rng.random()], speed)
        for k, (i, j, z) in enumerate(product(range(n), range(n), range(layers)))
    ]


def stack() -> list[sim.RigidBody]:
    """Piles of boxes that come to rest, on a half-space."""
    brick = so.shapes.box((0.2, 0.1, 0.06))
    return [FLOOR] + [
        sim.RigidBody.free(brick, mass=0.5, pose=(np.eye(3), [0.5 * i, 0.4 * j, 0.031 + 0.061 * z]))
        for i, j, z in product(range(3), range(2), range(3))
    ]


class Jumping:
    """A path that is beside other bodies for two ticks in ten, and far away else."""

    def pose(self, t: float) -> so.Pose:
        tick = round(t / 1e-3)
        place = 0.16 * (tick // 10 % 4)
        near = tick % 10 in (4, 5)
        return so.Pose(np.eye(3), [place, 0.0, 0.16] if near else [30.0 + place, 5.0, 0.16])

    def twist(self, t: float) -> so.Twist:
        return so.Twist.zero()


class Sweeping:
    """A path that crosses the bodies at 60 m/s, from side to side."""

    def pose(self, t: float) -> so.Pose:
        return so.Pose(np.eye(3), [0.3 + 3.0 * np.sin(20.0 * t), 0.2, 0.1])

    def twist(self, t: float) -> so.Twist:
        return so.Twist([60.0 * np.cos(20.0 * t), 0.0, 0.0], [0.0, 0.0, 0.0])


def jumping() -> list[sim.RigidBody]:
    return [FLOOR, *grid(4), sim.RigidBody.driven(so.shapes.sphere(0.06), Jumping())]


def sweeping() -> list[sim.RigidBody]:
    return [*grid(4), sim.RigidBody.driven(so.shapes.capsule(0.03, 0.3), Sweeping()), TABLE]


def thrown() -> list[sim.RigidBody]:
    """Balls that meet at up to 50 m/s, eight at a time when a record is made, far from 0."""
    rng = np.random.default_rng(8)
    found = []
    for k in range(24):
        way = rng.normal(size=3)
        way *= 5.0 / np.linalg.norm(way)
        at = 1e4 + 0.06 * rng.normal(size=3) + way
        twist = so.Twist(-way / (0.1 * (1 + k % 3)), np.zeros(3))
        found.append(sim.RigidBody.free(KINDS[3], mass=0.3, pose=(np.eye(3), at), twist=twist))
    return found


SCENES: dict[str, tuple[Callable[[], list[sim.RigidBody]], dict[str, object]]] = {
    "half-space": (lambda: [FLOOR, *grid(4)], {}),
    "half-space last": (lambda: [*grid(4), FLOOR], {}),
    "table": (lambda: [TABLE, *grid(3, 2)], {}),
    "stacks": (stack, {}),
    "jumping": (jumping, {}),
    "sweeping": (sweeping, {}),
    "thrown": (thrown, {"gravity": (0.0, 0.0, 0.0)}),
}


def made(
    monkeypatch: pytest.MonkeyPatch,
    bodies: list[sim.RigidBody],
    tree: bool,
    law: so.PredictorCorrector,
    method: str = "semi-implicit",
    **options: object,
) -> sim.Operator:
    monkeypatch.setattr(near_pairs, "LEAST_PAIRS", 1 if tree else 10**9)
    operator = sim.Operator(sim.System(bodies, CONTACT, **options), 1e-3, method, law=law)
    assert (operator.packed[0][K.I_NEAR] > 0) == tree
    return operator


def same_motion(
    monkeypatch: pytest.MonkeyPatch,
    bodies: list[sim.RigidBody],
    law: so.PredictorCorrector,
    ticks: int,
    method: str = "semi-implicit",
    **options: object,
) -> sim.SystemRun:
    """Run both; every number of every record, trackers and far pairs included, is the same."""
    runs = []
    for tree in (False, True):
        operator = made(monkeypatch, bodies, tree, law, method, **options)
        state = operator.start(allow_overlap=True)
        first = operator.run(state, ticks, every=ticks // 4)
        # records in the midst of the ticks, and a run that goes on
        runs.append((first, operator.run(first.final, 33, every=11)))
    for one, other in zip(*runs, strict=True):
        assert one.states.tobytes() == other.states.tobytes()
        assert one.accounts.tobytes() == other.accounts.tobytes()
        assert one.final.data.tobytes() == other.final.data.tobytes()
    return runs[1][0]


@pytest.mark.parametrize("scene", SCENES)
def test_the_motion_is_the_same(monkeypatch: pytest.MonkeyPatch, scene: str) -> None:
    bodies, options = SCENES[scene]
    law = so.PredictorCorrector(depth="local", within=0.03)
    run = same_motion(monkeypatch, bodies(), law, 400, **options)
    far = np.array([run.answers(pair).status == T.FAR for pair in range(len(run.system.pairs))])
    assert 0.2 < far.mean() < 1.0
    assert run.deepest > 1e-4


@pytest.mark.parametrize("method", ["euler", "heun", "midpoint", "rk4"])
def test_by_every_method(monkeypatch: pytest.MonkeyPatch, method: str) -> None:
    law = so.PredictorCorrector(depth="local", within=0.03)
    bodies = [FLOOR, *grid(3)]
    stiff = sim.HuntCrossley(stiffness=200.0, damping=0.3, depth=5e-3)
    monkeypatch.setitem(globals(), "CONTACT", stiff)
    assert same_motion(monkeypatch, bodies, law, 200, method).deepest > 0.0


def test_with_kept_proofs_of_depth(monkeypatch: pytest.MonkeyPatch) -> None:
    law = so.PredictorCorrector(depth="global", within=0.03)
    assert same_motion(monkeypatch, jumping(), law, 80).deepest > 1e-3


def test_with_horizons_of_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = [FLOOR, *grid(3)]
    system = sim.System(bodies, CONTACT)
    laws = {
        pair: so.PredictorCorrector(depth="local", within=0.02 * (1 + k % 5))
        for k, pair in enumerate(system.pairs)
    }
    same_motion(monkeypatch, bodies, laws, 200)


def test_with_pairs_in_any_order(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = [FLOOR, *grid(4)]
    rng = np.random.default_rng(2)
    pairs = sim.System(bodies, CONTACT).pairs
    chosen = [pairs[k][:: rng.choice([-1, 1])] for k in rng.permutation(len(pairs))[:100]]
    law = so.PredictorCorrector(depth="local", within=0.03)
    same_motion(monkeypatch, bodies, law, 200, pairs=chosen)


def hand(t: float) -> so.Pose:
    """Down into the bodies and out of them."""
    return so.Pose(np.eye(3), [0.16, 0.16, 0.2 + 0.1 * np.cos(20.0 * t)])


def test_with_a_coupler(monkeypatch: pytest.MonkeyPatch) -> None:
    """Several ticks a reading, of which only the last is recorded."""
    sampling = sim.Sampling(period=5e-3, device_damping=20.0)
    coupler = sim.VirtualCoupler(
        stiffness=500.0, damping=1.0, max_force=20.0, max_age=0.02, sampling=sampling
    )
    ball = sim.RigidBody.free(so.shapes.sphere(0.03), mass=0.2, pose=hand(0.0))
    law = so.PredictorCorrector(depth="local", within=0.03)
    runs = []
    for tree in (False, True):
        bodies = [FLOOR, *grid(3), ball]
        operator = made(monkeypatch, bodies, tree, law, coupler=coupler, tool=len(bodies) - 1)
        given = sim.DeviceReadings.along(hand, 60, 5e-3)
        state = operator.start(allow_overlap=True).engage()
        runs.append(operator.run(state, 300, every=5, device=given))
    assert runs[0].states.tobytes() == runs[1].states.tobytes()
    assert runs[0].accounts.tobytes() == runs[1].accounts.tobytes()
    assert (runs[1].spots[:, [10 in pair for pair in runs[1].system.pairs]] > 0).any()


def test_a_motion_without_bounds_ends_at_the_same_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    law = so.PredictorCorrector(depth="local", within=0.03)
    told = []
    for tree in (False, True):
        operator = made(monkeypatch, [FLOOR, *grid(3)], tree, law)
        data = operator.start(allow_overlap=True).data.copy()
        data[K.STATE_HEADER + 5 * K.N_BODY + K.X_VELOCITY] = 9e99  # beyond 1e100 in 11,111 ticks
        data.flags.writeable = False
        with pytest.raises(StandoffError, match="no longer finite") as error:
            operator.run(sim.SystemState(operator.system, data), 12_000, every=12_000)
        told.append(str(error.value))
    assert "After tick 111" in told[0]
    assert told[0] == told[1]


def test_what_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only where each pair of bounded bodies has a horizon, and there are many."""
    bodies = [FLOOR, *grid(4)]
    within = so.PredictorCorrector(depth="local", within=0.03)
    system = sim.System(bodies, CONTACT)

    def searches(law: object, found: sim.System = system, **options: str) -> bool:
        return bool(sim.Operator(found, 1e-3, law=law, **options).packed[0][K.I_NEAR] > 0)

    assert searches(within)
    assert not searches(None)
    assert not searches(dict.fromkeys(system.pairs[:-1], within))
    floor = {pair: within for pair in system.pairs if 0 not in pair}
    assert searches(floor)  # pairs with a half-space are visited in any case
    assert not searches(so.PaperLaw(depth="local", within=0.03))
    assert not searches(None, tracker="inside")
    assert not searches(within, sim.System(bodies[:5], CONTACT))
