"""A sweep's job: what its file says, checked and built, and the answers of any of its rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion import Pose
from standoff.scene import Scene
from standoff.sweep.keep import Keep
from standoff.sweep.parameters import Parameter, in_ranges
from standoff.sweep.proof.effort import Effort
from standoff.sweep.rows import Rows
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.samplers import Sampler
from standoff.sweep.subjects.pair import ConvexPair
from standoff.sweep.subjects.subject import Alone, Subject
from standoff.sweep.summary import Summary
from standoff.sweep.work import ShardWork, Token
from standoff.tracking.distance_arrays import Distances
from standoff.typing import Array

BLOCK = 8192
"""Rows computed at once: their poses and answers, some 5 MB, stay near the processor, and what a
call costs by itself is shared by many."""


@dataclass(frozen=True, eq=False)
class Job(ShardWork):
    """A sweep over what a job's file names: a pair of bodies, a world or a robot.

    `standoff.sweep.load_job` reads one from a file.

    Attributes
    ----------
    file : Path
    title : str
    subject : Subject
        What is swept: it answers rows by their numbers.
    parameters : tuple of Parameter
        In the file's order.
    kind : str
        Of the sampler, as the file names it.
    seed : int
    source : Sampler or SampleFile
    rows : int
    keep : Keep
    shard_rows : int
    effort : Effort
        What a proof over the parameters' ranges may take.
    """

    file: Path
    title: str
    subject: Subject
    parameters: tuple[Parameter, ...]
    kind: str
    seed: int
    source: Sampler | SampleFile
    rows: int
    keep: Keep
    shard_rows: int
    effort: Effort = field(default_factory=Effort)

    @property
    def pair(self) -> ConvexPair:
        """What is swept, of a job over two convex bodies.

        Raises StandoffError if it is over something else.
        """
        if not isinstance(self.subject, ConvexPair):
            raise StandoffError(
                f"The job is over {self.subject.name}, and this is of a pair of convex bodies: ask "
                "job.answers or job.alone.",
                "job",
            )
        return self.subject

    @property
    def scene(self) -> Scene:
        """Seen through the pair, of a pair."""
        return self.pair.scene

    @property
    def bodies(self) -> tuple[Body, Body]:
        """A and B, of a pair."""
        return self.pair.bodies

    @property
    def homes(self) -> tuple[Pose, Pose]:
        """World poses of A and B where all parameters are zero, of a pair."""
        return self.pair.homes

    @property
    def within(self) -> float | None:
        """Horizon [length]; of rows that are farther apart only that is proven."""
        return self.subject.within

    @property
    def shards(self) -> int:
        """How many shards there are; the last may be shorter than the others."""
        return -(-self.rows // self.shard_rows)

    def shard(self, k: int) -> tuple[int, int]:
        """Return the first row of a shard, and the first behind it."""
        return k * self.shard_rows, min((k + 1) * self.shard_rows, self.rows)

    @property
    def columns(self) -> list[str]:
        """Names of a row's numbers."""
        return [name for p in self.parameters for name in p.columns]

    def numbers(self, first: int, end: int) -> Array:
        """Return the parameters of rows first .. end - 1, shape (end - first, columns)."""
        if isinstance(self.source, SampleFile):
            return self.source.numbers(first, end)
        return in_ranges(self.parameters, self.source.points(first, end))

    def poses(self, numbers: Array) -> tuple[Array, Array]:
        """Return the world poses of A and B, (n, 4, 4) each, or (1, 4, 4) where none moves it.

        Raises StandoffError if the job is of no pair.
        """
        return self.pair.poses(self.parameters, numbers)

    def distances(self, first: int, end: int) -> Distances:
        """Return the distances of rows first .. end - 1 of a pair: of each row the same bits,
        whichever others are computed with it.

        Raises StandoffError if the job is of no pair: `answers` is for any.
        """
        return self.pair.distances(self.parameters, self.numbers(first, end))

    def answers(self, first: int, end: int) -> Rows:
        """Return what is kept of rows first .. end - 1: of each row the same bits, whichever
        others are computed with it."""
        return self.subject.rows(self.parameters, self.numbers(first, end), first)

    def alone(self, row: int) -> Alone:
        """Return one row in full."""
        return self.subject.alone(self.parameters, self.numbers(row, row + 1), row)

    @cached_property
    def facts(self) -> Mapping[str, Any]:
        """All that its results depend on, as plain data."""
        sampler: dict[str, Any] = {"kind": self.kind, "rows": self.rows, "seed": self.seed}
        if isinstance(self.source, SampleFile):
            sampler["file_sha256"] = self.source.digest
        return {
            "version": 1,
            "title": self.title,
            "length_unit": self.subject.length_unit,
            **self.subject.facts(),
            "within": self.within,
            "parameters": {p.name: p.facts() for p in self.parameters},
            "order": [p.name for p in self.parameters],
            "sampler": sampler,
            "keep": self.keep.facts(),
            "shards": {"rows": self.shard_rows},
        }

    @property
    def counts(self) -> dict[str, int]:
        return {"rows": self.rows, "shards": self.shards, "seed": self.seed}

    @property
    def token(self) -> Token:
        return Token(str(self.file.absolute()), self.digest)

    def nothing(self) -> Summary:
        return Summary(self.keep)

    def computed(self, k: int) -> Summary:
        return self.kept(*self.shard(k))

    def kept(self, first: int, end: int) -> Summary:
        """Return what is kept of rows first .. end - 1."""
        found = Summary(self.keep)
        for start in range(first, end, BLOCK):
            found.add_rows(self.answers(start, min(start + BLOCK, end)))
        return found

    def from_facts(self, facts: Mapping[str, Any]) -> Summary:
        return Summary.from_facts(facts, self.keep)

    def try_one(self, k: int) -> None:
        first, _ = self.shard(k)
        self.answers(first, first + 1)


def check_job(job: Any) -> None:
    """Refuse what is no job.

    Raises StandoffTypeError.
    """
    if not isinstance(job, Job):
        raise StandoffTypeError(f"job is {shown(job)}: give what load_job returns.", "job", job)
