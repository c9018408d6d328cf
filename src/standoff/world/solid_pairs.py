"""Which pairs of a world are asked as solids: those of a body with a solid among its pieces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.errors import StandoffError
from standoff.world.pieces import CompoundPiece, PieceUnion
from standoff.world.rules import Rules
from standoff.world.shapes import Shape, dimension_of_shape, is_solid


class SolidPairs(NamedTuple):
    """What does not change of them.

    Attributes
    ----------
    bodies : (n,) array of bool
        Has the body a solid among its pieces?
    tracked : (n,) array of bool
        Has it a pair in which neither has one?
    asked : tuple
        Of each piece what ``so.solids.distance`` is asked of; None of one that is in no pair with
        a body that has a solid.
    """

    bodies: NDArray[np.bool_]
    tracked: NDArray[np.bool_]
    asked: tuple[Any, ...]

    @property
    def any(self) -> bool:
        """Has any body a solid among its pieces?"""
        return bool(self.bodies.any())


def solid_pairs(
    names: Sequence[str], pieces: Sequence[Sequence[CompoundPiece]], rules: Rules
) -> SolidPairs:
    """Of all bodies, with what is asked of them made and checked.

    Raises StandoffError: a body in a pair with a solid that has no volume, or whose rounded
    boundary is of no exact kind; its name is told.
    """
    n = len(names)
    solid = np.array([any(is_solid(piece.body) for piece in each) for each in pieces])
    meets, tracked = np.zeros(n, dtype=bool), np.ones(n, dtype=bool)
    if solid.any():
        every = np.arange(n)
        for i in every:
            partners = rules.counting(np.full(n, i), every)
            meets[i] = (partners & (solid | solid[i])).any()
            tracked[i] = (partners & ~(solid | solid[i])).any()
    made: dict[int, Any] = {}
    asked: list[Any] = []
    for name, each, met in zip(names, pieces, meets, strict=True):
        for piece in each:
            if met and id(piece.body) not in made:
                made[id(piece.body)] = _asked(name, piece.body)
            asked.append(made[id(piece.body)] if met else None)
    return SolidPairs(solid, tracked, tuple(asked))


def _asked(name: str, shape: Shape) -> Any:
    """A solid, or a convex body as one."""
    if is_solid(shape):
        return shape
    try:
        if dimension_of_shape(shape) == 2:
            from standoff.solids.planar.solid import PlanarSolid

            return PlanarSolid.of(shape)
        from standoff.solids.spatial.models import as_model

        return as_model(shape)
    except StandoffError as error:
        raise StandoffError(
            f"{name!r} would be a pair with a solid: {error} Or ignore the pair.", "bodies", shape
        ) from error


def refuse_solids(bodies: Mapping[str, Any], what: str, instead: str) -> None:
    """Refuse bodies that are solids, or have one among their pieces, where only convex ones go.

    Raises StandoffError: the name of the first is told.

    Parameters
    ----------
    bodies : mapping of str to Body, Solid, PlanarSolid or Compound
    what : str
        Does not take solids: the first words of the message.
    instead : str
        What to use: its last words.
    """
    for name, body in bodies.items():
        shapes = [x.body for x in body.pieces.values()] if isinstance(body, PieceUnion) else [body]
        if any(is_solid(shape) for shape in shapes):
            raise StandoffError(
                f"{what} takes convex bodies alone, and {name!r} is or has a solid: {instead}.",
                "bodies",
                body,
            )
