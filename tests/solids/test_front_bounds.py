"""What a front keeps of each pair of pieces, against points of the pieces and against the local
minima that a query from nothing finds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numba import njit
from scipy.spatial.transform import Rotation

import standoff as so
from draws import draws
from families.solid_shapes import bolt, bracket, egg, peg, ring, tube
from on_first_use import OnFirstUse
from shares import share
from standoff.kernels.algebra.rigid import unit_quaternion
from standoff.kernels.entries.queries import on_face
from standoff.kernels.entries.solids import STILL as STILL_POSE
from standoff.kernels.entries.solids import side_at
from standoff.kernels.solids import front_rows as F
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.front_motion import (
    carry_row,
    mark_bound,
    mark_place,
    mark_shut,
    slope_of,
)
from standoff.kernels.solids.over_plane import beside_by, feet_of, plane_of
from standoff.kernels.solids.spatial_closing import OWN_B
from standoff.kernels.solids.spatial_pieces import leaf_box
from standoff.kernels.solids.torus_potential import (
    AXIS_OF,
    CENTRE_OF,
    CIRCLE_OF,
    CONE_OF,
    TORUS_THROUGH,
    Potential,
    potential_jet,
)
from standoff.kernels.values import Pose
from standoff.solids import Solid, SolidTracker
from standoff.solids.spatial.minimum import leaf_jet_of

Array = np.ndarray
STILL = np.eye(4)
PAIRS = OnFirstUse(
    {
        "bracket, bolt": lambda: (bracket(), bolt()),
        "ring, peg": lambda: (ring(1.0, 0.25), peg(0.3, -1.0, 1.0)),
        "bracket, peg": lambda: (bracket(), peg(0.6, -1.0, 1.0)),
        "egg, tube": lambda: (egg(0.9, 0.6, 0.4), tube(0.5, 0.8, 0.0, 0.6)),
    }
)
SAMPLES = 4
# Of B, length.
RADIUS = 0.3
# How much more than B's motion a point of A may move, as B sees it.
AFAR = 2.0


def placed(turn: Array, shift: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def motions() -> dict[str, Array]:
    """A step of B (4, 4): along, about its own middle, about a far point, and at random."""
    turn = Rotation.from_rotvec([0.0, 0.01, 0.004]).as_matrix()
    far = np.array([2.0, -1.0, 1.0])
    return {
        "along": placed(np.eye(3), [0.004, -0.01, 0.006]),
        "turning": placed(turn, np.zeros(3)),
        "swinging": placed(turn, far - turn @ far),
    }


@cache
def points_of(solid: Solid, leaf: int, box: tuple[float, ...]) -> Array:
    """Points (n, 3) of a leaf's part that are on the solid, own frame."""
    part = solid.leaves[leaf]
    u, v = np.linspace(*box[:2], SAMPLES), np.linspace(*box[2:], SAMPLES)
    found = []
    for s in u[: 1 if part.dim == 0 else None]:
        for t in v[: None if part.dim == 2 else 1]:
            ints, reals = solid.boundary.ints, solid.boundary.reals
            if part.dim == 2 and not on_face(ints, reals, part.chart, float(s), float(t)):
                continue
            found.append(leaf_jet_of(solid.packed, leaf, float(s), float(t))[0])
    return np.array(found).reshape(-1, 3)


def leaves_below(solid: Solid, node: int) -> list[int]:
    own = solid.packed[2]
    at = int(own[S.NODES]) + S.NODE_INTS * node
    if own[at + 2] >= 0:
        return [int(own[at + 2])]
    return leaves_below(solid, int(own[at])) + leaves_below(solid, int(own[at + 1]))


def part_points(solid: Solid, which: float, box: Array) -> Array:
    if which >= 0.0:
        return points_of(solid, int(which), tuple(box.tolist()))
    leaves = leaves_below(solid, -1 - int(which))
    whole = [points_of(solid, k, tuple(map(float, solid.leaves[k].reals[:4]))) for k in leaves]
    return np.concatenate(whole)


