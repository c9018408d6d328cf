"""Steps of a closing, each against what knows nothing of it: the nearest place on trimming curves,
whether a cut pays, and what a hard search proves loosely."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from scipy.optimize import lsq_linear
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from draws import draws
from families.solid_shapes import bolt, bracket, peg, tube
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.entries.queries import on_face
from standoff.kernels.entries.solids import CLOSING, STILL, nearest_in_leaves, side_at
from standoff.kernels.solids import front_rows as F
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids import spatial_progress as C
from standoff.kernels.solids.front_close import pays_to_cut
from standoff.kernels.solids.spatial_closing import nearest_of
from standoff.kernels.solids.spatial_search import close_loosely
from standoff.kernels.solids.trim_witness import nearest_on_trim
from standoff.solids import Solid
from standoff.solids.spatial import minimum
from standoff.solids.spatial.minimum import leaf_jet_of

Array = np.ndarray
INNER, OUTER = 0.5, 0.8


def row_of(turn: Array, move: Array) -> Array:
    return np.concatenate([np.ravel(turn), move])


def whole(solid: Solid, leaf: int) -> Array:
    return np.array(solid.leaves[leaf].reals[:4])


def leaves(solid: Solid, dim: int) -> list[int]:
    return [k for k, leaf in enumerate(solid.leaves) if leaf.dim == dim]


@njit
def part_of(solid, pose, leaf, box):
    side = side_at(solid, pose, S.OUTSIDE)
    return S.Part(side, leaf, S.Box(box[0], box[1], box[2], box[3]))


@njit
def on_trim(solids, pose, numbers, box_a, box_b, counts):
    a = part_of(solids[0], STILL, numbers[0], box_a)
    b = part_of(solids[1], pose, numbers[1], box_b)
    return nearest_on_trim(a, b, pointer(counts, 0))


def rims_to(a: Solid, b: Solid, pose: Array, box: Array | None = None) -> list[tuple[float, Array]]:
    """Of each of A's leaves that is trimmed and each vertex of B: (distance, parameters)."""
    counts, found = np.zeros(8, dtype=np.int64), []
    for one in leaves(a, 2):
        for other in leaves(b, 0):
            numbers = np.array([one, other])
            asked = whole(a, one) if box is None else box
            q, d = on_trim((a.packed, b.packed), pose, numbers, asked, whole(b, other), counts)
            found.append((d, np.array(q)))
    return found


def test_the_nearest_on_rims_is_that_of_two_circles(rng) -> None:
    """From any place: in the rims' plane, on the axis, where all of a rim is as near, on a rim."""
    a, b = tube(INNER, OUTER, -0.6, 0.6), bracket()
    heights = np.array([leaf_jet_of(a.packed, k, 0.0, 0.0)[0][2] for k in leaves(a, 2)])
    spots = np.array([leaf_jet_of(b.packed, k, 0.0, 0.0)[0] for k in leaves(b, 0)])
    places = [
        (0.0, 0.0, 1.0),
        (0.0, 0.0, 0.6),
        (OUTER, 0.0, 0.6),
        (0.7, 0.3, 0.6),
        (0.0, -9.0, 0.0),
    ]
    beyond: list[float] = []
    for place in [*places, *rng.normal(size=(draws(60), 3))]:
        turn = Rotation.random(random_state=rng).as_matrix()
        move = np.array(place) - turn @ spots[0]
        at = spots @ turn.T + move
        found = rims_to(a, b, row_of(turn, move))
        told = np.reshape([d for d, _ in found], (len(heights), len(spots)))
        for d, q in found:
            if d < np.inf:
                assert min(abs(np.hypot(*q[:2]) - r) for r in (INNER, OUTER)) < 1e-12
        off = np.abs(np.hypot(at[:, 0], at[:, 1])[:, None] - [INNER, OUTER]).min(axis=1)
        for height in (-0.6, 0.6):
            true = np.hypot(at[:, 2] - height, off)
            beyond.extend((told[heights == height].min(axis=0) - true) / np.maximum(true, 0.1))
    assert min(beyond) > -1e-12
    assert max(beyond) < 0.01
    assert np.median(beyond) < 1e-4


@pytest.mark.parametrize(
    ("move", "least"),
    [
        ((2.0, 0.0, 0.6), 2.0 - OUTER - 0.3),
        ((0.0, 0.0, 0.6), INNER - 0.3 * 2**0.5),
        ((0.0, 0.0, 1.0), np.hypot(INNER - 0.3 * 2**0.5, 0.4)),
        ((INNER, 0.0, 0.6), 0.0),
    ],
)
def test_the_nearest_on_rims_to_a_square_beside_them(move, least) -> None:
    """The box of a round end, in the plane of the rims or above it."""
    a, b = tube(INNER, OUTER, -0.6, 0.6), peg(0.3, 0.0, 1.0)
    counts, told = np.zeros(8, dtype=np.int64), []
    low = [k for k in leaves(b, 2) if b.leaves[k].cut and leaf_jet_of(b.packed, k, 0, 0)[0][2] == 0]
    for one in leaves(a, 2):
        for other in low:
            boxes = whole(a, one), whole(b, other)
            pose = row_of(np.eye(3), np.array(move))
            asked = (a.packed, b.packed), pose, np.array([one, other]), *boxes, counts
            told.append(on_trim(*asked)[1])
    assert min(told) == pytest.approx(least, abs=1e-9)


