"""What a user makes a world of, checked: bodies, rules, fixed poses, the law."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose, PoseLike
from standoff.tracking.inputs import matrix_and_mark
from standoff.tracking.law_options import Law
from standoff.tracking.laws import checked_law
from standoff.typing import Array
from standoff.world.pieces import CompoundPiece, PieceUnion, name_of
from standoff.world.poses import GivenPoses, mend_poses
from standoff.world.shapes import Shape, as_shape

BodyLike: TypeAlias = "Shape | PieceUnion"


def law_of_pairs(law: Any) -> Law:
    """The law by which pairs are tracked.

    Raises TypeError, ValueError: not a law; one with a horizon of its own.
    """
    found: Law = checked_law(law)
    if found.within is not None:
        raise StandoffError(
            f"The law has within = {found.within:g}: a world has one horizon for all pairs, "
            "its own `within`; give it there.",
            "law",
            law,
        )
    return found


def mapping_of(given: Any, argument: str, values: str) -> dict[Any, Any]:
    """A mapping that may be left out.

    Raises StandoffTypeError.
    """
    if given is None or isinstance(given, Mapping):
        return dict(given or {})
    raise StandoffTypeError(
        f"{argument} = {shown(given)}: give a mapping to {values}.", argument, given
    )


def pairs_of(given: Any, argument: str) -> tuple[Any, ...]:
    """Pairs of names, as a tuple.

    Raises StandoffTypeError.
    """
    if isinstance(given, str | Mapping) or not isinstance(given, Iterable):
        raise StandoffTypeError(
            f"{argument} = {shown(given)}: give a list of pairs of names.", argument, given
        )
    return tuple(given)


def names_of(given: Any, argument: str) -> tuple[Any, ...]:
    """Names of bodies, as a tuple.

    Raises StandoffTypeError.
    """
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise StandoffTypeError(
            f"{argument} = {shown(given)}: give a list of names.", argument, given
        )
    return tuple(given)


def checked_bodies(bodies: Any) -> dict[str, BodyLike]:
    """Bodies by name.

    Raises StandoffTypeError.
    """
    if not isinstance(bodies, Mapping) or not bodies:
        raise StandoffTypeError(
            f"bodies = {shown(bodies)}: give a mapping of names to bodies, at least one.",
            "bodies",
            bodies,
        )
    found: dict[str, BodyLike] = {}
    for name, body in bodies.items():
        shape = body if isinstance(body, PieceUnion) else as_shape(body)
        if shape is None:
            raise StandoffTypeError(
                f"The body {name_of(name)!r} is {shown(body)}: give a Body, a Solid or a Compound.",
                "bodies",
                body,
            )
        found[name_of(name)] = shape
    return found


def named_pieces(bodies: Mapping[str, BodyLike]) -> dict[str, CompoundPiece]:
    """All pieces, by the names of bodies and pieces."""
    found: dict[str, CompoundPiece] = {}
    for name, body in bodies.items():
        if isinstance(body, PieceUnion):
            found |= {f"{name}.{part}": piece for part, piece in body.pieces.items()}
        else:
            found[name] = CompoundPiece(body, Pose.identity())
    return found


def fixed_poses_of(names: Sequence[str], given: Mapping[str, PoseLike]) -> Array:
    """World poses (n, 4, 4) of the fixed bodies, as every frame reads them.

    Raises StandoffError: no pose; the body's name is told.
    """
    poses = np.empty((len(names), 4, 4))
    for k, name in enumerate(names):
        try:
            poses[k] = matrix_and_mark(Pose.of(given[name]))[0]
        except StandoffError as error:
            raise type(error)(f"fixed[{name!r}]: {error}", "fixed", given[name]) from error
    return mend_poses(GivenPoses(poses, 0), names).matrices
