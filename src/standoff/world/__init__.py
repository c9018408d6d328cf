"""Worlds: many bodies, which pairs of them count, and the proven clearance of all."""

from typing import TYPE_CHECKING

from standoff.on_demand import on_demand

if TYPE_CHECKING:
    from standoff.world.answer import WorldAnswer
    from standoff.world.compounds import Compound, compound
    from standoff.world.impact import WorldImpact
    from standoff.world.pair_answer import PairAnswer
    from standoff.world.pair_arrays import PairArrays
    from standoff.world.solid_answer import SolidPairAnswer
    from standoff.world.state import WorldState
    from standoff.world.world import World
else:
    __getattr__, __dir__ = on_demand(__name__)

__all__ = [
    "Compound",
    "PairAnswer",
    "PairArrays",
    "SolidPairAnswer",
    "World",
    "WorldAnswer",
    "WorldImpact",
    "WorldState",
    "compound",
]
