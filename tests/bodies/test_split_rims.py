"""A cylinder whose rims are cut into arcs: vertices with face angles of 180 degrees."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry import ConicArc, Cylinder, Plane
from standoff.kernels.body import layout as L

RADIUS, LENGTH = 0.7, 1.3


def split_cylinder(arcs: int) -> so.Body:
    x, y = np.array([RADIUS, 0.0, 0.0]), np.array([0.0, RADIUS, 0.0])
    turns = 0.3 + 2.0 * np.pi * np.arange(arcs + 1) / arcs
    vertices, edges = [], []
    for height in (-LENGTH / 2, LENGTH / 2):
        centre, first = np.array([0.0, 0.0, height]), len(vertices)
        vertices += [centre + x * np.cos(t) + y * np.sin(t) for t in turns[:-1]]
        for i in range(arcs):
            arc = ConicArc(centre, x, y, turns[i], turns[i + 1])
            edges.append(so.bodies.Edge(arc, first + i, first + (i + 1) % arcs))
    low, high = range(arcs), range(arcs, 2 * arcs)
    side = Cylinder(np.diag([RADIUS, RADIUS, 1.0]), np.zeros(3))
    bottom = Plane.through([0, 0, -LENGTH / 2], [0, 1.0, 0], [1.0, 0, 0])
    top = Plane.through([0, 0, LENGTH / 2], [1.0, 0, 0], [0, 1.0, 0])
    faces = [
        so.bodies.Face((side,), tuple((e, 1) for e in low) + tuple((e, -1) for e in high)),
        so.bodies.Face((bottom,), tuple((e, -1) for e in low)),
        so.bodies.Face((top,), tuple((e, 1) for e in high)),
    ]
    return so.Body.from_brep(vertices, edges, faces)


@pytest.mark.parametrize("arcs", [2, 3])
def test_vertices_on_the_rims_have_wide_sectors(arcs: int) -> None:
    body = split_cylinder(arcs)
    rows = body.ints[body.ints[L.VERTICES] :][: L.VERTEX_STRIDE * 2 * arcs]
    counts = rows.reshape(-1, L.VERTEX_STRIDE)[:, L.VERTEX_N_SECTORS]
    assert (counts == 2).all()  # the disc and the side, both 180 degrees


@pytest.mark.parametrize("arcs", [2, 3])
@pytest.mark.parametrize(
    "partner",
    [so.shapes.point(), so.shapes.ellipsoid(1, 0.2, 0.4), so.shapes.box(1, 0.5, 0.2)],
    ids=lambda body: body.name,
)
def test_split_rims_change_no_answer(arcs: int, partner: so.Body, rng: np.random.Generator) -> None:
    split, whole = split_cylinder(arcs), so.shapes.cylinder(RADIUS, LENGTH)
    certified = 0
    for k in range(400):
        turn = np.eye(3) if k % 4 == 0 else Rotation.random(random_state=rng).as_matrix()
        pose, at = so.Pose(turn), so.Pose(np.eye(3), 1.8 * rng.normal(size=3))
        p, q = so.distance(split, partner, pose, at), so.distance(whole, partner, pose, at)
        assert p.status is q.status, (turn, at.translation)
        if p.certified:
            certified += 1
            assert p.distance == pytest.approx(q.distance, abs=1e-11), (turn, at.translation)
    assert certified > 200


def test_a_sector_released_in_vain_gives_way_to_an_edge() -> None:
    # The disc's sector falls steepest, but the step leaves the disc at once, over the edge that
    # rises: vertex and sector took turns until the descent gave up.
    at = so.Pose(np.eye(3), np.array([-0.273759, -0.66104496, -1.783337]))
    partner, home = so.shapes.ellipsoid(1, 0.2, 0.4), so.Pose.identity()
    p = so.distance(split_cylinder(3), partner, home, at)
    assert p.certified
    assert p.feature_a == so.Feature("edge", 1)
    whole = so.distance(so.shapes.cylinder(RADIUS, LENGTH), partner, home, at)
    assert p.distance == pytest.approx(whole.distance, abs=1e-13)
