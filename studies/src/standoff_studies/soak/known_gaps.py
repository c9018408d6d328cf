"""Pairs whose distance is known without any search, for queries of the certificate.

Either the bodies are placed by their support points along a normal, so that the gap along it is
their distance; or their corners lie on a lattice (`lattice`).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies import shapes
from standoff.bodies.body import Body
from standoff.errors import BodyError
from standoff.geometry import Line
from standoff.typing import Array
from standoff_studies import oracles
from standoff_studies.soak.lattice import PER_LENGTH, signed_distance, whole
from standoff_studies.soak.motions import random_direction, random_rotation, stream
from standoff_studies.soak.placing import heights
from standoff_studies.soak.shapes import Made, Shape, draw_shape, made

Rng = np.random.Generator

DRAWER = 8
"""Number of bodies that scenes share, since making a body takes longer than querying it."""

BUILT, LATTICE = 2, 3
"""Streams of a seed's random numbers, for the two drawers."""

LENGTHS = frozenset({"axes", "r", "radius", "length", "height", "offset", "rounding", "vertices"})
"""Parameters that scale with a body."""

LATTICE_SHARE = 0.45
"""Share of the pairs that are on a lattice."""

SCALED = 0.2
"""Share of the bodies that are far smaller or larger than those of the soak's pairs."""

LEAPS = 0.3
"""Share of the poses of a walk that are unrelated to those before."""

FAR_OUT = 2.0**20
"""Lengths from the origin, of some lattice pairs."""

QUARTER = 0.25


class Scene(NamedTuple):
    """Two bodies at world poses, and their signed distance.

    Attributes
    ----------
    a, b : Made
    pose_a, pose_b : (12,) arrays
    normal : (3,) array
        The one with which it was constructed, from A to B, world axes; arbitrary on a lattice.
    truth : float
        The signed distance, including swept radii.
    where : str
        How it was constructed.
    """

    a: Made
    b: Made
    pose_a: Array
    pose_b: Array
    normal: Array
    truth: float
    where: str


def draw_scene(rng: Rng, seed: int, number: int) -> Scene:
    """Draw a pair of known distance; `seed` and `number` name the drawers of its bodies."""
    return draw_walk(rng, seed, number, 1)[0]


def draw_walk(rng: Rng, seed: int, number: int, count: int) -> list[Scene]:
    """Draw a number of poses of one pair: small motions, and leaps between them."""
    if rng.random() < LATTICE_SHARE:
        return _lattice_walk(rng, lattice_drawer(seed, number), count)
    return _built_walk(rng, built_drawer(seed, number), count)


@lru_cache(maxsize=2)
def built_drawer(seed: int, number: int) -> tuple[Made, ...]:
    """Return bodies of the soak's kinds, some far smaller or larger than those."""
    rng = stream(seed, BUILT, number)
    found: list[Made] = []
    while len(found) < DRAWER:
        shape = draw_shape(rng)
        if rng.random() < SCALED:
            shape = scaled(shape, 10.0 ** rng.uniform(-6.0, 6.0))
        try:
            one = made(shape)
        except BodyError:
            continue  # faces of a thin core are back to back up to roundoff: the body is rejected
        if one.body.bounded or (len(found) and found[0].body.bounded):
            found.append(one)
    return tuple(found)


def scaled(shape: Shape, factor: float) -> Shape:
    """Return a shape with all its lengths multiplied."""
    numbers = {
        name: (np.asarray(value) * factor).tolist() if name in LENGTHS else value
        for name, value in shape.numbers.items()
    }
    return Shape(shape.kind, numbers)


class _Setting(NamedTuple):
    """How a pair is constructed: A's position, both rotations, a normal and the gap along it."""

    turn_a: Array
    turn_b: Array
    place_a: Array
    normal: Array
    gap: float


def _built_walk(rng: Rng, drawer: tuple[Made, ...], count: int) -> list[Scene]:
    while True:
        a, b = (drawer[int(k)] for k in rng.integers(0, DRAWER, 2))
        if a.body.bounded or b.body.bounded:
            break
    scenes: list[Scene] = []
    for _ in range(count):
        if not scenes or rng.random() < LEAPS:
            setting = _draw_setting(rng, a, b)
        else:
            setting = _moved(rng, a, b, setting)
        scenes.append(_built(a, b, setting))
    return scenes


