"""The soak's cases: the pair for a seed and a number, its motion and the tracker's options."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from standoff.tracking.law_options import Law
from standoff.tracking.laws import PredictorCorrector, law_of_facts
from standoff.typing import Array
from standoff_studies.soak.directions import shift_into
from standoff_studies.soak.motions import Frames, Motion, Path, draw_path, random_direction, stream
from standoff_studies.soak.placing import heights
from standoff_studies.soak.shapes import Made, Shape, draw_shape, made

Rng = np.random.Generator

DRAWER = 8
"""Number of shapes that pairs share, since making a body takes longer than tracking it."""

PER_DRAWER = 64
"""Pairs from one drawer."""

SHAPES, PAIRS = 0, 1
"""Streams of a seed's random numbers."""

FAMILIES = {"apart": 0.75, "touching": 0.12, "passing": 0.1, "inside": 0.03}
"""Shares of the motions: kept apart by a gap; built to touch at one frame, in small motions; let
into one another by a fifth of the lesser body at most; around one another's middle."""


@dataclass(frozen=True)
class Case:
    """One pair of the soak, determined by `number` and `seed`.

    Attributes
    ----------
    seed, number : int
    family : str
        Of FAMILIES.
    a, b : Shape
    motion : Motion
    options : dict
        The name and the options of the law, if they are not the defaults.
    frames : int
    """

    seed: int
    number: int
    family: str
    a: Shape
    b: Shape
    motion: Motion
    options: dict[str, Any]
    frames: int

    @property
    def law(self) -> Law:
        """The law of `options`."""
        return law_of_facts({"law": PredictorCorrector.name, **self.options})

    def facts(self) -> dict[str, Any]:
        """Return the case as plain data."""
        return asdict(self) | {"a": self.a._asdict(), "b": self.b._asdict()}

    @classmethod
    def of(cls, facts: dict[str, Any]) -> Case:
        """Return the case from plain data.

        Raises
        ------
        KeyError, TypeError
            It is not a case.
        """
        parts = {
            "a": Shape(**facts["a"]),
            "b": Shape(**facts["b"]),
            "motion": Motion.of(facts["motion"]),
        }
        return cls(**(facts | parts))


