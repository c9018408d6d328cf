"""No tick leaves out a pair whose own bound would not: against all pairs, by brute force."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from pointed import pointed
from scipy.spatial.transform import Rotation

import standoff as so
import standoff.simulation as sim
from standoff.kernels.body import layout as L
from standoff.kernels.dynamics import arrays as K
from standoff.kernels.dynamics import near_arrays as G
from standoff.kernels.dynamics.near_pairs import find_near
from standoff.simulation.packed_system import body_start

WITHIN = 0.2
SHAPES = (
    so.shapes.ellipsoid(0.05, 0.04, 0.06),
    so.shapes.box((0.1, 0.06, 0.3)),
    so.shapes.sphere(0.06),
    so.shapes.capsule(0.03, 0.4),
    so.shapes.box((1.5, 1.5, 0.05)),
    so.shapes.polytope(np.array([[0.3, 0, 0], [0.4, 0, 0], [0.3, 0.1, 0], [0.3, 0, 0.1]])),
)
N = 24


def system(rng: np.random.Generator, all_pairs: bool) -> sim.System:
    """Free and fixed bodies of several kinds, and two half-spaces."""
    bodies = [sim.RigidBody.fixed(so.shapes.halfspace())]
    for k in range(N):
        shape = SHAPES[k % len(SHAPES)]
        free = k % 4 != 3
        bodies.append(sim.RigidBody.free(shape, mass=1.0) if free else sim.RigidBody.fixed(shape))
    bodies.append(sim.RigidBody.fixed(so.shapes.halfspace()))
    chosen = [
        (i, j)
        for i, j in itertools.combinations(range(N + 2), 2)
        if "free" in (bodies[i].kind, bodies[j].kind)
    ]
    if not all_pairs:
        chosen = [chosen[k] for k in rng.permutation(len(chosen))[: len(chosen) // 2]]
        chosen = [pair[:: 1 if rng.random() < 0.5 else -1] for pair in chosen]
    return sim.System(bodies, sim.HuntCrossley(stiffness=10.0, depth=1e-3), pairs=chosen)


class Search:
    """The kernel's search, tick after tick."""

    def __init__(self, made: sim.System) -> None:
        law = so.PredictorCorrector(depth="local", within=WITHIN)
        layout, numbers, ints, reals, options, _ = sim.Operator(made, 1e-3, law=law).packed
        assert layout[K.I_NEAR] > 0
        self.made = made
        self.kept = [x.copy() for x in (layout, numbers, options)]
        pointers = [pointed(x) for x in self.kept]
        solids = K.Solids(*(pointed(np.zeros(1)),) * 6)
        self.bodies = ints, reals
        ints_at, reals_at = pointed(ints), pointed(reals)
        self.system = K.System(
            pointers[0], pointers[1], ints_at, reals_at, pointers[2], pointers[1], solids
        )
        self.near, self.near_numbers = G.near_arrays(self.system)
        empty = pointed(np.zeros(1))
        unused = dict.fromkeys(K.Scratch._fields, empty)
        near = {"near": pointed(self.near), "near_numbers": pointed(self.near_numbers)}
        self.scratch = K.Scratch(**unused | near)

    def tick(self, poses: np.ndarray) -> tuple[bool, list[int]]:
        """(must it visit all, the pairs that it visits) at poses of all bodies."""
        rows = [np.zeros(K.STATE_HEADER)]
        for body, (R, p) in zip(self.made.bodies, poses, strict=True):
            if np.isfinite(p).all():
                rows.append(body_start(replace(body, pose=so.Pose(R, p))))
            else:
                rows.append(np.concatenate([R.ravel(), p, np.zeros(6)]))
        state = np.concatenate(rows)
        everything = bool(find_near(self.system, pointed(state), self.scratch))
        n = self.near[G.G_VISITED]
        return everything, self.near[G.NEAR_HEADER : G.NEAR_HEADER + max(n, 0)].tolist()


def bound(a: so.Body, b: so.Body, pose_a: tuple, pose_b: tuple) -> float:
    """Of two boxes along the line of their centres; without one for a half-space."""
    if not (a.bounded and b.bounded):
        return -np.inf
    ends = []
    for body, (R, p) in ((a, pose_a), (b, pose_b)):
        centre = body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
        ends.append((R @ centre + p, R, body.reals[L.BOX_HALF : L.BOX_HALF + 3], body.radius))
    d = ends[1][0] - ends[0][0]
    length = float(np.linalg.norm(d))
    if length == 0.0:
        return -np.inf
    reach = sum(np.abs(R.T @ d / length) @ half + radius for _, R, half, radius in ends)
    return length - float(reach)


