"""Threads: the screw motion of a face, and the potential that is constant along one."""

from __future__ import annotations

from functools import cache
from itertools import product

import mpmath as mp
import numpy as np
import pytest
from numba import njit

import standoff as so
from families.threads import FLANK, GAP, RISE, bar, beside, flanks
from standoff.kernels.entries.solids import side_at
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.screw import common_screw, screw_between
from standoff.kernels.solids.spatial_pieces import leaf_box, leaf_jet
from standoff.kernels.solids.torus_potential import SCREW_OF, THIRD, Potential, potential_jet
from standoff.solids import distance
from standoff.solids.spatial import tree
from standoff.solids.spatial.minimum import IDENTITY, leaf_jet_of
from standoff.solids.spatial.screws import screw_of
from standoff.tracking.status import Status

STILL = so.Pose.identity()


def drawn(rng, least: float) -> Potential:
    """The potential of a screw about the z-axis that serves from `least` along x on."""
    rise, angle = rng.uniform(-0.5, 0.5), rng.uniform(0.0, 2.0 * np.pi)
    s, t = np.cos(angle), np.sin(angle)
    steepest = np.hypot(s * np.hypot(1.0, rise / least), t)
    slopes = (s / steepest, t / steepest, 0.0)
    zero = (0.0, 0.0, 0.0)
    return Potential(SCREW_OF, zero, (1.0, 0.0, 0.0), slopes, (0.0, 0.0, 1.0), rise, least, 1.0)


def plain(phi, x):
    """The formula, with mpmath's numbers."""
    return phi.e2[0] * (x[2] - phi.k1 * mp.atan2(x[1], x[0])) + phi.e2[1] * mp.hypot(x[0], x[1])


def derivative(phi, place, way, order: int) -> float:
    """Of some order along a way."""
    with mp.workdps(40):
        line = [(mp.mpf(p), mp.mpf(w)) for p, w in zip(place, way, strict=True)]
        return float(mp.diff(lambda s: plain(phi, [p + s * w for p, w in line]), 0, order))


def beyond(rng, least: float) -> np.ndarray:
    return np.array([least, 0.0, 0.0]) + rng.exponential(1.0) * np.array(
        [abs(rng.normal()), *rng.normal(size=2)]
    )


def test_the_potential_changes_by_no_more_than_the_way(rng) -> None:
    steep = 0.0
    for _ in range(2000):
        least = 10.0 ** rng.uniform(-1.0, 0.5)
        phi = drawn(rng, least)
        x = beyond(rng, least)
        y = beyond(rng, least) if rng.random() < 0.5 else x + 1e-3 * rng.normal(size=3)
        y[0] = max(y[0], least)
        change = abs(potential_jet(phi, tuple(x), 0.0)[0] - potential_jet(phi, tuple(y), 0.0)[0])
        way = np.linalg.norm(y - x)
        assert change <= way * (1.0 + 1e-9) + 1e-14
        steep = max(steep, change / way)
    assert steep > 0.95


@pytest.mark.parametrize("reach", [0.0, 0.3])
def test_its_derivatives_and_their_bounds(reach, rng) -> None:
    tightest = 0.0
    for _ in range(60):
        phi = drawn(rng, 1.0)
        x = beyond(rng, 1.0)
        value, gradient, H, c1, c2 = potential_jet(phi, tuple(x), reach)
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        near = x + reach * rng.uniform(0.0, 1.0) * rng.normal(size=3) / 3.0
        near[0] = max(near[0], 1.0)
        if np.linalg.norm(near - x) > reach:
            near = x
        here = [derivative(phi, x, way, k) for k in range(3)]
        there = [abs(derivative(phi, near, way, k)) for k in (2, 3)]
        a, b, c, d, e, f = H
        full = np.array([[a, b, c], [b, d, e], [c, e, f]])
        assert value == pytest.approx(here[0], abs=1e-14 * (1.0 + abs(x).max()))
        assert gradient @ way == pytest.approx(here[1], abs=1e-13)
        assert way @ full @ way == pytest.approx(here[2], abs=1e-13)
        assert there[0] <= (c1 + c2) * (1.0 + 1e-12)
        assert there[1] <= (THIRD * (c1 * c1 + c2 * c2) + 3.0 * c1 * c2) * (1.0 + 1e-12)
        tightest = max(tightest, there[0] / (c1 + c2))
    assert tightest > 0.3


def test_the_screw_of_a_face_is_found(rng) -> None:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    shift = rng.normal(size=3)
    u, v = rng.uniform(0.0, 1.0, 60), rng.uniform(0.0, 2.0, 60)
    for rise in (0.16, -0.4, 0.0):
        radius = 2.0 + u
        out = np.stack([np.cos(v), np.sin(v), 0 * v], axis=1)
        around = np.stack([-np.sin(v), np.cos(v), 0 * v], axis=1)
        z = np.array([0.0, 0.0, 1.0])
        points = radius[:, None] * out + (rise * v + 0.3 * u * u)[:, None] * z
        across = np.cross(out + 0.6 * u[:, None] * z, radius[:, None] * around + rise * z)
        across /= np.linalg.norm(across, axis=1)[:, None]
        screw = screw_of(points @ turn.T + shift, across @ turn.T)
        assert screw is not None
        assert screw.rise == pytest.approx(rise, abs=1e-12)
        assert abs(screw.axis @ turn[:, 2]) == pytest.approx(1.0, abs=1e-12)
        off = screw.point - shift
        assert np.linalg.norm(off - (off @ screw.axis) * screw.axis) < 1e-11


