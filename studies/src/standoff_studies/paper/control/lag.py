"""Lag of the paper's law without feedforward, measured on random pairs, and its bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import standoff as so
from standoff.bodies import Body
from standoff.motion import ConstantTwist, Pose, Twist
from standoff.recording import Recording, track
from standoff.typing import Array
from standoff_studies.paper.pair_simulation import REST

DT = 1e-3
"""Frame time [s]."""
FRAMES = 40
"""Frames of a case: at K h = 0.5 the start's error is 1e-12 of itself at their end."""
LAG = 1e-3
"""Error that the gain should keep, as a fraction of the smaller body's size."""
LEAST_STEP, MOST_STEP = 0.02, 1.0
"""Range of K h: below it a case does not have time to settle, above it the error may overshoot."""
FINE = "euler", 1e-9
"""A step so short that every gain is stable: those beyond `MOST_STEP` are replaced by it here."""


class Case(NamedTuple):
    """A random pair in motion; B moves, A is at rest.

    Attributes
    ----------
    kind : str
    a, b : Body
    pose_b : Pose
    twist_b : Twist
    """

    kind: str
    a: Body
    b: Body
    pose_b: Pose
    twist_b: Twist


class Lag(NamedTuple):
    """The measurements on a case.

    Attributes
    ----------
    kind : str
    error : float
        Greatest distance of a core's witness point from its true place, over all frames [length].
    bound : float
        What ``so.min_gain`` promises with the gain used [length].
    tracker : so.Tracker
        Without feedforward, at that gain.
    """

    kind: str
    error: float
    bound: float
    tracker: so.Tracker

    @property
    def part(self) -> float:
        """The error divided by its bound."""
        return self.error / self.bound


def ellipsoid(random: np.random.Generator) -> Body:
    """Semi-axes between 0.3 and 1.2 [length]."""
    return so.shapes.ellipsoid(*random.uniform(0.3, 1.2, 3))


PAIRS: dict[str, Callable[[np.random.Generator], tuple[Body, Body]]] = {
    "ellipsoid - point": lambda r: (ellipsoid(r), so.shapes.point()),
    "ellipsoid - ellipsoid": lambda r: (ellipsoid(r), ellipsoid(r)),
    "box - ellipsoid": lambda r: (so.shapes.box(*r.uniform(0.4, 1.5, 3)), ellipsoid(r)),
    "lens - ellipsoid": lambda r: (so.shapes.lens(1.0, r.uniform(0.2, 0.6)), ellipsoid(r)),
    "ellipsoid - capsule": lambda r: (ellipsoid(r), so.shapes.capsule(*r.uniform(0.2, 0.8, 2))),
    "sphere - ellipsoid": lambda r: (so.shapes.sphere(r.uniform(0.2, 0.8)), ellipsoid(r)),
}


def random_case(kind: str, random: np.random.Generator) -> Case:
    """B at a random pose some distance away, moving sideways, rotating, or both."""
    a, b = PAIRS[kind](random)
    direction = random.normal(size=3)
    direction /= np.linalg.norm(direction)
    turn = Rotation.from_rotvec(random.uniform(-2.0, 2.0, 3)).as_matrix()
    off = 0.5 * (a.size + b.size) + 10.0 ** random.uniform(-1.5, 0.5)
    v, omega = random.normal(size=(2, 3)) * [[random.integers(0, 2)], [random.integers(0, 2)]]
    if not v.any() and not omega.any():
        v = random.normal(size=3)
    return Case(kind, a, b, Pose(turn, off * direction), Twist(v, omega))


def measured_lag(case: Case) -> Lag | None:
    """Run a case with the gain from `so.min_gain`; None if that gain is out of range.

    The truth is the certified distance at the same poses.
    """
    paths = REST, ConstantTwist(case.pose_b, case.twist_b)
    truth = track(so.Tracker(case.a, case.b, dt=DT), *paths, FRAMES * DT, locate=False)
    v, omega = case.twist_b.v, case.twist_b.omega
    speed, spin = float(np.linalg.norm(v)), float(np.linalg.norm(omega))
    wanted = LAG * min(body.size or 1.0 for body in (case.a, case.b))
    among = float(truth.distance.min()), float(truth.distance.max())
    least = so.min_gain(case.a, case.b, wanted, speed, spin, distance=among, step=FINE)
    gain = float(np.clip(least, LEAST_STEP / DT, MOST_STEP / DT))
    bound = wanted * least / gain
    if not 0.0 < bound <= 10.0 * wanted:
        return None  # too fast for this step: the error would not be small
    law = so.Tracker(
        case.a, case.b, DT, law=so.PaperLaw(integrator="euler", gain=gain, feedforward=False)
    )
    made = track(law, *paths, FRAMES * DT, locate=False)
    off = core_points(case, made) - core_points(case, truth)
    error = float(np.linalg.norm(off, axis=2).max())
    return Lag(case.kind, error, bound, law)


def core_points(case: Case, made: Recording) -> Array:
    """Both witness points of each answer, without the swept radii, (n, 2, 3)."""
    inwards = np.array([[-case.a.radius], [case.b.radius]])
    return np.stack([made.point_a, made.point_b], axis=1) + inwards * made.normal[:, None]


def measured_lags(count: int, seed: int = 4) -> list[Lag]:
    """Cases of each kind in turn, `count` in total, without those that `measured_lag` rejects."""
    random = np.random.default_rng(seed)
    kinds = list(PAIRS)
    lags = []
    for k in range(count):
        lag = measured_lag(random_case(kinds[k % len(kinds)], random))
        if lag is not None:
            lags.append(lag)
    return lags
