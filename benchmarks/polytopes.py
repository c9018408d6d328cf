"""Polytopes of 10 to 10,000 facets: time to build one, of a step and of a call, beside Coal's.

Run with ``python -m benchmarks.polytopes``. Vertices are on the ellipsoids of ``benchmarks.speed``,
whose motion they take: 1 ms frames, contenders in turn, medians. Each polytope is paired with an
ellipsoid, and with another one of as many facets. Coal's ``Convex`` of the same points takes its
cached guess and tight tolerances. Beside the times: the greatest gap of our certificate, and how
far Coal's distances are from ours at most.
"""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import standoff as so
from benchmarks.peers import coal_request
from benchmarks.speed import (
    FRAMES,
    SEMI_AXES,
    Contender,
    Frames,
    cold_queries,
    compiled_loop,
    make_frames,
    python_steps,
    timed,
)

Array = NDArray[np.float64]

FACETS = (10, 100, 1_000, 10_000)
RUNS = 5
BUILDS = 5
CLOUDS = (100, 1_000, 10_000)
"""Points whose hull is built."""
CHECKED = 10
"""One frame in so many is checked."""
ELLIPSOID, EACH_OTHER = "ellipsoid", "each other"


class Race(NamedTuple):
    """A pair's contenders, and what was found of their answers."""

    facets: int
    against: str
    contenders: list[Contender]
    gap: float
    off: float


def points(facets: int, axes: tuple[float, ...], seed: int) -> Array:
    """Points of an ellipsoid, in no order, whose hull has so many triangles."""
    rng = np.random.default_rng(seed)
    found = rng.normal(size=(facets // 2 + 2, 3))
    found /= np.linalg.norm(found, axis=1)[:, None]
    return np.asarray(found * axes)


def coal_convex(cloud: Array) -> Any:
    import coal

    listed = coal.StdVec_Vec3s()
    for point in cloud:
        listed.append(point)
    return coal.Convex.convexHull(listed, True, None)


def coal_steps(frames: Frames, a: Any, b: Any) -> tuple[Contender, Callable[[int], float]]:
    """Coal's functor with its cached guess, and its distance of a frame."""
    import coal

    places = [
        tuple(coal.Transform3s(p.rotation, p.translation) for p in row) for row in frames.poses
    ]
    query, request, result = coal.ComputeDistance(a, b), coal_request(True), coal.DistanceResult()
    request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess

    def ask(place_a: Any, place_b: Any) -> float:
        result.clear()
        found = query(place_a, place_b, request, result)
        request.updateGuess(result)
        return float(found)

    def run() -> None:
        for row in places[1:]:
            ask(*row)

    def witnesses(k: int) -> tuple[Array, Array]:
        ask(*places[k])
        return np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2())

    return Contender("Coal", FRAMES, run, witnesses, keeps=(a, b)), lambda k: ask(*places[k])


def entered(frames: Frames, facets: int, against: str) -> Race:
    """A pair with its contenders, each of which has run once."""
    import coal

    clouds = [points(facets, axes, seed) for seed, axes in enumerate(SEMI_AXES)]
    a = so.Body.from_points(clouds[0])
    b = so.Body.from_points(clouds[1])
    theirs = [coal_convex(cloud) for cloud in clouds]
    if against == ELLIPSOID:
        b, theirs[1] = so.shapes.ellipsoid(*SEMI_AXES[1]), coal.Ellipsoid(*SEMI_AXES[1])
    peer, distance = coal_steps(frames, *theirs)
    step = python_steps(frames, "step", frames.matrices, frames.pairs, a, b)
    chosen = [compiled_loop(frames, a, b), step, cold_queries(frames, a, b), peer]
    for contender in chosen:
        contender.run()
    gap = off = 0.0
    for k in range(1, FRAMES + 1, CHECKED):
        answer = so.distance(a, b, *frames.poses[k])
        found = chosen[0].witnesses(k)
        tracked = float(np.linalg.norm(found[1] - found[0]))
        gap = max(gap, tracked - answer.lower_bound)
        off = max(off, abs(distance(k) - answer.distance))
    return Race(facets, against, chosen, gap, off)


def race(facets: tuple[int, ...] = FACETS, runs: int = RUNS) -> None:
    """Time every pair in turn and print a table."""
    frames = make_frames()
    pairs = [entered(frames, n, against) for n in facets for against in (ELLIPSOID, EACH_OTHER)]
    times = np.array([[[timed(c) for c in p.contenders] for p in pairs] for _ in range(runs)])
    head = f"{'facets':>7s} {'against':12s}{'compiled':>10s}{'step':>8s}{'cold':>9s}{'Coal':>8s}"
    print(f"µs, medians of {runs}\n{head}{'our gap':>10s}{'Coal off':>10s}")
    for pair, row in zip(pairs, np.median(times, axis=0), strict=True):
        loop, step, cold, peer = row
        print(
            f"{pair.facets:7d} {pair.against:12s}{loop:10.2f}{step:8.1f}{cold:9.1f}{peer:8.1f}"
            f"{pair.gap:10.1e}{pair.off:10.1e}"
        )


def builds(sizes: tuple[int, ...] = CLOUDS) -> None:
    """Time ``Body.from_points`` and Coal's hull of points of a sphere, and print a table."""
    print(f"{'points':>7s}{'ms':>10s}{'ms of CPU':>11s}{'Coal, ms':>10s}")
    so.Body.from_points(points(100, (1.0, 1.0, 1.0), 0))
    for n in sizes:
        cloud = points(2 * (n - 2), (1.0, 1.0, 1.0), n)
        makers = (so.Body.from_points, coal_convex)
        found = np.array([[spent(make, cloud) for make in makers] for _ in range(BUILDS)])
        (ours, own), (theirs, _) = 1e3 * np.median(found, axis=0)
        print(f"{n:7d}{ours:10.1f}{own:11.1f}{theirs:10.1f}")


def spent(make: Callable[[Array], Any], cloud: Array) -> tuple[float, float]:
    """(wall, CPU) time, s."""
    begun, used = time.perf_counter(), time.process_time()
    make(cloud)
    return time.perf_counter() - begun, time.process_time() - used


def main() -> None:
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", "coal"))
    print(f"{platform.machine()}, Python {platform.python_version()}, {versions}")
    builds()
    print()
    race()


if __name__ == "__main__":
    main()
