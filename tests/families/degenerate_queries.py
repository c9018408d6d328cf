"""Queries of degenerate pairs and their judge: certificate, truth, witnesses, nothing silent."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.degenerate import KINDS, Kind, aimed, partner, scaled
from families.shapes import Rng, Twin
from oracles.bounds import maximise_separation, separation
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.poses import size_of
from standoff_studies.oracles import HalfSpace, Placed

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)
ROUNDINGS = 64.0
"""Roundings, in eps of the span (sizes, coordinates and distance), that a bound may be off by."""
GLOBAL = 1.1e-3
"""Share of the depth by which a depth proven the least may exceed it (1e-3 is what is proven)."""
FLATNESS = 10.0
"""Radii of curvature at deepest points, over the pair's size."""
GAPS = (1e-9, 1.0)
"""Range of the gaps, over the pair's size."""
DEPTHS = (1e-9, 1e-1)
"""Range of the depths, over the thickness the constructed normal meets."""
KISSING = 10.0
"""Gaps are greater than this many times the noise of their poses."""
PER_BODY = 20
"""Poses of one body of a kind: making it is slower than a query."""
REACH = 1e3
"""Positions of A, in sizes from the origin."""


@dataclass(frozen=True)
class Pose:
    """Two placed bodies, and what is known: low <= true signed distance <= high."""

    a: Twin
    b: Twin
    placed_a: Placed
    placed_b: Placed
    low: float
    high: float

    @property
    def poses(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        first, second = self.placed_a, self.placed_b
        return (first.rotation, first.position), (second.rotation, second.position)

    @property
    def size(self) -> float:
        return size_of(self.a.shape, self.b.shape)

    @property
    def noise(self) -> float:
        """Roundings of the poses and of what is computed from them, length."""
        places = np.abs([self.placed_a.position, self.placed_b.position]).max()
        known = abs(self.low) if np.isfinite(self.low) else 0.0
        return ROUNDINGS * EPS * (self.size + float(places) + known)


@dataclass
class Tally:
    """What was found of one kind at one level; errors and gaps are over the pair's size."""

    name: str
    level: float
    queries: int = 0
    uncertified: int = 0
    restarted: int = 0
    errors: list[float] = field(default_factory=list)
    gaps: list[float] = field(default_factory=list)
    evaluations: list[int] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


def thickness(first: Placed, second: Placed, normal: Array) -> float:
    """The lesser extent of the two bodies along a normal (a half-space has none)."""
    bounded = [body for body in (first, second) if not isinstance(body.shape, HalfSpace)]
    both = np.array([normal, -normal])
    return min(float(body.relative(both)[0].sum()) for body in bounded)


def draw(kind: Kind, body: Twin, other: Twin, rng: Rng, *, overlap: bool = False) -> Pose:
    """Draw a pose of a pair: a known gap apart, or overlapping along a normal."""
    rotation = random_rotation(rng)
    normal = aimed(rng, kind, rotation)
    size = size_of(body.shape, other.shape)
    place = size * 10.0 ** float(rng.uniform(-1, np.log10(REACH))) * rng.normal(size=3)
    gap = size * float(np.exp(rng.uniform(*np.log(GAPS))))
    while True:
        pair = exact_pair(
            body.shape, other.shape, gap, rng, normal=normal, rotation_a=rotation, position_a=place
        )
        # Vertices a little below their plane count as on it: the bound tells what that loses.
        low = min(pair.distance, separation(pair.a, pair.b, pair.normal))
        pose = Pose(body, other, pair.a, pair.b, low, pair.distance)
        # Kissing pairs have tests of their own: there the rounding of the poses decides.
        if pair.distance > KISSING * pose.noise:
            break
        gap *= 10.0
    if not overlap:
        return pose
    thick = thickness(pair.a, pair.b, pair.normal)
    depth = thick * float(np.exp(rng.uniform(*np.log(DEPTHS))))
    return sunk(pose, pair.normal, max(depth, KISSING * pose.noise))


def sunk(pose: Pose, normal: Array, depth: float) -> Pose:
    """B moved along a normal until it is ``depth`` deep there; a lesser depth may be elsewhere."""
    b = pose.placed_b
    moved = Placed(b.shape, b.rotation, b.position - (pose.low + depth) * normal)
    low = separation(pose.placed_a, moved, normal)
    # A half-space lets nothing out but along its normal. Elsewhere a lesser depth is possible, and
    # the bodies may even be apart: a tip that passes a tip by less than it was moved.
    only = isinstance(pose.a.shape, HalfSpace) or isinstance(b.shape, HalfSpace)
    return Pose(pose.a, pose.b, pose.placed_a, moved, low, low if only else depth)


def deep(body: Twin, other: Twin, rng: Rng) -> Pose:
    """Draw a pose within the pair's middle; what is known of it is an independent search's best."""
    a, b = body.shape, other.shape
    apart = float(rng.uniform(0, 0.5)) * (a.bounding_radius + b.bounding_radius)
    first = Placed(a, random_rotation(rng), rng.normal(size=3))
    second = Placed(b, random_rotation(rng), first.position + apart * random_normal(rng))
    found = maximise_separation(first, second)
    return Pose(body, other, first, second, found.value, max(found.upper, 0.0))


def _finite(answer: so.Proximity) -> bool:
    numbers = [answer.distance, answer.lower_bound, *answer.point_a, *answer.point_b]
    return bool(np.isfinite([*numbers, *answer.normal]).all())


def faults(pose: Pose, answer: so.Proximity) -> list[str]:
    """Return what is wrong with an answer."""
    if not _finite(answer):
        return [f"not finite: {answer!r}"]
    d, low, noise = answer.distance, answer.lower_bound, pose.noise
    found = []
    if not abs(np.linalg.norm(answer.normal) - 1.0) <= 1e-12:
        found.append(f"normal of length {np.linalg.norm(answer.normal)}")
    if not low - noise <= pose.high:
        found.append(f"lower bound {low!r} above the truth {pose.high!r}")
    upper = getattr(answer, "upper_bound", max(d, 0.0))
    if not upper + noise >= pose.low:
        found.append(f"upper bound {upper!r} below the truth {pose.low!r}")
    if d == 0.0 and not pose.low - noise <= 0.0 <= pose.high + noise:
        found.append(f"silent 0, truth {pose.low!r}")
    if not low <= d + noise:
        found.append(f"lower bound {low!r} above the distance {d!r}")
    parted = separation(pose.placed_a, pose.placed_b, answer.normal)
    if not parted >= low - noise:
        found.append(f"the normal separates by {parted!r} only, less than {low!r}")
    # The normal may turn within the certificate's gap: the points of swept bodies follow it, and in
    # penetration those of faces, by the radii of curvature.
    reach, gap = pose.a.body.radius + pose.b.body.radius + abs(d), max(d - low, 0.0)
    reach += pose.size * FLATNESS if d < KISSING * noise else 0.0
    between = answer.point_b - answer.point_a - d * answer.normal
    if not np.linalg.norm(between) <= noise + 2.0 * np.sqrt((gap + noise) * reach) + gap:
        found.append(f"witness points miss distance times normal by {between}")
    return found


def judge(tally: Tally, pose: Pose, tolerance: float = 1e-9) -> so.Proximity | None:
    """Ask for the distance cold and add what was found; never an exception, NaN or warning."""
    tally.queries += 1
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            answer = so.distance(pose.a.body, pose.b.body, *pose.poses)
    except Exception as problem:  # whatever it is, it is a failure to be reported
        tally.failures.append(f"{type(problem).__name__}: {problem}")
        return None
    found = faults(pose, answer)
    tally.uncertified += not answer.certified
    tally.restarted += answer.counts.restarts > 0
    tally.evaluations.append(answer.counts.evaluations)
    if answer.certified and not found:
        size = pose.size
        off = max(pose.low - answer.distance, answer.distance - pose.high, 0.0)
        tally.errors.append(off / size)
        tally.gaps.append(max(answer.distance - answer.lower_bound, 0.0) / size)
        allowed = tolerance * size + pose.noise + (GLOBAL * abs(pose.low) if pose.low < 0 else 0.0)
        if not off <= allowed:
            found.append(f"certified, but off by {off!r} of size {size!r}")
    tally.failures += [f"{tally.name} at {tally.level:g}: {text}; {answer!r}" for text in found]
    return answer


def run(
    name: str, level: float, count: int, rng: Rng, *, scale: float = 1.0, how: str = "apart"
) -> Tally:
    """Judge ``count`` poses of a kind at a level, bodies of size ``scale`` or so.

    ``how``: "apart" and "sunk" along a known normal, or "deep" anywhere.
    """
    tally = Tally(name, level)
    kind = KINDS[name]
    body = kind.make(rng, level)
    for number in range(count):
        if number % PER_BODY == 0 and number:
            body = kind.make(rng, level)
        other = partner(rng, body)
        while how == "deep" and isinstance(other.shape, HalfSpace):
            other = partner(rng, body)
        first, second = (
            (body, other) if scale == 1.0 else (scaled(body, scale), scaled(other, scale))
        )
        if how == "deep":
            judge(tally, deep(first, second, rng))
        else:
            judge(tally, draw(kind, first, second, rng, overlap=how == "sunk"))
    return tally
