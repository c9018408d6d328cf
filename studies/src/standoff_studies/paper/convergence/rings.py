"""Which starts arrive on bodies that bend inwards, and at which minimum, judged by solids."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from standoff.bodies import shapes
from standoff.geometry import Torus
from standoff.motion import Pose
from standoff.solids import Solid, distance
from standoff.tracking.inputs import flat_pose
from standoff.typing import Array
from standoff_studies.paper.convergence.ring_law import (
    COVARIANT,
    GRADIENT,
    PARTS,
    PRINTED,
    followed,
    ring_system,
)
from standoff_studies.paper.convergence.starts import ARRIVED

THIN, FAT, POINT = (1.0, 0.2), (1.0, 0.45), (0.0, 0.0)
"""Radii of a ring's circle and of its tube [length]."""

HOLLOW = "hollow ring and point"

KINDS = {
    "ring and point": (FAT, POINT),
    "two rings": (THIN, THIN),
    "linked rings": (THIN, THIN),
    "fat and thin": (FAT, THIN),
    HOLLOW: (FAT, POINT),
}
"""The radii of both bodies by the kind of pair; of a hollow ring those of its hollow, in which the
point is: its wall bends inwards both ways on half of it, as the inside of a bowl does."""

SHELL = 0.15
"""Thickness of a hollow ring [length]."""

WITHIN = {"linked rings": 0.2, HOLLOW: 0.15}
"""How far the second body's centre is from the first one's circle [length]."""

POSES, STARTS = 2, 150
"""Of each kind, and at each of them."""

NEARER, DRAWS = 40, 20_000
"""More starts that are nearer than the second minimum, and of how many draws."""

SEED = 5

LEAST_GAP = 0.1
"""Least distance of a drawn pair [length]."""

AWAY = {"ring and point": 0.6, "two rings": 1.8, "fat and thin": 1.9}
"""Distance of the second body's centre of the others [length]."""

FAR = 10.0
"""Above every distance [length]."""

FRAMES = 3000
"""Most frames of a start."""

ROUNDOFF = 1e-12
"""A rise of the distance above this is no roundoff [length]."""


class RingLaw(NamedTuple):
    """A law: what stands for H, K h, and the stages of a step."""

    form: int
    step: float
    stages: int


RING_LAWS = {
    "as printed": RingLaw(PRINTED, 0.1, 2),
    "covariant M": RingLaw(COVARIANT, 0.1, 2),
    "covariant, by principal directions": RingLaw(PARTS, 0.1, 2),
    "gradient": RingLaw(GRADIENT, 0.1, 2),
    "Newton": RingLaw(PRINTED, 1.0, 1),
}
"""The laws by name. The gradient is that of the metric: of E, by lengths on the surfaces."""


@dataclass(frozen=True, eq=False)
class RingPair:
    """Two rings, or a ring and a point, and the minima that the judge tells, the least first."""

    kind: str
    radii: Array
    pose: Pose
    minima: tuple[float, ...]

    @property
    def second(self) -> float:
        """The distance of the second minimum, or of none [length]."""
        return next((x for x in self.minima if x > self.minima[0] + ARRIVED), FAR)


class Arrived(NamedTuple):
    """What became of the starts of one law.

    Attributes
    ----------
    tried, at_least, at_other : int
        Starts drawn evenly, those at the least distance, and at another local minimum.
    unknown : int
        Ends with H definite at no minimum that the judge tells.
    below, below_arrived : int
        More starts, nearer than the second minimum, and how many of them came to the least.
    rises : int
        Frames in which the distance rose.
    """

    tried: int
    at_least: int
    at_other: int
    unknown: int
    below: int
    below_arrived: int
    rises: int


@cache
def solid(radius: float, *tubes: float) -> Solid:
    """A ring as a solid, each of its walls in two halves; with two tubes it is hollow."""
    halves = [(tube, x) for tube in tubes for x in (-0.5 * np.pi, 0.5 * np.pi)]
    return Solid.from_patches([Torus(radius, tube, v0=x, v1=x + np.pi) for tube, x in halves])


