"""The cases of the report: every pair of shapes at every gap and depth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import nan
from zlib import crc32

import numpy as np

from standoff_studies.accuracy.least_depth import least_bounds
from standoff_studies.accuracy.solids import Kind, Solid, draw_solids
from standoff_studies.accuracy.truth import Truth, draw_truth

GAPS = (1e-6, 1e-3, 1.0)
DEPTHS = (1e-6, 1e-3, 1e-1)
LEVELS = (*GAPS, *(-depth for depth in DEPTHS))
"""Signed distances of the cases, over the pair's size."""
SOLIDS = 4
"""Solids of each kind, so that the lengths of a pair vary."""
DRAWS = 60
"""Draws before a case is given up: some have no unique witnesses, others no minimum."""
RANGE = 1.0
"""Coordinates of A's origin, drawn within plus and minus this, over the size."""
SLACK = 1e-9
"""A depth below the constructed one by more than this, over the size, is another minimum."""


@dataclass(frozen=True)
class Case:
    """One placed pair and its truth.

    Attributes
    ----------
    kinds : names of the pair's shapes, in the order of the catalogue; A and B may be swapped.
    level : requested signed distance over the size.
    size : the greater of both bodies' sizes, length; with a half-space, that of the bounded one.
    least : the least depth, length: the constructed one if no direction has a smaller one; NaN for
        a gap.
    """

    kinds: tuple[str, str]
    number: int
    level: float
    size: float
    a: Solid
    b: Solid
    truth: Truth
    least: float

    @property
    def constructed(self) -> bool:
        """Is the constructed answer the one to compare with, not that of another minimum?"""
        return self.level > 0 or self.least >= -self.truth.distance


def pairs(kinds: Sequence[Kind]) -> list[tuple[Kind, Kind]]:
    """Return all pairs except that of two half-spaces."""
    both = combinations_with_replacement(kinds, 2)
    return [pair for pair in both if {kind.name for kind in pair} != {"halfspace"}]


def catalogue(kinds: Sequence[Kind], seed: int) -> dict[str, tuple[Solid, ...]]:
    """Return the solids of every kind; they do not depend on which other kinds there are."""
    return {kind.name: draw_solids(kind, SOLIDS, _generator(seed, kind.name)) for kind in kinds}


def _generator(seed: int, *words: str) -> np.random.Generator:
    return np.random.default_rng([seed, *(crc32(word.encode()) for word in words)])


def pair_size(a: Solid, b: Solid) -> float:
    """Return the greater of both bodies' sizes, of those that have one; 1 for two points."""
    sizes = [solid.body.size for solid in (a, b) if solid.bounded]
    return max(sizes) or 1.0


def draw_cases(
    pair: tuple[Kind, Kind],
    solids: dict[str, tuple[Solid, ...]],
    count: int,
    seed: int,
) -> Iterator[Case]:
    """Draw the cases of one pair, ``count`` at each level.

    A level at which a pair has no cases is omitted: two segments, for example, have no depth.
    """
    names = (pair[0].name, pair[1].name)
    for level in LEVELS:
        if level < 0 and pair[0].flat and pair[1].flat:
            continue
        rng = _generator(seed, *names, repr(level))
        for number in range(count):
            case = _draw(names, solids, level, number, rng)
            if case is not None:
                yield case


def _draw(
    names: tuple[str, str],
    solids: dict[str, tuple[Solid, ...]],
    level: float,
    number: int,
    rng: np.random.Generator,
) -> Case | None:
    for _ in range(DRAWS):
        a, b = (solids[name][int(rng.integers(len(solids[name])))] for name in names)
        if rng.random() < 0.5:
            a, b = b, a
        size = pair_size(a, b)
        position = RANGE * size * rng.uniform(-1, 1, 3)
        truth = draw_truth(a, b, level * size, position, rng)
        if truth is None or truth.stiffness <= 0:
            continue
        least = nan
        if level < 0:
            lower, least = least_bounds(a, b, truth, size, SLACK * size)
            if lower <= 0:  # pushed through: B has left A on the other side
                continue
        return Case(names, number, level, size, a, b, truth, least)
    return None
