"""One shard: computed, written as text with checksums, and read again."""

from __future__ import annotations

import json
from typing import Any

from standoff.sweep.digests import digest_of
from standoff.sweep.work import ShardTotals, ShardWork

FORMAT, VERSION = "standoff sweep shard", 1


class NotThisShard(Exception):
    """A shard's file that is damaged, or belongs to something else; the message says why."""


def text_of_shard(work: ShardWork, code: str, k: int, found: ShardTotals) -> str:
    """Return the text of a shard's file: the same for the same job and code.

    Parameters
    ----------
    work : Job or Proof
    code : str
        Digest of what computed it.
    k : int
        Number of the shard.
    found : Summary or ProofSummary
    """
    first, end = work.shard(k)
    facts: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "job": work.digest,
        "code": code,
        "shard": k,
        "first": first,
        "end": end,
        **found.facts(),
    }
    text = json.dumps(facts | {"sha256": digest_of(facts)}, allow_nan=False)
    return f"{text}\n"


def read_shard(work: ShardWork, code: str, k: int, text: bytes) -> ShardTotals:
    """Return what a shard's file holds.

    Raises NotThisShard if it is damaged, or is not this shard of this job by this code.
    """
    try:
        facts = json.loads(text)
        own = facts.pop("sha256")
    except (ValueError, KeyError, AttributeError, TypeError) as error:
        raise NotThisShard("it is not a whole file") from error
    if digest_of(facts) != own:
        raise NotThisShard("its content is not what its checksum says")
    first, end = work.shard(k)
    for key, value in (
        *(("format", FORMAT), ("version", VERSION), ("job", work.digest), ("code", code)),
        *(("shard", k), ("first", first), ("end", end)),
    ):
        if facts.get(key) != value:
            raise NotThisShard(f"its {key} is {facts.get(key)!r}, not {value!r}")
    return work.from_facts(facts)
