"""One frame behind every route: the same frames answer alike, bit for bit, however they are asked.

C is compared in tests/c_interface. The servo and the operator make one call (`track_pair`); here
the operator stands for both.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from families.formula_bodies import power_ball
from standoff import simulation as sim
from standoff.geometry import Line
from standoff.kernels.dynamics import arrays as D
from standoff.kernels.state import arrays as K
from standoff.tracking import calls
from standoff.tracking.inputs import flat_pose

Array = np.ndarray
DT = 2.0**-10
"""Frame time [s]: sums of it are exact."""
FRAMES = 90


class Frames(NamedTuple):
    """Poses (n, 4, 4) and twists (n, 6) of both bodies."""

    poses_a: Array
    poses_b: Array
    twists_a: Array
    twists_b: Array


class Case(NamedTuple):
    a: so.Body
    b: so.Body
    law: Any
    twists: bool
    reach: float
    """Between the bodies' origins, at first."""
    sweep: float
    """How far B comes nearer."""


ELLIPSOID, LENS = so.shapes.ellipsoid(1.0, 0.7, 0.5), so.shapes.lens(1.0, 0.4)
BOX, ROUNDED = so.shapes.box(1.0, 0.8, 0.6), so.shapes.box(0.8, 0.6, 0.5, rounding=0.1)
DEFAULT, ALONE = so.PredictorCorrector(), so.PredictorCorrector(restarts=False)
VORONOI = so.PaperLaw(switching="voronoi")
COVARIANT = so.PaperLaw(solve="covariant", integrator="heun")
CORNERS = [(-0.5, -0.4), (0.6, -0.3), (0.1, 0.6)]
PLANAR = so.shapes.planar_loop([Line(p, q) for p, q in pairwise([*CORNERS, CORNERS[0]])])


def formula() -> so.Body:
    pytest.importorskip("sympy")
    body: so.Body = power_ball(np.random.default_rng(1)).body
    return body


CASES = {
    "apart, smooth": lambda: Case(ELLIPSOID, so.shapes.sphere(0.5), DEFAULT, True, 3.0, 0.8),
    "apart, no twists": lambda: Case(ELLIPSOID, ELLIPSOID, DEFAULT, False, 3.0, 0.8),
    "edges": lambda: Case(BOX, ELLIPSOID, DEFAULT, True, 2.6, 0.9),
    "polytopes": lambda: Case(BOX, BOX, DEFAULT, True, 2.2, 0.7),
    "into overlap": lambda: Case(LENS, BOX, DEFAULT, True, 1.8, 1.6),
    "overlap, no twists": lambda: Case(ELLIPSOID, BOX, DEFAULT, False, 1.4, 1.1),
    "deadline": lambda: Case(LENS, BOX, so.PredictorCorrector(deadline=2), True, 1.8, 1.5),
    "a coarse tolerance": lambda: Case(
        LENS, BOX, so.PredictorCorrector(tolerance=1e-4), True, 1.8, 1.0
    ),
    "local depth": lambda: Case(BOX, BOX, so.PredictorCorrector(depth="local"), True, 1.2, 0.9),
    "one minimum": lambda: Case(BOX, BOX, ALONE, True, 1.2, 0.9),
    "one minimum, apart": lambda: Case(BOX, ELLIPSOID, ALONE, True, 2.6, 0.9),
    "a horizon": lambda: Case(LENS, BOX, so.PredictorCorrector(within=0.3), True, 2.4, 1.6),
    "a horizon, no twists": lambda: Case(
        ELLIPSOID, BOX, so.PredictorCorrector(within=0.3), False, 2.4, 1.6
    ),
    "a horizon, the paper's law": lambda: Case(
        ELLIPSOID, LENS, so.PaperLaw(within=0.3), True, 2.6, 0.9
    ),
    "half-space": lambda: Case(so.shapes.halfspace(), LENS, DEFAULT, True, 1.5, 1.4),
    "planar": lambda: Case(PLANAR, PLANAR, DEFAULT, True, 2.2, 1.6),
    "rounded": lambda: Case(ROUNDED, ELLIPSOID, DEFAULT, True, 2.2, 1.4),
    "formula": lambda: Case(formula(), ELLIPSOID, DEFAULT, True, 3.2, 1.5),
    "the paper's law": lambda: Case(ELLIPSOID, LENS, so.PaperLaw(), True, 2.6, 0.6),
    "the paper's switching": lambda: Case(LENS, BOX, VORONOI, True, 2.4, 0.8),
    "the paper's law, covariant": lambda: Case(LENS, LENS, COVARIANT, True, 2.6, 0.6),
    "the paper's law in overlap": lambda: Case(BOX, BOX, so.PaperLaw(), True, 1.6, 1.2),
}


