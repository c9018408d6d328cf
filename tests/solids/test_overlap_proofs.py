"""What proves a depth, by itself: no place, normal or length makes it claim what is not so."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

import standoff as so
from draws import draws
from families.solid_shapes import bracket, egg, peg, ring, tube
from on_first_use import OnFirstUse
from standoff.kernels.entries.solid_contact import pieces_parted
from standoff.kernels.entries.solids import nearest_in_leaves
from standoff.kernels.solids import spatial_progress as C
from standoff.solids.parting import least_way_out
from standoff.solids.spatial.contact import MOST_LOCAL
from standoff.solids.spatial.minimum import SearchOptions, started
from standoff.solids.spatial.pair import PlacedPair
from standoff.solids.spatial.points import depth_beside, signed_distances
from standoff.solids.spatial.solid_model import SolidModel

Array = np.ndarray
SOLIDS = OnFirstUse(
    {
        "bracket": lambda: bracket(),
        "egg": lambda: egg(0.9, 0.6, 0.4),
        "ring": lambda: ring(1.0, 0.25),
        "tube": lambda: tube(0.5, 0.8, 0.0, 0.6),
        "peg": lambda: peg(0.3, -1.0, 1.0),
    }
)


@pytest.mark.parametrize("name", SOLIDS)
def test_no_point_is_told_to_be_deeper_than_it_is(name: str, rng: np.random.Generator) -> None:
    solid = SOLIDS[name]
    spots = rng.uniform(-0.6, 0.6, size=(draws(60), 3)) * solid.size
    true = signed_distances(solid, spots)
    for spot, distance, low in zip(spots, true.distance, true.lower_bound, strict=True):
        # the boundary may be nearer than what is known of it, or as near
        about = abs(distance) * rng.choice([1.0, 1.0 + 1e-9, 1.3, 4.0])
        told, nearest = depth_beside(solid, spot, about)
        assert told <= max(-low, 0.0) + 1e-12
        if distance < 0.0:
            assert told >= -distance - 0.11 * about
            assert np.linalg.norm(nearest - spot) <= -distance + 0.2 * about
        # where it is known wrongly, nothing is claimed
        wrong = depth_beside(solid, spot, 0.3 * abs(distance))[0]
        assert wrong <= 0.0


def brute_gap(pair: PlacedPair, leaves: tuple[int, int], shift: Array) -> float:
    """The least distance of two leaves that Newton's method finds from many starts, with B moved by
    a vector of A's frame."""
    pose = pair.relative.copy()
    pose[9:] += shift
    grids = []
    for solid, leaf in zip((pair.a, pair.b), leaves, strict=True):
        u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
        grids.append([(u, v) for u in np.linspace(u0, u1, 3) for v in np.linspace(v0, v1, 3)])
    rows = np.array([[0.0, *leaves, *p, *q] for p in grids[0] for q in grids[1]])
    counts = np.zeros(8, dtype=np.int64)
    nearest_in_leaves((pair.a.packed, pair.b.packed), pose, rows, counts)
    least = rows[:, 0].min()  # infinite where a point is off its solid
    return float(least)


def jet_point(solid: SolidModel, leaf: int, u: float, v: float) -> Array:
    from standoff.solids.spatial.minimum import leaf_jet_of

    return leaf_jet_of(solid.packed, leaf, u, v)[0]


@pytest.mark.parametrize("names", [("bracket", "egg"), ("ring", "ring"), ("tube", "peg")])
def test_no_pieces_are_told_to_be_parted_that_are_not(
    names: tuple[str, str], rng: np.random.Generator
) -> None:
    a, b = (SOLIDS[name] for name in names)
    claimed = 0
    for _ in range(draws(150)):
        leaves = int(rng.integers(len(a.leaves))), int(rng.integers(len(b.leaves)))
        sides = zip((a, b), leaves, strict=True)
        ranges = [s.leaves[k].reals[o : o + 2] for s, k in sides for o in (0, 2)]
        at = [rng.uniform(*each) for each in ranges]
        # B is put so that both points are at any signed distance along any unit vector
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        d = -(10.0 ** rng.uniform(-4.0, -0.5))
        turn = so.Pose.exp(rng.normal(size=3)).rotation
        x, y = jet_point(a, leaves[0], *at[:2]), jet_point(b, leaves[1], *at[2:])
        pose = so.Pose(turn, x + d * n - turn @ y)
        pair = PlacedPair(a, b, so.Pose.identity(), pose)
        row = np.zeros(C.MINIMUM_REALS)
        row[0], row[1:3], row[3:7], row[C.NORMAL : C.NORMAL + 3] = d, leaves, at, n
        best, _ = started(SearchOptions(1e-10 * pair.size, above=1.0), pair.size, 1.0)
        lists = best, np.empty(C.MINIMUM_REALS * MOST_LOCAL)
        counts = np.zeros(8, dtype=np.int64)
        by = pieces_parted((a.packed, b.packed), pair.relative, row, lists, counts)
        if by > 0.0:
            claimed += 1
            assert by >= -d
            assert brute_gap(pair, leaves, by * n) > 1e-10 * pair.size
    assert claimed > 0


def test_the_shortest_way_out_is_the_shortest(rng: np.random.Generator) -> None:
    for _ in range(draws(40)):
        normals = rng.normal(size=(rng.integers(1, 6), 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        depths = 10.0 ** rng.uniform(-6.0, 0.0, size=len(normals))
        way = least_way_out(normals, depths)
        found = scipy.optimize.minimize(
            lambda w: w @ w,
            np.zeros(3),
            constraints={"type": "ineq", "fun": lambda w, n=normals, d=depths: n @ w - d},
            options={"ftol": 1e-14, "maxiter": 500},
        )
        if way is None:
            assert not found.success
            continue
        assert (normals @ way >= depths - 1e-9 * depths.max()).all()
        if found.success:
            assert way @ way <= found.fun * (1.0 + 1e-4) + 1e-12
    opposed = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    assert least_way_out(opposed, np.array([0.1, 0.2])) is None
    assert least_way_out(np.empty((0, 3)), np.empty(0)) is None
