"""Solids of a system that need not be convex: which pairs they are in, and what the compiled tick
reads of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.kernels.dynamics import flat_parts as F
from standoff.kernels.solids import spatial_layout as S
from standoff.kernels.solids.contact_front import CONTACT_REALS
from standoff.kernels.solids.contact_places import F_ROWS, MOST_ROWS
from standoff.simulation.flat_parts import FlatParts, flat_parts
from standoff.solids.spatial.models import as_model
from standoff.solids.spatial.solid_model import SolidModel
from standoff.solids.spatial.stationary import fans_of
from standoff.solids.spatial.tolerances import PROOF_ROUNDING, PROOF_TOLERANCE
from standoff.solids.tracked.tracker import untracked

NO_FLATS = FlatParts((), np.zeros((0, 3)), np.zeros((0, F.RIM_REALS)), F.CURVED)

SOLID_SPRINGS = 8.0
"""Springs of one stiffness that a contact of solids may be worth: a square's on both sides."""


SHARING_SPAN = 0.1
"""Of the smaller solid's size: spots of contact nearer than this to each other share a spring."""


LEAST_ROWS, ROWS_A_LEAF = 2048, 24
"""Room for pairs of pieces, at least, and for each leaf of both solids: a nut of two turns on its
bolt has 8 a leaf, a peg in its hole 4, and parts that lie on each other more for some ticks."""


class PackedSolids(NamedTuple):
    """Of each body where its arrays begin, none for one that meets no solid; and the arrays."""

    starts: list[list[int]]
    arrays: tuple[NDArray[Any], ...]


def flats_of(body: Body | SolidModel) -> FlatParts:
    """What of a body can be level with a contact of convex bodies."""
    return NO_FLATS if isinstance(body, SolidModel) else flat_parts(body)


def contact_model(body: Body | SolidModel) -> SolidModel:
    """A body as its contacts with solids see it.

    Raises StandoffError: one that is not bounded, or a point.
    """
    model = as_model(body)
    if isinstance(body, Body) and not body.bounded:
        raise StandoffError(
            f"{body!r} is a half-space, which is not bounded: contacts of solids are kept by "
            "pieces of both. Take a box or a plate in its place.",
            "bodies",
            body,
        )
    why = untracked(model)
    if why:
        raise StandoffError(f"{body!r} {why}", "bodies", body)
    return model


def room_for_rows(models: tuple[SolidModel, SolidModel] | None) -> int:
    """For how many pairs of pieces there is room in what a pair of solids keeps from tick to tick;
    0 where neither is a solid."""
    if models is None:
        return 0
    leaves = sum(int(model.packed[2][S.N_LEAVES]) for model in models)
    return min(max(ROWS_A_LEAF * leaves, LEAST_ROWS), MOST_ROWS)


def kept_length(rows: int) -> int:
    """How many numbers a pair of solids keeps with room for so many rows."""
    return F_ROWS + CONTACT_REALS * rows if rows else 0


def pack_solids(models: tuple[SolidModel | None, ...]) -> PackedSolids:
    """Boundaries, leaves and trees, and directions from vertices, of all solids one behind the
    other."""
    parts: list[list[NDArray[Any]]] = [[np.zeros(1, dtype=d)] for d in (int, float) * 3]
    lengths = [1] * len(parts)
    starts: list[list[int]] = []
    for model in models:
        if model is None:
            starts.append([])
            continue
        starts.append(list(lengths))
        for k, array in enumerate((*model.packed, *fans_of(model))):
            parts[k].append(array)
            lengths[k] += len(array)
    return PackedSolids(starts, tuple(np.concatenate(part) for part in parts))


def pair_numbers(models: tuple[SolidModel, SolidModel] | None, depth: float) -> list[float]:
    """Of a pair: the depth its contact is meant for, the sizes of both, the tolerance, lengths, the
    part of sizes and distances that is for rounding, and within which length spots share a spring;
    zeros where neither is a solid."""
    if models is None:
        return [0.0] * 5
    sizes = models[0].size, models[1].size
    span = SHARING_SPAN * min(sizes)
    return [depth, sum(sizes), PROOF_TOLERANCE * sum(sizes), PROOF_ROUNDING, span]
