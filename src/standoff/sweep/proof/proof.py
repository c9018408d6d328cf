"""A proof over the box of a job's parameters: what is asked, and the cells of its shards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.numbers import not_negative
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.sweep.job import Job, check_job
from standoff.sweep.parameters import UNIFORM, Parameter
from standoff.sweep.proof.box import ParameterBox
from standoff.sweep.proof.cells import Cells
from standoff.sweep.proof.mover import PlacedBody
from standoff.sweep.proof.pair_box import PairBox
from standoff.sweep.proof.robot_box import RobotBox
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import ProofSummary
from standoff.sweep.proof.tolerances import FINEST_SHARE
from standoff.sweep.proof.world_box import WorldBox
from standoff.sweep.subjects.pair import ConvexPair
from standoff.sweep.subjects.robot import RobotSubject
from standoff.sweep.subjects.world import SceneWorld
from standoff.sweep.work import Token, Work


class Proof(Work):
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
