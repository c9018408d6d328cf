"""On which side of a solid points beyond its sharp vertices are."""

import numpy as np
import pytest

from families.solid_shapes import prism
from standoff.solids.spatial.minimum import leaf_jet_of
from standoff.solids.spatial.points import distance_to_boundary, side_of


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.3])
def test_points_beyond_an_acute_vertex_are_outside(turned, rng) -> None:
    """Of the edges that end there, some have both faces turned away from the point: what they would
    say holds along the edge only."""
    wide = np.deg2rad(20.0)
    corner = np.array([0.31, -0.17, 0.0])
    first, last = (np.array([np.cos(t), np.sin(t)]) for t in (turned, turned + wide))
    flat = corner[:2]
    solid = prism([tuple(flat), tuple(flat + first), tuple(flat + last)], 0.5)
    normals = np.array([[first[1], -first[0], 0.0], [-last[1], last[0], 0.0], [0.0, 0.0, -1.0]])
    weights = rng.dirichlet([0.4, 0.4, 0.4], 120)
    away = weights @ normals
    away *= (rng.uniform(0.05, 0.5, 120) / np.linalg.norm(away, axis=1))[:, None]
    told = solid.signed_distance(corner + away)
    np.testing.assert_allclose(told.distance, np.linalg.norm(away, axis=1), atol=1e-12)
    assert not solid.contains(corner + away).any()
    ends = [
        (leaf, float(u))
        for leaf, part in enumerate(solid.leaves)
        if part.dim == 1
        for u in part.reals[:2]
        if np.linalg.norm(leaf_jet_of(solid.packed, leaf, float(u), 0.0)[0] - corner) < 1e-12
    ]
    assert len(ends) == 3
    for point in (corner + away)[:40]:
        found = distance_to_boundary(solid, point)
        for leaf, u in ends:  # whichever place is found first
            row = np.array([found.upper, 0.0, leaf, 0.0, 0.0, u, 0.0, 0.0])
            assert side_of(solid, row, found.minima, point) == 1.0
