"""Solids against closed forms: the judge's own formulas, and that it sees what is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from standoff.solids.asked import QueryOptions
from standoff.solids.spatial.distance import spatial_distance
from standoff.tracking.status import Status
from standoff_studies.soak import (
    blocks,
    solid_cells,
    solid_judge,
    solid_meshes,
    solid_outlines,
    solid_pairs,
    solid_points,
)
from standoff_studies.soak.solid_judge import NOISE
from standoff_studies.soak.solid_outlines import Arc, Cubic, Outline, Segment, polygon
from standoff_studies.soak.solid_poses import draw_poses, pairs_of
from standoff_studies.soak.solid_truth import Egg, Elbow, Hollowed, Swept, Turned, signed

PAIR = "drum", "plate"


def square(half):
    return polygon((-half, -half), (half, -half), (half, half), (-half, half))


def truths():
    control = np.array([[0.25, 0.0], [0.8, 0.35], [-0.05, 0.65], [0.35, 1.0]])
    top = np.array([0.0, 1.0])
    lid, axis = [Segment(control[-1], top), Segment(np.zeros(2), control[0])], Segment(top, 0 * top)
    hole = Arc(np.zeros(2), 0.25, -np.pi, np.pi)
    groove = Arc(np.array([0.6, 0.0]), 0.2, -0.5 * np.pi, -1.5 * np.pi)
    rest = polygon((0.6, 0.2), (0.15, 0.5), (0.15, -0.4), (0.6, -0.2))[:-1]
    return {
        "plate": Swept(Outline([*square(0.6), hole]), 0.0, 0.3),
        "hollow": Hollowed(
            Swept(Outline(square(0.5)), -0.5, 0.5), Swept(Outline(square(0.3)), -0.3, 0.3)
        ),
        "elbow": Elbow(0.5, 0.14, 0.22, 0.3),
        "vase": Turned(Outline([Cubic(control), *lid], [axis])),
        "pulley": Turned(Outline([groove, *rest])),
        "egg": Egg(np.array([0.5, 0.35, 0.25])),
    }  # fmt: skip


TRUTHS = truths()
FINE = 0.02
"""Radius of the cells of a test."""


def covered(truth):
    """Points of a boundary, and how far any other of its points is from them at most."""
    points = []
    for patch in truth.patches:
        boxes = np.array([[0.5, 0.5, 0.5, 0.5]])
        while len(boxes):
            found = solid_cells.cells_of(truth.form, patch, boxes)
            at, radius = found[:, :3], found[:, 3]
            points.append(at[(radius >= 0.0) & (radius <= FINE)])
            u, v, du, dv = boxes[radius > FINE].T
            halves = [(u + s * du / 2, v + t * dv / 2, du / 2, dv / 2)
                      for s in (-1, 1) for t in (-1, 1)]  # fmt: skip
            boxes = np.concatenate([np.column_stack(each) for each in halves])
    return np.concatenate(points)


@pytest.mark.parametrize("name", TRUTHS)
def test_closed_forms_are_distances_from_their_own_boundaries(name, rng):
    truth = TRUTHS[name]
    boundary = covered(truth)
    assert np.abs(signed(truth, boundary)).max() < 1e-13
    low, high = boundary.min(axis=0) - 0.2, boundary.max(axis=0) + 0.2
    points = rng.uniform(low, high, (400, 3))
    sampled, _ = cKDTree(boundary).query(points)
    excess = sampled - np.abs(signed(truth, points))
    assert excess.min() > -1e-12  # a sample is never nearer than the closed form says
    assert excess.max() < FINE  # and the cells cover the boundary
    assert (signed(truth, points) < 0.0).any()


@pytest.mark.parametrize("name", TRUTHS)
def test_sides_are_those_of_a_path_from_outside(name, rng):
    """Along a line from far away the sign changes only where the distance passes zero."""
    truth = TRUTHS[name]
    for way in rng.normal(size=(5, 3)):
        line = np.linspace(-3.0, 3.0, 6001)[:, None] * way / np.linalg.norm(way)
        line = line + 0.3 * rng.normal(size=3)
        told = signed(truth, line)
        assert told[0] > 0.0
        assert np.abs(np.diff(told)).max() < 1e-3 * (1.0 + 1e-9)


def test_an_egg_is_sharp_beside_its_planes_of_symmetry():
    """Inside the focal curve the nearest point leaves the plane of the longer semiaxes."""
    a, b, c = 0.5, 0.35, 0.25
    egg = Egg(np.array([a, b, c]))
    x, y = 0.1, 0.05
    foot = a**2 * x / (a**2 - c**2), b**2 * y / (b**2 - c**2)
    z = c * np.sqrt(1.0 - (foot[0] / a) ** 2 - (foot[1] / b) ** 2)
    depth = np.hypot(np.hypot(foot[0] - x, foot[1] - y), z)
    points = np.array([[x, y, off] for off in (0.0, 1e-300, 1e-17, 1e-15, 1e-13)])
    assert np.abs(signed(egg, points) + depth).max() < 1e-12
    beside = signed(egg, np.array([[x, y, 1e-6]]))[0]
    assert abs(beside + depth - 1e-6 * z / depth) < 1e-11


@pytest.mark.parametrize(("inside", "far"), [(True, 0.7), (False, 1.6)])
def test_windings_of_a_mesh(inside, far):
    """A cube: solid angles, and the distance from its faces, edges and corners."""
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")).reshape(3, -1).T
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    rows = [row for a, b, c, d in sides for row in ((a, b, c), (a, c, d))]
    cube = corners[np.array(rows)].astype(float)
    points = far * np.array([[1.0, 0.2, -0.3], [1.0, 1.0, 0.1], [-1.0, 1.0, 1.0]])
    windings, lengths = solid_meshes.windings_and_distances(cube, points)
    assert np.abs(windings - inside).max() < 1e-14
    right = 1.0 - far if inside else np.linalg.norm(np.maximum(np.abs(points) - 1.0, 0.0), axis=1)
    assert np.abs(lengths - right).max() < 1e-15


@pytest.fixture(scope="module")
def drawn():
    (a, first), (b, second) = (solid_pairs.made(name) for name in PAIR)
    return a, b, (first, second), draw_poses(a, b, 30, np.random.default_rng(3))


@pytest.fixture(scope="module")
def asked():
    """Answers, each asked for once."""
    known = {}

    def ask(a, b, pose_a, pose_b):
        key = a.name, pose_a.tobytes(), pose_b.tobytes()
        if key not in known:
            # few are enough for a true interval, and for these poses nearly always for a proof
            known[key] = spatial_distance(a, b, pose_a, pose_b, QueryOptions(deadline=5000))
        return known[key]

    return ask


def judged(drawn, ask):
    lines = []
    return solid_judge.judged(*drawn, ask, lines.append), lines


def test_the_library_s_answers_are_sound(drawn, asked):
    verdict, lines = judged(drawn, asked)
    assert verdict.sound, lines
    assert verdict.poses == 30
    assert verdict.known > 10
    names = {status for _, status in verdict.statuses}
    assert {"CONVERGED", "OVERLAPPING", "CONTINUUM"} <= names
    assert "overlap" in solid_pairs.table(verdict)


def raised(told):
    return replace(told, lower_bound=told.lower_bound + 1e-6, upper_bound=told.upper_bound + 1e-6)


def nearer(told):
    """All numbers of a distance that is less by 1e-6: only the points tell."""
    less = told.distance - 1e-6
    return replace(told, distance=less, lower_bound=less, upper_bound=less)


def low(told):
    return replace(told, upper_bound=0.5 * told.distance, lower_bound=0.4 * told.distance)


def named(status):
    return lambda told: replace(told, status=status)


def wide(told):
    return replace(told, lower_bound=0.9 * told.lower_bound)


def off(told):
    return replace(told, point_a=told.point_a + 1e-8)


def within(told):
    return replace(told, inside="A")


def larger(told):
    ball = told.overlap._replace(radius=1.0001 * told.overlap.radius + 1e-9)
    return replace(told, overlap=ball, distance=-2.0 * ball.radius, upper_bound=-2.0 * ball.radius)


BREAKS = (
    ("bound", Status.CONVERGED, raised),
    ("witness", Status.CONVERGED, nearer),
    ("bound", Status.CONVERGED, low),
    ("status", Status.CONVERGED, named(Status.TOUCHING)),
    ("status", Status.CONVERGED, named(Status.CONTAINED)),
    ("status", Status.CONVERGED, named(Status.OVERLAPPING)),
    ("status", Status.OVERLAPPING, named(Status.CONVERGED)),
    ("status", Status.OVERLAPPING, named(Status.TOUCHING)),
    ("continuum", Status.CONVERGED, named(Status.CONTINUUM)),
    ("width", Status.CONVERGED, wide),
    ("witness", Status.CONVERGED, off),
    ("inside", Status.CONVERGED, within),
    ("ball", Status.OVERLAPPING, larger),
)


@pytest.mark.parametrize(("kind", "status", "broken"), BREAKS)
def test_a_mistake_is_found(drawn, asked, kind, status, broken):
    a, b, solids, poses = drawn

    def ask(first, second, pose_a, pose_b):
        told = asked(first, second, pose_a, pose_b)
        return broken(told) if told.status is status else told

    few = tuple(each[:12] for each in poses)
    verdict, lines = judged((a, b, solids, few), ask)
    assert verdict.faults[kind] > 0, verdict
    assert "pose_b" in lines[0]


def test_points_are_judged(rng):
    known, solid = solid_pairs.made("drum")
    points = solid_points.drawn(known, 300, rng)
    told = solid.signed_distance(points)
    mesh = prism_mesh(0.24, 0.4, 200)
    verdict, wrong = solid_points.compared(known, points, told, mesh)
    assert verdict.sound
    assert verdict.meshed > 100
    assert not wrong
    spare = 10.0 * NOISE * known.size
    less = solid_points.CHORD * known.size
    for name, off in (
        ("bound", told._replace(lower_bound=told.upper_bound + spare)),
        ("side", told._replace(distance=-told.distance)),
        ("winding", told._replace(distance=-told.distance)),
        ("mesh", told._replace(distance=told.distance + np.sign(told.distance) * 4.0 * less)),
        ("nearest", told._replace(nearest=told.nearest + spare)),
        ("gradient", told._replace(gradient=-told.gradient)),
    ):
        assert getattr(solid_points.compared(known, points, off, mesh)[0], name) > 0


def prism_mesh(radius, high, sides):
    """Triangles of a prism in a cylinder from z = 0."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    low = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle])
    up = np.array([0.0, 0.0, high])
    top, following = low + up, np.roll(low, -1, axis=0)
    over = following + up
    middles = np.zeros_like(low), np.zeros_like(low) + up
    faces = (low, following, over), (low, over, top), (middles[0], following, low), (
        middles[1], top, over)  # fmt: skip
    return np.concatenate([np.stack(each, axis=1) for each in faces])