def test_parts_that_no_trim_is_in_have_no_place_on_one() -> None:
    a, b = tube(INNER, OUTER, -0.6, 0.6), bracket()
    pose = row_of(np.eye(3), np.array([0.0, 0.0, 2.0]))
    for box in ((0.6, 0.7, 0.1, 0.2), (0.0, 0.3, 0.0, 0.3), (0.65, 0.65, 0.0, 0.0)):
        flat = [k for k in leaves(a, 2) if a.leaves[k].cut]
        found = rims_to(a, b, pose, np.array(box))
        assert len(found) > len(flat)
        assert all(d == np.inf for d, _ in found)


@njit
def cut_pays(solids, pose, numbers, box_a, box_b, goal, travel, counts):
    a = part_of(solids[0], STILL, numbers[0], box_a)
    b = part_of(solids[1], pose, numbers[1], box_b)
    q, distance = nearest_of(a, b, pointer(counts, 0))
    return pays_to_cut((a, b, q, distance), goal, travel, pointer(counts, 0)), distance


def least_of(jets: list[Array], boxes: list[Array]) -> float:
    """The distance of two flat parts or lines: least squares within bounds."""
    columns = np.column_stack([jets[0][1], jets[0][2], -jets[1][1], -jets[1][2]])
    low, high = np.concatenate([box.reshape(2, 2) for box in boxes]).T
    free = high > low
    off = jets[0][0] - jets[1][0] + columns[:, ~free] @ low[~free]
    if not free.any():
        return float(np.linalg.norm(off))
    told = lsq_linear(columns[:, free], -off, (low[free], high[free]), method="bvls", tol=1e-15)
    return float(np.sqrt(2.0 * told.cost))


