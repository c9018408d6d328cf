"""Bounds in cells, against distances anywhere in them: any body, any parameters, any cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.kernels.body import layout as L
from standoff.sweep.job import Job
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.extent import farthest
from standoff.sweep.proof.mover import TOGETHER
from standoff.sweep.proof.proof import Proof
from standoff.tracking.many_distances import answered_rows
from sweep.conftest import TOP, Make

AWAY = so.Pose.exp([0.4, -0.3, 0.5], [0.6, -1.1, 0.4])
"""So that a body's origin is not in its middle."""

BODIES = {
    "ellipsoid": so.shapes.ellipsoid([3.0, 1.0, 0.8]),
    "ellipsoid away": so.shapes.ellipsoid([1.0, 2.0, 0.5]).transformed(AWAY.matrix),
    "sphere": so.shapes.sphere(1.5),
    "sphere away": so.shapes.sphere(0.7).transformed(AWAY.matrix),
    "lens": so.shapes.lens(radius=3.0, offset=1.0),
    "rounded box": so.shapes.box(2.0, 1.0, 3.0, rounding=0.4),
    "box away": so.shapes.box(2.0, 1.0, 0.5).transformed(AWAY.matrix),
    "cylinder": so.shapes.cylinder(1.0, 2.0),
    "capsule": so.shapes.capsule(0.5, 4.0),
    "point": so.shapes.point().transformed(AWAY.matrix),
    "superellipsoid": so.shapes.superellipsoid([1.0, 2.0, 1.5], [0.5, 0.8]),
}

SPATIAL = f"""{TOP}
[parameters.x]
moves = "tool"
what = "x"
from = -4.0
to = 5.0
[parameters.a]
moves = "tool"
what = "turn_z"
from = -2.0
to = 3.0
[parameters.b]
moves = "tool"
what = "turn_x"
from_degrees = -70.0
to_degrees = 200.0
[parameters.c]
moves = "part"
what = "turn_y"
from = -0.5
to = 1.0
[parameters.d]
moves = "tool"
what = "turn_y"
from = 0.0
to = 0.7
[parameters.y]
moves = "part"
what = "y"
from = -3.0
to = 1.0
[sampler]
kind = "random"
rows = 10
"""

PLANAR = SPATIAL[: SPATIAL.index("[parameters.b]")] + SPATIAL[SPATIAL.index("[parameters.y]") :]

PLANAR_SCENE = """version = 1
[bodies.tool]
shape = "planar_loop"
[[bodies.tool.curves]]
kind = "ellipse"
centre = [0.5, 0.2]
semi_axes = [3.0, 1.0]
tilt = 0.4
[bodies.part]
shape = "planar_loop"
[[bodies.part.curves]]
kind = "bezier"
control_points = [[1.0, 0.0], [0.775, 0.645], [0.175, 1.005], [-0.5, 0.9]]
[[bodies.part.curves]]
kind = "bezier"
control_points = [[-0.5, 0.9], [-0.87, 0.41], [-0.91, -0.27], [-0.6, -0.8]]
[[bodies.part.curves]]
kind = "bezier"
control_points = [[-0.6, -0.8], [0.12, -1.04], [0.76, -0.72], [1.0, 0.0]]
[placements.tool]
position = [1.0, 6.0, 0.0]
[pair]
a = "tool"
b = "part"
"""


def with_bodies(job: Job, bodies: tuple[so.Body, so.Body]) -> Job:
    return replace(job, subject=replace(job.pair, bodies=bodies))


def some_cells(rng: np.random.Generator, n: int, columns: int) -> Cells:
    depth = rng.integers(0, 9, (n, columns))
    place = rng.integers(0, 1 << 62, (n, columns)) % (1 << depth)
    return Cells(place, depth, np.zeros((n, 0)))


def points_in(rng: np.random.Generator, cells: Cells) -> np.ndarray:
    """A point of the unit cube in each cell: at times a corner, or on a side."""
    way = np.clip(rng.uniform(-1.5, 1.5, cells.place.shape), -1.0, 1.0)
    return cells.middles + way * cells.halves


def check_cells(job: Job, rng: np.random.Generator, n: int = 1000) -> np.ndarray:
    bounds = Proof(job, 0.0).box
    cells = some_cells(rng, n, len(job.parameters))
    found = answered_rows(*job.bodies, *job.poses(bounds.numbers(cells)))
    told = bounds.bounds(cells, found)
    balls = bounds.by_balls(job.poses(bounds.numbers(cells)), bounds.moves(cells)[0])
    low = np.array([p.low for p in job.parameters])
    for _ in range(4):
        numbers = low + points_in(rng, cells) * bounds.width
        there = answered_rows(*job.bodies, *job.poses(numbers))
        assert (told.lower <= there.upper_bound).all()
        assert (balls <= there.upper_bound).all()
        assert (told.upper >= there.lower_bound).all()
    return np.isfinite(told.lower)


@pytest.mark.parametrize("name", BODIES)
def test_no_place_in_a_cell_is_beyond_its_bounds(
    name: str, make: Make, rng: np.random.Generator
) -> None:
    job = make(SPATIAL)
    other = BODIES[list(BODIES)[int(rng.integers(len(BODIES) - 2))]]
    for bodies in ((BODIES[name], other), (other, BODIES[name])):
        assert check_cells(with_bodies(job, bodies), rng).mean() > 0.9