def test_the_command_ends_with_1_after_a_fault(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["", "--poses", "4", "--parts", "drum"])
    monkeypatch.setattr(blocks, "TELL", -1.0)
    monkeypatch.setattr(solid_pairs, "BLOCK", 4)
    assert solid_pairs.main() == 0
    assert "to block 1" in capsys.readouterr().out
    right = spatial_distance
    monkeypatch.setattr(solid_pairs, "spatial_distance", lambda *given: off(right(*given)))
    assert solid_pairs.main() == 1
    assert "witness" in capsys.readouterr().out


def test_a_cubic_may_have_two_places_that_are_nearly_nearest():
    """Where Newton's method from the best place of a grid led to the other one."""
    vase = TRUTHS["vase"]
    point = np.array([[0.6399306598117207, -0.6844676890063156, 0.760394511522376]])
    bent = next(each for each in vase.outline.pieces if isinstance(each, Cubic))
    spots = solid_outlines.points_of(bent, np.linspace(0.0, 1.0, 20_001))
    rho = np.hypot(*point[0, :2])
    least = np.hypot(spots[:, 0] - rho, spots[:, 1] - point[0, 2]).min()
    assert abs(signed(vase, point)[0] - least) < 1e-8


@pytest.mark.parametrize(("block", "pose"), [(41, 0), (41, 4), (190, 19), (312, 6)])
def test_an_overlap_that_planes_prove_has_a_ball_too(block, pose):
    """In these poses of seed 72 none is found about the middle of the deepest place."""
    pairs = pairs_of(list(solid_pairs.MAKERS))
    (a, first), (b, second) = (solid_pairs.made(name) for name in pairs[block % len(pairs)])
    poses = draw_poses(a, b, 20, np.random.default_rng([72, block]))
    verdict, lines = judged(
        (a, b, (first, second), tuple(each[pose : pose + 1] for each in poses)), spatial_distance
    )
    assert verdict.sound, lines
    assert {status for _, status in verdict.statuses} == {"OVERLAPPING"}


