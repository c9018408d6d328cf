"""``python -m standoff_studies.soak.solid_depths``: bounds of the depth of solids that overlap.

Block k of a seed draws poses of one of 22 pairs, always the same. The least translation that parts
them is known: of unions of boxes along common axes by all cells between their faces, of convex
polytopes by their facets and edges, of balls, drums and pins in closed form; of parts that are
turned against each other an adversary looks for a translation that parts them and is shorter than
what is proven of all, by their boxes alone. Of a pin that is pressed into its bore the interference
is known too. Both bounds are finite, no bound is on the wrong side, and B, moved as is told, is
apart. The exit code is 1 after a fault.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.geometry.curves import Line
from standoff.solids import PlanarSolid, Solid, SolidProximity, distance
from standoff.tracking.status import Status
from standoff.typing import Array
from standoff_studies.soak import blocks, flush_depths, solid_parts

BLOCK = 25
"""Poses of a pair."""
NOISE = 1e-8
"""Of the size: what bounds may be off by, the tolerance of answers and of potentials."""
SHALLOWEST = 1e-2
"""Of B's size: overlaps that are drawn are at least so deep."""
LATTICE = 0.25
"""Length: half of the shifts of boxes are multiples of it, so that faces are flush."""
LONG = 1e6
"""Length, far more than any: of what has no ends."""
DRAWER = 6
"""Polytopes of each kind that are drawn from."""
TRIED, ROUNDS, NEXT = 400, 4, 10
"""Translations that the adversary tries at once, how often, and how many it goes on from."""

Rng = np.random.Generator


class Drawn(NamedTuple):
    """A pair at a pose of B in A's frame.

    Attributes
    ----------
    least : length of the least translation that parts them; nan: not known.
    pressed : how deep a boundary is in the other solid; nan: not known.
    boxes : corners of both solids' convex parts, (n, 8, 3) in A's frame; empty where not needed.
    """

    a: Any
    b: Any
    turn: Array
    shift: Array
    least: float
    pressed: float = np.nan
    boxes: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Verdict(blocks.Counted):
    """Poses; those that are wrong; of what is known to be true the shares that are proven, their
    logarithms' histogram, in percent; and seconds."""

    poses: int = 0
    wrong: int = 0
    shares: tuple[float, ...] = ()
    ways: tuple[float, ...] = ()
    seconds: float = 0.0

    def __str__(self) -> str:
        low, high = (np.percentile(x or (np.nan,), [50, 10]) for x in (self.shares, self.ways))
        most = np.percentile(self.ways or (np.nan,), 90)
        each = 1e3 * self.seconds / max(self.poses, 1)
        return (
            f"{self.poses:,} poses, {each:.1f} ms each: {self.wrong} wrong; of the true depth the "
            f"proven lower bound is {low[0]:.3f} (median), {low[1]:.3f} (a tenth is below), the "
            f"way out {high[0]:.3f} (median), {most:.3f} (a tenth is above)"
        )


