"""What the compiled tick reads to find the pairs of a system that may be near each other."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from standoff.kernels.world import arrays as W
from standoff.simulation.rigid_body import FREE
from standoff.simulation.system import System
from standoff.simulation.tolerances import BALL_SLACK
from standoff.tracking.law_options import Law
from standoff.tracking.laws import PaperLaw
from standoff.typing import Array
from standoff.world.packed import packed_pieces, pieces_of

LEAST_PAIRS = 100
"""Pairs of bounded bodies: of fewer, to look at all takes no longer than to search."""

FREE_KIND, OTHER_KIND = 0, 1
MEETS: Final = (1, 1, 1, 0)
"""Of these kinds: two bodies that are not free are no pair."""


class NearRows(NamedTuple):
    """Behind the integers and the numbers of a packed system; `dynamics.near_arrays` reads them."""

    ints: list[int]
    numbers: list[float]


def near_rows(system: System, laws: tuple[Law, ...]) -> NearRows | None:
    """The rows of a system whose ticks may leave pairs out; None where they visit all.

    That takes a horizon of every pair of bounded bodies. Pairs with a half-space are always
    visited, and so are all pairs of a system with a solid.
    """
    if any(system.of_solids):
        return None
    bounded = [body.body.bounded for body in system.bodies]
    horizons = [
        _horizon(law)
        for (a, b), law in zip(system.pairs, laws, strict=True)
        if bounded[a] and bounded[b]
    ]
    if len(horizons) < LEAST_PAIRS or not max(horizons) < np.inf:
        return None
    n = len(system.bodies)
    keys = [min(pair) * n + max(pair) for pair in system.pairs]
    order = np.argsort(keys, kind="stable").tolist()
    kinds = [FREE_KIND if body.kind == FREE else OTHER_KIND for body in system.bodies]
    ints = [sum(bounded), *range(n + 1), *kinds, *(0 if each else 1 for each in bounded), *MEETS]
    ints += [keys[k] for k in order] + order
    reach = max(horizons) * (1.0 + BALL_SLACK)
    return NearRows(ints, [reach, *_balls(system).ravel().tolist()])


def _horizon(law: Law) -> float:
    """Beyond it the frame of a pair is a bound, length; the paper's law makes every frame."""
    if isinstance(law, PaperLaw) or law.within is None:
        return float("inf")
    return law.within


def _balls(system: System) -> Array:
    """(n, N_FACT) facts of the balls about the bodies' boxes, each a point with a radius; of
    half-spaces, their own."""
    facts = packed_pieces([pieces_of(body.body) for body in system.bodies]).facts.copy()
    radii = (facts[:, W.F_RADIUS] + facts[:, W.F_REACH]) * (1.0 + BALL_SLACK)
    bounded = facts[:, W.F_PLANE] == 0.0
    facts[bounded, W.F_RADIUS] = radii[bounded]
    facts[bounded, W.F_HALF : W.F_HALF + 3] = 0.0
    facts[bounded, W.F_REACH] = 0.0
    return facts