@pytest.mark.parametrize(("name", "way"), share(2, PAIRS, [*motions(), "towards"]))
def test_no_pair_of_pieces_is_nearer_than_its_bound(name: str, way: str) -> None:
    a, b = PAIRS[name]
    rng = np.random.default_rng(len(name) + len(way))
    pose = placed(Rotation.random(random_state=rng).as_matrix(), np.zeros(3))
    apart = rng.normal(size=3)
    pose[:3, 3] = 0.7 * (a.size + b.size) * apart / np.linalg.norm(apart)
    if name == "bracket, peg":  # an edge beside a round wall
        pose[:3, :3] = Rotation.from_rotvec([0.2, 0.1, 0.0]).as_matrix()
        apart = np.array([1.0, 1.0, 0.2])
        pose[:3, 3] = a.size * apart / np.linalg.norm(apart)
    nearer = placed(np.eye(3), -0.01 * apart / np.linalg.norm(apart))
    tracker, step = SolidTracker(a, b), motions().get(way, nearer)
    state = tracker.start(STILL, pose)
    tight, seen = 0, set()
    for k in range(24):
        pose = pose @ step if way == "turning" else step @ pose
        state, found = tracker.step(state, STILL, pose)
        assert found.certified
        if k % 6 != 5:
            continue
        front = state.front
        assert front is not None
        n = int(front.store[F.N_ROWS])
        rows = front.rows.reshape(n, F.ROW_REALS)
        bounds = front.keys.reshape(n, F.KEY_REALS)[:, 0] - front.store[F.GONE]
        # the farthest kept bounds can be wrong most
        closed = np.flatnonzero(rows[:, F.ROW_WAY] >= 0.0)
        seen.update(rows[closed, F.ROW_WAY].tolist())
        for i in {*np.argsort(-bounds)[:200].tolist(), *closed.tolist()}:
            row = rows[i]
            x = part_points(a, row[F.ROW_A], row[F.ROW_BOXES : F.ROW_BOXES + 4])
            y = part_points(b, row[F.ROW_B], row[F.ROW_BOXES + 4 : F.ROW_BOXES + 8])
            if not len(x) or not len(y):
                continue
            y = y @ pose[:3, :3].T + pose[:3, 3]
            least = np.linalg.norm(x[:, None] - y[None], axis=2).min()
            assert bounds[i] <= least + 1e-9
            tight += bounds[i] > 0.8 * least
    assert tight > 20
    assert name != "bracket, peg" or OWN_B in seen


@pytest.mark.parametrize("way", motions())
def test_no_local_minimum_is_in_what_is_shut(way: str) -> None:
    """By normals and tangents: what a plane's face leaves out is only proven up to a distance."""
    a, b = PAIRS["bracket, bolt"]
    step = motions()[way]
    tracker = SolidTracker(a, b)
    pose = placed(Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix(), [2.6, 0.4, 0.9])
    state = tracker.start(STILL, pose)
    looked = 0
    for k in range(30):
        pose = pose @ step if way == "turning" else step @ pose
        state, found = tracker.step(state, STILL, pose)
        if k % 3:
            continue
        front = state.front
        assert front is not None
        n = int(front.store[F.N_ROWS])
        rows, keys = front.rows.reshape(n, -1), front.keys.reshape(n, -1)
        shut = (keys[:, 1] > front.store[F.GONE]) & (rows[:, F.ROW_GOAL] == np.inf)
        cold = so.solids.distance(a, b, STILL, pose, minima=found.distance + 1.5)
        assert cold.certified
        for each in cold.minima:
            looked += 1
            for row in rows[shut & (rows[:, F.ROW_A] >= 0.0)]:
                held = is_within(a, row, 0, each) and is_within(b, row, 1, each)
                assert not held, (k, each)
    assert looked >= 10


def is_within(solid: Solid, row: Array, side: int, found: so.solids.NearestPair) -> bool:
    """Is a witness point inside of a row's part, away from its sides?"""
    leaf = int(row[F.ROW_A + side])
    feature = found.feature_b if side else found.feature_a
    at = found.parameters_b if side else found.parameters_a
    if solid.feature_of(leaf) != feature:
        return False
    box = row[F.ROW_BOXES + 4 * side :][:4].reshape(2, 2)[: len(at)]
    spare = 1e-6 * (box[:, 1] - box[:, 0])
    return bool(np.all(box[:, 0] + spare < at) and np.all(at < box[:, 1] - spare))