Box = tuple[tuple[float, float, float], tuple[float, float, float]]
UNIONS: dict[str, tuple[list[tuple[float, float]], float, list[Box]]] = {
    "elbow": (
        [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 1.0,
        [((0, 0, 0), (3, 1, 1)), ((0, 0, 0), (1, 3, 1))],
    ),
    "channel": (
        [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], 2.0,
        [((0, 0, 0), (3, 1, 2)), ((0, 0, 0), (1, 2, 2)), ((2, 0, 0), (3, 2, 2))],
    ),
    "stairs": (
        [(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 3), (0, 3)], 1.5,
        [((0, 0, 0), (3, 1, 1.5)), ((0, 0, 0), (2, 2, 1.5)), ((0, 0, 0), (1, 3, 1.5))],
    ),
    "block": ([(0, 0), (10, 0), (10, 10), (0, 10)], 10.0, [((0, 0, 0), (10, 10, 10))]),
    "cube": ([(0, 0), (4, 0), (4, 4), (0, 4)], 4.0, [((0, 0, 0), (4, 4, 4))]),
    "bar": ([(0, 0), (1, 0), (1, 1), (0, 1)], 6.0, [((0, 0, 0), (1, 1, 6))]),
    "slab": ([(0, 0), (5, 0), (5, 4), (0, 4)], 0.75, [((0, 0, 0), (5, 4, 0.75))]),
}  # fmt: skip
"""Prisms of an outline and a height, and the boxes that they are the unions of."""


@cache
def union(name: str) -> Solid:
    outline, height, _ = UNIONS[name]
    return Solid(solid_parts.swept(np.array(outline, dtype=float), 0.0, height, 0.0, name))


@cache
def turned(*corners: tuple[float, float]) -> Solid:
    """About z, from a profile (rho, z)."""
    return Solid(solid_parts.turned_part("turned", corners).boundary)


def least_of_boxes(a: Array, b: Array) -> float:
    """The least translation of b that leaves no common inside of unions of boxes (n, 2, 3): the
    least distance of 0 from a cell, between planes of their faces, that no pair of boxes covers."""
    low = (a[:, None, 0] - b[None, :, 1]).reshape(-1, 3)
    high = (a[:, None, 1] - b[None, :, 0]).reshape(-1, 3)
    if not np.any(np.all((low < 0.0) & (high > 0.0), axis=1)):
        return 0.0  # between walls, say, where each way but one leads into one of them
    cuts = [np.unique(np.r_[-np.inf, low[:, k], high[:, k], np.inf]) for k in range(3)]
    cells = np.array(list(product(*(range(len(c) - 1) for c in cuts))))
    first, last = (np.array([cuts[k][cells[:, k] + e] for k in range(3)]).T for e in (0, 1))
    within = np.all((low <= first[:, None]) & (high >= last[:, None]), axis=2)
    covered = np.any(within, axis=1)
    nearest = np.clip(0.0, first, last)
    return float(np.linalg.norm(nearest[~covered], axis=1).min())


def of_unions(rng: Rng, name: str, other: str) -> Drawn:
    """Two unions of boxes along common axes."""
    a, b = (np.array(UNIONS[each][2], dtype=float) for each in (name, other))
    low, high = a[:, 0].min(axis=0) - b[:, 1].max(axis=0), a[:, 1].max(axis=0)
    while True:
        shift = rng.uniform(low, high)
        flush = rng.random(3) < 0.5
        shift = np.where(flush, np.round(shift / LATTICE) * LATTICE, shift)
        least = least_of_boxes(a, b + shift)
        if least > SHALLOWEST * union(other).size and not _inside(a, b + shift):
            return Drawn(union(name), union(other), np.eye(3), shift, least)


@cache
def flat(name: str) -> PlanarSolid:
    ends = [np.array([*p, 0.0], dtype=float) for p in UNIONS[name][0]]
    sides = zip(ends, ends[1:] + ends[:1], strict=True)
    return PlanarSolid.from_loops([[Line(p, q) for p, q in sides]])


def of_flat_unions(rng: Rng, name: str, other: str) -> Drawn:
    """The outlines of two unions of boxes, as solids in the plane."""
    a, b = (np.array(UNIONS[each][2], dtype=float) for each in (name, other))
    a[:, 0, 2], a[:, 1, 2] = -LONG, LONG
    while True:
        shift = np.append(rng.uniform(-3.0, 3.0, 2), 0.0)
        shift = np.where(rng.random(3) < 0.5, np.round(shift / LATTICE) * LATTICE, shift)
        least = least_of_boxes(a, b + shift)
        if least > SHALLOWEST * flat(other).size and not _inside(
            a[..., :2], b[..., :2] + shift[:2]
        ):
            return Drawn(flat(name), flat(other), np.eye(3), shift, least)


def _inside(a: Array, b: Array) -> bool:
    """May one be wholly inside the other? Then the boundaries need not meet."""
    ends = [(x[:, 0].min(axis=0), x[:, 1].max(axis=0)) for x in (a, b)]
    (al, ah), (bl, bh) = ends
    return bool(((bl > al) & (bh < ah)).all() or ((al > bl) & (ah < bh)).all())


CORNERS = np.array(list(product((0, 1), repeat=3)))


def of_turned_unions(rng: Rng, name: str, other: str) -> Drawn:
    """Two unions of boxes, turned against each other: the least is for the adversary to find."""
    turn = Rotation.random(random_state=rng).as_matrix()
    parts = []
    for each in (name, other):
        ends = np.array(UNIONS[each][2], dtype=float)
        parts.append(np.where(CORNERS[None], ends[:, None, 1], ends[:, None, 0]))
    a, b = parts[0], parts[1] @ turn.T
    while True:
        shift = rng.uniform(a.min(axis=(0, 1)), a.max(axis=(0, 1))) - b.mean(axis=(0, 1))
        inside = ((b + shift > a.min(axis=(0, 1))) & (b + shift < a.max(axis=(0, 1)))).all()
        if not inside and least_overlap((a, b + shift), np.zeros((1, 3)))[0] > 0.1:
            return Drawn(union(name), union(other), turn, shift, np.nan, boxes=(a, b + shift))


def least_overlap(boxes: tuple[Array, ...], by: Array) -> Array:
    """Of translations (n, 3) of the second boxes: how deep the deepest pair of boxes overlaps."""
    found = np.full(len(by), -np.inf)
    for one in boxes[0]:
        for two in boxes[1]:
            ways = [x[k] - x[0] for x in (one, two) for k in (1, 2, 4)]
            ways += [np.cross(p, q) for p in ways[:3] for q in ways[3:]]
            n = np.array([w / np.linalg.norm(w) for w in ways if np.linalg.norm(w) > 1e-9])
            n = np.vstack([n, -n])
            depth = (one @ n.T).max(axis=0) - (two @ n.T).min(axis=0) - by @ n.T
            found = np.maximum(found, depth.min(axis=1))
    return found


def shorter_way(rng: Rng, boxes: tuple[Array, ...], length: float) -> float:
    """The least overlap that the adversary finds after a translation of a length."""
    ways, size, found = rng.normal(size=(TRIED, 3)), 1.0, np.inf
    for _ in range(ROUNDS):
        ways *= length / np.linalg.norm(ways, axis=1)[:, None]
        told = least_overlap(boxes, ways)
        found = min(found, float(told.min()))
        best = ways[np.argsort(told)[:NEXT]]
        size *= 0.2
        spread = size * length * rng.normal(size=(TRIED // NEXT, NEXT, 3))
        ways = (best[None] + spread).reshape(-1, 3)
    return found


@cache
def polytope(draw: Callable[..., flush_depths.Shape], number: int) -> tuple[Any, Solid]:
    shape = draw(np.random.default_rng([number, 12]), 0.0)
    return shape, Solid(shape.body)


def of_polytopes(rng: Rng, one: Callable[..., Any], two: Callable[..., Any]) -> Drawn:
    """Two convex polytopes, which are asked as solids."""
    (a, solid), (b, other) = (polytope(each, int(rng.integers(DRAWER))) for each in (one, two))
    while True:
        turn = Rotation.random(random_state=rng).as_matrix()
        way = rng.normal(size=3)
        shift = 0.5 * a.size * way / np.linalg.norm(way) * rng.uniform(0.2, 1.0)
        pose = flush_depths.Poses(turn[None], shift[None])
        n = flush_depths.directions(a, b, pose.turns)
        least = float(flush_depths.depths(a, b, pose, n).min())
        ends = b.points @ turn.T + shift
        inside = bool(((ends @ a.normals.T).max(axis=0) < a.height(a.normals)).all())
        around = bool(
            ((((a.points - shift) @ turn) @ b.normals.T).max(axis=0) < b.height(b.normals)).all()
        )
        if least > SHALLOWEST * b.size and not (inside or around):
            break
    return Drawn(solid, other, turn, shift, least)


@cache
def ball(radius: float) -> Solid:
    return Solid(so.shapes.ellipsoid(radius, radius, radius))


def of_balls(rng: Rng) -> Drawn:
    way = rng.normal(size=3)
    shift = way / np.linalg.norm(way) * rng.uniform(0.45, 1.55)
    least = 1.6 - float(np.linalg.norm(shift))
    return Drawn(ball(1.0), ball(0.6), np.eye(3), shift, least)


def of_ball_and_block(rng: Rng) -> Drawn:
    shift = rng.uniform(0.7, 9.3, 3)
    k = int(rng.integers(3))
    shift[k] = rng.choice([0.0, 10.0]) + rng.uniform(-0.5, 0.5)
    shift[k] = np.clip(shift[k], 0.05, 9.95)
    least = float(np.minimum(shift, 10.0 - shift).min()) + 0.6
    return Drawn(union("block"), ball(0.6), np.eye(3), shift, least)


def of_drums(rng: Rng) -> Drawn:
    """Two drums with parallel axes."""
    a, b = (turned((0, 0), (r, 0), (r, h), (0, h)) for r, h in ((2.0, 3.0), (1.0, 2.0)))
    e, way, z = rng.uniform(1.05, 2.8), rng.uniform(0.0, 6.3), rng.uniform(-1.8, 2.8)
    z = float(rng.choice([z, 0.0, 1.0]))
    least = min(3.0 - e, 3.0 - z, z + 2.0)
    return Drawn(a, b, np.eye(3), np.array([e * np.cos(way), e * np.sin(way), z]), least)


def of_drum_in_block(rng: Rng) -> Drawn:
    drum = turned((0, 0), (1.5, 0), (1.5, 6), (0, 6))
    x, y, z = *rng.uniform(1.5, 8.5, 2), float(rng.choice([rng.uniform(-5.0, 9.0), 0.0, 4.0]))
    if rng.random() < 0.3:
        x, z = 1.5, float(np.clip(z, -4.0, 8.0))
    elif 0.0 < z < 4.0:
        z += 4.0
    least = min(x + 1.5, 11.5 - x, y + 1.5, 11.5 - y, 10.0 - z, z + 6.0)
    return Drawn(union("block"), drum, np.eye(3), np.array([x, y, z]), least)


@cache
def plate(hole: float) -> Solid:
    return Solid(solid_parts.plate(10.0, 5.0, hole).boundary)


def of_pressed_pin(rng: Rng, most: float) -> Drawn:
    """A pin that is thicker than its bore, flush with the plate or longer or shorter."""
    low, high = ((0.0, 5.0), (-2.0, 7.0), (1.0, 6.5))[int(rng.integers(3))]
    thicker = most * float(rng.choice([0.25, 0.5, 1.0]))
    r = 2.0 + thicker
    pin = turned((0, low), (r, low), (r, high), (0, high))
    off = 0.9 * thicker * float(rng.choice([0.0, rng.random()]))
    way, spin = rng.uniform(0.0, 6.3, 2)
    shift = off * np.array([np.cos(way), np.sin(way), 0.0])
    side = _half_of(plate(2.0)) + r - float(np.abs(shift[:2]).max())
    turn = Rotation.from_euler("z", spin).as_matrix()
    least = min(5.0 - low, high, side)
    return Drawn(plate(2.0), pin, turn, shift, least, thicker + off)


def _half_of(solid: Solid) -> float:
    return float(np.asarray(solid.boundary.vertex_points)[:, 0].max())


def random_pose(rng: Rng, flat: bool) -> Array:
    """(4, 4): any, or one in the plane."""
    pose = np.eye(4)
    turn = (
        Rotation.from_euler("z", rng.uniform(0.0, 6.3))
        if flat
        else Rotation.random(random_state=rng)
    )
    pose[:3, :3], pose[:3, 3] = turn.as_matrix(), rng.normal(size=3)
    pose[2, 3] *= not flat
    return pose


PAIRS: tuple[Callable[[Rng], Drawn], ...] = (
    partial(of_unions, name="block", other="cube"),
    partial(of_unions, name="slab", other="bar"),
    partial(of_unions, name="elbow", other="elbow"),
    partial(of_unions, name="elbow", other="cube"),
    partial(of_unions, name="channel", other="bar"),
    partial(of_unions, name="channel", other="elbow"),
    partial(of_unions, name="stairs", other="channel"),
    partial(of_unions, name="stairs", other="stairs"),
    partial(of_turned_unions, name="elbow", other="elbow"),
    partial(of_turned_unions, name="channel", other="bar"),
    partial(of_turned_unions, name="block", other="cube"),
    partial(of_polytopes, one=flush_depths._box, two=flush_depths._box),
    partial(of_polytopes, one=flush_depths._box, two=flush_depths._hull),
    partial(of_polytopes, one=flush_depths._prism, two=flush_depths._hull),
    partial(of_flat_unions, name="elbow", other="channel"),
    partial(of_flat_unions, name="stairs", other="bar"),
    of_balls,
    of_ball_and_block,
    of_drums,
    of_drum_in_block,
    partial(of_pressed_pin, most=0.02),
    partial(of_pressed_pin, most=0.1),
)


def judged(drawn: Drawn, told: SolidProximity, rng: Rng, pose: Array) -> list[str]:
    """What is wrong of an answer; `pose`: A's in the world."""
    noise = NOISE * (drawn.a.size + drawn.b.size)
    if told.status is not Status.OVERLAPPING or told.overlap is None:
        return [f"{told.status.name} of solids that overlap"]
    overlap, faults = told.overlap, []
    if not np.isfinite([told.lower_bound, told.upper_bound]).all():
        faults.append(f"bounds {told.lower_bound!r}, {told.upper_bound!r}")
    if not told.lower_bound <= told.distance <= told.upper_bound:
        faults.append(f"distance {told.distance!r} off its bounds")
    if overlap.parting is None:
        return [*faults, "no way out"]
    way = pose[:3, :3].T @ overlap.parting
    if drawn.boxes:
        if least_overlap(drawn.boxes, way[None])[0] > noise:
            faults.append(f"the way out {way!r} does not part them")
        if shorter_way(rng, drawn.boxes, (1.0 - 1e-6) * overlap.depth) <= 0.0:
            faults.append(f"a way shorter than {overlap.depth!r} parts them")
        return faults
    if overlap.depth > drawn.least + noise:
        faults.append(f"depth {overlap.depth!r}, and {drawn.least!r} parts them")
    if float(np.linalg.norm(way)) < drawn.least - noise:
        faults.append(f"way out {way!r}, and none shorter than {drawn.least!r} is")
    if overlap.held < drawn.pressed - noise:
        faults.append(f"held at {overlap.held!r}, and {drawn.pressed!r} deep")
    return faults


def judge_block(number: int, seed: int, poses: int = BLOCK) -> tuple[Verdict, list[str]]:
    """Poses of a pair, and the faults' lines."""
    rng = np.random.default_rng([seed, number, 11])
    verdict, lines = Verdict(), []
    for k in range(poses):
        drawn = PAIRS[number % len(PAIRS)](rng)
        pose_a, inner = random_pose(rng, isinstance(drawn.a, PlanarSolid)), np.eye(4)
        inner[:3, :3], inner[:3, 3] = drawn.turn, drawn.shift
        begun = time.perf_counter()
        told = distance(drawn.a, drawn.b, pose_a, pose_a @ inner)
        seconds = time.perf_counter() - begun
        faults = judged(drawn, told, rng, pose_a)
        shares = _shares(drawn, told)
        verdict = verdict.plus(Verdict(1, int(bool(faults)), *shares, seconds))
        lines += [f"seed {seed}, block {number}, pose {k}: {fault}" for fault in faults]
    return verdict, lines


def _shares(drawn: Drawn, told: SolidProximity) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Of the true depth: what is proven, and the bound on the other side."""
    if told.overlap is None or not np.isfinite(drawn.least):
        return (), ()
    if told.overlap.held < np.inf and not np.isfinite(drawn.pressed):
        return (), ()
    if told.overlap.held < np.inf:
        return (told.overlap.depth / drawn.pressed,), (told.overlap.held / drawn.pressed,)
    return (told.overlap.depth / drawn.least,), (told.overlap.way / drawn.least,)


def main() -> None:
    given = blocks.options(__doc__, "poses", 10_000, BLOCK).parse_args()
    total = blocks.run(given, BLOCK, partial(judge_block, seed=given.seed))
    sys.exit(total is not None and not total.sound)


if __name__ == "__main__":
    main()
