"""What shards are parts of: the rows of a job, or the cells of a proof."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from standoff.sweep.digests import digest_of


class ShardTotals(Protocol):
    """What is kept of some shards."""

    def add(self, later: Any) -> None:
        """Add what is kept of the shards behind them."""

    def facts(self) -> dict[str, Any]:
        """Return plain data that JSON can hold."""


class Token(NamedTuple):
    """What another process knows a work by.

    Attributes
    ----------
    file : str
        Of the job.
    digest : str
        Of the job.
    clearance : float or None
        Of a proof.
    """

    file: str
    digest: str
    clearance: float | None = None


class ShardWork(ABC):
    """What is computed shard by shard, each by itself, and merged in their order."""

    file: Path
    """The job's."""

    rows: int
    """What progress counts."""

    @property
    @abstractmethod
    def shards(self) -> int:
        """How many shards there are."""

    @abstractmethod
    def shard(self, k: int) -> tuple[int, int]:
        """Return the first of what progress counts in a shard, and the first behind it."""

    @property
    @abstractmethod
    def facts(self) -> Mapping[str, Any]:
        """All that its results depend on, as plain data."""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of `facts`."""
        return digest_of(self.facts)

    @property
    @abstractmethod
    def counts(self) -> dict[str, int]:
        """What a manifest tells of it first."""

    @property
    @abstractmethod
    def token(self) -> Token:
        """What another process knows it by: `known_works.work_of` takes it."""

    @abstractmethod
    def nothing(self) -> Any:
        """Return what is kept of no shard."""

    @abstractmethod
    def computed(self, k: int) -> ShardTotals:
        """Return what is kept of shard k."""

    @abstractmethod
    def from_facts(self, facts: Mapping[str, Any]) -> ShardTotals:
        """Return what a shard's file has as plain data."""

    @abstractmethod
    def try_one(self, k: int) -> None:
        """Ask once of shard k, so that one process compiles what is not compiled yet."""
