"""Overlapping pairs of every kind, their motions into depth, and what is wrong with an answer.

The reference is the proven least of s(n) (``oracles.depth``): a depth is right where it does not
exceed it, and no answer may be below it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families import curved_shapes, nurbs_bodies, shapes
from families.shapes import Maker, Rng, Twin, random_lengths
from families.tracked_motions import twist
from oracles.bounds import pair_size, separation
from oracles.depth import least_depth
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.poses import feature_normal, rotation_about
from standoff_studies import oracles as oracle
from standoff_studies.oracles import Placed

Array = NDArray[np.float64]

SHARE = 0.2
"""Greatest depth of sharp and mixed pairs, over the lesser body's greatest extent."""
SHALLOW = 1e-6
"""Least depth drawn, over the greatest."""
ALIGNED = 0.25
"""Share of cases along the normal of a flat or straight feature."""
FOUND = 1e-6
"""Relative excess over the least depth within which it counts as found."""
PROMISED = 1e-3
"""Relative excess that GLOBAL rules out."""
NOISE = 1e-10
"""Roundoff of depths and of the reference's own bracket, over the pair's size."""
PER_PAIR = 10
"""Cases of one pair of bodies."""
FRAMES = 40
"""Frames of a motion into depth."""
DT = 0.01
"""Frame time, s."""
APPROACH = 0.3
"""Distance covered by a motion into depth, over the pair's size, besides the depth."""
SPIN = 1.0
"""Greatest angular velocity of a motion, rad/s."""


def spans(twin: Twin) -> Array:
    """A body's extents along its axes, (3,) or (2,)."""
    axes = np.eye(3)[: twin.shape.dimension]
    return np.asarray(twin.shape.support_many(axes)[0] + twin.shape.support_many(-axes)[0])


def ellipsoid(rng: Rng) -> Twin:
    """Axes up to five to one."""
    axes = random_lengths(rng, 3, 0.4, 2.0)
    return Twin(oracle.Ellipsoid(*axes), so.shapes.ellipsoid(*axes))


def rock(rng: Rng) -> Twin:
    vertices = rng.normal(size=(int(rng.integers(4, 24)), 3)) * np.exp(rng.uniform(-0.5, 0.5, 3))
    return Twin(oracle.Polytope(vertices), so.shapes.polytope(vertices))


def superellipsoid(rng: Rng) -> Twin:
    return curved_shapes.superellipsoid(rng)


MIXED: tuple[Maker, ...] = (
    ellipsoid,
    shapes.box,
    rock,
    shapes.lens,
    shapes.cylinder,
    shapes.cone,
    shapes.capsule,
    shapes.cap,
    superellipsoid,
    curved_shapes.rounded_polytope,
    curved_shapes.egg,
    nurbs_bodies.ellipsoid,
)


def mixed(rng: Rng) -> Twin:
    return MIXED[rng.integers(len(MIXED))](rng)


@dataclass(frozen=True)
class Kind:
    """Makers of a pair; depths up to the smallest semi-axis (``deep``) or SHARE of the size."""

    first: Maker
    second: Maker
    deep: bool = False


KINDS: dict[str, Kind] = {
    "ellipsoids": Kind(ellipsoid, ellipsoid, deep=True),
    "boxes": Kind(shapes.box, shapes.box),
    "polytopes": Kind(rock, rock),
    "lenses": Kind(shapes.lens, shapes.lens),
    "cylinders": Kind(shapes.cylinder, shapes.cylinder),
    "cones": Kind(shapes.cone, shapes.cone),
    "superellipsoids": Kind(superellipsoid, superellipsoid),
    "mixed": Kind(mixed, mixed),
    "planar": Kind(shapes.loop, shapes.loop),
}
"""Kinds of overlapping pairs."""