def test_where_there_are_many_screws_or_none_no_one_is_taken(rng) -> None:
    v, z = rng.uniform(0.0, 2.0, 60), rng.uniform(0.0, 1.0, 60)
    out = np.stack([np.cos(v), np.sin(v), 0 * v], axis=1)
    assert screw_of(out + z[:, None] * np.array([0.0, 0.0, 1.0]), out) is None  # a cylinder
    sphere = rng.normal(size=(60, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    assert screw_of(sphere, sphere) is None
    plane = np.stack([v, z, 0 * v], axis=1)
    assert screw_of(plane, np.tile([0.0, 0.0, 1.0], (60, 1))) is None
    bent = rng.normal(size=(60, 3))
    assert screw_of(bent, sphere) is None
    assert screw_of(bent[:5], sphere[:5]) is None
    assert screw_of(np.zeros((60, 3)), sphere) is None


@cache
def answers() -> tuple:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tree, "put_screws", lambda leaves, charts, beside: None)
        without = bar(FLANK, 0.0, 1.0, 5), bar(beside(), -0.2, 0.8, 5)
    return distance(*flanks(), STILL, STILL), distance(*without, STILL, STILL)


def test_flanks_side_by_side_are_closed_by_their_screw() -> None:
    by_screw, by_others = answers()
    for answer in answers():
        assert answer.status is Status.CONVERGED
        # splines are threads only nearly
        assert answer.distance == pytest.approx(GAP, rel=0.02)
    assert by_screw.distance == pytest.approx(by_others.distance, abs=1e-12)
    assert by_screw.counts.evaluations < 0.5 * by_others.counts.evaluations


@njit
def between(solids, pose, leaves, at, n):
    a, b = side_at(solids[0], pose, S.OUTSIDE), side_at(solids[1], pose, S.OUTSIDE)
    pa = S.Part(a, leaves[0], leaf_box(a, leaves[0]))
    pb = S.Part(b, leaves[1], leaf_box(b, leaves[1]))
    jets = leaf_jet(a, leaves[0], at[0], at[1]), leaf_jet(b, leaves[1], at[2], at[3])
    x, y = jets[0][0], jets[1][0]
    return screw_between(pa, pb, x, y, n, common_screw(pa, pb, leaves, jets))


def sampled(solid, leaf: int) -> tuple[np.ndarray, np.ndarray]:
    """Parameters of a leaf, and its points there."""
    u0, u1, v0, v1 = solid.leaves[leaf].reals[:4]
    places = np.array(list(product(np.linspace(u0, u1, 5), np.linspace(v0, v1, 9))))
    return places, np.array([leaf_jet_of(solid.packed, leaf, u, v)[0] for u, v in places])


def test_between_two_parts_it_changes_by_no_more_than_the_way() -> None:
    a, b = flanks()
    leaves_of = [[k for k, leaf in enumerate(s.leaves) if leaf.kind == S.SCREWED] for s in (a, b)]
    made, steepest = 0, 0.0
    for one, other in product(*leaves_of):
        (ps, xs), (qs, ys) = sampled(a, one), sampled(b, other)
        ways = np.linalg.norm(xs[:, None] - ys[None], axis=2)
        i, j = np.unravel_index(ways.argmin(), ways.shape)
        if ways[i, j] > 0.1:
            continue
        n = (ys[j] - xs[i]) / ways[i, j]
        leaves = np.array([one, other])
        at = (*ps[i].tolist(), *qs[j].tolist())
        known, phi = between((a.packed, b.packed), IDENTITY, leaves, at, tuple(n))
        if not known:
            continue
        made += 1
        low, high = (
            np.array([potential_jet(phi, tuple(p), 0.0)[0] for p in own]) for own in (xs, ys)
        )
        changes = np.abs(high[None] - low[:, None]) / ways
        assert changes.max() <= 1.0 + 1e-12
        steepest = max(steepest, changes.max())
    assert made > 5
    assert steepest > 0.9995


def test_a_bar_has_one_screw() -> None:
    for solid in flanks():
        found = {
            (leaf.reals[S.NATURAL_REALS + 1],) for leaf in solid.leaves if leaf.kind == S.SCREWED
        }
        assert len(found) == 1
        assert abs(found.pop()[0]) == pytest.approx(RISE, rel=1e-2)


def test_edges_of_a_thread_have_its_screw() -> None:
    for solid in flanks():
        records = [
            tuple(leaf.reals[S.NATURAL_REALS : S.NATURAL_REALS + 9])
            for leaf in solid.leaves
            if leaf.kind == S.SCREWED and leaf.dim == 1
        ]
        edges = {leaf.feature for leaf in solid.leaves if leaf.kind == S.SCREWED and leaf.dim == 1}
        # all four along the bar, and those of its ends, which are beside its faces too
        assert len(edges) >= 4
        assert len(set(records)) == 1