def test_nor_above_a_half_space(make: Make, rng: np.random.Generator) -> None:
    text = SPATIAL.replace('moves = "part"\nwhat = "turn_y"', 'moves = "part"\nwhat = "x"')
    job = make(text)
    bodies = BODIES["rounded box"], so.shapes.halfspace([0.3, -0.4, 1.0], 0.5)
    assert check_cells(with_bodies(job, bodies), rng).all()


def test_nor_in_the_plane(make: Make, rng: np.random.Generator) -> None:
    assert check_cells(make(PLANAR, PLANAR_SCENE), rng).all()


def test_along_any_normal_a_turn_adds_no_more_to_the_support(
    make: Make, rng: np.random.Generator
) -> None:
    """Of vertices, against their greatest height at any other angle; the normal is any, and so is
    the point that stands for the support."""
    vertices = rng.normal([1.0, 0.5, -0.3], size=(20, 3))
    job = make(SPATIAL)
    job = with_bodies(job, (so.shapes.polytope(vertices), job.bodies[1]))
    bounds = Proof(job, 0.0).box
    mover = bounds.movers[0]
    cells = some_cells(rng, 3000, len(job.parameters))
    at, half = bounds.numbers(cells) * bounds.unit, bounds.half(cells)
    normal = rng.normal(size=(3000, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    order = [k for k, p in enumerate(job.parameters) if p.moves == "tool" and p.what != "x"]

    def heights(angles: np.ndarray) -> np.ndarray:
        turn = job.homes[0].rotation @ Rotation.from_euler("ZXY", angles[:, order]).as_matrix()
        return np.einsum("nij,vj,ni->nv", turn, vertices, normal)

    middle = heights(at)
    points = np.einsum(
        "nij,nj->ni",
        job.homes[0].rotation @ Rotation.from_euler("ZXY", at[:, order]).as_matrix(),
        vertices[middle.argmax(axis=1)],
    )
    given = mover.given_up(normal, points, at, half)
    assert (given[TOGETHER] <= 2.0 * mover.far + 1e-9).all()
    used = 0.0
    for _ in range(20):
        other = at + np.clip(rng.uniform(-1.5, 1.5, at.shape), -1.0, 1.0) * half
        more = heights(other).max(axis=1) - middle.max(axis=1)
        assert (more <= given[TOGETHER] + 1e-12).all()
        used = max(used, float((more / given[TOGETHER]).max()))
    assert used > 0.9  # the bound is met, all but


def test_a_turn_about_the_normal_turns_it_by_no_more_than_those_before(
    make: Make, rng: np.random.Generator
) -> None:
    """In the middle the normal is along the second turn's axis, and elsewhere it is not."""
    job = make(SPATIAL)
    box = Proof(job, 0.0).box
    mover, columns = box.movers[0], len(job.parameters)
    # the first turn goes a little, the second far, and the third hardly at all
    depth = np.tile([0, 3, 0, 0, 30, 0], (500, 1))
    place = rng.integers(0, 1 << depth)
    cells = Cells(place, depth, np.zeros((500, 0)))
    assert [p.name for p in job.parameters][1:5] == ["a", "b", "c", "d"]
    assert columns == 6
    at, half = box.numbers(cells) * box.unit, box.half(cells)
    order = [k for k, p in enumerate(job.parameters) if p.moves == "tool" and p.what != "x"]
    home, first = job.homes[0].rotation, Rotation.from_rotvec(at[:, order[:1]] * [[0.0, 0.0, 1.0]])
    normal = first.apply([1.0, 0.0, 0.0]) @ home.T
    bound, _ = mover.turned(normal, at, half)

    def seen(angles: np.ndarray) -> np.ndarray:
        turn = home @ Rotation.from_euler("ZXY", angles[:, order]).as_matrix()
        return np.einsum("nij,ni->nj", turn, normal)

    met = np.zeros(500)
    for _ in range(50):
        other = at + np.clip(rng.uniform(-1.5, 1.5, at.shape), -1.0, 1.0) * half
        cosine = np.sum(seen(other) * seen(at), axis=1)
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        assert (angle <= bound + 1e-7).all()
        met = np.maximum(met, angle / bound)
    assert met.max() > 0.9


@pytest.mark.parametrize("name", BODIES)
def test_the_farthest_point_is_found(name: str) -> None:
    body = BODIES[name]
    wall = so.shapes.halfspace()
    directions = np.random.default_rng(3).normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    turns = [Rotation.align_vectors([-d], [[0.0, 0.0, 1.0]])[0].as_matrix() for d in directions]
    poses = np.tile(np.eye(4), (len(turns), 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = turns, 20.0 * directions
    points = so.distances(body, wall, np.eye(4), poses).point_a
    # of the core, which the radius is not turned with
    core = points - (body.reals[L.RADIUS] * directions)
    reached = np.linalg.norm(core, axis=1).max()
    assert reached - 1e-12 <= farthest(body) <= 1.004 * reached + 1e-12


def test_of_planar_bodies_too(make: Make) -> None:
    tool, part = make(PLANAR, PLANAR_SCENE).bodies
    around = np.linspace(0.0, 2.0 * np.pi, 2000)
    points = np.array([3.0 * np.cos(around), np.sin(around)])
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    reached = np.linalg.norm(turn @ points + [[0.5], [0.2]], axis=0).max()
    assert reached - 1e-12 <= farthest(tool) <= 1.0001 * reached
    assert 1.0 <= farthest(part) <= 1.04
