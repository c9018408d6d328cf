"""The printed Voronoi tests, alone: from any feature they lead to the one nearest to a point."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from numba import njit

import standoff as so
from shares import share
from standoff.bodies.features import feature_of
from standoff.kernels.compiler.decorators import pointer
from standoff.kernels.entries.queries import chart_normal, feature_jet
from standoff.kernels.pair import events as N
from standoff.kernels.paper.voronoi import voronoi_switch
from standoff.kernels.state.options import read_options
from standoff.kernels.values import Pair, Place, Work
from standoff.tracking.options import pack_options
from standoff.tracking.places import put
from standoff.tracking.rows import StateRow
from standoff_studies.paper.bodies import lens_of_patches, planar_body
from standoff_studies.paper.simulation_a.setting import vault

BODIES = {
    "lens": so.shapes.lens(1.0, 0.45),
    "lens of patches": lens_of_patches(),
    "box": so.shapes.box(1.0, 0.7, 0.5),
    "tetrahedron": so.shapes.polytope(
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 0.9, 0.1], [0.3, 0.3, 0.8]]
    ),
    "cylinder": so.shapes.cylinder(0.5, 0.8),
    "cone": so.shapes.cone(0.5, 0.9),
    "planar loop": planar_body(),
}
POINT = so.shapes.point()
REST = np.eye(4)
MOST = 12
"""Switches from any feature to the nearest: a Lin-Canny walk visits no feature twice."""


@njit
def switch(
    ints: Any, reals: Any, x: Any, law: Any, mode: Any, q: Any, counts: Any, log: Any
) -> bool:
    body = pointer(ints, 0), pointer(reals, 0)
    place = Place(mode[0], mode[1], mode[2], mode[3], q[0], q[1], q[2], q[3])
    none = pointer(log, 0)
    work = Work(pointer(counts, 0), pointer(log, 0), none, none)
    pair = Pair(body[0], body[1], body[0], body[1])
    options = read_options(pointer(law, 0))
    switched, place = voronoi_switch(pair, 0, (x[0], x[1], x[2]), law[-1], place, options, work)
    mode[0], mode[1], q[0], q[1] = place.feature_a, place.chart_a, place.u, place.v
    return switched


def starts(body: so.Body) -> list[tuple[so.Feature, tuple[float, ...]]]:
    """A place on every feature, found from points around the body; vertices beside."""
    found: dict[so.Feature, tuple[float, ...]] = {}
    rng = np.random.default_rng(5)
    for x in points(body, 400, rng):
        answer = so.distance(body, POINT, REST, so.Pose(np.eye(3), x))
        found.setdefault(answer.feature_a, answer.parameters_a)
    assert len(found) == body.n_faces + body.n_edges + body.n_vertices
    return list(found.items())


def points(body: so.Body, n: int, rng: np.random.Generator) -> np.ndarray:
    directions = rng.normal(size=(n, 3))
    if body.dimension == 2:
        directions[:, 2] = 0.0
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return directions * body.size * rng.uniform(0.75, 2.0, (n, 1))


STEEP = {
    "stretched lens": lens_of_patches().transformed(np.diag([0.7, 1.1, 0.9])),
    "vault": vault(),
}
"""Bodies with faces whose nearest side has no plane, as it has collapsed, or hides their middle."""


@pytest.mark.parametrize("name", STEEP)
def test_no_side_or_corner_holds_a_point_on_a_far_face(name: str) -> None:
    """From corners, sides and middles of all faces to the feature of a cold query."""
    body = STEEP[name]
    law = np.append(
        pack_options(so.PaperLaw(switching="voronoi", reset="nearest").resolved(1e-3)),
        4.0 * body.size,
    )
    rng, along = np.random.default_rng(3), (0.0, 0.5, 1.0)
    counts, log = N.new_counts(), np.zeros(N.MAX_EVENTS * N.EVENT_COLUMNS)
    for x in points(body, 100, rng):
        truth = so.distance(body, POINT, REST, so.Pose(np.eye(3), x))
        for face, u, v in product(range(body.n_faces), along, along):
            state = StateRow()
            put(state, 0, body, (("face", face), (u, v)))
            mode, q = state.mode.astype(np.int64), state.q.copy()
            counts[:] = 0
            switches = 0
            while switch(body.ints, body.reals, x, law, mode, q, counts, log):
                switches += 1
                assert switches <= MOST, (x, face, u, v)
            found = feature_of(body, int(mode[0]))
            assert found == truth.feature_a, (x, face, u, v, found, truth.feature_a)


@pytest.mark.parametrize(("name", "far_side"), share(2, BODIES, ["left", "kept"]))
def test_voronoi_tests_lead_to_the_nearest_feature(name: str, far_side: str) -> None:
    """From every feature to that of a cold query, or, where the far side is kept, to a face that
    has the point behind it; and never farther from the point at a switch (the paper: the distance
    between features never grows)."""
    body = BODIES[name]
    options = pack_options(so.PaperLaw(switching="voronoi", far_side=far_side).resolved(1e-3))
    law = np.append(options, 4.0 * body.size)
    begins = starts(body)
    rng = np.random.default_rng(11)
    counts, log = N.new_counts(), np.zeros(N.MAX_EVENTS * N.EVENT_COLUMNS)
    longest, stayed = 0, 0
    for x in points(body, 60, rng):
        pose = so.Pose(np.eye(3), x)
        truth = so.distance(body, POINT, REST, pose)
        for feature, parameters in begins:
            state = StateRow()
            put(state, 0, body, (feature, parameters))
            mode, q = state.mode.astype(np.int64), state.q.copy()
            counts[:] = 0
            apart = [distance_at(body, mode, q, pose)]
            while switch(body.ints, body.reals, x, law, mode, q, counts, log):
                apart.append(distance_at(body, mode, q, pose))
                assert len(apart) <= MOST, (x, feature)
            longest = max(longest, len(apart) - 1)
            assert (np.diff(apart) <= 1e-12).all(), (x, feature, apart)
            found = feature_of(body, int(mode[0]))
            if found != truth.feature_a:
                assert found.kind == "face", (x, feature, found)
                assert behind(body, mode, q, x), (x, feature, found)
                stayed += 1
    assert longest >= 2
    assert stayed <= (0.15 * 60 * len(begins) if far_side == "kept" else 0)


def behind(body: so.Body, mode: np.ndarray, q: np.ndarray, x: np.ndarray) -> bool:
    """Is x behind the face's tangent plane at its point, where the printed tests do not look?"""
    normal = chart_normal(body.ints, body.reals, int(mode[1]), float(q[0]), float(q[1]))
    jet = feature_jet(body.ints, body.reals, int(mode[0]), int(mode[1]), float(q[0]), float(q[1]))
    return bool(np.dot(normal, x - np.array(jet[0])) < 0.0)


def distance_at(body: so.Body, mode: np.ndarray, q: np.ndarray, pose: so.Pose) -> float:
    feature = feature_of(body, int(mode[0]))
    n = {"face": 2, "edge": 1, "vertex": 0}[feature.kind]
    here = (feature, tuple(float(t) for t in q[:n]))
    system = so.tracking.pair_system(body, POINT, REST, pose, here, (("vertex", 0), ()))
    return float(np.linalg.norm(system.dR))
