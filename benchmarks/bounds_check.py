"""Queries of every kind with every index of the kernels checked.

Run from the repository's root: ``python -m benchmarks.bounds_check --poses 20 [FAMILY ...]``. The
kernels are compiled anew with checks into ``build/bounds-check``, which takes a minute; with
``--python`` they run as plain Python, a thousand times slower, and an error's traceback names the
line. The answers are judged elsewhere; here only an exception is a fault.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
KERNELS = ROOT / "src" / "standoff" / "kernels"
JUMP = 3.0
"""Greatest jump of a wild motion from frame to frame, in sizes of the pair."""


def check_every_index(python: bool) -> None:
    """Set what `kernels.compiler.decorators` reads at import; nothing may have imported it."""
    if "standoff" in sys.modules:
        raise RuntimeError("standoff is imported already: its kernels are compiled unchecked")
    digest = hashlib.sha256()
    for source in sorted(KERNELS.glob("*.py")):
        digest.update(source.read_bytes())
    cache = ROOT / "build" / "bounds-check" / digest.hexdigest()[:16]
    os.environ["STANDOFF_BOUNDS_CHECK"] = "1"
    os.environ["NUMBA_DISABLE_JIT"] = "1" if python else "0"
    os.environ["NUMBA_CACHE_DIR"] = str(cache)
    sys.path[:0] = [str(ROOT / "tests")]


def laws() -> list[Any]:
    """Every predictor, integrator, feedback and variant of the paper's law, once at least."""
    import standoff as so
    from standoff.tracking.feedback import PI, FiniteTime, GainMatrix, MotionGain
    from standoff.tracking.laws import every_option

    found: list[Any] = []
    for law, name in ((so.PredictorCorrector, "predictor"), (so.PaperLaw, "integrator")):
        found += [law(**{name: word}) for word in every_option()[name].kind.names]
    variants: list[dict[str, Any]] = [{"switching": "voronoi"}]
    variants += [{"switching": "voronoi", "saturation": "hold"}]
    variants += [{"switching": "none"}, {"realisation": "integrated"}, {"solve": "plain"}]
    gains = (PI(50.0, 500.0), GainMatrix([50.0, 60.0, 70.0, 80.0]), MotionGain(1e-3))
    variants += [{"feedback": chosen} for chosen in (*gains, FiniteTime(50.0, 0.5, 1e-2))]
    return found + [so.PaperLaw(**options) for options in variants]


