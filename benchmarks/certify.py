"""Joint paths and boxes of configurations: how many proofs are wrong, and what they cost.

Run from the repository's root:

- ``python -m benchmarks.certify paths --paths 1000 [--samples 100000] [--seed 1] [--rings 2]``:
  random trees of joints on random straight paths, each judged by many samples of an oracle with
  other kinematics and closed-form distances (``tests/robots/path_oracle.py``); half of them graze
  the clearance. With rings, among so many solids that need not be convex.
- ``python -m benchmarks.certify arms --paths 20 [--samples 10000] [--seed 1]``: the same for real
  arms among a pole, a ball and a crate, judged by Pinocchio with Coal, and by MuJoCo
  (``tests/robots/real_arms.py``).
- ``python -m benchmarks.certify speed``: arms of seven joints among obstacles, certified, and
  beside it the same path sampled at 1 kHz.
- ``python -m benchmarks.certify boxes``: the share of a box that is proven, against time, for two
  to seven joints.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

import standoff as so
from standoff.robots.robot import Robot

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path.insert(0, str(TESTS))

BLOCK = 10_000
"""Samples that the oracle takes at once."""

FEW = 60
"""Samples that tell whether a path is worth judging."""

SAMPLED_WITHIN = 0.05
"""The horizon of the sampled path [m]: farther pairs are only bounded."""

CLEARANCE = 5e-3
"""That arms must keep [m]."""

ORACLE = 1e-11
"""Accuracy of the oracle's distances [length]."""


def paths(count: int, samples: int, seed: int, rings: int) -> int:
    """Judge many proofs; the number of wrong ones."""
    from robots.path_oracle import drawn_judged, least_distances
    from standoff.robots.proof import Verdict

    quicken()
    rng = np.random.default_rng(seed)
    verdicts: Counter[str] = Counter()
    wrong, taken, steps, margins = 0, [], [], []
    done = 0
    while done < count:
        judged = drawn_judged(rng, int(rng.integers(1, 8)), rings=rings)
        points = rng.uniform(-1.0, 1.0, judged.robot.nq)
        points = points + rng.uniform(-0.6, 0.6, (int(rng.integers(2, 6)), judged.robot.nq))
        times = np.linspace(0.0, 1.0, samples)
        own = np.linspace(0.0, 1.0, len(points))
        if least_distances(judged, points).min() <= 1e-3:
            continue
        some = np.linspace(0.0, 1.0, 200)
        q = np.stack([np.interp(some, own, points[:, k]) for k in range(points.shape[1])], 1)
        if least_distances(judged, q).min() <= 1e-3:
            continue
        least = np.empty(samples)
        for first in range(0, samples, BLOCK):
            part = times[first : first + BLOCK]
            q = np.stack([np.interp(part, own, points[:, k]) for k in range(points.shape[1])], 1)
            least[first : first + BLOCK] = least_distances(judged, q).min(axis=1)
        if least.min() <= 1e-3:
            continue
        done += 1
        margin = float(rng.choice([-1e-6, 1e-6, -1e-3, 1e-3, rng.uniform(-0.05, 0.05)]))
        clearance = max(0.0, least.min() - margin)
        begin = time.perf_counter()
        proof = judged.robot.certify(points, clearance, times=own)
        taken.append(time.perf_counter() - begin)
        verdicts[proof.verdict.name] += 1
        steps.append(proof.counts.steps / proof.counts.pairs)
        bad = False
        if proof.verdict is Verdict.PROVEN:
            margins.append(least.min() - proof.proven)
            bad = least.min() < max(clearance, proof.proven) - ORACLE
        else:
            bad = least[times < proof.time].min(initial=np.inf) < clearance - ORACLE
        if proof.verdict is Verdict.VIOLATED:
            q = proof.witness.q[None]
            bad |= least_distances(judged, q).min() >= clearance + ORACLE
        if bad:
            wrong += 1
            tell(f"WRONG: seed {seed}, path {done}: {proof}")
        if done % 100 == 0:
            tell(f"{done} paths, {wrong} wrong, {dict(verdicts)}")
    tell(
        f"{count} paths of 1 to 7 joints, {samples} samples each, seed {seed}: {wrong} wrong; "
        f"{dict(verdicts)}; {np.median(taken) * 1e3:.1f} ms median, {np.max(taken) * 1e3:.0f} "
        f"most; steps a pair {np.median(steps):.1f} median, {np.max(steps):.0f} most"
    )
    return wrong


