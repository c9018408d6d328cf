"""``python -m standoff_studies.soak.flush_depths``: depths of bodies whose facets are nearly flush.

A facet of one body is laid on one of the other's, or an edge along an edge, and turned by 1e-16 to
1e-3 rad, as deep as 1e-12 to a third of the size. The judge is the support functions: no direction
may part the bodies by less than the depth that is told, and of polytopes the least is known, as it
is along a facet's normal or square to an edge of each. Block k of a seed is always the same. The
exit code is 1 after a fault.
"""

from __future__ import annotations

import sys
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry.curves import Line
from standoff.typing import Array
from standoff_studies.soak import blocks

BLOCK = 500
"""Poses of a pair."""
ANGLES = -16.0, -3.0
"""Powers of ten of the turn, rad."""
DEPTHS = -12.0, -0.5
"""Powers of ten of the depth along the facet's normal, of the lesser size."""
THOUSANDTH = 1e-3
"""Of a depth: what GLOBAL leaves open."""
TOLERANCE = 1e-10
"""Of the size: the default tolerance of answers, within which depths and signs mean nothing."""
NOISE = 1e-13
"""Of the size: what roundings may do to a bound."""
SAME = 1e-9
"""Normals (chord) and heights (of the size) nearer than this are those of one facet."""
RINGS = 10.0 ** np.arange(-16.0, 0.0)
"""Tangents of the angles by which a judge of round bodies goes off the facets' normals."""
ROUTES_EVERY = 250
"""Poses from one that is asked by other routes too to the next."""


class Shape(NamedTuple):
    """A body, and what its support function is made of: the hull of points, or of one disc and a
    point or another disc on the z-axis, and a ball."""

    name: str
    body: so.Body
    points: Array  # of a polytope; of a round body the middles of its discs
    discs: Array  # radii of the points' discs about z, (m,)
    ball: float
    normals: Array  # of its facets
    edges: Array  # unit vectors

    @property
    def size(self) -> float:
        return float(self.body.size)

    def height(self, n: Array) -> Array:
        """h(n) along unit vectors (..., 3) in its own axes."""
        heights = n @ self.points.T
        if self.discs.any():
            heights += np.hypot(n[..., 0], n[..., 1])[..., None] * self.discs
        return np.asarray(heights.max(axis=-1) + self.ball)


def _polytope(name: str, points: Array, ball: float, body: so.Body) -> Shape:
    hull = ConvexHull(points)
    equations = hull.equations[:, :3]
    normals: list[Array] = []
    for n in equations:
        if all(n @ other < 1.0 - SAME for other in normals):
            normals.append(n)
    edges = [
        points[np.delete(hull.simplices[k], j)]
        for k in range(len(equations))
        for j, other in enumerate(hull.neighbors[k])
        if other > k and equations[k] @ equations[other] < 1.0 - SAME
    ]
    ways = np.array([b - a for a, b in edges])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return Shape(name, body, points, np.zeros(len(points)), ball, np.array(normals), ways)


def _box(rng: np.random.Generator, ball: float) -> Shape:
    half = 0.5 * np.exp(rng.uniform(-1.5, 0.0, 3))
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    body = so.shapes.box(tuple(2.0 * (half + ball)), rounding=ball)
    return _polytope("box", corners, ball, body)


def _prism(rng: np.random.Generator, ball: float) -> Shape:
    n = int(rng.integers(3, 9))
    angle = 2.0 * np.pi * np.arange(n) / n
    rim = rng.uniform(0.2, 0.7) * np.column_stack([np.cos(angle), np.sin(angle)])
    half = 0.5 * rng.uniform(0.1, 1.0)
    points = np.vstack([np.column_stack([rim, np.full(n, z)]) for z in (-half, half)])
    return _polytope("prism", points, ball, so.shapes.polytope(points, rounding=ball))