def _draw_setting(rng: Rng, a: Made, b: Made) -> _Setting:
    turn_a, turn_b = random_rotation(rng), random_rotation(rng)
    n = _some_normal(rng, a, b, turn_a, turn_b)
    away = random_direction(rng) * 10.0 ** rng.uniform(0.0, 6.0)
    place_a = away if rng.random() < 0.1 else np.zeros(3)
    size = _reach(a, b)
    gap = 0.0 if rng.random() < 0.15 else size * 10.0 ** rng.uniform(-14.0, 0.7)
    if rng.random() < 0.3:
        # overlapping swept radii, and bodies inside a half-space
        bounded = a.body.bounded and b.body.bounded
        gap -= rng.random() * (a.body.radius + b.body.radius if bounded else size)
    return _Setting(turn_a, turn_b, place_a, n, float(gap))


def _reach(a: Made, b: Made) -> float:
    sizes = [one.body.size + one.body.radius for one in (a, b) if one.body.bounded]
    return max([x for x in sizes if x > 0.0], default=1.0)


def _moved(rng: Rng, a: Made, b: Made, at: _Setting) -> _Setting:
    """A setting that differs slightly from another."""
    angle = 10.0 ** rng.uniform(-4.0, -0.5)
    turn_b = _turn(rng, angle) @ at.turn_b
    n = at.normal + angle * rng.random() * random_direction(rng)
    n /= np.linalg.norm(n)
    if not b.body.bounded:
        n = -turn_b[:, 2]
    elif not a.body.bounded:
        n = at.turn_a[:, 2]
    gap = max(at.gap + angle * _reach(a, b) * rng.normal(), min(at.gap, 0.0))
    return at._replace(turn_b=turn_b, normal=n, gap=float(gap))


def _turn(rng: Rng, angle: float) -> Array:
    """A rotation about a random axis."""
    x, y, z = np.tan(0.5 * angle) * random_direction(rng)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # Cayley's form: orthonormal to roundoff
    return np.asarray(np.linalg.solve(np.eye(3) - cross, np.eye(3) + cross))


def _built(a: Made, b: Made, at: _Setting) -> Scene:
    """Both bodies placed with their support points along the normal, separated by the gap."""
    n = at.normal
    pose_a = np.concatenate([at.turn_a.ravel(), at.place_a])
    pose_b = np.append(at.turn_b.ravel(), np.zeros(3))
    x_a = heights(a, pose_a[None], n[None])[1][0]
    x_b = heights(b, pose_b[None], -n[None])[1][0]
    pose_b[9:] = x_a - x_b + at.gap * n
    up = heights(a, pose_a[None], n[None])[0][0] + heights(b, pose_b[None], -n[None])[0][0]
    return Scene(a, b, pose_a, pose_b, n, -float(up), "built")


def _some_normal(rng: Rng, a: Made, b: Made, turn_a: Array, turn_b: Array) -> Array:
    """A direction from A to B: that of a half-space, random, or of a flat face or an edge."""
    if not a.body.bounded:
        return turn_a[:, 2]
    if not b.body.bounded:
        return -turn_b[:, 2]
    if rng.random() < 0.5:
        one, turn, sign = (a, turn_a, 1.0) if rng.random() < 0.5 else (b, turn_b, -1.0)
        special = one.support.special_normals(rng)
        if rng.random() < 0.3 or not len(special):
            special = np.concatenate([np.eye(3), -np.eye(3)])
        n = sign * turn @ np.asarray(special[int(rng.integers(len(special)))], dtype=float)
        return np.asarray(n / np.linalg.norm(n))
    return random_direction(rng)


class Corners(NamedTuple):
    """A body with its exact corners, and its name in a report."""

    made: Made
    points: Array
    planar: bool


@lru_cache(maxsize=2)
def lattice_drawer(seed: int, number: int) -> tuple[Corners, ...]:
    """Return points, segments, boxes, polytopes and polygons with corners on a lattice."""
    rng = stream(seed, LATTICE, number)
    makers = [_segment, _segment, _box, _polytope, _polytope, _point, _polygon, _loop, _loop]
    return tuple(maker(rng) for maker in makers)


def _rounding(rng: Rng) -> float:
    return float(rng.choice([0.0, 0.0, 0.25, 1.0]))


def _cornered(name: str, body: Body, points: NDArray[Any], planar: bool = False) -> Corners:
    points = np.asarray(points, dtype=np.float64)
    core = oracles.Vertices(points)
    support = oracles.Swept(core, body.radius) if body.radius > 0.0 else core
    numbers = {"corners": points.tolist(), "rounding": body.radius}
    return Corners(Made(Shape(name, numbers), body, support), points, planar)


def _point(rng: Rng) -> Corners:
    return _cornered("lattice point", shapes.point(rounding=_rounding(rng)), np.zeros((1, 3)))


def _segment(rng: Rng) -> Corners:
    while True:
        ends = QUARTER * rng.integers(-6, 7, (2, 3))
        if (ends[0] != ends[1]).any():
            break
    body = shapes.segment(start=ends[0], end=ends[1], rounding=_rounding(rng))
    return _cornered("lattice segment", body, ends)