def arms(count: int, samples: int, seed: int) -> int:
    """Judge proofs of paths of real arms; the number of wrong ones."""
    sys.path.insert(0, str(TESTS / "robots"))
    from real_arms import ACCURACY, ARMS, arm, sampled, wrong_in

    from standoff.robots.proof import Verdict

    tell("| arm | pairs | paths | proven | violated | undecided | wrong | samples | ms |")
    tell("|---|---|---|---|---|---|---|---|---|")
    total = 0
    for name in ARMS:
        judged, rng = arm(name), np.random.default_rng(seed)
        verdicts: Counter[Verdict] = Counter()
        wrong, taken = 0, []
        while sum(verdicts.values()) < count:
            points = judged.path(rng)
            if sampled(judged, points, FEW).least.min() < 1e-3:
                continue
            seen = sampled(judged, points, samples)
            margin = float(rng.choice([-2.0 * ACCURACY, 2.0 * ACCURACY, -1e-3, 1e-3]))
            if seen.least.min() - abs(margin) < 0.0:
                continue
            begin = time.perf_counter()
            proof = judged.robot.certify(points, seen.least.min() - margin)
            taken.append(time.perf_counter() - begin)
            verdicts[proof.verdict] += 1
            said = wrong_in(proof, judged, points, seen)
            if said:
                wrong += 1
                tell(f"WRONG: {name}, seed {seed}, path {len(taken)}: {said}: {proof}")
        each = " | ".join(str(verdicts[verdict]) for verdict in Verdict)
        tell(
            f"| {name} | {len(judged.pairs)} | {count} | {each} | {wrong} | {samples} | "
            f"{np.median(taken) * 1e3:.0f} |"
        )
        total += wrong
    return total


def quicken() -> None:
    """Compile the oracle's distance of two segments, after a comparison with its own."""
    import numba

    from robots import path_oracle

    @numba.njit
    def to_segment(p, a, b):  # type: ignore[no-untyped-def]
        along, up, size = 0.0, 0.0, 0.0
        for i in range(3):
            along += (p[i] - a[i]) * (b[i] - a[i])
            size += (b[i] - a[i]) ** 2
        t = min(max(along / size, 0.0), 1.0) if size > 0.0 else 0.0
        for i in range(3):
            up += (p[i] - a[i] - t * (b[i] - a[i])) ** 2
        return np.sqrt(up)

    @numba.njit
    def apart(a0, a1, b0, b1):  # type: ignore[no-untyped-def]
        found = np.empty(len(a0))
        for k in range(len(a0)):
            p, q, r, s = a0[k], a1[k], b0[k], b1[k]
            best = min(to_segment(p, r, s), to_segment(q, r, s))
            best = min(best, min(to_segment(r, p, q), to_segment(s, p, q)))
            uu, vv, uv, uw, vw = 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(3):
                u, v, w = q[i] - p[i], s[i] - r[i], p[i] - r[i]
                uu, vv, uv, uw, vw = uu + u * u, vv + v * v, uv + u * v, uw + u * w, vw + v * w
            det = uu * vv - uv * uv
            if det > 1e-12 * uu * vv:
                x, y = (uv * vw - vv * uw) / det, (uu * vw - uv * uw) / det
                if 0.0 < x < 1.0 and 0.0 < y < 1.0:
                    gap = 0.0
                    for i in range(3):
                        u, v, w = q[i] - p[i], s[i] - r[i], p[i] - r[i]
                        gap += (w + x * u - y * v) ** 2
                    best = min(best, np.sqrt(gap))
            found[k] = best
        return found

    ends = np.random.default_rng(0).normal(size=(4, 10_000, 3))
    ends[1, ::7] = ends[0, ::7]
    own = path_oracle.segments_apart
    assert np.abs(apart(*ends) - own(*ends)).max() < 1e-12
    path_oracle.segments_apart = apart