def travel_at(turn: Array, shift: Array) -> F.Travel:
    pose = Pose(tuple(turn.ravel().tolist()), tuple(shift.tolist()))
    quaternion = unit_quaternion(pose.R)
    return F.Travel(
        50.0, 0.0, RADIUS, 1.0 / RADIUS, AFAR, True, pose, quaternion, 0.0, 0.0, 0.0,
        0.0, pose, quaternion,
    )  # fmt: skip


@njit
def carry(front, middle, first, then, bend, room, goal):
    mark_place(front, 0, middle, 0.1, 0.4, first)
    mark_bound(front, 0, 1.0, (0.0, 0.0, 1.0), bend, room)
    mark_shut(front, 0, 0.5, goal)
    carry_row(front, 0, 0.0, then)


def carried(
    turn: Array, shift: Array, bend: float, room: float, goal: float = np.inf
) -> tuple[float, float]:
    """(bound, length that is still shut) of a row that had 1 and 0.5, with the slope along z, when
    B was as it is; after a turn of B about the middle of its piece, and a shift. It was shut for
    pairs up to `goal`, and is asked for those up to 0."""
    store, keys, row = (np.zeros(n) for n in (F.STORE_REALS, F.KEY_REALS, F.ROW_REALS))
    front = F.Front(store, keys, row, 1, np.zeros(0), np.zeros(0))
    rng = np.random.default_rng(3)
    first, at = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    front.keys[:] = -np.inf
    middle = first @ [0.3, -0.2, 0.5] + at
    then = travel_at(turn @ first, middle + turn @ (at - middle) + shift)
    carry(front, tuple(middle.tolist()), travel_at(first, at), then, bend, room, goal)
    return front.keys[0] - 50.0, front.keys[1] - 50.0


def test_a_row_s_bound_is_lessened_along_its_slope_alone() -> None:
    none, up = np.eye(3), np.array([0.0, 0.0, 0.02])
    across = np.array([0.3, -0.4, 0.0])
    # bounds are kept beside the motion of all, which is 50
    close = pytest.approx
    assert carried(none, across, 0.0, np.inf) == (close(1.0), close(0.0, abs=1e-12))
    assert carried(none, up, 0.0, np.inf) == (close(1.02), close(0.48))
    assert carried(none, -up, 0.0, np.inf) == (close(0.98), close(0.48))
    # a slope that bends: over the piece's radius of 0.1, and half of the way
    assert carried(none, across, 0.2, np.inf)[0] == close(1.0 - 0.2 * (0.1 + 0.25) * 0.5)
    way = np.hypot(0.5, 0.02)
    bent = 0.2 * (0.1 + 0.5 * way) * way
    assert carried(none, across - up, 0.2, np.inf)[0] == close(0.98 - bent)
    # but never by more than was gone
    assert carried(none, -up, 0.2, np.inf)[0] == close(0.98)
    # beyond where the slope is known, what was gone counts
    assert carried(none, across, 0.0, 0.4)[0] == close(0.5)
    assert carried(none, up, 0.0, 0.01)[0] == close(0.98)


@pytest.mark.parametrize("angle", [1e-9, 1e-3, 0.3, 3.0])
def test_a_turn_of_a_row_s_piece_counts_by_its_radius(angle: float) -> None:
    rng = np.random.default_rng(int(1e3 * angle) + 1)
    for _ in range(20):
        axis = rng.normal(size=3)
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        bound, shut = carried(turn, np.zeros(3), 0.0, np.inf)
        chord = 2.0 * np.sin(0.5 * angle)
        assert bound == pytest.approx(1.0 - 0.1 * chord, abs=1e-13)
        # what is shut by normals lasts by the turn
        assert shut == pytest.approx(0.5 - RADIUS * angle, abs=1e-13)
        # by a plane, by how far A's piece may move as B sees it; while it is asked for no more
        _, shut = carried(turn, np.zeros(3), 0.0, np.inf, 9.0)
        assert shut == pytest.approx((0.5 - 0.4 * chord) / AFAR, abs=1e-13)
        assert carried(np.eye(3), np.array([0.1, 0.0, 0.0]), 0.0, np.inf, 0.05)[1] == pytest.approx(
            0.05
        )
        assert carried(np.eye(3), np.zeros(3), 0.0, np.inf, -1e-9)[1] == -np.inf


@njit
def slope_and_values(phi, centre, radius, room, y, z):
    slope, bend, room = slope_of(phi, 1.0, centre, radius, room)
    return slope, bend, room, potential_jet(phi, y, 0.0)[0], potential_jet(phi, z, 0.0)[0]