def _box(rng: Rng) -> Corners:
    half = QUARTER * rng.integers(1, 7, 3) / 2
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    body = shapes.box(*(2 * half).tolist())
    return _cornered("lattice box", body, signs * half)


def _polytope(rng: Rng) -> Corners:
    """A tetrahedron, or one with one or two more corners, all on its hull."""
    while True:
        points = QUARTER * rng.integers(-5, 6, (int(rng.integers(4, 7)), 3))
        if abs(np.linalg.det(points[1:4] - points[0])) < QUARTER:
            continue
        facets = oracles.Polytope(points).facets
        if len(np.unique(np.concatenate(facets.corners))) == len(points):
            break
    return _cornered("lattice polytope", shapes.polytope(points, rounding=_rounding(rng)), points)


def _triangle(rng: Rng) -> Array:
    """Three corners in z = 0, counterclockwise."""
    while True:
        points = np.column_stack([QUARTER * rng.integers(-5, 6, (3, 2)), np.zeros(3)])
        turn = float(np.cross(points[1] - points[0], points[2] - points[0])[2])
        if abs(turn) >= QUARTER:
            return points if turn > 0.0 else points[::-1].copy()


def _polygon(rng: Rng) -> Corners:
    """A flat triangle in space: two faces back to back."""
    points = _triangle(rng)
    return _cornered("lattice polygon", shapes.polygon(points, rounding=_rounding(rng)), points)


def _loop(rng: Rng) -> Corners:
    """A planar triangle in z = 0."""
    points = _triangle(rng)
    sides = [Line(points[k], points[(k + 1) % 3]) for k in range(3)]
    body = shapes.planar_loop(sides, rounding=_rounding(rng))
    return _cornered("lattice loop", body, points, planar=True)


def _lattice_walk(rng: Rng, drawer: tuple[Corners, ...], count: int) -> list[Scene]:
    """Two lattice bodies, rotated by quarter turns; mostly with corners or edges in common."""
    while True:
        a, b = (drawer[int(k)] for k in rng.integers(0, len(drawer), 2))
        if a.planar == b.planar:
            break
    # far from the origin a pose still represents the lattice exactly
    away = np.zeros(3)
    if rng.random() < 0.15:
        away[: 2 if a.planar else 3] = FAR_OUT * rng.integers(-4, 5, 2 if a.planar else 3)
    scenes: list[Scene] = []
    for _ in range(count):
        if not scenes or rng.random() < LEAPS:
            turns = _quarter_turn(rng, a.planar), _quarter_turn(rng, a.planar)
            shift = _meeting(rng, a.points @ turns[0].T, b.points @ turns[1].T)
        else:
            shift = shift + rng.integers(-1, 2, 3) / PER_LENGTH
        shift[2] *= not a.planar
        scenes.append(_on_lattice(rng, a, b, turns, shift, away))
    return scenes


def _on_lattice(
    rng: Rng, a: Corners, b: Corners, turns: tuple[Array, Array], shift: Array, away: Array
) -> Scene:
    corners_a, corners_b = whole(a.points @ turns[0].T), whole(b.points @ turns[1].T + shift)
    core = signed_distance(corners_a, corners_b, a.planar)
    pose_a = np.concatenate([turns[0].ravel(), away])
    pose_b = np.concatenate([turns[1].ravel(), away + shift])
    normal = random_direction(rng)
    normal[2] *= not a.planar
    normal /= np.linalg.norm(normal)
    truth = core - a.made.body.radius - b.made.body.radius
    return Scene(a.made, b.made, pose_a, pose_b, normal, truth, "lattice")


def _quarter_turn(rng: Rng, planar: bool) -> Array:
    """A rotation that maps the lattice to itself."""
    if planar:
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[int(rng.integers(4))]
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], dtype=float)
    signs = np.diag(rng.choice([-1.0, 1.0], 3))
    turn = signs[:, rng.permutation(3)]
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


def _meeting(rng: Rng, corners_a: Array, corners_b: Array) -> Array:
    """A shift of B, in steps: a corner or midpoint of one on one of the other, or next to it."""
    met = _mark(rng, corners_a) - _mark(rng, corners_b)
    if rng.random() < 0.4:
        met = met + QUARTER * rng.integers(-3, 4, 3) * float(rng.choice([0.5, 1.0, 4.0]))
    return np.asarray(np.round(met * PER_LENGTH) / PER_LENGTH)


def _mark(rng: Rng, corners: Array) -> Array:
    """A corner, or the midpoint of two."""
    i, j = rng.integers(0, len(corners), 2)
    return np.asarray(corners[i] if rng.random() < 0.5 else 0.5 * (corners[i] + corners[j]))
