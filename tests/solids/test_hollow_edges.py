"""What has gone past a hollow edge, or into a hollow corner: the nearest of the boundary is then
the edge or the vertex itself, and it holds as the faces beside it do."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import standoff as so
from bodies.brep_solids import prism
from standoff import simulation as sim
from standoff.bodies import Edge, Face
from standoff.geometry import Line, Plane
from standoff.solids import Solid, distance
from standoff.tracking.status import Status
from standoff_studies.soak import solid_parts

STILL = so.Pose.identity()


@cache
def bracket() -> Solid:
    return Solid.from_brep(*prism([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 2.0))


BOX = Solid(so.shapes.box((1.0, 1.0, 1.0)))
DOWN = -1e-3


@cache
def spike() -> Solid:
    """Its vertex down, at the origin."""
    base = [[x, 1, z] for x, z in ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))]
    return Solid(so.Body.from_points([[0, 0, 0], *base]))


def groove(slope: float) -> Solid:
    """A block whose top has a hollow edge along z, through the origin."""
    rim = np.tan(slope)
    return Solid.from_brep(*prism([(-1, -1), (1, -1), (1, rim), (0, 0), (-1, rim)], 1.0))


def at(*place: float) -> so.Pose:
    return so.Pose(np.eye(3), place)


@pytest.mark.parametrize("degrees", [1.0, 20.0, 45.0])
def test_a_vertex_passes_a_hollow_edge_without_a_jump(degrees: float) -> None:
    """Its depth is that of the point, whichever feature is the nearest."""
    block = groove(np.radians(degrees))
    wide = 2.0 * np.tan(np.radians(degrees))
    features = set()
    for k, across in enumerate(np.linspace(-wide, wide, 21)):
        tip = np.array([DOWN * across, DOWN, 0.5 + 0.01 * k])
        true = block.signed_distance(tip[None])
        found = distance(block, spike(), STILL, at(*tip), minima=5e-3)
        assert found.status is Status.OVERLAPPING
        assert found.distance == pytest.approx(true.distance[0], abs=1e-12)
        assert found.normal == pytest.approx(true.gradient[0], abs=1e-9)
        turned = distance(spike(), block, at(*tip), STILL, minima=5e-3)
        assert turned.distance == pytest.approx(found.distance, abs=1e-12)
        assert turned.normal == pytest.approx(-found.normal, abs=1e-9)
        features.add(found.feature_a.kind)
    assert features == {"face", "edge"}


def test_a_box_in_a_corner_is_held_at_all_its_corners() -> None:
    over = 1e-4, 2e-4
    found = distance(bracket(), BOX, STILL, at(1.5 - over[0], 1.5 - over[1], 1.0), minima=1e-3)
    told = sorted((round(m.distance, 9), *m.normal.round(6).tolist()) for m in found.minima)
    size = np.hypot(*over)
    beside = (round(-size, 9), *(np.round(over / size, 6).tolist()), 0.0)
    assert told == [beside, beside, (-2e-4, 0.0, 1.0, 0.0), (-1e-4, 1.0, 0.0, 0.0)]


def notched() -> Solid:
    """A cube of side 2 without the cube of side 1 at one of its corners: three walls that meet at
    (1, 1, 1)."""
    points = np.array([(x, y, z) for x in (0, 1, 2) for y in (0, 1, 2) for z in (0, 1, 2)], float)
    loops = []
    for turn in range(3):

        def number(a: int, b: int, c: int, turn: int = turn) -> int:
            x, y, z = np.roll((a, b, c), turn)
            return 9 * int(x) + 3 * int(y) + int(z)

        low = [(0, 0, 0), (0, 0, 2), (0, 2, 2), (0, 2, 0)]
        high = [(2, 0, 0), (2, 2, 0), (2, 2, 1), (2, 1, 1), (2, 1, 2), (2, 0, 2)]
        wall = [(1, 1, 1), (1, 2, 1), (1, 2, 2), (1, 1, 2)]
        loops += [[number(*corner) for corner in loop] for loop in (low, high, wall)]
    used = sorted({k for loop in loops for k in loop})
    loops = [[used.index(k) for k in loop] for loop in loops]
    vertices = points[used]
    ends = sorted({tuple(sorted((a, b))) for loop in loops for a, b in ways(loop)})
    edges = [Edge(Line(vertices[a], vertices[b]), a, b) for a, b in ends]
    faces = []
    for loop in loops:
        area = sum(np.cross(vertices[a], vertices[b]) for a, b in ways(loop))
        along = vertices[loop[1]] - vertices[loop[0]]
        plane = Plane.through(vertices[loop[0]], along, np.cross(area, along))
        sides = tuple((ends.index((min(w), max(w))), 1 if w[0] < w[1] else -1) for w in ways(loop))
        faces.append(Face((plane,), sides))
    return Solid.from_brep(vertices, edges, faces)


def ways(loop: list[int]) -> list[tuple[int, int]]:
    return list(zip(loop, loop[1:] + loop[:1], strict=True))


def test_a_vertex_in_a_hollow_corner() -> None:
    """Three walls: the nearest is the corner where they meet."""
    pocket = notched()
    over = np.array([1e-4, 2e-4, 3e-4])
    found = distance(pocket, BOX, STILL, at(*(1.5 - over)), minima=1e-3)
    assert found.feature_a.kind == found.feature_b.kind == "vertex"
    assert found.distance == pytest.approx(-np.linalg.norm(over), abs=1e-12)
    assert found.normal == pytest.approx(over / np.linalg.norm(over), abs=1e-9)


def test_nothing_that_is_apart_is_pressed() -> None:
    """A vertex outside a convex edge, and one beside a thin wall, has no place below 0."""
    for place in ((3.6, 1.6, 1.0), (-0.6, -0.6, 1.0), (1.5 + 1e-3, 1.5 + 1e-3, 1.0)):
        found = distance(bracket(), BOX, STILL, at(*place), minima=0.5)
        assert found.status in (Status.CONVERGED, Status.CONTINUUM)
        assert min(m.distance for m in found.minima) > 0.0


@pytest.mark.parametrize("turned", [False, True])
def test_a_box_that_is_pressed_askew_into_a_corner_stays_there(turned: bool) -> None:
    """Without the places at the hollow edge it would turn about its far corners, and fall through
    the floor."""
    law = sim.HuntCrossley(stiffness=1e6, depth=1e-4, damping=0.5)
    box = sim.RigidBody.free(
        BOX, mass=1.0, inertia=np.eye(3) / 6.0, pose=at(1.5 + 1e-4, 1.5 + 1e-4, 1.0)
    )
    bodies = [sim.RigidBody.fixed(bracket()), box]
    system = sim.System(bodies[::-1] if turned else bodies, law, gravity=[-0.3, -1.0, 0.0])
    run = sim.Operator(system, 1e-4).run(sim.Operator(system, 1e-4).start(), 5000, 500)
    moved = run.final.pose(0 if turned else 1)
    corner = moved.translation + moved.rotation @ [-0.5, -0.5, 0.0]
    assert np.abs(corner[:2] - 1.0).max() < 5e-4
    assert run.uncertified == 0
    assert run.deepest < 5e-4


def test_what_stands_before_a_convex_edge_is_not_pressed() -> None:
    """The far vertex of a small box looks away from the edge that it stands before."""
    small = Solid(so.shapes.box((0.05, 0.05, 0.05)))
    law = sim.HuntCrossley(stiffness=1e6, depth=0.05, damping=0.5)
    body = sim.RigidBody.free(small, mass=1.0, inertia=np.eye(3), pose=at(3.1, 1.1, 1.0))
    system = sim.System([sim.RigidBody.fixed(bracket()), body], law, gravity=[0.0, 0.0, 0.0])
    operator = sim.Operator(system, 1e-6)
    contact = operator.run(operator.start(), 1, 1).final.contact(0)
    assert min(place.distance for place in contact.places) == pytest.approx(0.075 * np.sqrt(2.0))
    assert contact.spots == ()


LONG = Solid(so.shapes.box((1.0, 1.0, 4.0)))


@pytest.mark.parametrize("over", [(1e-4, 1e-4), (1e-4, 3e-4), (-1e-4, 2e-4), (2e-4, -1e-4)])
@pytest.mark.parametrize("turned", [False, True])
def test_an_edge_that_reaches_past_both_ends_of_a_hollow_edge(
    over: tuple[float, float], turned: bool
) -> None:
    """It is held at both ends, by what it is past: one wall or two."""
    solids, poses = (bracket(), LONG), (STILL, at(1.5 - over[0], 1.5 - over[1], 1.0))
    if turned:
        solids, poses = solids[::-1], poses[::-1]
    found = distance(*solids, *poses, minima=1e-3)
    past = np.maximum(over, 0.0)
    depth, way = np.linalg.norm(past), past / np.linalg.norm(past)
    held = [m for m in found.minima if abs(m.distance + depth) < 1e-12]
    if min(over) > 0.0:
        held = [m for m in held if {m.feature_a.kind, m.feature_b.kind} == {"vertex", "edge"}]
        assert sorted(round(float(m.point_a[2])) for m in held) == [0, 2]
    assert held
    for place in held:
        normal = -place.normal if turned else place.normal
        assert normal == pytest.approx([*way, 0.0], abs=1e-9)


def test_a_tilted_edge_is_held_where_it_is_deepest() -> None:
    """Of both ends of the hollow edge at the one that the edge is farther past."""
    past = np.array([2e-4, 1e-4])
    for tilt in (1e-4, -1e-4):
        pose = so.Pose.exp([0.0, tilt, 0.0], [1.5 - past[0], 1.5 - past[1], 1.0])
        found = distance(bracket(), LONG, STILL, pose, minima=2e-3)
        [place] = [m for m in found.minima if "vertex" in (m.feature_a.kind, m.feature_b.kind)]
        end = 0.0 if tilt > 0.0 else 2.0
        assert place.point_a == pytest.approx([1.0, 1.0, end], abs=1e-9)
        there = np.hypot(past[0] + 1e-4, past[1])
        assert place.distance == pytest.approx(-there, rel=1e-3)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, 4.0])
def test_a_rim_past_a_hollow_rim(angle: float) -> None:
    """A round peg at the bottom of a wider blind hole, past its wall and its floor."""
    corners = ((0, 0), (0.5, 0), (0.5, 1), (1, 1), (1, -1), (0, -1))
    hole = Solid(solid_parts.turned_part("hole", corners).boundary)
    peg = Solid(solid_parts.drum(0.45, 2.0).boundary)
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    for past in ([1e-4, 2e-4], [3e-4, 1e-4]):
        place = (0.05 + past[0]) * out - [0.0, 0.0, past[1]]
        found = distance(hole, peg, STILL, at(*place), minima=1e-3)
        [rim] = [m for m in found.minima if m.feature_a.kind == m.feature_b.kind == "edge"]
        assert rim.distance == pytest.approx(-np.hypot(*past), abs=1e-10)
        way = (past[1] * np.array([0.0, 0.0, 1.0]) - past[0] * out) / np.hypot(*past)
        assert rim.normal == pytest.approx(way, abs=1e-6)


def test_a_long_box_that_is_pressed_into_a_short_corner_stays_there() -> None:
    """Without the places at the ends of the hollow edge it fell through the floor."""
    law = sim.HuntCrossley(stiffness=1e6, depth=1e-4, damping=0.5)
    inertia = np.diag([17.0, 17.0, 2.0]) / 12.0
    over = at(1.5 + 1e-4, 1.5 + 1e-4, 1.0)
    box = sim.RigidBody.free(LONG, mass=1.0, inertia=inertia, pose=over)
    system = sim.System([sim.RigidBody.fixed(bracket()), box], law, gravity=[-0.3, -1.0, 0.0])
    operator = sim.Operator(system, 1e-4)
    run = operator.run(operator.start(), 5000, 500)
    moved = run.final.pose(1)
    for end in (-1.0, 1.0):
        corner = moved.translation + moved.rotation @ [-0.5, -0.5, end]
        assert np.abs(corner[:2] - 1.0).max() < 5e-4
    assert run.uncertified == run.jumps == 0
    assert run.deepest < 5e-4