def frames_of(case: Case) -> Frames:
    """A approaches B along a slanted way while both turn; about z alone in the plane."""
    planar = case.a.dimension == 2
    t = DT * np.arange(FRAMES)
    spins = np.array([[0.0, 0.0, 0.4], [0.3, -0.2, 1.1]]) * ([0, 0, 1] if planar else 1)
    if not case.a.bounded:
        spins[0] = 0.0
    way = np.array([0.96, 0.28, 0.0]) if planar else np.array([0.9, 0.3, 0.316])
    if not case.a.bounded:
        way = np.array([0.0, 0.0, 1.0])
    phase = np.pi * t / t[-1]
    far = case.reach - 0.5 * case.sweep * (1.0 - np.cos(phase))
    speed = -0.5 * case.sweep * np.sin(phase) * np.pi / t[-1]
    poses = np.tile(np.eye(4), (2, FRAMES, 1, 1))
    for body, spin in enumerate(spins):
        turns = Rotation.from_rotvec(np.outer(10.0 * t, spin))
        poses[body, :, :3, :3] = turns.as_matrix()
    poses[1, :, :3, 3] = far[:, None] * way
    twists = np.zeros((2, FRAMES, 6))
    twists[:, :, 3:] = 10.0 * spins[:, None]
    twists[1, :, :3] = speed[:, None] * way
    return Frames(*poses, *twists)


class Listed:
    """A path through listed poses, one each half frame: those between are not asked for."""

    def __init__(self, poses: Array, twists: Array) -> None:
        self.poses, self.twists = poses, twists

    def pose(self, t: float) -> so.Pose:
        return so.Pose(*_parts(self.poses[round(t / DT)]))

    def twist(self, t: float) -> so.Twist:
        return so.Twist(self.twists[round(t / DT)][:3], self.twists[round(t / DT)][3:])


def _parts(pose: Array) -> tuple[Array, Array]:
    return pose[:3, :3], pose[:3, 3]


def tracker_of(case: Case) -> so.Tracker:
    return so.Tracker(case.a, case.b, DT, case.law)


def begun(case: Case, frames: Frames, tracker: so.Tracker) -> so.TrackerState:
    given = [x[0] for x in frames[: 4 if case.twists else 2]]
    return tracker.start(*given)


