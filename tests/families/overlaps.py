"""Random pairs that overlap: touching by a millionth of their size up to one inside the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from families import shapes
from families.shapes import Maker, Twin
from oracles.bounds import overlap
from oracles.exact_pairs import exact_pair, random_normal, random_rotation
from oracles.poses import size_of
from standoff_studies.oracles import HalfSpace, Placed

DEPTHS = (1e-6, 0.5)
"""Range of the depths by which pairs are pushed together along a normal, over the pair's size."""
CONTAINED = 0.2
"""Share of pairs whose origins, which lie inside or close, almost coincide."""
OFF_CENTRE = 0.05
"""Distance of those origins, over the pair's size."""
PER_PAIR = 10
"""Poses of one pair of bodies."""

PAIRS: dict[str, tuple[Maker, Maker]] = {
    "solids": (shapes.solid, shapes.extended_solid),
    "a point in a solid": (shapes.point, shapes.extended_solid),
    "solid and half-space": (shapes.solid, shapes.half_space),
    "half-space and solid": (shapes.half_space, shapes.solid),
    "planar loops": (shapes.loop, shapes.loop),
    "planar loop and point": (shapes.loop, shapes.planar_point),
}
"""Kinds of pairs: the makers of their bodies."""


@dataclass(frozen=True)
class Overlapping:
    """Two bodies at poses where an oracle finds that they overlap."""

    a: Twin
    b: Twin
    placed_a: Placed
    placed_b: Placed
    label: str


def _place(a: Twin, b: Twin, rng: np.random.Generator) -> tuple[Placed, Placed, str]:
    size = size_of(a.shape, b.shape)
    planar = a.shape.dimension == b.shape.dimension == 2
    unbounded = isinstance(a.shape, HalfSpace) or isinstance(b.shape, HalfSpace)
    if unbounded or rng.random() > CONTAINED:
        depth = float(np.exp(rng.uniform(*np.log(DEPTHS))))
        pair = exact_pair(a.shape, b.shape, -depth * size, rng)
        return pair.a, pair.b, f"pushed together by {depth:.3g} of the size"
    rotations = [random_rotation(rng, planar) for _ in range(2)]
    offset = OFF_CENTRE * size * random_normal(rng, planar)
    first, second = (
        Placed(a.shape, rotations[0], np.zeros(3)),
        Placed(b.shape, rotations[1], offset),
    )
    return first, second, "one origin almost at the other"


def draw_overlapping(kind: str, count: int, rng: np.random.Generator) -> Iterator[Overlapping]:
    """Yield ``count`` overlapping pairs; poses that turn out separated are drawn again."""
    found = 0
    while found < count:
        a, b = (maker(rng) for maker in PAIRS[kind])
        for _ in range(min(PER_PAIR, count - found)):
            first, second, label = _place(a, b, rng)
            if overlap(first, second):
                found += 1
                yield Overlapping(a, b, first, second, label)