class Sweep:
    """Asks pairs of bodies in every way, and counts the queries and what they raised."""

    def __init__(self, poses: int, frames: int, seed: int) -> None:
        self.poses, self.frames = poses, frames
        self.rng = np.random.default_rng(seed)
        self.counts: Counter[str] = Counter()
        self.faults: list[str] = []
        self.laws = laws()

    def attempt(self, what: str, label: str, ask: Callable[[], object], queries: int = 1) -> None:
        """Run one question; all of them are sound, so nothing may be refused."""
        self.counts[what] += queries
        try:
            ask()
        except Exception as error:
            if len(self.faults) < 20:
                traceback.print_exc()
            self.faults.append(f"{what}, {label}: {type(error).__name__}: {error}")

    def pair(self, label: str, a: Any, b: Any, poses: list[tuple[Any, Any]], planar: bool) -> None:
        """All questions about one pair at its poses."""
        import standoff as so
        from families.starts import random_start

        tracker = so.Tracker(a, b)
        for pose_a, pose_b in poses:
            self.attempt("cold", label, lambda p=pose_a, q=pose_b: so.distance(a, b, p, q))
            starts = [random_start(body, self.rng) for body in (a, b)]
            for settle in (True, False):
                given = (pose_a, pose_b, *starts)
                self.attempt(
                    "start_from",
                    label,
                    lambda g=given, s=settle: tracker.start_from(*g, settle=s),
                )
        for law in self.laws:
            told = f"{label} {law}"
            pose = poses[self.rng.integers(len(poses))]
            self.attempt(
                "tracked",
                told,
                lambda x=law, p=pose: self.track(a, b, p, planar, x),
                self.frames,
            )
        told = f"{label} wild"
        self.attempt("wild", told, lambda: self.wild(a, b, poses[0], planar), self.frames)

    def track(self, a: Any, b: Any, pose: tuple[Any, Any], planar: bool, law: Any) -> None:
        """Follow B on a slow screw from a pose, by the library's own loop."""
        import standoff as so
        from standoff.motion import ConstantTwist, Fixed, Pose

        pose_a, pose_b = (Pose.of(p) for p in pose)
        v, omega = self.rng.normal(size=(2, 3))
        if planar:
            v, omega = v * [1.0, 1.0, 0.0], omega * [0.0, 0.0, 1.0]
        twist = so.Twist(v, omega)
        path = ConstantTwist(pose_b, twist)
        so.track(
            so.Tracker(a, b, 1e-2, law),
            Fixed(pose_a),
            path,
            self.frames * 1e-2,
        )

    def wild(self, a: Any, b: Any, pose: tuple[Any, Any], planar: bool) -> None:
        """Teleports, deep penetration, twists that have nothing to do with the motion."""
        import standoff as so
        from oracles.exact_pairs import random_rotation

        sizes = [body.size for body in (a, b) if np.isfinite(body.size)]
        size = max(sum(sizes), 1e-3)
        tracker = so.Tracker(a, b)
        state = tracker.start(*pose)
        for k in range(self.frames):
            shift = self.rng.normal(size=3) * JUMP * size * (k % 3) / 2
            shift[2] *= not planar
            turn = np.eye(4)
            turn[:3, :3], turn[:3, 3] = random_rotation(self.rng, planar), shift
            spin = self.rng.normal(size=3) * 100.0
            spin[:2] *= not planar
            twist = so.Twist(shift * 1e3, spin) if k % 2 else None
            state, _ = tracker.step(state, np.eye(4), turn, None, twist)

    def family(self, name: str) -> None:
        """One instance of a family of the tests."""
        from families.pairs import draw

        seed = int(self.rng.integers(1 << 31))
        instance = draw(name, seed, 0, self.poses)
        poses = [(p.pose_a, p.pose_b) for p in instance.poses]
        planar = instance.a.body.dimension == 2 or instance.b.body.dimension == 2
        self.pair(instance.label, instance.a.body, instance.b.body, poses, planar)

    def overlapping(self, kind: str) -> None:
        """Overlapping poses of one kind of pair."""
        from families.overlaps import draw_overlapping

        for drawn in draw_overlapping(kind, max(1, self.poses // 4), self.rng):
            a, b = drawn.a.body, drawn.b.body
            pose = tuple((p.rotation, p.position) for p in (drawn.placed_a, drawn.placed_b))
            planar = a.dimension == 2 or b.dimension == 2
            self.pair(f"{kind}: {drawn.label}", a, b, [pose], planar)

    def points(self) -> None:
        """A point through a planar body, out and in."""
        import standoff as so
        from families.shapes import loop

        body = loop(self.rng).body
        tracker = so.PointTracker(body, 1e-2)
        state = tracker.start((0.0, 0.0))

        def step(x: Any) -> None:
            nonlocal state
            state, _ = tracker.step(state, x)

        for x in self.rng.normal(size=(self.frames, 2)) * body.size:
            self.attempt("point", f"{body!r} at {x}", lambda x=x: step(x))


def main() -> int:
    """Print the counts; the exit code is 1 at any exception that is not documented."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("families", nargs="*", help="families of tests/families; all by default")
    parser.add_argument("--poses", type=int, default=20, help="poses of each family")
    parser.add_argument("--frames", type=int, default=12, help="frames of each motion")
    parser.add_argument("--python", action="store_true", help="as plain Python, with tracebacks")
    parser.add_argument("--seed", type=int, help="default: a fresh one")
    arguments = parser.parse_args()
    check_every_index(arguments.python)
    from families.overlaps import PAIRS
    from families.pairs import FAMILIES
    from standoff.kernels.compiler.decorators import BOUNDS_CHECK

    if not BOUNDS_CHECK:
        raise RuntimeError("the kernels do not check their indices")
    unknown = sorted(set(arguments.families) - set(FAMILIES) - set(PAIRS))
    if unknown:
        parser.error(f"unknown families {unknown}: choose from {sorted([*FAMILIES, *PAIRS])}")
    seed = arguments.seed
    if seed is None:
        seed = int(np.random.default_rng().integers(1 << 31))
    sweep = Sweep(arguments.poses, arguments.frames, seed)
    began = time.perf_counter()
    names = arguments.families or [*FAMILIES, *PAIRS]
    for name in names:
        sweep.family(name) if name in FAMILIES else sweep.overlapping(name)
    sweep.points()
    told = ", ".join(f"{count} {what}" for what, count in sweep.counts.items())
    spent = time.perf_counter() - began
    print(f"seed {seed}: {told}; {len(sweep.faults)} faults in {spent:.0f} s")
    print("\n".join(sweep.faults[:20]))
    return 1 if sweep.faults else 0


if __name__ == "__main__":
    sys.exit(main())