@dataclass(frozen=True)
class Case:
    """Two placed bodies that overlap, the proven least depth, and a motion that ends there.

    ``motion`` is None where none is drawn.
    """

    label: str
    a: Twin
    b: Twin
    placed_a: Placed
    placed_b: Placed
    normal: Array
    depth: float
    lower: float
    motion: Callable[[float], tuple[Placed, Placed]] | None

    @property
    def placed(self) -> tuple[Placed, Placed]:
        return self.placed_a, self.placed_b

    @property
    def poses(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        a, b = self.placed
        return (a.rotation, a.position), (b.rotation, b.position)

    @property
    def size(self) -> float:
        return pair_size(self.placed_a, self.placed_b)


def limit(kind: Kind, a: Twin, b: Twin) -> float:
    """The greatest depth of a kind's cases, a length."""
    if kind.deep:
        return 0.5 * float(min(spans(a).min(), spans(b).min()))
    return SHARE * float(min(spans(a).max(), spans(b).max()))


def _motion(
    a: Placed, b: Placed, normal: Array, way: float, rng: Rng
) -> Callable[[float], tuple[Placed, Placed]]:
    """Return a motion that ends at the placements at time FRAMES * DT, from apart."""
    planar = a.shape.dimension == b.shape.dimension == 2
    axes = [np.array([0, 0, 1.0]) if planar else random_normal(rng) for _ in range(2)]
    rates = rng.uniform(-SPIN, SPIN, 2)
    end = FRAMES * DT

    def at(t: float) -> tuple[Placed, Placed]:
        turns = [
            rotation_about(axis, rate * (t - end)) for axis, rate in zip(axes, rates, strict=True)
        ]
        shift = (1 - t / end) * way * normal
        return (
            Placed(a.shape, turns[0] @ a.rotation, a.position),
            Placed(b.shape, turns[1] @ b.rotation, b.position + shift),
        )

    return at


def _poses(a: Twin, b: Twin, deepest: float, rng: Rng) -> tuple[Placed, Placed]:
    """Push two bodies together: along any normal, or a feature's, as deep as is drawn."""
    planar = a.shape.dimension == b.shape.dimension == 2
    first, second = random_rotation(rng, planar), random_rotation(rng, planar)
    normal = None
    if rng.random() < ALIGNED:
        options = [feature_normal(a.shape, first, rng), feature_normal(b.shape, second, rng)]
        signed = [n * sign for n, sign in zip(options, (1, -1), strict=True) if n is not None]
        normal = signed[rng.integers(len(signed))] if signed else None
    share = rng.uniform(0, 1) if rng.random() < 0.7 else SHALLOW ** rng.uniform(0, 1)
    place = rng.normal(size=3) * (0 if planar else 1)
    pair = exact_pair(
        a.shape,
        b.shape,
        -float(share) * deepest,
        rng,
        normal=normal,
        rotation_a=first,
        rotation_b=second,
        position_a=place,
    )
    return pair.a, pair.b


@lru_cache(16)
def bodies(name: str, seed: int, number: int) -> tuple[Twin, Twin]:
    """Return pair ``number`` of a kind: bodies of patches take a second to make."""
    rng = np.random.default_rng([seed, list(KINDS).index(name), number, 0])
    kind = KINDS[name]
    return kind.first(rng), kind.second(rng)


def draw_case(name: str, seed: int, number: int) -> Case:
    """Return case ``number`` of a kind; ``draw_case(*label)`` gives the same one again.

    Poses where the bodies turn out to touch at most are drawn again.
    """
    a, b = bodies(name, seed, number // PER_PAIR)
    deepest = limit(KINDS[name], a, b)
    rng = np.random.default_rng([seed, list(KINDS).index(name), number, 1])
    while True:
        first, second = _poses(a, b, deepest, rng)
        n, depth, lower = least_depth(first, second)
        if 0.5 * SHALLOW * deepest <= depth <= deepest:
            way = depth + APPROACH * pair_size(first, second)
            motion = _motion(first, second, n, way, rng)
            label = f"draw_case({name!r}, {seed}, {number})"
            return Case(label, a, b, first, second, n, depth, lower, motion)


def track_into(case: Case, depth: str, blind: bool = False) -> list[so.Proximity]:
    """The answers of a tracker along the case's motion; ``blind``: without velocities."""
    if case.motion is None:
        raise ValueError(f"{case.label} has no motion")
    poses = case.motion
    tracker = so.Tracker(case.a.body, case.b.body, dt=DT, law=so.PredictorCorrector(depth=depth))

    def flat(placed: Placed) -> tuple[Array, Array]:
        return placed.rotation, placed.position

    state = tracker.start(*(flat(p) for p in poses(0.0)))
    answers = [state.proximity]
    for frame in range(1, FRAMES + 1):
        t = frame * DT
        here = poses(t)
        twists: tuple[so.Twist | None, so.Twist | None] = (None, None)
        if not blind:
            before, after = poses(t - 1e-6), poses(t + 1e-6)
            twists = (twist(before[0], after[0], 2e-6), twist(before[1], after[1], 2e-6))
        state, answer = tracker.step(state, *(flat(p) for p in here), *twists)
        answers.append(answer)
    return answers


def excess(case: Case, answer: so.Proximity) -> float:
    """How much deeper an answer is than the least depth, relative; roundoff taken off."""
    found = -answer.distance
    return max(0.0, found - case.depth - NOISE * case.size) / case.depth


def faults(case: Case, answer: so.Proximity) -> list[str]:
    """What no answer in penetration may be, whether or not it found the least depth."""
    d, low, high, noise = answer.distance, answer.lower_bound, answer.upper_bound, NOISE * case.size
    found = []
    if not np.isfinite([d, low, high, *answer.normal, *answer.point_a, *answer.point_b]).all():
        return [f"not finite: {answer!r}"]
    if answer.status not in (so.Status.GLOBAL, so.Status.LOCAL):
        found.append(f"status {answer.status.name}")
    if not d <= -case.lower + noise:
        found.append(f"depth {-d!r} is less than any, {case.lower!r}")
    if not low <= -case.depth + noise:
        found.append(f"lower bound {low!r} above the distance {-case.depth!r}")
    if not high >= -case.depth - noise:
        found.append(f"upper bound {high!r} below the distance {-case.depth!r}")
    along = separation(case.placed_a, case.placed_b, answer.normal)
    if not abs(along - d) <= noise:
        found.append(f"distance {d!r}, but {along!r} along the normal")
    if not abs(answer.point_b - answer.point_a - d * answer.normal).max() <= 10 * noise:
        found.append("the points are not the depth apart along the normal")
    over = excess(case, answer)
    if answer.status is so.Status.GLOBAL and over > PROMISED:
        found.append(f"GLOBAL, but {over:.3g} deeper than the least {case.depth!r}")
    return found
