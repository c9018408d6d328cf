"""A proof over the box of a job's parameters: what is asked, and the cells of its shards."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from standoff.bodies.body import Body
from standoff.checks.numbers import not_negative
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose
from standoff.robots.limits import check_limits
from standoff.robots.motions import LinkFrames
from standoff.robots.sight import Middle, Separations, Sight, closing, gains, some_of
from standoff.sweep.job import Job, check_job
from standoff.sweep.parameters import UNIFORM, Parameter
from standoff.sweep.proof.box import CellFindings, ParameterBox, QueryFindings
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.mover import PlacedBody
from standoff.sweep.proof.pair_box import PairBox
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import ProofSummary
from standoff.sweep.proof.tolerances import FINEST_SHARE
from standoff.sweep.subjects.pair import ConvexPair
from standoff.sweep.subjects.robot import RobotSubject
from standoff.sweep.subjects.world import SceneWorld
from standoff.sweep.work import ShardWork, Token
from standoff.typing import Array, Bools, Ints
from standoff.world.pieces import PieceUnion


class Proof(ShardWork):
    """That the bodies of a job keep a clearance at all parameters in their ranges.

    Raises TypeError, ValueError: no job, or a clearance that is no length, or is negative;
    parameters without ranges, or a subject that cells are not known of.

    Parameters
    ----------
    job : Job
        Its sampler has no part in it.
    clearance : float
        Length.
    """

    def __init__(self, job: Job, clearance: float) -> None:
        check_job(job)
        self.job, self.file = job, job.file
        self.clearance = not_negative(clearance, "clearance")
        self.box = _box(job, self.clearance)
        self.effort, self.rows = job.effort, job.effort.shards
        reach = float(self.box.moves(self.box.whole)[0][0])
        given = self.effort.finest
        self.box.finest = FINEST_SHARE * reach if given is None else given

    @property
    def shards(self) -> int:
        """Parts of the box."""
        return self.effort.shards

    def shard(self, k: int) -> tuple[int, int]:
        """Return the number of a part, and the next."""
        return k, k + 1

    @property
    def most(self) -> int:
        """Places that each list holds."""
        return self.job.keep.worst

    def computed(self, k: int) -> ProofSummary:
        """Return what is proven of part k."""
        every = self.effort.queries
        queries = every * (k + 1) // self.shards - every * k // self.shards
        return search(self.box, self.first(k), queries, self.most)

    def first(self, k: int) -> Cells:
        """Return part k of the box as a cell: all parts are of one size, halved along the parameter
        that moves a point most."""
        cell = self.box.whole
        for bit in range(self.shards.bit_length() - 2, -1, -1):
            along = self.box.moves(cell)[1].argmax(axis=1)
            cell = cell.halved(along).at([k >> bit & 1])
        return cell

    @cached_property
    def facts(self) -> Mapping[str, Any]:
        """All that its results depend on, as plain data."""
        asked = {"clearance": self.clearance, "finest": self.box.finest}
        left_out = ("sampler", "keep", "shards")
        facts = {key: value for key, value in self.job.facts.items() if key not in left_out}
        own = asked | {"queries": self.effort.queries, "shards": self.shards}
        return {**facts, "prove": own | {"worst": self.most}}

    @property
    def counts(self) -> dict[str, int]:
        return {"shards": self.shards}

    @property
    def token(self) -> Token:
        return self.job.token._replace(clearance=self.clearance)

    def nothing(self) -> ProofSummary:
        return ProofSummary(self.most, len(self.job.parameters))

    def from_facts(self, facts: Mapping[str, Any]) -> ProofSummary:
        return ProofSummary.from_facts(facts, self.most, len(self.job.parameters))

    def try_one(self, k: int) -> None:
        self.box.look(self.first(k))


def check_proof(proof: Any) -> None:
    """Refuse what is no proof.

    Raises StandoffTypeError.
    """
    if not isinstance(proof, Proof):
        raise StandoffTypeError(
            f"proof is {shown(proof)}: give Proof(job, clearance).", "proof", proof
        )


def _box(job: Job, clearance: float) -> ParameterBox:
    """The job's box of parameters.

    Raises StandoffError.
    """
    if job.kind == "file":
        raise StandoffError(
            "a proof needs the range of each parameter, and a sampler of kind 'file' has none: "
            "choose another kind",
            "job",
        )
    for p in job.parameters:
        if p.what == UNIFORM:
            raise StandoffError(
                f"parameters.{p.name}: a proof halves ranges, and a uniform rotation has none: "
                "give 'turn_x', 'turn_y' and 'turn_z'",
                "job",
            )
    if isinstance(job.subject, RobotSubject):
        return RobotBox(job.subject, job.parameters, clearance)
    if isinstance(job.subject, SceneWorld):
        _check_planes(job.subject.world.bodies, job.parameters)
        return WorldBox(job.subject, job.parameters, clearance)
    if isinstance(job.subject, ConvexPair):
        subject = job.subject
        given = (subject.scene.pair, subject.bodies, subject.homes, subject.shaped)
        placed = [PlacedBody(*each) for each in zip(*given, strict=True)]
        _check_planes({each.name: each.body for each in placed}, job.parameters)
        return PairBox((placed[0], placed[1]), job.parameters, clearance)
    raise StandoffError(
        f"a proof is of convex bodies or of a robot, and {job.subject.name} need not be convex",
        "job",
    )


def _check_planes(bodies: Mapping[str, Any], parameters: Sequence[Parameter]) -> None:
    """Refuse turns of a half-space, whose points go infinitely far.

    Raises StandoffError.
    """
    for name, body in bodies.items():
        turns = [p.name for p in parameters if p.moves == name and p.unit]
        if turns and isinstance(body, Body) and not body.bounded:
            raise StandoffError(
                f"parameters.{turns[0]}: '{name}' is a half-space, and a turn moves its points "
                "infinitely far: turn the other body, the other way",
                "job",
            )


# The box of a robot's joints: every pair that it watches, in every cell.
#
# How far the pieces of a pair move against each other is bounded as `Robot.certify_box` does it
# (docs/certify.md); a cell is proven where all pairs are.

SEEN_TOGETHER = 8192
"""Pairs in cells whose bounding boxes are seen at once: some 10 MB."""


class RobotBox(ParameterBox):
    """The joints of a robot.

    Raises StandoffError: a range that is outside a joint's limits.

    Parameters
    ----------
    subject : RobotSubject
    parameters : sequence of Parameter
        Joints of one number.
    clearance : float
    """

    def __init__(
        self, subject: RobotSubject, parameters: Sequence[Parameter], clearance: float
    ) -> None:
        super().__init__(parameters, clearance)
        self.subject, self.sight = subject, Sight(subject.robot)
        self.unit = np.array([np.pi / 180.0 if p.degrees else 1.0 for p in parameters])
        self.block = max(1, SEEN_TOGETHER // max(1, self.sight.pairs))
        motions, joints = self.sight.watched.motions, subject.robot.joints
        at = [int(joints.q_at[joints.names.index(p.moves)]) for p in parameters]
        self.columns = np.array([at.index(q) if q in at else -1 for q in motions.q_at.tolist()])
        ends = np.array([[p.low for p in parameters], [p.high for p in parameters]])
        corners = subject.configurations(parameters, np.stack([ends[0], ends.mean(0), ends[1]]))
        check_limits(subject.robot, corners, "parameters")
        whole = self.ways(self.whole)[0]
        self.doubt = self.sight.roundoff(corners[1], whole)

    def ways(self, cells: Cells) -> Array:
        """Return how far each motion goes in cells (n, nm + 1); the last is the world's, 0."""
        motions = self.sight.watched.motions
        half = cells.halves * self.width * self.unit
        found = np.zeros((len(half), motions.size + 1))
        moved = np.flatnonzero(self.columns >= 0)
        found[:, moved] = np.abs(motions.ratios[moved]) * half[:, self.columns[moved]]
        return found

    @property
    def pairs(self) -> int:
        return self.sight.pairs

    def _seen(self, cells: Cells) -> tuple[Array, LinkFrames, Ints, Ints, Middle]:
        """Configurations in the middles with their frames; of each pair that is left in a cell, the
        cell, the pair, and how far it can move."""
        q = self.subject.configurations(self.parameters, self.numbers(cells))
        frames = self.sight.frames(q)
        at, pairs = np.nonzero(cells.known < self.clearance)
        return q, frames, at, pairs, self.sight.middle(pairs, frames, at, self.ways(cells)[at])

    def moves(self, cells: Cells) -> tuple[Array, Array]:
        n = len(cells.place)
        _, frames, at, pairs, middle = self._seen(cells)
        whole, ways = np.zeros(n), np.zeros((n, len(self.parameters)))
        np.maximum.at(whole, at, middle.way)
        np.maximum.at(ways, at, self._gains(middle, self.sight.by_boxes(pairs, frames, at, middle)))
        return whole, ways

    def look(self, cells: Cells) -> CellFindings:
        n = len(cells.place)
        q, frames, at, pairs, middle = self._seen(cells)
        boxed = self.sight.by_boxes(pairs, frames, at, middle)
        bound = boxed.lower - closing(middle, boxed)
        upper, distance = np.full(n, np.inf), np.full(n, np.inf)
        worth = self._worth(pairs, middle, boxed, bound)
        ask, apart = self._asked(worth, pairs, q, frames, at, boxed)
        some = some_of(middle, ask)
        bound[ask] = np.maximum(bound[ask], apart.lower - closing(some, apart))
        bound -= self.doubt
        best = boxed._replace(normals=boxed.normals.copy(), along=boxed.along.copy())
        best.normals[ask], best.along[ask] = apart.normals, apart.along
        np.minimum.at(distance, at[ask], apart.upper + self.doubt)
        np.minimum.at(upper, at[ask], apart.upper + some.way + self.doubt)
        known, moved = cells.known.copy(), np.zeros(n)
        known[at, pairs] = np.maximum(known[at, pairs], bound)
        lower = known.min(axis=1)
        open_ = known[at, pairs] < self.clearance
        np.maximum.at(moved, at[open_], middle.way[open_])
        ways = np.zeros((n, len(self.parameters)))
        # along what gives back most of the pair that stands in the way most
        worst = np.flatnonzero(open_ & (known[at, pairs] == lower[at]))
        ways[at[worst]] = self._gains(
            some_of(middle, worst), Separations._make(x[worst] for x in best)
        )
        # and where the middle is too near, of the pair that is nearest there
        steps = ways.copy()
        nearest = np.flatnonzero(apart.upper + self.doubt == distance[at[ask]])
        steps[at[ask[nearest]]] = self._gains(some_of(some, nearest), None)
        told = QueryFindings(lower, upper, distance, ways, steps)
        uncertified = int(np.count_nonzero(~np.isfinite(apart.lower)))
        asked = np.array([len(ask), uncertified])
        return self.decided(cells, moved, told, asked)._replace(known=known)

    def _asked(
        self, worth: Bools, pairs: Ints, q: Array, frames: LinkFrames, at: Ints, boxed: Separations
    ) -> tuple[Ints, Separations]:
        """Which pairs are asked, and what they answer: those that are worth it, and in a cell whose
        middle is too near, all that may be nearer still."""
        ask = np.flatnonzero(worth)
        apart = self.sight.ask(pairs[ask], q, frames, at[ask])
        nearest = np.full(len(q), np.inf)
        np.minimum.at(nearest, at[ask], apart.upper + self.doubt)
        near = nearest[at]
        more = np.flatnonzero(~worth & (near < self.clearance) & (boxed.lower < near))
        if not len(more):
            return ask, apart
        rest = self.sight.ask(pairs[more], q, frames, at[more])
        both = (np.concatenate(each) for each in zip(apart, rest, strict=True))
        return np.concatenate([ask, more]), Separations._make(both)

    def _worth(self, pairs: Ints, middle: Middle, boxed: Separations, bound: Array) -> Bools:
        """Is a pair asked? Not where its boxes prove it, nor where a query would hardly prove
        anything: as far as can be seen the middle is too near for that, and surely too far for a
        violation of the whole cell."""
        watched = self.sight.watched
        a, b = watched.a[pairs], watched.b[pairs]
        between = middle.seen[1].centres - middle.seen[0].centres
        flat = watched.cores.planes[a] | watched.cores.planes[b]
        apart = np.where(
            flat,
            np.einsum("ki,ki->k", boxed.normals, between),
            np.sqrt(np.einsum("ki,ki->k", between, between)),
        )
        for piece in (a, b):
            apart -= watched.cores.radius[piece] + watched.cores.half[piece].min(axis=1)
        taken = boxed.lower - bound
        hopeless = (apart - taken < self.clearance) & (boxed.lower + middle.way >= self.clearance)
        found: Bools = (bound - self.clearance < self.doubt) & ~hopeless
        return found

    def _gains(self, middle: Middle, apart: Separations | None) -> Array:
        """What halving each parameter gives back of what its pairs can move (k, columns)."""
        chain = middle.reaches.chain
        numbers = np.where(chain >= 0, np.append(self.columns, -1)[chain], -1)
        return gains(middle, apart, numbers, len(self.parameters))


# The box of a world's parameters: every pair of bodies that counts, piece by piece.


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

    def look(self, cells: Cells) -> CellFindings:
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
        told = QueryFindings(lower, upper, distance, ways, steps)
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
