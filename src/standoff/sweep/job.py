"""A sweep's job: what its file says, checked and built, and the poses of any of its rows."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from standoff.bodies.body import Body
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffTypeError
from standoff.motion import Pose
from standoff.scene import Scene
from standoff.sweep.parameters import Parameter, in_ranges, moved
from standoff.sweep.sample_file import SampleFile
from standoff.sweep.samplers import Sampler
from standoff.tracking.many_distances import Distances, answered_rows

Array = NDArray[np.float64]


class Bins(NamedTuple):
    """A histogram of distances: equal bins, a row at the upper end not among them."""

    low: float
    high: float
    number: int

    @property
    def edges(self) -> Array:
        """(number + 1,) ends of the bins."""
        return np.linspace(self.low, self.high, self.number + 1)


class Keep(NamedTuple):
    """What is kept of the rows.

    Attributes
    ----------
    worst : int
        How many rows of least distance.
    below : float or None
        Rows that are not proven to be so far apart are kept [length].
    most_below : int
        How many of them; all are counted.
    bins : Bins or None
    """

    worst: int = 1000
    below: float | None = None
    most_below: int = 10_000
    bins: Bins | None = None

    def facts(self) -> dict[str, Any]:
        """Return plain data, as a job's file has it."""
        known: dict[str, Any] = {"worst": self.worst}
        if self.below is not None:
            known |= {"below": self.below, "most_below": self.most_below}
        if self.bins is not None:
            low, high, number = self.bins
            known["histogram"] = {"from": low, "to": high, "bins": number}
        return known


@dataclass(frozen=True, eq=False)
class Job:
    """A sweep over poses of the two bodies of a scene's pair.

    `standoff.sweep.load_job` reads one from a file.

    Attributes
    ----------
    file : Path
    title : str
    scene : Scene
        Seen through the pair.
    bodies : pair of Body
    homes : pair of Pose
        World poses of A and B where all parameters are zero.
    parameters : tuple of Parameter
        In the file's order.
    kind : str
        Of the sampler, as the file names it.
    seed : int
    source : Sampler or SampleFile
    rows : int
    keep : Keep
    shard_rows : int
    within : float or None
        Horizon [length]; of rows that are farther apart only that is proven.
    """

    file: Path
    title: str
    scene: Scene
    bodies: tuple[Body, Body]
    homes: tuple[Pose, Pose]
    parameters: tuple[Parameter, ...]
    kind: str
    seed: int
    source: Sampler | SampleFile
    rows: int
    keep: Keep
    shard_rows: int
    within: float | None = None

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
        """Return the world poses of A and B, (n, 4, 4) each, or (1, 4, 4) where none moves it."""
        a, b = (
            moved(home, body, self.parameters, numbers)
            for home, body in zip(self.homes, self.scene.pair, strict=True)
        )
        return a, b

    def distances(self, first: int, end: int) -> Distances:
        """Return the distances of rows first .. end - 1: of each row the same bits, whichever
        others are computed with it."""
        a, b = self.poses(self.numbers(first, end))
        return answered_rows(*self.bodies, a, b, within=self.within)

    @cached_property
    def facts(self) -> Mapping[str, Any]:
        """All that its results depend on, as plain data."""
        a, b = self.scene.pair
        sampler: dict[str, Any] = {"kind": self.kind, "rows": self.rows, "seed": self.seed}
        if isinstance(self.source, SampleFile):
            sampler["file_sha256"] = self.source.digest
        return {
            "version": 1,
            "title": self.title,
            "length_unit": self.scene.length_unit,
            "pair": {"a": a, "b": b},
            "bodies": {"a_sha256": self.bodies[0].digest, "b_sha256": self.bodies[1].digest},
            "poses": dict(zip("ab", (p.matrix.tolist() for p in self.homes), strict=True)),
            "within": self.within,
            "parameters": {p.name: p.facts() for p in self.parameters},
            "order": [p.name for p in self.parameters],
            "sampler": sampler,
            "keep": self.keep.facts(),
            "shards": {"rows": self.shard_rows},
        }

    @cached_property
    def digest(self) -> str:
        """SHA-256 of `facts`."""
        return digest_of(self.facts)


def digest_of(facts: Mapping[str, Any]) -> str:
    """Return the SHA-256 of plain data; numbers are written so that they are read as the same."""
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode("utf-8")).hexdigest()


def check_job(job: Any) -> None:
    """Refuse what is no job.

    Raises
    ------
    StandoffTypeError
    """
    if not isinstance(job, Job):
        raise StandoffTypeError(f"job is {shown(job)}: give what load_job returns.", "job", job)
