"""Rigid bodies of several pieces: what they are, below what asks them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose, PoseLike
from standoff.motion.rotations import without_rounding
from standoff.read_only import KeepsReadOnly
from standoff.tracking.inputs import matrix_and_mark
from standoff.wording import counted
from standoff.world.poses import check_level
from standoff.world.shapes import Shape, as_shape, dimension_of_shape, is_flat


class CompoundPiece(NamedTuple):
    """One piece of a compound, and where it is fixed.

    Attributes
    ----------
    body : Body, Solid or PlanarSolid
    pose : Pose
        Of the piece's frame in the compound's: a rotation to roundoff, so that one that is composed
        with it is as near to one as before; of a planar compound's exactly in z = 0.
    """

    body: Shape
    pose: Pose


PieceLike: TypeAlias = "Shape | CompoundPiece | tuple[Shape, PoseLike]"
"""A body or a solid in its place, or with its pose in the compound's frame."""


class PieceUnion(KeepsReadOnly):
    """A rigid body of several pieces with fixed placements: what a world reads of a `Compound`.

    Attributes
    ----------
    pieces : dict of str to Piece
    dimension : int
        2 for planar pieces, 3 for spatial ones.
    """

    __slots__ = ("dimension", "pieces")

    def __init__(self, pieces: Mapping[str, PieceLike]) -> None:
        if not (is_mapping(pieces) and pieces):
            raise StandoffTypeError(
                f"pieces = {shown(pieces)}: give a mapping of names to bodies, or to (body, pose); "
                "at least one.",
                "pieces",
                pieces,
            )
        found = {name_of(name): _piece(name, given) for name, given in pieces.items()}
        self.dimension = dimension_of({n: piece.body for n, piece in found.items()})
        planar = self.dimension == 2
        if planar:
            check_in_plane(found)
        self.pieces = {
            name: CompoundPiece(x.body, _exact(x.pose, planar)) for name, x in found.items()
        }

    def __len__(self) -> int:
        return len(self.pieces)

    def __repr__(self) -> str:
        return f"<Compound of {counted(len(self), 'piece')}: {', '.join(self.pieces)}>"


def is_mapping(given: Any) -> bool:
    """Is it a mapping?"""
    return isinstance(given, Mapping)


def name_of(name: Any) -> str:
    """A name, checked.

    Raises StandoffTypeError.
    """
    if isinstance(name, str) and name:
        return name
    raise StandoffTypeError(f"The name {shown(name)} is not a string of one letter or more.")


def _piece(name: str, given: Any) -> CompoundPiece:
    body, pose = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    shape = as_shape(body)
    if shape is None:
        raise StandoffTypeError(
            f"The piece {name!r} is {shown(given)}: give a Body or a Solid, or (body, pose).",
            "pieces",
            given,
        )
    try:
        return CompoundPiece(shape, Pose.identity() if pose is None else Pose.of(pose))
    except StandoffError as error:
        raise type(error)(f"The piece {name!r}: {error}", "pieces", given) from error


def _exact(pose: Pose, planar: bool) -> Pose:
    """The nearest rotation to roundoff, of one that may be off by what is let pass in a pose; a
    planar one without the tilt that may be left in it."""
    rotation = pose.rotation
    if planar:
        rotation = np.eye(3)
        rotation[:2, :2] = pose.rotation[:2, :2]
    return Pose.from_checked(without_rounding(rotation), pose.translation, repaired=pose.repaired)


def check_in_plane(pieces: Mapping[str, CompoundPiece]) -> None:
    """Refuse a piece that is fixed out of z = 0; its name is told.

    Raises StandoffError.
    """
    check_level(list(pieces), [matrix_and_mark(x.pose)[0] for x in pieces.values()], "pieces")


def dimension_of(bodies: Mapping[str, Shape]) -> int:
    planar = [name for name, body in bodies.items() if dimension_of_shape(body) == 2]
    spatial = [name for name, body in bodies.items() if not is_flat(body)]
    if planar and spatial:
        raise StandoffError(
            f"{planar[0]!r} is planar and {spatial[0]!r} is not: a compound, and a world, is of "
            "planar bodies or of spatial ones.",
            "pieces",
        )
    return 2 if planar else 3
