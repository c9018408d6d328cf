"""Pieces that are asked as solids, where a frame has them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from standoff.kernels.world import arrays as W
from standoff.motion import Pose
from standoff.solids.answer import SolidProximity
from standoff.solids.query import distance
from standoff.tracking.threads import in_parts
from standoff.typing import Array, Ints
from standoff.world.model import Model


class PlacedSolid(NamedTuple):
    """A piece that is asked as a solid.

    Attributes
    ----------
    solid : Solid, PlanarSolid or SolidModel
    pose : Pose
    doubt : float
        What roundoff of its placement in its body may do to a distance [length].
    """

    solid: Any
    pose: Pose
    doubt: float


def placed_solid(world: Model, placed: Array, p: int) -> PlacedSolid:
    """Piece p, of which a row of ``placed`` (n pieces, N_PLACED) says where it is."""
    row = placed[p]
    pose = Pose(row[W.P_ROTATION : W.P_SHIFT].reshape(3, 3), row[W.P_SHIFT : W.P_SHIFT + 3])
    composed = world.search.pieces.facts[p, W.F_PLACED] != 0.0
    return PlacedSolid(world.solids.asked[p], pose, float(row[W.P_PAD]) if composed else 0.0)


def signed_bounds(found: SolidProximity) -> tuple[float, float]:
    """Between which the signed distance of two solids is proven to lie, length.

    One inside the other's material cannot leave it on a shorter way than the wall between them.
    """
    if found.inside:
        return -math.inf, min(0.0, -found.lower_bound)
    return found.lower_bound, found.upper_bound


def solid_answers_at(
    world: Model, placed: Sequence[Array], frames: Ints, pieces: tuple[Ints, Ints], workers: int
) -> tuple[Array, ...]:
    """What is known of k pairs of pieces that are asked as solids, each in one of several frames:
    the columns of ``many_frames.PieceAnswers``. Arguments as for ``many_frames.answers_at``.
    """
    k = len(frames)
    numbers, vectors = np.empty((3, k)), np.empty((3, k, 3))

    def some(first: int, end: int) -> None:
        for i in range(first, end):
            a, b = (placed_solid(world, placed[frames[i]], int(each[i])) for each in pieces)
            found, doubt = distance(a.solid, b.solid, a.pose, b.pose), a.doubt + b.doubt
            lower, upper = signed_bounds(found)
            told = -found.distance if found.inside else found.distance
            numbers[:, i] = told, lower - doubt, upper + doubt
            vectors[:, i] = found.point_a, found.point_b, found.normal

    in_parts(some, k, workers)
    return (*numbers, *vectors)
