"""Exact derivatives beside the finite differences that users of other engines take.

    python -m benchmarks.derivatives

For two ellipsoids apart: time and error of the gradient by (1) `answer.gradient`, (2) central
differences of `coal.distance`, at the step that serves it best, and (3) central differences of
`so.distance`; of the Hessian likewise. The truth is that of 50 digits
(standoff_studies.oracles.optima). Then the time of a gradient and of all derivatives over that of a
step, for several pairs, in the compiled loops and from Python.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import coal
import mpmath as mp
import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff_studies.oracles import optima

AXES_A, AXES_B = (0.5, 0.3, 0.2), (0.2, 0.3, 0.4)
STEPS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
ROUNDS = 5
S = so.shapes
PAIRS = {
    "two ellipsoids": (S.ellipsoid(*AXES_A), S.ellipsoid(*AXES_B)),
    "lens and ellipsoid": (S.lens(1.0, 0.45), S.ellipsoid(0.15, 0.3, 0.2)),
    "two boxes": (S.box(1.0, 1.0, 1.0), S.box(0.5, 0.6, 0.7)),
    "two capsules": (S.capsule(0.2, 1.0), S.capsule(0.3, 0.8)),
    "cylinder and cone": (S.cylinder(0.4, 1.0), S.cone(0.5, 1.0)),
}


def moved(pose: np.ndarray, twist: np.ndarray) -> np.ndarray:
    after = np.eye(4)
    after[:3, :3] = Rotation.from_rotvec(twist[3:]).as_matrix() @ pose[:3, :3]
    after[:3, 3] = pose[:3, 3] + twist[:3]
    return after


def least(call: Callable[[], object], count: int) -> float:
    """Microseconds of a call: the least of ROUNDS means."""
    call()
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(count):
            call()
        times.append((time.perf_counter() - start) / count)
    return 1e6 * min(times)


def central(distance: Callable[[np.ndarray], float], h: float) -> np.ndarray:
    """Gradient by 24 distances."""
    return np.array([(distance(h * e) - distance(-h * e)) / (2.0 * h) for e in np.eye(12)])


def second(distance: Callable[[np.ndarray], float], h: float) -> np.ndarray:
    """Hessian by 1 + 24 + 264 distances."""
    here, e = distance(np.zeros(12)), h * np.eye(12)
    one = np.array([[distance(s * e[i]) for s in (1.0, -1.0)] for i in range(12)])
    found = np.diag((one[:, 0] - 2.0 * here + one[:, 1]) / h**2)
    for i in range(12):
        for j in range(i):
            corners = [s * t * distance(s * e[i] + t * e[j]) for s in (1, -1) for t in (1, -1)]
            found[i, j] = found[j, i] = sum(corners) / (4.0 * h**2)
    return found


def coal_distance(pose_a: np.ndarray, pose_b: np.ndarray) -> Callable[[np.ndarray], float]:
    shapes = coal.Ellipsoid(*AXES_A), coal.Ellipsoid(*AXES_B)
    request, result = coal.DistanceRequest(), coal.DistanceResult()

    def of(twists: np.ndarray) -> float:
        first, other = moved(pose_a, twists[:6]), moved(pose_b, twists[6:])
        result.clear()
        places = [coal.Transform3s(x[:3, :3], x[:3, 3]) for x in (first, other)]
        return coal.distance(shapes[0], places[0], shapes[1], places[1], request, result)

    return of


def beside_differences(gap: float, rng: np.random.Generator) -> None:
    a, b = PAIRS["two ellipsoids"]
    normals = Rotation.random(random_state=rng).as_matrix()[:2]
    points = [np.square(x) * n for x, n in zip((AXES_A, AXES_B), normals, strict=True)]
    points = [x / np.sqrt(x @ n) for x, n in zip(points, normals, strict=True)]
    n = Rotation.random(random_state=rng).as_matrix()[0]
    pose_a, pose_b = np.eye(4), np.eye(4)
    pose_a[:3, :3] = Rotation.align_vectors([n], [normals[0]])[0].as_matrix()
    pose_b[:3, :3] = Rotation.align_vectors([-n], [normals[1]])[0].as_matrix()
    pose_b[:3, 3] = pose_a[:3, :3] @ points[0] + gap * n - pose_b[:3, :3] @ points[1]
    features = optima.ellipsoid(AXES_A, normals[0]), optima.ellipsoid(AXES_B, normals[1])
    with mp.workdps(optima.DIGITS):
        gradient, hessian, *_ = optima.Pair(features, (pose_a, pose_b), n, gap).derivatives()
    answer = so.distance(a, b, pose_a, pose_b)
    by_coal = coal_distance(pose_a, pose_b)

    def by_standoff(twists: np.ndarray) -> float:
        return so.distance(a, b, moved(pose_a, twists[:6]), moved(pose_b, twists[6:])).distance

    # the calls alone: who differentiates in C++ makes the poses in no time
    shapes = coal.Ellipsoid(*AXES_A), coal.Ellipsoid(*AXES_B)
    places = [coal.Transform3s(x[:3, :3], x[:3, 3]) for x in (pose_a, pose_b)]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    calls = {
        "coal": least(
            lambda: coal.distance(shapes[0], places[0], shapes[1], places[1], request, result),
            5000,
        ),
        "so.distance": least(lambda: so.distance(a, b, pose_a, pose_b), 1000),
    }
    print(f"\nGap {gap:g}: time, us, and greatest error (of the Hessian over its greatest entry)")
    scale = np.abs(hessian).max()
    error = np.abs(answer.gradient - gradient).max()
    print(
        f"  gradient  exact              {least(lambda: answer.gradient, 1000):9.1f}  {error:.1e}"
    )
    for name, of in (("coal", by_coal), ("so.distance", by_standoff)):
        errors = {h: np.abs(central(of, h) - gradient).max() for h in STEPS}
        h = min(errors, key=errors.__getitem__)
        took = 24 * calls[name]
        print(f"  gradient  {name:11s} {h:5.0e}  {took:9.1f}  {errors[h]:.1e}")
    error = np.abs(answer.hessian - hessian).max() / scale
    print(f"  Hessian   exact              {least(answer.derivatives, 1000):9.1f}  {error:.1e}")
    for name, of in (("coal", by_coal), ("so.distance", by_standoff)):
        errors = {h: np.abs(second(of, h) - hessian).max() / scale for h in STEPS}
        h = min(errors, key=errors.__getitem__)
        took = 289 * calls[name]
        print(f"  Hessian   {name:11s} {h:5.0e}  {took:9.1f}  {errors[h]:.1e}")


def beside_steps(n: int = 20_000) -> None:
    """Ratios to a step, of rows of `so.distances` to frames of `run`, and of single answers."""
    print("\nTime over that of a step: compiled, then from Python; and the step, us")
    turns = np.linspace(0.0, 1.0, n)
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.from_rotvec(np.outer(turns, [0.3, 0.5, 1.0])).as_matrix()
    poses[:, :3, 3] = np.c_[2.2 * np.cos(turns), 2.2 * np.sin(turns), 0.2 * turns]
    for name, (a, b) in PAIRS.items():
        tracker = so.Tracker(a, b)
        state = tracker.start(np.eye(4), poses[0])
        found = so.distances(a, b, np.eye(4), poses, warm=True)
        frame = least(lambda t=tracker, s=state: t.run(s, np.eye(4), poses), 1) / n
        slope = least(lambda f=found: f.gradient, 1) / n
        everything = least(found.derivatives, 1) / n
        step = least(lambda t=tracker, s=state: t.step(s, np.eye(4), poses[1]), 2000)
        answer = tracker.step(state, np.eye(4), poses[1])[1]
        gradient = least(lambda x=answer: x.gradient, 2000)
        derivatives = least(answer.derivatives, 2000)
        print(
            f"  {name:20s} gradient {slope / frame:4.2f} {gradient / step:5.2f}   "
            f"all {everything / frame:4.2f} {derivatives / step:5.2f}   "
            f"step {frame:5.3f} {step:5.2f}"
        )


if __name__ == "__main__":
    rng = np.random.default_rng(20261123)
    for gap in (1.0, 1e-2, 1e-4, 1e-6):
        beside_differences(gap, rng)
    beside_steps()
