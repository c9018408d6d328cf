"""Kinds of edges: proven by bounds of the normals, and searched from both sides where not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from families.solid_shapes import ball, bolt, bracket, prism
from standoff.bodies import EdgeKind
from standoff.bodies.face_leaves import face_charts
from standoff.kernels.solids import spatial_layout as S
from standoff.solids import Solid
from standoff.solids.spatial import edge_kinds, tree
from standoff.solids.spatial.distance import spatial_distance
from standoff.solids.spatial.trims import columns_of, pieces_of
from standoff_studies.soak.solid_parts import MAKERS


def proven(solid: Solid) -> list[EdgeKind | None]:
    charts = {chart.number: chart for chart in face_charts(solid.boundary)}
    pieces = pieces_of(solid.boundary, charts)
    return edge_kinds.proven_kinds(solid.boundary, charts, pieces, columns_of(pieces))


@pytest.mark.parametrize("name", ["bolt", "bracket", "channel", "hollow", "plate", "wedge", "ring"])
def test_kinds_of_parts_are_proven(name: str) -> None:
    solid = Solid(MAKERS[name]().boundary)
    assert proven(solid) == list(solid.boundary.edge_kinds)
    assert solid.edges_sampled == ()


@pytest.mark.slow
def test_blends_of_other_axes_are_only_sampled() -> None:
    """A pipe's straight ends go over into its bend: a cylinder and a torus about another axis."""
    solid = Solid(MAKERS["elbow"]().boundary)
    told = {solid.boundary.edge_kinds[k] for k in solid.edges_sampled}
    assert told == {EdgeKind.SMOOTH}
    assert 0 < len(solid.edges_sampled) < solid.boundary.n_edges / 3


@pytest.mark.parametrize("turn", [3e-4, -3e-4, 2e-9])
def test_a_turn_that_is_almost_none_is_decided(turn: float) -> None:
    """An edge in the middle of a top that is bent by an angle: at 2e-9 radians it is smooth."""
    outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0 + np.tan(turn)), (0.0, 1.0)]
    solid = prism(outline, 0.5)
    expected = EdgeKind.SMOOTH if abs(turn) < 1e-8 else None
    expected = expected or (EdgeKind.CONVEX if turn > 0.0 else EdgeKind.REFLEX)
    found = proven(solid)
    assert found.count(EdgeKind.CONVEX) == (15 if expected is EdgeKind.CONVEX else 14)
    assert expected in found
    assert None not in found


def test_a_kind_that_contradicts_the_samples_is_not_believed(monkeypatch) -> None:
    """With the normals' cones too wide to decide, edges are pieces seen from both sides, and the
    distance is the same."""
    made = bracket().boundary
    whole = spatial_distance(bracket(), ball(0.2), None, (np.eye(3), (2.3, 0.8, 0.35)))
    kinds = edge_kinds._kinds

    def undecided(*given: Any) -> edge_kinds.Kinds:
        found = kinds(*given)
        return edge_kinds.Kinds({kind: at & False for kind, at in found.shown.items()}, found.lost)

    monkeypatch.setattr(edge_kinds, "_kinds", undecided)
    doubtful = Solid(made)
    assert len(doubtful.edges_sampled) == made.n_edges
    senses = {leaf.senses for leaf in doubtful.leaves if leaf.dim == 1}
    assert senses == {S.OUTSIDE | S.INSIDE}
    answer = spatial_distance(doubtful, ball(0.2), None, (np.eye(3), (2.3, 0.8, 0.35)))
    assert answer.status is whole.status
    assert answer.distance == pytest.approx(whole.distance, abs=1e-12)


def test_edges_have_narrow_cones_of_normals() -> None:
    """Where the normals are known, the search may leave an edge out by them."""
    for solid in (bolt(), bracket()):
        wide = [leaf.reals[S.CONE_OUT + 3] for leaf in solid.leaves if leaf.dim == 1]
        known = [angle for angle in wide if angle >= 0.0]
        assert max(known) < 0.5 * np.pi
        leaves, _, _ = tree.all_leaves(solid.boundary)
        assert len(leaves) == len(solid.leaves)


def test_a_kind_holds_of_all_vectors_in_the_cones(rng) -> None:
    """Whatever unit vectors in the cones are taken, the sine of the turn has the sign that was
    proven."""

    def near(axis: np.ndarray, angle: float) -> np.ndarray:
        way = np.cross(axis, rng.normal(size=3))
        turn = angle * np.sqrt(rng.uniform())
        return np.cos(turn) * axis + np.sin(turn) * way / np.linalg.norm(way)

    decided = lost = 0
    for _ in range(800):
        axes = [v / np.linalg.norm(v) for v in rng.normal(size=(3, 3))]
        if rng.uniform() < 0.5:  # nearly smooth, with normals that are known well
            axes[1] = near(axes[0], 1e-3)
            axes[2] = np.cross(axes[0], axes[1])
            axes[2] *= rng.choice([-1.0, 1.0]) / np.linalg.norm(axes[2])
            angles = [*(1e-3 * rng.uniform(0.0, 0.5, 2)), rng.uniform(0.0, 1.2)]
        else:
            angles = [*rng.uniform(0.0, 0.2, 2), rng.uniform(0.0, 0.25)]
        cones = list(zip(axes, angles, strict=True))
        found = edge_kinds._kinds(*(axis[None] for axis in axes), tuple(angles))
        sines = []
        for _ in range(60):
            one, two, way = (near(*cone) for cone in cones)
            sines.append(float(np.cross(one, two) @ way))
        if found.shown[EdgeKind.CONVEX][0]:
            assert min(sines) > 0.0
        elif found.shown[EdgeKind.REFLEX][0]:
            assert max(sines) < 0.0
        decided += bool(found.shown[EdgeKind.CONVEX] | found.shown[EdgeKind.REFLEX])
        lost += bool(found.lost)
        for _ in range(10 if found.lost else 0):  # a narrower tangent decides no better
            t = near(axes[2], angles[2])[None]
            again = edge_kinds._kinds(axes[0][None], axes[1][None], t, (*angles[:2], 0.0))
            assert not any(shown.any() for shown in again.shown.values())
    assert decided > 100
    assert lost > 20