@cache
def ring_pairs(kind: str) -> tuple[RingPair, ...]:
    """Pairs of a kind: poses are drawn until the judge proves that they are apart, and of two rings
    until it tells several minima."""
    rng, found = np.random.default_rng([SEED, list(KINDS).index(kind)]), list[RingPair]()
    a, b = KINDS[kind]
    while len(found) < POSES:
        turn, way = rng.normal(size=(2, 3))
        if kind in WITHIN:
            pose = Pose.exp(np.array([0.5 * np.pi, 0.0, 0.0]) + 0.3 * turn, WITHIN[kind] * way)
            pose = Pose(pose.rotation, pose.translation + np.array([a[0], 0.0, 0.0]))
        else:
            pose = Pose.exp(turn, AWAY[kind] * way / np.linalg.norm(way))
        one = RingPair(kind, np.array([*a, *b]), pose, _judged(kind, pose))
        apart = bool(one.minima) and one.minima[0] > LEAST_GAP
        if apart and (b == POINT or one.second < FAR):
            found.append(one)
    return tuple(found)


def _judged(kind: str, pose: Pose) -> tuple[float, ...]:
    """The proven distance and the other minima, or nothing where they are not apart."""
    a, b = KINDS[kind]
    ring = solid(*a, a[1] + SHELL) if kind == HOLLOW else solid(*a)
    other = shapes.point() if b == POINT else solid(*b)
    answer = distance(ring, other, Pose.identity(), pose, minima=FAR)
    if not answer.certified or answer.distance <= 0.0:
        return ()
    return (answer.distance, *sorted(each.distance for each in answer.minima))


def arrivals(pair: RingPair, law: RingLaw) -> Arrived:
    """Follow a law from starts drawn evenly in the parameters."""
    pose, counts = flat_pose(pair.pose), np.zeros(6, dtype=int)
    distances = np.empty(FRAMES + 1)
    g, form, lengths = np.empty(4), np.empty((4, 4)), np.empty(4)
    for k, q in enumerate(np.vstack([*_starts(pair)])):
        took = followed(pair.radii, pose, q, *law, distances)
        end = ring_system(pair.radii, pose, q, PRINTED, g, form, lengths)
        is_minimum = took < FRAMES and bool(np.linalg.eigvalsh(form)[0] > 0.0)
        least = abs(end - pair.minima[0]) < ARRIVED
        known = min(abs(end - x) for x in pair.minima) < ARRIVED
        spread = k < STARTS
        counts += (
            *(spread and least, spread and known and not least, is_minimum and not known),
            *(not spread, not spread and least),
            int((np.diff(distances[: took + 1]) > ROUNDOFF).sum()),
        )
    return Arrived(STARTS, *counts.tolist())


@cache
def _starts(pair: RingPair) -> tuple[Array, Array]:
    """Starts drawn evenly in the parameters, and those of more draws that are nearer than the
    second minimum."""
    rng, pose = np.random.default_rng(SEED), flat_pose(pair.pose)
    spread, nearer = rng.uniform(0.0, 2.0 * np.pi, (STARTS, 4)), list[Array]()
    g, form, lengths = np.empty(4), np.empty((4, 4)), np.empty(4)
    for q in rng.uniform(0.0, 2.0 * np.pi, (DRAWS, 4)):
        if (
            len(nearer) < NEARER
            and ring_system(pair.radii, pose, q, PRINTED, g, form, lengths) < pair.second
        ):
            nearer.append(q)
    return spread, np.array(nearer).reshape(-1, 4)


@cache
def all_arrivals() -> dict[tuple[str, str], Arrived]:
    """By the kind of pair and the law, over its poses."""
    found = {}
    for kind in KINDS:
        for name, law in RING_LAWS.items():
            rows = np.array([arrivals(pair, law) for pair in ring_pairs(kind)])
            found[kind, name] = Arrived(*rows.sum(axis=0).tolist())
    return found
