"""Runs of every kind of body under every law, apart and in contact, for comparison with committed
ones.

``python -m families.traces`` (from ``tests``) records them anew: after a change that is meant to
alter answers, and then say in the commit which and why.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import standoff as so

Array = NDArray[np.float64]

FILE = Path(__file__).with_name("traces.npz")
FRAMES = 40
DT = 5e-3
"""Frame time, s."""
NUMBERS = ("distance", "lower_bound", "upper_bound", "rate")
VECTORS = ("point_a", "point_b", "normal", "velocity_a", "velocity_b")


def polytope() -> so.Body:
    corners = np.random.default_rng(3).normal(size=(10, 3))
    return so.shapes.polytope(corners / np.linalg.norm(corners, axis=1)[:, None])


BODIES: dict[str, Callable[[], so.Body]] = {
    "ellipsoid": lambda: so.shapes.ellipsoid(0.5, 0.9, 0.7),
    "lens": lambda: so.shapes.lens(1.0, 0.5),
    "box": lambda: so.shapes.box(0.6, 0.9, 1.1),
    "cylinder": lambda: so.shapes.cylinder(0.5, 1.2),
    "cone": lambda: so.shapes.cone(0.6, 1.0),
    "capsule": lambda: so.shapes.capsule(0.3, 0.9),
    "polytope": polytope,
    "superellipsoid": lambda: so.shapes.superellipsoid(0.5, 0.7, 0.9, 0.6, 1.3),
    "sphere": lambda: so.shapes.sphere(0.6),
    "segment": lambda: so.shapes.segment(0.8),
    "cap": lambda: so.shapes.cap(1.0, 0.3),
    "rounded box": lambda: so.shapes.box(0.5, 0.7, 0.9, rounding=0.1),
    "egg": lambda: so.shapes.egg(0.5, 1.2),
    "spindle": lambda: so.shapes.spindle(0.4, 1.5),
    "gore": lambda: so.shapes.gore(0.3, 0.8),
}

LAWS: dict[str, Callable[[], object]] = {
    "default": so.PredictorCorrector,
    "one-step": lambda: so.PredictorCorrector(predictor="feedforward"),
    "secant": lambda: so.PredictorCorrector(predictor="secant"),
    "local": lambda: so.PredictorCorrector(depth="local"),
    "deadline": lambda: so.PredictorCorrector(deadline=4),
    "euler": lambda: so.PaperLaw(integrator="euler"),
    "heun": lambda: so.PaperLaw(gain=100.0),
    "integrated": lambda: so.PaperLaw(integrator="rk4", realisation="integrated"),
    "printed": lambda: so.PaperLaw(
        gain=100.0, switching="voronoi", saturation="zero", far_side="kept"
    ),
    "raw": lambda: so.PaperLaw(integrator="midpoint", switching="none", solve="plain"),
}


def runs() -> list[tuple[str, str, str]]:
    """(body A, body B, law): each body twice, each law with bodies of several kinds."""
    names, laws = list(BODIES), list(LAWS)
    pairs = [(names[k], names[(3 * k + 1 + k % 4) % len(names)]) for k in range(len(names))]
    return [(a, b, laws[(7 * k + s) % len(laws)]) for s in (0, 5) for k, (a, b) in enumerate(pairs)]


def pose(turn: Array, position: Array) -> Array:
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = Rotation.from_rotvec(turn).as_matrix(), position
    return made


def trace(a: str, b: str, law: str) -> Array:
    """Rows of all frames, (FRAMES, 4 + 15 + 3): numbers, vectors, status and both features.

    B comes from 1.9 away, half of the runs until the bodies overlap; three of four have twists.
    """
    number = runs().index((a, b, law))
    rng = np.random.default_rng(number)
    spin_a, spin_b, about = rng.normal(size=(3, 3))
    away = rng.normal(size=3)
    away /= np.linalg.norm(away)
    speed = -away * (1.6 if number % 2 else 0.5) / (FRAMES * DT)
    first, second = BODIES[a](), BODIES[b]()
    tracker = so.Tracker(first, second, DT, law=LAWS[law]())
    rows, state = [], None
    for k in range(FRAMES):
        t = k * DT
        poses = pose(spin_a * t, np.zeros(3)), pose(about, 1.9 * away + speed * t)
        poses[1][:3, :3] = Rotation.from_rotvec(spin_b * t).as_matrix() @ poses[1][:3, :3]
        twists = (np.r_[np.zeros(3), spin_a], np.r_[speed, spin_b]) if number % 4 else ()
        if state is None:
            state = tracker.start(*poses, *twists)
        else:
            state, _ = tracker.step(state, *poses, *twists)
        rows.append(row(state.proximity, first, second))
    return np.array(rows)


def row(answer: so.Proximity, a: so.Body, b: so.Body) -> Array:
    vectors = [getattr(answer, name) for name in VECTORS]
    features = [
        ("face", "edge", "vertex").index(feature.kind) * 1000 + feature.index
        for feature in (answer.feature_a, answer.feature_b)
    ]
    numbers = [getattr(answer, name) for name in NUMBERS]
    return np.concatenate([numbers, *vectors, [answer.status.value, *features]])


def record() -> None:
    """Write all runs to FILE."""
    np.savez_compressed(FILE, **{"|".join(run): trace(*run) for run in runs()})


if __name__ == "__main__":
    record()
