"""Random motions of a family's pairs, tracked frame by frame and judged like cold queries.

B circles A and both turn; their distance along the line of their origins is a wave, so they stay
apart however close they come. A frame turns a body by a few hundredths of a radian, and the next
one is tracked from it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import standoff as so
from families.cold_queries import PER_INSTANCE, Report, judge
from families.pairs import FAMILIES, GAPS, Instance, draw
from oracles.exact_pairs import random_normal, random_rotation
from oracles.poses import DrawnPose, rotation_about, size_of
from standoff_studies.oracles import HalfSpace, Placed, Shape

Array = NDArray[np.float64]
Motion = Callable[[float], DrawnPose]

DT = 0.01
"""Frame time, s."""
SPIN = 4.0
"""Greatest angular velocity of a body and of the line between them, rad/s."""
RATE_STEP = 1e-6
"""Half the time over which velocities are taken as differences, s."""


def tracked_families() -> list[str]:
    """Families that move freely: all but those with a half-space."""
    return [name for name in FAMILIES if "half-space" not in name]


def _turn(rng: np.random.Generator, planar: bool) -> Callable[[float], Array]:
    """Return a random rotation that turns about an axis which itself turns."""
    start = random_rotation(rng, planar)
    first, second = random_normal(rng), random_normal(rng)
    if planar:
        first = second = np.array([0.0, 0.0, 1.0])
    rates, phase = rng.uniform(-SPIN / 2, SPIN / 2, 2), rng.uniform(0, 2 * np.pi)
    return lambda t: (
        rotation_about(first, rates[0] * t)
        @ rotation_about(second, np.sin(rates[1] * t + phase))
        @ start
    )


def random_motion(a: Shape, b: Shape, rng: np.random.Generator) -> Motion:
    """Return a continuous motion of two shapes that stay apart by GAPS, over their size."""
    planar = a.dimension == b.dimension == 2
    turn_a, turn_b, swing = (_turn(rng, planar) for _ in range(3))
    line, place = random_normal(rng, planar), rng.normal(size=3)
    if planar:
        place[2] = 0.0
    low, high = np.log(GAPS)
    middle, wave = rng.uniform(low, high), rng.uniform(0, 1)
    size, drift = size_of(a, b), random_normal(rng, planar)

    def at(t: float) -> DrawnPose:
        first = Placed(a, turn_a(t), (place + 0.3 * drift * t) * size)
        direction = swing(t) @ line
        second = Placed(b, turn_b(t), np.zeros(3))
        reach = first.relative(direction)[0][0] + second.relative(-direction)[0][0]
        gap = size * float(np.exp(middle + wave * np.sin(SPIN * t)))
        placed = Placed(b, second.rotation, first.position + (reach + gap) * direction)
        return DrawnPose(first, placed, "free", None)

    return at


def twist(first: Placed, second: Placed, span: float) -> so.Twist:
    """Return the mean velocity between two close placements."""
    spin = (second.rotation - first.rotation) @ (second.rotation + first.rotation).T / 2
    omega = np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1]])
    return so.Twist((second.position - first.position) / span, omega / (2 * span))


def track(
    instance: Instance, motion: Motion, blind: bool
) -> tuple[list[DrawnPose], list[so.Proximity]]:
    """Track a pair along a motion; ``blind``: without its velocities."""
    tracker = so.Tracker(instance.a.body, instance.b.body, dt=DT)
    first = motion(0.0)
    state = tracker.start(first.pose_a, first.pose_b)
    poses, answers = [], []
    for frame in range(1, PER_INSTANCE + 1):
        t = frame * DT
        pose = motion(t)
        twists: tuple[so.Twist | None, so.Twist | None] = (None, None)
        if not blind:
            before, after = motion(t - RATE_STEP), motion(t + RATE_STEP)
            twists = (
                twist(before.a, after.a, 2 * RATE_STEP),
                twist(before.b, after.b, 2 * RATE_STEP),
            )
        state, answer = tracker.step(state, pose.pose_a, pose.pose_b, *twists)
        poses.append(pose)
        answers.append(answer)
    return poses, answers


def run_tracked(name: str, count: int, seed: int) -> Report:
    """Judge ``count`` tracked frames of a family, rounded up to whole motions."""
    report = Report(name, "tracked")
    for number in range(-(-count // PER_INSTANCE)):
        instance = draw(name, seed, number, 0)
        if isinstance(instance.a.shape, HalfSpace) or isinstance(instance.b.shape, HalfSpace):
            raise ValueError(f"family {name} has a half-space: its motions are not free")
        rng = np.random.default_rng([seed, number, 2])
        motion = random_motion(instance.a.shape, instance.b.shape, rng)
        poses, answers = track(instance, motion, number % 2 == 1)
        judge(report, Instance(instance.label, instance.a, instance.b, poses), answers)
    return report