def draw_case(seed: int, number: int, frames: int) -> tuple[Case, Made, Made, Frames]:
    """Return pair `number` of a seed, its two bodies, and its frames."""
    rng = stream(seed, PAIRS, number)
    drawer = drawer_of(seed, number // PER_DRAWER)
    while True:
        a, b = (drawer[int(k)] for k in rng.integers(0, DRAWER, 2))
        if a.body.bounded or b.body.bounded:
            break
    family = str(rng.choice(list(FAMILIES), p=list(FAMILIES.values())))
    motion, moves = _draw_motion(rng, family, a, b, frames)
    options = _draw_options(rng)
    return Case(seed, number, family, a.shape, b.shape, motion, options, frames), a, b, moves


@lru_cache(maxsize=2)
def drawer_of(seed: int, number: int) -> tuple[Made, ...]:
    """Return the shapes that a run of PER_DRAWER pairs shares."""
    rng = stream(seed, SHAPES, number)
    shapes = [draw_shape(rng) for _ in range(DRAWER)]
    while all(shape.kind == "halfspace" for shape in shapes):
        shapes = [draw_shape(rng) for _ in range(DRAWER)]
    return tuple(made(shape) for shape in shapes)


def _draw_options(rng: Rng) -> dict[str, Any]:
    """Mostly the defaults; sometimes other options, and the paper's law."""
    options: dict[str, Any] = {}
    if rng.random() < 0.3:
        names = ["feedforward-2", "feedforward", "secant", "none"]
        options["predictor"] = str(rng.choice(names))
    if rng.random() < 0.1:
        options["tolerance"] = float(10.0 ** rng.uniform(-11.0, -4.0))
    if rng.random() < 0.15:
        options["depth"] = "local"
    if rng.random() < 0.05:
        options["deadline"] = int(rng.integers(1, 200))
    if rng.random() < 0.04:
        options["law"] = "paper"
        options.pop("predictor", None)
    return options


def _draw_motion(rng: Rng, family: str, a: Made, b: Made, frames: int) -> tuple[Motion, Frames]:
    sizes = [made.body.size for made in (a, b) if made.body.bounded and made.body.size > 0.0]
    size, least = max(sizes, default=1.0), min(sizes, default=1.0)
    small = family == "touching"
    reach = float(10.0 ** rng.uniform(-4.0, -0.5)) if small else float(rng.uniform(0.3, 2.0))
    path_a, path_b = (
        draw_path(rng, least if small else size, reach)
        if made.body.bounded
        else Path(draw_path(rng, size, reach).start, [0.0, 0.0, 0.0])
        for made in (a, b)
    )
    motion = Motion(path_a, path_b, step=float(10.0 ** rng.uniform(-4.0, -1.0)))
    motion = _shown(rng, motion, size, frames)
    moves = motion.frames(frames)
    shift = _shift(rng, family, a, b, moves, size, least)
    moves.poses_b[:, 9:] += shift
    return replace(motion, b=replace(motion.b, centre=shift.tolist())), moves


def _shown(rng: Rng, motion: Motion, size: float, frames: int) -> Motion:
    """Uneven steps, teleports, wrong and missing twists."""
    if rng.random() < 0.3:
        motion = replace(motion, uneven=float(rng.uniform(0.0, 1.0)))
    if rng.random() < 0.15:
        count = int(rng.integers(1, 6))
        jumps = [
            [float(rng.integers(1, max(frames, 2))), float(rng.uniform(0.1, 20.0))]
            for _ in range(count)
        ]
        motion = replace(motion, jumps=jumps)
    draw = rng.random()
    if draw < 0.2:
        return replace(motion, twists=False)
    if draw < 0.3:
        return replace(
            motion, twist_factor=float(rng.choice([-1.0, 0.0, 0.5, 0.8, 1.2, 3.0, 100.0]))
        )
    if draw < 0.35:
        error = rng.normal(size=6) * np.repeat([size, 1.0], 3) * 10.0 ** rng.uniform(-3.0, 1.0)
        return replace(motion, twist_error=error.tolist())
    return motion


def _shift(
    rng: Rng, family: str, a: Made, b: Made, frames: Frames, size: float, least: float
) -> Array:
    """The shift of B's path, (3,), that makes the pair belong to its family."""
    u = _approach(rng, a, b, frames)
    rows = np.broadcast_to(u, (len(frames.steps), 3))
    gaps = -(heights(a, frames.poses_a, rows)[0] + heights(b, frames.poses_b, -rows)[0])
    if family == "apart":
        return np.asarray(u * (size * 10.0 ** rng.uniform(-7.0, 0.5) - gaps.min()))
    if family == "passing":
        depth = least * 10.0 ** rng.uniform(-4.0, -0.7)
        return u * shift_into(a, b, frames, u, depth)
    if family == "inside":
        # half-spaces would be left far behind: their gap is what is small
        middle = frames.poses_a[0, 9:] - frames.poses_b[0, 9:]
        if not (a.body.bounded and b.body.bounded):
            return np.asarray(-u * (gaps.mean() + least * rng.uniform(0.0, 0.5)))
        return np.asarray(middle + least * rng.uniform(0.0, 0.3) * random_direction(rng))
    k = int(rng.integers(0, len(frames.steps)))
    x_a = heights(a, frames.poses_a[k : k + 1], u[None])[1][0]
    x_b = heights(b, frames.poses_b[k : k + 1], -u[None])[1][0]
    gap = least * float(rng.choice([-1.0, 0.0, 1.0])) * 10.0 ** rng.uniform(-12.0, -2.0)
    return np.asarray(x_a - x_b + gap * u)


def _approach(rng: Rng, a: Made, b: Made, frames: Frames) -> Array:
    """A direction from A to B; with a half-space, its normal."""
    if not a.body.bounded:
        return frames.poses_a[0, [2, 5, 8]]
    if not b.body.bounded:
        return -frames.poses_b[0, [2, 5, 8]]
    if rng.random() < 0.15:
        # along an axis of one of them, so that faces, rims and vertices meet directly
        poses = frames.poses_a if rng.random() < 0.5 else frames.poses_b
        k, axis = int(rng.integers(0, len(poses))), int(rng.integers(0, 3))
        return np.asarray(poses[k, [axis, 3 + axis, 6 + axis]] * float(rng.choice([-1.0, 1.0])))
    return random_direction(rng)
