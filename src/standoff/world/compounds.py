"""Compounds, and the distance of two bodies of which one is a compound: a world of the two, asked
once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from typing import Any

from standoff.motion import PoseLike
from standoff.solids.answer import SolidProximity
from standoff.world.given import checked_bodies
from standoff.world.pair_answer import PairAnswer
from standoff.world.pieces import PieceLike, PieceUnion
from standoff.world.solid_answer import SolidPairAnswer
from standoff.world.world import World

PAIRS = 16
"""Number of worlds kept at hand, with their bodies: those used last."""


class Compound(PieceUnion):
    """A rigid body of several pieces with fixed placements: their union.

    Attributes
    ----------
    pieces : dict of str to Piece
    dimension : int
        2 for planar pieces, 3 for spatial ones.
    """

    __slots__ = ()

    def cold_query(
        self, a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
    ) -> Any:
        """The distance of two bodies, one of them this one; see ``so.distance``.

        Parameters
        ----------
        a, b : Compound, Body, Solid or PlanarSolid
        pose_a, pose_b : Pose or what ``Pose.of`` reads
        within : float or None
            Horizon, length.

        Returns
        -------
        PairAnswer, or SolidProximity where a piece of them is a solid
        """
        return cold_answer(a, b, pose_a, pose_b, within)


def compound(pieces: Mapping[str, PieceLike]) -> Compound:
    """A rigid body of several pieces with fixed placements.

    Raises TypeError: not a mapping, a name that is no string, a piece that is no body and no solid.
    Raises ValueError: no piece, no pose, planar pieces among spatial ones, a planar piece out of z
    = 0.

    Parameters
    ----------
    pieces : mapping of str to Body, Solid or PlanarSolid, or to one with its pose
        By name; a piece without a pose has the compound's frame for its own.

    Returns
    -------
    Compound
    """
    return Compound(pieces)


def cold_answer(
    a: Any, b: Any, pose_a: PoseLike, pose_b: PoseLike, within: float | None
) -> PairAnswer | SolidProximity:
    """The answer of two bodies, the least over their pieces; see ``so.distance``.

    Raises TypeError, ValueError as of a `World`: no body, no pose, a planar one with a spatial one
    or out of its plane.
    """
    checked_bodies({"a": a, "b": b})  # what cannot be hashed is no body either
    found = _world(a, b, within).distances({"a": pose_a, "b": pose_b})["a", "b"]
    if isinstance(found, SolidPairAnswer):
        return SolidProximity(**{x.name: getattr(found, x.name) for x in fields(SolidProximity)})
    return found


@lru_cache(maxsize=PAIRS)
def _world(a: Any, b: Any, within: float | None) -> World:
    return World({"a": a, "b": b}, within=within)