def by_step(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    rows = [state.proximity.row]
    for k in range(1, FRAMES):
        state, answer = tracker.step(state, *[x[k] for x in frames[: 4 if case.twists else 2]])
        rows.append(answer.row)
    return np.array(rows)


def by_step_of_objects(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    rows = [state.proximity.row]
    for k in range(1, FRAMES):
        given = [_parts(x[k]) for x in frames[:2]]
        given += [(x[k][:3], x[k][3:]) for x in frames[2:]] if case.twists else []
        state, answer = tracker.step(state, *given)
        rows.append(answer.row)
    return np.array(rows)


def by_step_into(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    buffer, rows = tracker.buffer(state), [state.proximity.row]
    for k in range(1, FRAMES):
        tracker.step_into(buffer, *[x[k] for x in frames[: 4 if case.twists else 2]])
        rows.append(buffer.out.copy())
    return np.array(rows)


def by_the_buffer(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    buffer, rows = tracker.buffer(state), [state.proximity.row]
    buffer.has_twist = case.twists
    for k in range(1, FRAMES):
        buffer.pose_a[:], buffer.pose_b[:] = (flat_pose(x[k]) for x in frames[:2])
        if case.twists:
            buffer.twist_a[:], buffer.twist_b[:] = (x[k] for x in frames[2:])
        tracker.step_into(buffer)
        rows.append(buffer.out.copy())
    return np.array(rows)


def by_run(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    _, answers = tracker.run(state, *[x[1:] for x in frames[: 4 if case.twists else 2]])
    return np.vstack([state.proximity.row, answers.blocks[:, : K.N_OUT]])


def by_motions(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    state = begun(case, frames, tracker)
    rows = [np.array([flat_pose(pose) for pose in x[1:]]) for x in frames[:2]]
    motions = np.hstack([*rows, frames.twists_a[1:], frames.twists_b[1:]])
    steps = np.full(FRAMES - 1, DT)
    found = calls.run(tracker.table, motions, case.twists, steps, state.data.copy())
    return np.vstack([state.proximity.row, found.rows])


TOLD = {
    K.DISTANCE: "distance",
    K.LOWER_BOUND: "lower_bound",
    K.UPPER_BOUND: "upper_bound",
    K.POINT_A: "point_a",
    K.POINT_B: "point_b",
    K.NORMAL: "normal",
    K.OUT_RATE: "rate",
    K.VELOCITY_A: "velocity_a",
    K.VELOCITY_B: "velocity_b",
    K.RESIDUAL: "residual",
}
"""Of an answer, what a recording keeps as it is."""


def by_track(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    if not case.twists:
        pytest.skip("a path has twists")
    paths = Listed(frames.poses_a, frames.twists_a), Listed(frames.poses_b, frames.twists_b)
    from standoff.recording.track import track_along

    times = DT * np.arange(FRAMES)
    told = track_along(tracker, *paths, times, locate=False)
    rows = np.full((FRAMES, K.N_OUT), np.nan)
    for column, name in TOLD.items():
        values = np.asarray(getattr(told, name)).reshape(FRAMES, -1)
        rows[:, column : column + values.shape[1]] = values
    rows[:, K.STATUS] = [status.value for status in told.status]
    return rows


def by_distances(case: Case, frames: Frames, tracker: so.Tracker) -> Array:
    if case.twists or case.law is not DEFAULT:
        pytest.skip("so.distances takes neither twists nor a law")
    return so.distances(case.a, case.b, *frames[:2], warm=True).rows


def simulated(case: Case, frames: Frames, law: Any) -> tuple[Array, Frames]:
    """The answers of a pair in a simulated system, and the frames that it has made.

    A is driven. B is free, so heavy that its contact does not turn it, and goes straight on: its
    pose and velocity stand in the state as the tracker reads them.
    """
    start = so.Pose(*_parts(frames.poses_b[0]))
    speed = -case.sweep / (DT * FRAMES) * frames.poses_b[0, :3, 3] / case.reach
    bodies = [
        sim.RigidBody.driven(case.a, Listed(frames.poses_a, frames.twists_a)),
        sim.RigidBody.free(
            case.b, mass=1e40, inertia=1e40 * np.eye(3), centre=np.zeros(3),
            pose=start, twist=so.Twist(speed, np.zeros(3)),
        ),
    ]  # fmt: skip
    system = sim.System(bodies, sim.HuntCrossley(stiffness=1e-50), gravity=(0.0, 0.0, 0.0))
    operator = sim.Operator(system, DT, law=law)
    run = operator.run(operator.start(allow_overlap=True), FRAMES - 1)
    at = D.STATE_HEADER + 2 * D.N_BODY + K.N_STATE
    poses, twists = np.tile(np.eye(4), (FRAMES, 1, 1)), np.zeros((FRAMES, 6))
    row = run.states[:, D.STATE_HEADER + D.N_BODY :]
    poses[:, :3, :3] = row[:, D.X_ROTATION : D.X_ROTATION + 9].reshape(-1, 3, 3)
    poses[:, :3, 3] = row[:, D.X_CENTRE : D.X_CENTRE + 3]
    twists[:, :3] = row[:, D.X_VELOCITY : D.X_VELOCITY + 3]
    made = Frames(frames.poses_a, poses, frames.twists_a, twists)
    return np.array(run.states[:, at : at + K.N_OUT]), made


ROUTES: dict[str, Callable[[Case, Frames, so.Tracker], Array]] = {
    "step, of objects": by_step_of_objects,
    "step_into": by_step_into,
    "step_into, in the buffer": by_the_buffer,
    "run": by_run,
    "flat motions": by_motions,
    "so.track": by_track,
    "so.distances, warm": by_distances,
}


NO_TURN = 1e-60
"""More than the velocities [1/s] by which contact turns a body of 1e40."""


def differing(found: Array, wanted: Array, least: float = 0.0) -> Array:
    """Frames whose answers differ in any bit of what the route tells."""
    told = ~np.isnan(found).all(axis=0)
    found, wanted = found[:, told], wanted[:, told]
    same = (
        (found == wanted) | (np.abs(found - wanted) < least) | (np.isnan(found) & np.isnan(wanted))
    )
    return np.flatnonzero(~same.all(axis=1))


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("name", CASES)
def test_every_route_answers_alike(name: str, route: str) -> None:
    case = CASES[name]()
    frames, tracker = frames_of(case), tracker_of(case)
    if route == "so.distances, warm":
        tracker = so.Tracker(case.a, case.b)  # its frame time is the usual one
    wanted = by_step(case, frames, tracker)
    found = ROUTES[route](case, frames, tracker)
    assert differing(found, wanted).tolist() == []


@pytest.mark.parametrize("route", [name for name in ROUTES if name != "so.distances, warm"])
def test_a_route_out_of_step_is_seen(route: str) -> None:
    """With one option of the law changed on that route alone."""
    case = CASES["into overlap"]()
    frames = frames_of(case)
    wanted = by_step(case, frames, tracker_of(case))
    other = case._replace(law=so.PredictorCorrector(predictor="secant"))
    assert len(differing(ROUTES[route](other, frames, tracker_of(other)), wanted))


@pytest.mark.parametrize("name", [name for name in CASES if "no twists" not in name])
def test_a_simulated_pair_answers_alike(name: str) -> None:
    case = CASES[name]()
    if case.a.dimension == 2:
        pytest.skip("systems are spatial")
    found, frames = simulated(case, frames_of(case), case.law)
    assert differing(found, by_step(case, frames, tracker_of(case)), NO_TURN).tolist() == []


def test_a_simulated_pair_out_of_step_is_seen() -> None:
    case = CASES["into overlap"]()
    other = so.PredictorCorrector(predictor="secant")
    found, frames = simulated(case, frames_of(case), other)
    assert len(differing(found, by_step(case, frames, tracker_of(case))))


def test_the_cases_have_all_statuses() -> None:
    seen = set()
    for made in CASES.values():
        case = made()
        seen |= set(by_step(case, frames_of(case), tracker_of(case))[:, K.STATUS].astype(int))
    names = {status.name for status in so.Status if status.value in seen}
    assert {
        *("CONVERGED", "TRACKING", "LOCAL", "GLOBAL", "DEADLINE", "NOT_RESTARTED", "FAR")
    } <= names
