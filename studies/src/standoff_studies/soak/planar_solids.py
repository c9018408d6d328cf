"""``python -m standoff_studies.soak.planar_solids``: planar solids against samples.

Pairs of drawn solids, of 10 to 400 lines, arcs, Bezier curves and splines, at drawn poses. The
judge samples both boundaries densely; between samples a point moves by no more than a reach, which
it measures itself, so that the true distance is at most what the samples show and at least that
less both reaches. In an overlap no sample may lie in the ball that is said to be inside both, and
the samples must come as near as the reaches.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections import Counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import standoff as so
from standoff.cli.terminal import tell
from standoff.geometry import ConicArc, Curve, Line, NurbsCurve, RationalBezier
from standoff.solids import SolidProximity, distance

Array = NDArray[np.float64]

TELL = 20.0  # s between two lines
PER_LENGTH = 400  # samples along a unit of length
POSES = 50  # of a pair
POOL = 30  # solids at a time
PAIRS = 2000  # of a pool
# The greatest distance between neighbouring samples, and half of it more for what lies between.
REACH = 0.75
ROUNDED_SAMPLE = 1e-12  # length
NEAR_SAMPLE = 1e-9  # length, between witness points at rest


class Judged(NamedTuple):
    """A solid, the tree over its samples, they, and their reach."""

    solid: so.PlanarSolid
    tree: cKDTree
    points: Array
    reach: float


def drawn_loop(rng: np.random.Generator, n: int) -> list[Curve]:
    """A loop of n curves round the origin that bends inward here and there."""
    angles = (np.arange(n) + rng.uniform(0.0, 0.6, n)) * 2.0 * np.pi / n
    radii = 0.8 + rng.uniform(-1.0, 1.0, n) * min(0.2, 4.0 / n)
    if n >= 40:
        radii += rng.uniform(0.0, 0.2) * np.cos(rng.integers(2, 6) * angles)
    corners = radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    following = np.roll(corners, -1, axis=0)
    return [drawn_curve(rng, p, q) for p, q in zip(corners, following, strict=True)]


def drawn_curve(rng: np.random.Generator, p: Array, q: Array) -> Curve:
    """A curve of any kind from p to q, or back."""
    kind = rng.integers(4)
    if kind == 0:
        return Line(p, q)
    side = np.array([p[1] - q[1], q[0] - p[0]])
    if kind == 1:
        # an arc through both, its centre beyond either side
        away = rng.choice([-1.0, 1.0]) * rng.uniform(2.0, 8.0)
        centre = 0.5 * (p + q) + away * side
        r = float(np.linalg.norm(p - centre))
        first, last = (float(np.arctan2(*(each - centre)[::-1])) for each in (p, q))
        if (last - first) % (2.0 * np.pi) > np.pi:
            first, last = last, first
        turn = (last - first) % (2.0 * np.pi)
        return ConicArc(centre, (r, 0.0), (0.0, r), first, first + turn)
    inner = [p + u * (q - p) + rng.uniform(-0.08, 0.08) * side for u in (0.33, 0.66)]
    if kind == 2:
        return RationalBezier([p, *inner, q], rng.uniform(0.7, 1.4, 4))
    points = np.array([p, *inner, q])
    return NurbsCurve(points, [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0])


def judged(rng: np.random.Generator) -> Judged:
    """A drawn solid with its samples; loops that meet themselves are drawn anew."""
    n = round(float(np.exp(rng.uniform(np.log(10.0), np.log(400.0)))))
    while True:
        try:
            solid = so.PlanarSolid.from_loops(drawn_loop(rng, n))
            break
        except so.BodyError:
            continue
    parts, reach = [], 0.0
    for curve in solid.edges:
        ends = curve.point(curve.last) - curve.point(curve.first)
        count = 8 + int(PER_LENGTH * float(np.linalg.norm(ends)))
        t = np.linspace(curve.first, curve.last, count)
        at = np.array([curve.point(float(x))[:2] for x in t])
        steps = np.linalg.norm(np.diff(at, axis=0), axis=1)
        reach = max(reach, REACH * float(steps.max()))
        parts.append(at)
    points = np.concatenate(parts)
    return Judged(solid, cKDTree(points), points, reach)


def planar_pose(x: float, y: float, angle: float) -> so.Pose:
    """A pose in the plane."""
    c, s = np.cos(angle), np.sin(angle)
    return so.Pose([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], (x, y, 0.0))


def fault(a: Judged, b: Judged, pose_b: so.Pose, answer: SolidProximity) -> str:
    """What is wrong with an answer for A at the origin; nothing if it is right."""
    R = np.asarray(pose_b.rotation)[:2, :2]
    moved = b.points @ R.T + np.asarray(pose_b.translation)[:2]
    seen = float(a.tree.query(moved)[0].min())
    reach = a.reach + b.reach
    if answer.status is so.Status.OVERLAPPING:
        if answer.overlap is None:
            return "overlapping without a common point"
        place, radius = answer.overlap.common_point[:2], answer.overlap.radius
        nearest = min(
            float(a.tree.query(place)[0]), float(np.linalg.norm(moved - place, axis=1).min())
        )
        if nearest < radius - ROUNDED_SAMPLE:
            return f"a boundary point {nearest:.6g} from the middle of a ball of {radius:.6g}"
        return "" if seen <= reach else f"overlapping, but samples are {seen:.6g} apart"
    if answer.lower_bound > seen + ROUNDED_SAMPLE:
        return f"lower bound {answer.lower_bound:.12g} above {seen:.12g} between samples"
    if answer.distance > seen + ROUNDED_SAMPLE:
        return f"distance {answer.distance:.12g} above {seen:.12g} between samples"
    if answer.certified and answer.lower_bound < seen - reach:
        return f"lower bound {answer.lower_bound:.12g} too far below {seen:.12g}"
    apart = float(np.linalg.norm(answer.point_b - answer.point_a))
    if abs(apart - answer.distance) > NEAR_SAMPLE:
        return f"points {apart:.12g} apart for the distance {answer.distance:.12g}"
    return ""


def main() -> int:
    """Read the options, run, and tell; 3 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--queries", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    rng = np.random.default_rng(given.seed)
    counted: Counter[str] = Counter()
    faults, done, spent, times = 0, 0, 0.0, []
    last = begun = time.monotonic()
    pool: list[Judged] = []
    for pair in itertools.count():
        if done >= given.queries:
            break
        if pair % PAIRS == 0:
            pool = [judged(rng) for _ in range(POOL)]
        a, b = (pool[k] for k in rng.integers(POOL, size=2))
        for _ in range(min(POSES, given.queries - done)):
            r, way, turn = rng.uniform(0.3, 2.6), rng.uniform(0.0, 7.0), rng.uniform(0.0, 7.0)
            pose_b = planar_pose(r * np.cos(way), r * np.sin(way), turn)
            start = time.perf_counter()
            answer = distance(a.solid, b.solid, so.Pose.identity(), pose_b)
            spent = time.perf_counter() - start
            times.append(spent)
            counted[answer.status.name] += 1
            wrong = fault(a, b, pose_b, answer)
            if wrong:
                faults += 1
                tell(f"query {done}, seed {given.seed}: {answer!r}: {wrong}")
            done += 1
        if time.monotonic() - last > TELL or done == given.queries:
            last = time.monotonic()
            middle, late = (1e3 * np.percentile(times, q) for q in (50.0, 99.0))
            tell(
                f"{done} queries in {last - begun:.0f} s, {faults} wrong, {dict(counted)}; median "
                f"{middle:.2f} ms, 99 % {late:.2f} ms"
            )
    return 3 if faults else 0


if __name__ == "__main__":
    raise SystemExit(main())
