"""The box of a world's parameters: every pair of bodies that counts, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from standoff.bodies.body import Body
from standoff.errors import StandoffError
from standoff.motion import Pose
from standoff.sweep.parameters import Parameter
from standoff.sweep.proof.box import Looked, ParameterBox, Told
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.mover import PlacedBody
from standoff.sweep.proof.pair_box import PairBox
from standoff.sweep.subjects.world import SceneWorld
from standoff.typing import Array
from standoff.world.pieces import PieceUnion


class WorldBox(ParameterBox):
    """The parameters of a scene's world. A cell is proven where all pairs are.

    Raises StandoffError: a body that need not be convex.

    Parameters
    ----------
    subject : SceneWorld
        Of convex bodies, or compounds of convex pieces.
    parameters : sequence of Parameter
        Shifts and turns.
    clearance : float
    """

    block = 2048

    def __init__(
        self, subject: SceneWorld, parameters: Sequence[Parameter], clearance: float
    ) -> None:
        super().__init__(parameters, clearance)
        self.boxes = [PairBox(pair, parameters, clearance) for pair in _pairs(subject)]

    @property
    def pairs(self) -> int:
        return len(self.boxes)

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        told = [box.moves(cells) for box in self.boxes]
        return np.max([whole for whole, _ in told], axis=0), np.max(
            [ways for _, ways in told], axis=0
        )

    def look(self, cells: Cells) -> Looked:
        n, columns = len(cells.place), len(self.parameters)
        upper, distance, moved = np.full(n, np.inf), np.full(n, np.inf), np.zeros(n)
        known, asked = cells.known.copy(), np.zeros(2, dtype=np.int64)
        worst, nearest = np.full(n, np.inf), np.full(n, np.inf)
        ways, steps = np.zeros((n, columns)), np.zeros((n, columns))
        for k, box in enumerate(self.boxes):
            left = np.flatnonzero(~(known[:, k] >= self.clearance))
            if not len(left):
                continue
            told, far, queries = box.told(cells.at(left))
            asked = asked + queries
            known[left, k] = np.maximum(known[left, k], told.lower)
            upper[left] = np.minimum(upper[left], told.upper)
            distance[left] = np.minimum(distance[left], told.distance)
            open_ = known[left, k] < self.clearance
            moved[left[open_]] = np.maximum(moved[left[open_]], far[open_])
            # halved along what moves the pair most that stands in the way most
            for values, least, given, found in (
                (told.lower, worst, told.ways, ways),
                (told.distance, nearest, told.moved, steps),
            ):
                first = open_ & (values < least[left])
                least[left[first]] = values[first]
                found[left[first]] = given[first]
        lower = known.min(axis=1)
        told = Told(lower, upper, distance, ways, steps)
        return self.decided(cells, moved, told, asked)._replace(known=known)


def _pairs(subject: SceneWorld) -> list[tuple[PlacedBody, PlacedBody]]:
    """All pairs of convex pieces that count, where the parameters are zero."""
    world = subject.world
    homes = dict(zip(world.moving, subject.homes, strict=True)) | world.fixed_poses
    pieces = {name: list(_pieces(name, body, homes[name])) for name, body in world.bodies.items()}
    return [(one, other) for a, b in world.pairs() for one in pieces[a] for other in pieces[b]]


def _pieces(name: str, shape: object, home: Pose) -> Iterator[PlacedBody]:
    if isinstance(shape, PieceUnion):
        for piece in shape.pieces.values():
            if not isinstance(piece.body, Body):
                raise _not_convex(name)
            yield PlacedBody(name, piece.body.transformed(piece.pose.matrix), home)
    elif isinstance(shape, Body):
        yield PlacedBody(name, shape, home)
    else:
        raise _not_convex(name)


def _not_convex(name: str) -> StandoffError:
    return StandoffError(
        f"'{name}' need not be convex, and a proof over a box is of convex bodies: give it as a "
        "compound of convex pieces",
        "job",
    )
