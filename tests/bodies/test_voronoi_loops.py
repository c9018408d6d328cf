"""Medial axes of random convex loops, against dense samples of the boundary."""

from collections import Counter
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import standoff as so
from draws import draws
from families.convex_loops import random_loop
from standoff.bodies.voronoi import discs, medial_axis

Array = NDArray[np.float64]
SAMPLES = 1200
"""Points of a densely sampled edge: its chords miss it by less than 1e-6 of the size here."""


@lru_cache(maxsize=4)
def sampled(body: so.Body) -> list[Array]:
    """Points (n, 2) of every edge."""
    return [
        np.array([edge.curve.point(t)[:2] for t in ts])
        for edge in body.edge_parts
        for ts in [np.linspace(edge.curve.first, edge.curve.last, SAMPLES)]
    ]


def distances(body: so.Body, point: Array) -> Array:
    """Distance of a point to every edge: to the chords between its samples."""
    found = []
    for points in sampled(body):
        start, along = points[:-1], np.diff(points, axis=0)
        share = ((point - start) * along).sum(axis=1) / (along**2).sum(axis=1)
        miss = point - start - np.clip(share, 0.0, 1.0)[:, None] * along
        found.append(np.linalg.norm(miss, axis=1).min())
    return np.array(found)


def corners(body: so.Body) -> list[int]:
    """Vertices where the tangent turns."""
    found = []
    for k in range(body.n_vertices):
        into, out = body.edge_parts[k - 1].curve, body.edge_parts[k].curve
        a, b = into.jet(into.last)[1], out.jet(out.first)[1]
        if np.cross(a, b)[2] > 1e-6 * np.linalg.norm(a) * np.linalg.norm(b):
            found.append(k)
    return found


@settings(max_examples=draws(3), deadline=None)
@given(st.integers(0, 10**6))
def test_random_loops_have_two_nearest_edges_along_a_tree(seed: int) -> None:
    """Every point of a branch is nearest to its two edges; the branches are one tree, and it has
    an end at every corner."""
    body = random_loop(seed)
    assume(body is not None)
    assert body is not None
    regions = so.voronoi_regions(body, tolerance=1e-3 * body.size)
    tolerance = 3e-6 * body.size
    ends: Counter[so.Feature] = Counter()
    places = set()
    for branch in regions.medial_axis:
        for point, depth, parameters in list(
            zip(branch.points[:, :2], branch.depth, branch.parameters, strict=True)
        )[::6]:
            found = distances(body, point)
            assert found.min() == pytest.approx(depth, abs=tolerance)
            for feature, t in zip(branch.features, parameters, strict=True):
                assert found[feature.index] == pytest.approx(depth, abs=tolerance)
                touch = body.edge_parts[feature.index].curve.point(t)[:2]
                assert np.linalg.norm(touch - point) == pytest.approx(depth, abs=tolerance)
        for end, point in zip(branch.ends, branch.points[[0, -1]], strict=True):
            places.add(tuple(np.round(point / (1e-7 * body.size)).tolist()))
            if end.kind == "corner":
                ends.update(end.features)
    assert ends == Counter({so.Feature("vertex", k): 1 for k in corners(body)})
    assert len(places) == len(regions.medial_axis) + 1
    check_nearest_edges(regions, seed)


def check_nearest_edges(regions: so.voronoi.VoronoiRegions, seed: int) -> None:
    """At random points inside, the feature is the edge nearest by dense samples."""
    body, rng = regions.body, np.random.default_rng(seed)
    edges = np.concatenate(sampled(body))
    for _ in range(20):
        point = rng.dirichlet(np.ones(4)) @ edges[rng.integers(0, len(edges), 4)]
        found = distances(body, point)
        if np.diff(np.sort(found))[0] > 1e-5 * body.size:
            assert regions.feature_at(point) == so.Feature("edge", int(found.argmin()))


def test_a_branch_with_the_wrong_edges_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checks at the end see discs that are too large by a millionth of the body."""
    body = random_loop(8)
    assert body is not None
    right = discs.greatest_disc

    def wrong(outline: object, foot: object, *way: object) -> discs.Touch:
        touch = right(outline, foot, *way)  # type: ignore[arg-type]
        return touch._replace(radius=touch.radius + 1e-6 * body.size)

    monkeypatch.setattr(medial_axis, "greatest_disc", wrong)
    with pytest.raises(so.voronoi.VoronoiError, match=r"fails its check|No junction"):
        so.voronoi_regions(body)


def test_a_branch_that_is_left_out_is_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    body = random_loop(8)
    assert body is not None
    right = medial_axis.leaves_of
    monkeypatch.setattr(medial_axis, "leaves_of", lambda outline: right(outline)[:-1])
    with pytest.raises(so.voronoi.VoronoiError):
        so.voronoi_regions(body)