@pytest.mark.parametrize("kind", [TORUS_THROUGH, CONE_OF, CIRCLE_OF, AXIS_OF, CENTRE_OF])
def test_a_potential_s_slope_differs_by_no_more_than_is_told(kind: int) -> None:
    rng = np.random.default_rng(kind)
    told = 0
    for _ in range(300):
        frame = Rotation.random(random_state=rng).as_matrix()
        e1, e2, n = (tuple(map(float, column)) for column in frame.T)
        k1, k2 = rng.uniform(-1.0, 1.0, 2) if kind == TORUS_THROUGH else rng.uniform(0.3, 0.9, 2)
        if kind == CONE_OF:
            k1, k2 = np.cos(k1), np.sin(k1)
        phi = Potential(kind, (0.1, -0.2, 0.3), e1, e2, n, float(k1), float(k2), 1.0)
        centre, radius, room = rng.normal(size=3), 0.2 * rng.uniform(), 0.2 * rng.uniform()
        way, by = rng.normal(size=(2, 3))
        y = centre + radius * rng.uniform() * way / np.linalg.norm(way)
        by *= room * rng.uniform() / np.linalg.norm(by)
        at = [tuple(map(float, x)) for x in (centre, y, y + by)]
        told_of = slope_and_values(phi, at[0], radius, room, at[1], at[2])
        slope, bend, told_room, before, after = told_of
        long = np.linalg.norm(by)
        if long > told_room:
            continue
        off = bend * (radius + 0.5 * long) * long
        assert after - before >= slope @ by - off - 1e-15
        assert after - before <= slope @ by + off + 1e-15
        told += 1
    assert told > 30


@njit
def beside(solids, pose, leaves, goal, share):
    """(length, jet and normal of the face): see `beside_by`, of A's leaf and B's."""
    a, b = side_at(solids[0], STILL_POSE, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    face = S.Part(a, leaves[0], leaf_box(a, leaves[0]))
    part = S.Part(b, leaves[1], leaf_box(b, leaves[1]))
    jet, n = plane_of(face)
    return beside_by(face, feet_of(jet, n, part), goal, 0.0, share), jet, n


def test_no_motion_that_is_told_brings_a_part_over_a_plane() -> None:
    """Nearer than what is to be proven, which grows by that motion too."""
    a, b = PAIRS["bracket, bolt"]
    rng, goal, tight = np.random.default_rng(8), 0.3, 0
    planes = [k for k, leaf in enumerate(a.leaves) if leaf.dim == 2]
    parts = [k for k, leaf in enumerate(b.leaves) if leaf.dim]
    for _ in range(draws(400)):
        turn, shift = Rotation.random(random_state=rng).as_matrix(), 2.0 * rng.normal(size=3)
        one, other = int(rng.choice(planes)), int(rng.choice(parts))
        pose = np.concatenate([turn.ravel(), shift])
        free, jet, n = beside((a.packed, b.packed), pose, (one, other), goal, 1.0)
        twice = beside((a.packed, b.packed), pose, (one, other), goal, 2.0)[0]
        if free <= 0.0:
            assert twice <= 0.0
            continue
        assert 0.5 * free - 1e-9 <= twice <= free + 1e-9
        points = points_of(b, other, tuple(map(float, b.leaves[other].reals[:4])))
        origin, across = np.array(jet[0]), np.array(jet[1:3]).T
        box = np.array(a.leaves[one].reals[:4]).reshape(2, 2)
        half = 0.5 * (box[:, 1] - box[:, 0])

        def over(by: np.ndarray, reach: float) -> bool:
            x = points @ turn.T + shift + by - origin  # noqa: B023
            height = x @ np.array(n)  # noqa: B023
            uv = np.linalg.lstsq(across, x.T, rcond=None)[0].T  # noqa: B023
            on = (np.abs(uv) < half - 1e-9).all(axis=1)  # noqa: B023
            return bool((on & (height > 1e-9) & (height < reach - 1e-9)).any())

        ways = rng.normal(size=(40, 3))
        ways = np.vstack([ways, n, -np.array(n), *across.T, *-across.T])
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        assert not any(over(0.999 * free * way, goal + 0.999 * free) for way in ways)
        tight += any(over(1.3 * free * way, goal + 1.3 * free) for way in ways)
    assert tight > 20
