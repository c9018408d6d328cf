"""The distance of two bodies of which one is a compound: a world of the two, asked once."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from typing import Any

from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.world.pair_answer import PairAnswer
from standoff.world.solid_answer import SolidPairAnswer
from standoff.world.world import World

PAIRS = 16
"""Number of worlds kept at hand, with their bodies: those used last."""


def cold_answer(
    a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
) -> PairAnswer | SolidProximity:
    """The answer of two bodies, the least over their pieces; see ``so.distance``.

    Raises
    ------
    TypeError, ValueError
        As of a `World`: no body, no pose, a planar one with a spatial one or out of its plane.
    """
    found = _world(a, b, within).distances({"a": pose_a, "b": pose_b})["a", "b"]
    if isinstance(found, SolidPairAnswer):
        return SolidProximity(**{x.name: getattr(found, x.name) for x in fields(SolidProximity)})
    return found


@lru_cache(maxsize=PAIRS)
def _world(a: Any, b: Any, within: float | None) -> World:
    return World({"a": a, "b": b}, within=within)