def test_a_cut_pays_where_the_other_half_is_farther(rng) -> None:
    """Of the longer part's half that does not hold the nearest points, by least squares."""
    a, told = bracket(), []
    parts = leaves(a, 2) + leaves(a, 1)
    for _ in range(draws(600)):
        turn, numbers = Rotation.random(random_state=rng).as_matrix(), rng.choice(parts, 2)
        pose = row_of(turn, 3.0 * rng.normal(size=3))
        boxes = []
        for k in numbers:
            low, high = whole(a, k).reshape(2, 2).T
            boxes.append(np.sort(rng.uniform(low, high, (2, 2)), axis=0).T.ravel())
        jets = [leaf_jet_of(a.packed, k, 0.0, 0.0) for k in numbers]
        jets[1] = jets[1] @ turn.T + np.array([pose[9:], *np.zeros((5, 3))])
        long = [np.linalg.norm(jet[1 + i]) * np.ptp(box[2 * i :][:2])
                for jet, box in zip(jets, boxes, strict=True) for i in range(2)]  # fmt: skip
        cut = int(np.argmax(long))
        if long[cut] < 1e-9 + np.partition(long, -2)[-2]:
            continue
        halves = []
        for half in range(2):
            both = [box.copy() for box in boxes]
            ends = both[cut // 2][2 * (cut % 2) :][:2]
            ends[1 - half] = ends.mean()
            halves.append(least_of(jets, both))
        distance = min(halves)
        goal = distance + rng.choice([-0.1, 0.0, 0.01, 0.3]) * long[cut]
        ahead = long[cut] * rng.choice([1e-6, 1e-2, 0.2, 0.3])
        travel = F.Travel(0.0, ahead, *[0.0] * 12)
        counts = np.zeros(8, dtype=np.int64)
        asked = (a.packed, a.packed), pose, numbers, *boxes, goal, travel, counts
        pays, found = cut_pays(*asked)
        assert found == pytest.approx(distance, abs=1e-9)
        other = max(halves)
        if abs(other - goal - ahead) > 1e-9:
            told.append(pays)
            assert pays == (other >= goal + ahead and long[cut] > 4.0 * ahead)
    assert 0.1 < np.mean(told) < 0.9


@njit
def loosely(solids, pose, first, best, minima, pairs, work, counts):
    a, b = side_at(solids[0], STILL, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    room = (pointer(pairs, 0), len(pairs), pointer(work, 0))
    left = len(pairs) // C.LEFT_REALS
    told = pointer(best, 0), pointer(minima, 0)
    close_loosely(a, b, first, left, told[0], told[1], room, pointer(counts, 0))


def leaf_points(solid: Solid, across: int = 12) -> list[Array]:
    """Of each leaf points that are on the solid."""
    found = []
    for k, leaf in enumerate(solid.leaves):
        u0, u1, v0, v1 = whole(solid, k)
        at = [(u, v) for u in np.linspace(u0, u1, across) for v in np.linspace(v0, v1, across)]
        ints, reals = solid.boundary.ints, solid.boundary.reals
        at = [q for q in at if leaf.dim < 2 or on_face(ints, reals, leaf.chart, *q)]
        found.append(np.array([leaf_jet_of(solid.packed, k, *q)[0] for q in at]).reshape(-1, 3))
    return found


@pytest.mark.parametrize("case", ["ample", "late", "local", "told too far"])
def test_what_a_hard_search_proves_loosely_is_true(case, rng) -> None:
    """Half of the least distance of all pairs, as long as there is time; never more than there is,
    though the search be told that its nearest points are farther than they are."""
    a, b, away = bolt(), bracket(), 2.0
    if case == "late":  # a pin in a bore, so that bounds of leaves do not do
        a, b, away = tube(INNER, OUTER, -0.6, 0.6), peg(0.4, -0.5, 0.5), 0.05
    size, tops = a.size + b.size, (leaf_points(a), leaf_points(b))
    for _ in range(draws(3)):
        pose, found = drawn_apart(a, b, away, rng)
        turn = pose[:9].reshape(3, 3)
        factor = 1.5 if case == "told too far" else 1.0
        best, minima = minimum.started(minimum.SearchOptions(1e-6 * size), size, 0.0)
        best[C.LEAST], best[C.BEYOND] = factor * found.upper, 0.0
        best[C.LEAF_A : C.AT + 4] = found.best[1:7]
        best[C.OPEN], best[C.N_OPEN], best[C.MOST_OPEN] = 7.0, 2.0, 0.0
        best[C.ABOVE] = 2.0 * found.upper if case == "local" else 0.0
        every = [(i, j) for i in range(len(a.leaves)) for j in range(len(b.leaves))]
        rows = np.array(
            [[np.inf, *pair, *middle_of(a, pair[0]), *middle_of(b, pair[1])] for pair in every]
        )
        counts = np.zeros(8, dtype=np.int64)
        nearest_in_leaves((a.packed, b.packed), pose, rows, counts)
        apart = []
        for _, i, j, *q in rows:
            x = leaf_jet_of(a.packed, i, *q[:2])[0]
            apart.append(
                np.linalg.norm(leaf_jet_of(b.packed, j, *q[2:])[0] @ turn.T + pose[9:] - x)
            )
        apart = np.full(len(rows), np.inf) if case == "told too far" else np.array(apart)
        lefts = np.column_stack([rows[:, 1:3], np.zeros(len(rows)), apart, rows[:, 3:]])
        first, before = len(lefts) // 3, best.copy()
        counts[C.BOXES] = 2 * best[C.BUDGET] if case == "late" else 0
        pairs = lefts.ravel().copy()
        loosely((a.packed, b.packed), pose, first, best, minima, pairs, np.empty(CLOSING), counts)
        after = pairs.reshape(lefts.shape)
        for at in (C.TOLERANCE, C.OPEN, C.N_OPEN, C.MOST_OPEN):
            assert best[at] == before[at]
        assert np.array_equal(np.delete(after, 2, axis=1), np.delete(lefts, 2, axis=1))
        low = after[:, 2]
        assert not low[:first].any()
        if case == "local":
            assert not low.any()
            continue
        if case == "late":
            assert low[first:].min() < 0.4 * found.upper
        if case == "ample":
            assert low[first:].min() >= 0.5 * found.upper - 2.0 * best[C.ROUNDING]
            assert np.mean(low[first:] > 0.9 * found.upper) > 0.5
        for (i, j), bound in zip(every, low, strict=True):
            x, y = tops[0][i], tops[1][j] @ turn.T + pose[9:]
            if len(x) and len(y):
                assert bound <= cKDTree(x).query(y)[0].min() + 2.0 * best[C.ROUNDING]


def drawn_apart(
    a: Solid, b: Solid, away: float, rng: np.random.Generator
) -> tuple[Array, minimum.LeastFound]:
    """A pose of B, near A, and what is found of it."""
    while True:
        turn, move = Rotation.random(random_state=rng), rng.normal(size=3)
        if away < 1.0:
            turn = Rotation.from_rotvec(0.05 * move / np.linalg.norm(move))
        pose = row_of(turn.as_matrix(), away * move / np.linalg.norm(move))
        senses, size = (S.OUTSIDE, S.OUTSIDE), a.size + b.size
        found = minimum.least_distance(a.packed, b.packed, pose, senses, size)
        if not found.met:
            return pose, found


def middle_of(solid: Solid, leaf: int) -> tuple[float, float]:
    u0, u1, v0, v1 = whole(solid, leaf)
    return 0.5 * (u0 + u1), 0.5 * (v0 + v1)