def _hull(rng: np.random.Generator, ball: float) -> Shape:
    points = rng.normal(size=(int(rng.integers(5, 11)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points *= rng.uniform(0.3, 1.0, 3)
    points = points[ConvexHull(points).vertices]
    return _polytope("hull", points, ball, so.shapes.polytope(points, rounding=ball))


def _round(rng: np.random.Generator, ball: float) -> Shape:
    """A cylinder or a cone; rounded ones have no facets."""
    radius, half = rng.uniform(0.2, 0.6), 0.5 * rng.uniform(0.2, 1.0)
    middles, up = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), np.array([[0.0, 0.0, 1.0]])
    if rng.random() < 0.5:
        body = so.shapes.cylinder(radius, 2.0 * half)
        normals, discs = np.vstack([up, -up]), np.array([radius, radius])
        return Shape("cylinder", body, middles, discs, 0.0, normals, up)
    body = so.shapes.cone(radius, 2.0 * half)
    return Shape("cone", body, middles, np.array([radius, 0.0]), 0.0, -up, np.empty((0, 3)))


def _planar(rng: np.random.Generator, ball: float) -> Shape:
    points = rng.normal(size=(int(rng.integers(3, 9)), 2))
    points = points[ConvexHull(points).vertices]
    corners = np.pad(points, ((0, 0), (0, 1)))
    ways = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([ways[:, 1], -ways[:, 0], ways[:, 2]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    sides = [Line(a, b) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    body = so.shapes.planar_loop(sides, rounding=ball)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return Shape("planar", body, corners, np.zeros(len(corners)), ball, normals, ways)


SPATIAL = (_box, _prism, _hull, _round)


class Poses(NamedTuple):
    """Of B beside A at rest."""

    turns: Array
    shifts: Array


def draw_pair(rng: np.random.Generator) -> tuple[Shape, Shape]:
    """Two shapes, a sixth of them planar, a sixth rounded."""
    ball = rng.uniform(0.02, 0.2) if rng.random() < 1.0 / 6.0 else 0.0
    if rng.random() < 1.0 / 6.0:
        return _planar(rng, ball), _planar(rng, 0.0)
    a, b = (SPATIAL[int(rng.integers(len(SPATIAL)))](rng, r) for r in (ball, 0.0))
    return a, b


def draw_poses(rng: np.random.Generator, a: Shape, b: Shape, count: int) -> Poses:
    made = [_pose(rng, a, b) for _ in range(count)]
    return Poses(np.array([turn for turn, _ in made]), np.array([shift for _, shift in made]))


def _pose(rng: np.random.Generator, a: Shape, b: Shape) -> tuple[Array, Array]:
    """B on a facet of A, turned off it."""
    planar = a.name == "planar"
    up = np.array([0.0, 0.0, 1.0])
    n, m = (shape.normals[int(rng.integers(len(shape.normals)))] for shape in (a, b))
    frames: list[Array] = []
    for shape, normal in ((a, n), (b, m)):
        ways = shape.edges[np.abs(shape.edges @ normal) < SAME]
        way = up if planar else _across(rng, normal)
        if len(ways) and not planar:
            way = ways[int(rng.integers(len(ways)))]
        out = normal if shape is a and not frames else -normal
        frames.append(np.column_stack([way, np.cross(out, way), out]))
    turn = frames[0] @ frames[1].T
    angle = 10.0 ** rng.uniform(*ANGLES)
    if not planar:
        about = rng.choice([0.0, angle, rng.uniform(0.0, 6.3)], p=[0.2, 0.3, 0.5])
        turn = Rotation.from_rotvec(about * n).as_matrix() @ turn
    axis = up * rng.choice([-1.0, 1.0]) if planar else rng.normal(size=3)
    if rng.random() < 0.95:
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix() @ turn
    if planar:
        turn[2], turn[:, 2] = up, up
    least = min(a.size, b.size)
    depth = least * 10.0 ** rng.uniform(*DEPTHS)
    lowest = -float(b.height(-(n @ turn)[None])[0])
    shift = (float(a.height(n[None])[0]) - lowest - depth) * n
    aside = _across(rng, n, planar) * least * rng.choice([0.3, 1e-3, 1e-9, 0.0])
    return turn, shift + aside + (_middle(a, n) - _middle(b, -(n @ turn)) @ turn.T) @ (
        np.eye(3) - np.outer(n, n)
    )


def _middle(shape: Shape, n: Array) -> Array:
    """Of the points that are farthest along a direction, or nearly."""
    heights = shape.points @ n
    return np.asarray(shape.points[heights > heights.max() - 1e-3 * shape.size].mean(axis=0))


def _across(rng: np.random.Generator, n: Array, planar: bool = False) -> Array:
    """A unit vector square to n."""
    way = np.cross(n, (0.0, 0.0, 1.0) if planar else rng.normal(size=3))
    return np.asarray(way / np.linalg.norm(way))


def directions(a: Shape, b: Shape, turns: Array) -> Array:
    """Unit vectors (k, m, 3), among which are those of all local minima of the depth of two
    polytopes."""
    back = np.swapaxes(turns, 1, 2)
    own = np.broadcast_to(a.normals, (len(turns), *a.normals.shape))
    facets = np.concatenate([own, -b.normals @ back], axis=1)
    found = [facets]
    if a.name != "planar":
        crosses = np.cross(a.edges[:, None], (b.edges @ back)[:, None])
        crosses = crosses.reshape(len(turns), -1, 3)
        # edges in line have no direction of their own
        lost = np.linalg.norm(crosses, axis=2)[..., None] < NOISE
        crosses = np.where(lost, a.normals[0], crosses)
        found += [crosses, -crosses]
    if a.discs.any() or b.discs.any():
        sides = np.vstack([np.eye(3), -np.eye(3)])
        steps = (RINGS[:, None, None] * sides).reshape(-1, 3)
        found += [(facets[:, :, None] + steps).reshape(len(turns), -1, 3)]
    ways = np.concatenate(found, axis=1)
    return np.asarray(ways / np.linalg.norm(ways, axis=2)[..., None])


def depths(a: Shape, b: Shape, pose: Poses, n: Array) -> Array:
    """s(n), (k, m), along unit vectors (k, m, 3): by how much B is to move along n to leave A."""
    along = np.einsum("kmi,ki->km", n, pose.shifts)
    return np.asarray(a.height(n) + b.height(-(n @ pose.turns)) - along)


class DepthVerdict(NamedTuple):
    """Counts: poses; of those that overlap by more than the tolerance the depths that exceed the
    least by more than a thousandth, and those that are not so near the one along their normal;
    statuses that say apart, though the normal does not part the bodies; bounds on the wrong side of
    the least depth; answers of other routes that are not the same; depths not proven the least."""

    poses: int = 0
    overlaps: int = 0
    deeper: int = 0
    not_own: int = 0
    apart: int = 0
    bound: int = 0
    route: int = 0
    unproven: int = 0

    @property
    def sound(self) -> bool:
        return not (self.deeper or self.not_own or self.apart or self.bound or self.route)

    def plus(self, other: DepthVerdict) -> DepthVerdict:
        return DepthVerdict(*(one + more for one, more in zip(self, other, strict=True)))

    def __str__(self) -> str:
        wrong = sum(self[2:7])
        return (
            f"{self.poses:,} poses, {self.overlaps:,} overlap; {wrong} wrong: deeper {self.deeper},"
            f" not along their normal {self.not_own}, apart {self.apart}, bound {self.bound}, "
            f"other routes {self.route}; {self.unproven} not proven least"
        )


def judged(a: Shape, b: Shape, pose: Poses, told: Any) -> Array:
    """(k, 8): the counts of each row of what was told."""
    size = a.size + b.size + np.linalg.norm(pose.shifts, axis=1)
    least = depths(a, b, pose, directions(a, b, pose.turns)).min(axis=1)
    own = depths(a, b, pose, told.normal[:, None])[:, 0]
    least = np.minimum(least, own)  # among the directions drawn none may part bodies that are apart
    # cores that are apart may be nearest along any direction
    exact = (least > a.ball + b.ball) & (not (a.discs.any() or b.discs.any()))
    bound = told.upper_bound < -least - NOISE * size
    bound |= exact & (told.lower_bound > -least + NOISE * size)
    within = least > 2.0 * TOLERANCE * size
    penetrating = np.array([status.penetrating for status in told.status])
    local = np.array([status is so.Status.LOCAL for status in told.status])
    counts = (
        np.ones(len(size)),
        within,
        within & (-told.distance > least * (1.0 + THOUSANDTH) + TOLERANCE * size),
        within & (np.abs(own + told.distance) > THOUSANDTH * np.abs(own) + TOLERANCE * size),
        (own > 2.0 * TOLERANCE * size) & ~penetrating,
        bound,
        np.zeros(len(size)),
        within & local,
    )
    return np.column_stack(counts).astype(int)


def other_routes(a: Shape, b: Shape, pose: Poses, k: int) -> list[float]:
    """The distance at pose k by a single query, a world and a tracker's start."""
    at, rest = so.Pose(pose.turns[k], pose.shifts[k]), so.Pose.identity()
    world = so.World({"a": a.body, "b": b.body})
    return [
        so.distance(a.body, b.body, rest, at).distance,
        world.distances([rest, at])["a", "b"].distance,
        so.Tracker(a.body, b.body, 1e-3).start(rest, at).proximity.distance,
    ]


def judge_block(number: int, seed: int) -> tuple[DepthVerdict, list[str]]:
    """Poses of a pair, and the faults' lines."""
    rng = np.random.default_rng([seed, number])
    a, b = draw_pair(rng)
    pose = draw_poses(rng, a, b, BLOCK)
    told = so.distances(a.body, b.body, np.eye(4), (pose.turns, pose.shifts))
    counts = judged(a, b, pose, told)
    for k in range(0, BLOCK, ROUTES_EVERY):
        others = other_routes(a, b, pose, k)
        counts[k, 6] = sum(distance != told.distance[k] for distance in others)
    verdicts = [DepthVerdict(*row) for row in counts.tolist()]
    lines = [
        f"seed {seed}, block {number}, pose {k}: {a.name} and {b.name}, told "
        f"{float(told.distance[k])!r} {told.status[k].name}: {one}"
        for k, one in enumerate(verdicts)
        if not one.sound
    ]
    return DepthVerdict(*counts.sum(axis=0).tolist()), lines


def main() -> None:
    given = blocks.options(__doc__, "poses", 1_000_000, BLOCK).parse_args()
    total = blocks.run(given, BLOCK, partial(judge_block, seed=given.seed))
    sys.exit(total is not None and not total.sound)


if __name__ == "__main__":
    main()