@pytest.mark.parametrize("deadline", [100, 400])
def test_what_is_called_a_continuum_before_its_proof_is_at_the_distance(deadline):
    """Newton's method came to nearer pairs than the answer's own, which were told as its ends."""
    (a, first), (b, second) = (solid_pairs.made(name) for name in ("ring", "pulley"))
    poses = draw_poses(a, b, 20, np.random.default_rng([5]))
    told = []

    def ask(*pair):
        told.append(spatial_distance(*pair, QueryOptions(deadline=deadline)))
        return told[-1]

    verdict, lines = judged((a, b, (first, second), tuple(p[17:18] for p in poses)), ask)
    assert verdict.sound, lines
    assert told[0].status is Status.DEADLINE


def test_a_point_that_is_on_a_boundary_to_a_rounding_has_no_side():
    """A query came to a point 4e-13 from the pole of a vase, whose side no ray decides."""
    names = pairs_of(list(solid_pairs.MAKERS))[1419 % 105]
    (a, first), (b, second) = (solid_pairs.made(name) for name in names)
    poses = draw_poses(a, b, 20, np.random.default_rng([72, 1419]))
    verdict, lines = judged(
        (a, b, (first, second), tuple(each[14:15] for each in poses)), spatial_distance
    )
    assert verdict.sound, lines