def among(count: int, rng: np.random.Generator, within: float | None = None) -> Robot:
    """The arm of the examples among random spheres, capsules, boxes and ellipsoids."""
    robot = Robot.from_mujoco(TESTS.parent / "examples" / "robots" / "arm.xml", within=within)
    found = {}
    for k in range(count):
        away = rng.normal(size=3)
        pose = np.eye(4)
        pose[:3, 3] = rng.uniform(0.5, 1.3) * away / np.linalg.norm(away) + [0.0, 0.0, 0.4]
        a, b, c = rng.uniform(0.03, 0.1, 3)
        found[f"obstacle {k}"] = (
            (
                so.shapes.sphere(a),
                so.shapes.capsule(radius=a, length=3.0 * b),
                so.shapes.box((2.0 * a, 2.0 * b, 2.0 * c)),
                so.shapes.ellipsoid(a, b, c),
            )[k % 4],
            pose,
        )
    return robot.with_obstacles(found)


def speed(count: int, seed: int) -> None:
    """An arm among obstacles: certify a path of a second, and sample it at 1 kHz."""
    tell("| obstacles | pairs | proven, ms | places | distances | violated, ms | 1 kHz, ms |")
    tell("|---|---|---|---|---|---|---|")
    for obstacles in (0, 20, 60):
        robot = among(obstacles, np.random.default_rng(seed))
        near = among(obstacles, np.random.default_rng(seed), SAMPLED_WITHIN)
        rng = np.random.default_rng(seed + 1)
        proven, found, sampled, made = [], [], [], []
        while len(proven) < count:
            points = rng.uniform(-1.2, 1.2, 7) + rng.uniform(-0.4, 0.4, (2, 7))
            points = np.clip(points, robot.lower, robot.upper)
            if robot.clearance(points[0]).distance < CLEARANCE:
                continue
            begin = time.perf_counter()
            proof = robot.certify(points, CLEARANCE)
            taken = time.perf_counter() - begin
            if not proof:
                found.append(taken)
                continue
            proven.append(taken)
            made.append(proof.counts)
            begin = time.perf_counter()
            state = near.start(points[0])
            for s in np.linspace(0.0, 1.0, 1001)[1:]:
                state, _ = near.step(state, points[0] + s * (points[1] - points[0]))
            sampled.append(time.perf_counter() - begin)
        counts = np.median([[each.configurations, each.queries] for each in made], axis=0)
        violated = f"{np.median(found) * 1e3:.0f}" if found else "-"
        tell(
            f"| {obstacles} | {made[0].pairs} | {np.median(proven) * 1e3:.1f} | {counts[0]:.0f} | "
            f"{counts[1]:.0f} | {violated} | {np.median(sampled) * 1e3:.0f} |"
        )


def boxes(seed: int) -> None:
    """The proven share of a box against the budget and time."""
    from robots.arms import arm

    tell("| joints | sides, rad | boxes | free | not free | open | s |")
    tell("|---|---|---|---|---|---|---|")
    for joints in range(2, 8):
        robot = arm(np.random.default_rng(seed), joints, 6)
        for side in (5.8, 1.0):
            middle = np.zeros(joints) if side > 2.0 else np.full(joints, 0.4)
            lower, upper = middle - 0.5 * side, middle + 0.5 * side
            for most in (100, 1_000, 10_000):
                begin = time.perf_counter()
                proof = robot.certify_box(lower, upper, 5e-3, max_boxes=most, whole=True)
                taken = time.perf_counter() - begin
                tell(
                    f"| {joints} | {side} | {proof.counts.boxes} | {proof.free:.1%} | "
                    f"{proof.violated:.1%} | {proof.open:.1%} | {taken:.2f} |"
                )
                if proof.open == 0.0:
                    break


def tell(text: str) -> None:
    """Print at once: a run takes long."""
    print(text, flush=True)


def main() -> int:
    """Run one of the measurements."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["paths", "arms", "speed", "boxes"])
    parser.add_argument("--paths", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=None)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rings", type=int, default=0)
    given = parser.parse_args()
    if given.what == "paths":
        found = paths(given.paths, given.samples or 100_000, given.seed, given.rings)
        return 1 if found else 0
    if given.what == "arms":
        return 1 if arms(given.paths, given.samples or 10_000, given.seed) else 0
    if given.what == "speed":
        speed(20, given.seed)
    else:
        boxes(given.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