def near_by_force(made: sim.System, poses: list) -> set[int]:
    return {
        number
        for number, (i, j) in enumerate(made.pairs)
        if not bound(made.bodies[i].body, made.bodies[j].body, poses[i], poses[j]) > WITHIN
    }


def moved(rng: np.random.Generator, poses: list, speeds: np.ndarray, tick: int) -> list:
    """The bodies go on and turn; now and then some jump, all pause, or all are in one place."""
    if tick % 40 == 20:
        return poses
    found = []
    for k, (R, p) in enumerate(poses):
        turn = Rotation.from_rotvec(0.02 * rng.normal(size=3)).as_matrix()
        at = p + speeds[k]
        if rng.random() < 0.01:
            at = rng.uniform(-2.0, 2.0, 3)
        if tick % 50 == 40:
            at = rng.uniform(-0.3, 0.3, 3)
        if tick % 50 == 45:
            at = rng.uniform(-3.0, 3.0, 3)
        if tick == 170:
            at = at + 1e7
        if tick == 171:
            at = at - 1e7
        found.append((turn @ R, at))
    return found


def farthest_gone(made: sim.System, old: list, new: list) -> tuple[float, float]:
    """At least and at most, how far a point of a bounded body has gone at the farthest."""
    least = most = 0.0
    for body, (R, p), (S, q) in zip(made.bodies, old, new, strict=True):
        if isinstance(body.body, so.Body) and body.body.bounded:
            own = body.body.reals[L.BOX_CENTRE : L.BOX_CENTRE + 3]
            half = body.body.reals[L.BOX_HALF : L.BOX_HALF + 3] + body.body.radius
            shift = float(np.linalg.norm(S @ own + q - R @ own - p))
            turned = float(np.linalg.norm(S - R) * np.linalg.norm(half))
            least, most = max(least, shift), max(most, shift + turned)
    return least, most


@pytest.mark.parametrize("all_pairs", [True, False])
def test_no_pair_is_missed(all_pairs: bool) -> None:
    rng = np.random.default_rng(5)
    made = system(rng, all_pairs)
    search = Search(made)
    n = len(made.bodies)
    poses = [(np.eye(3), rng.uniform(-2.0, 2.0, 3)) for _ in range(n)]
    speeds = 0.01 * rng.normal(size=(n, 3))
    before: set[int] = set()
    counted, looked_at_all = [], []
    for tick in range(250):
        old, poses = poses, moved(rng, poses, speeds, tick)
        everything, seen = search.tick(poses)
        # a body that goes farther than the horizon may have gone through any other
        least, most = farthest_gone(made, old, poses)
        assert everything or (tick > 0 and least <= 1.001 * WITHIN)
        assert not everything or tick == 0 or most > WITHIN
        looked_at_all.append(everything)
        assert seen == sorted(set(seen))
        near = near_by_force(made, poses)
        assert near <= set(seen)
        # and those that are no longer near are seen to be FAR
        assert before <= set(seen) or tick == 0
        before = set(seen) if tick == 0 else near
        counted.append(len(seen))
    assert np.median(counted) < 0.6 * len(made.pairs)
    assert 0.2 < np.mean(looked_at_all) < 0.8


def test_a_motion_that_a_frame_refuses_is_shown_to_all_pairs() -> None:
    rng = np.random.default_rng(6)
    made = system(rng, True)
    search = Search(made)
    poses = [(np.eye(3), rng.uniform(-2.0, 2.0, 3)) for _ in made.bodies]
    assert search.tick(poses)[0]
    assert not search.tick(poses)[0]
    bad = list(poses)
    bad[7] = (np.eye(3), np.array([np.nan, 0.0, 0.0]))
    assert search.tick(bad)[0]
    assert search.near[G.G_VISITED] == -1
    everything, seen = search.tick(poses)  # the table is made anew
    assert everything
    assert near_by_force(made, poses) <= set(seen)
    assert not search.tick(poses)[0]
