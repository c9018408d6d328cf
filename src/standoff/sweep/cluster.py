"""Shards computed on a cluster of Dask; their texts come back, and one process writes the files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError, of_extra
from standoff.sweep.code import code_facts
from standoff.sweep.digests import digest_of
from standoff.sweep.folder import put_text, shard_file
from standoff.sweep.known_works import work_of
from standoff.sweep.shard import text_of_shard
from standoff.sweep.work import ShardWork, Token

AHEAD = 2
"""Shards per thread of the cluster that are handed out before they are asked for."""


def made_on_cluster(
    work: ShardWork, folder: Path, missing: Sequence[int], address: str
) -> Iterator[int]:
    """Make shards on a cluster; yields each one's number when it is there.

    Raises ModuleNotFoundError if Dask is not installed. Raises StandoffError if a worker cannot
    read the job, or has another job or library. Raises OSError if the scheduler cannot be reached,
    or is lost.

    Parameters
    ----------
    work : Job or Proof
        The job's file, and what that names, must be at the same path on all machines.
    folder : Path
        Of this machine alone.
    missing : sequence of int
    address : str
        Of the scheduler, such as ``tcp://10.0.0.5:8786``.
    """
    with of_extra("distributed", "cluster"):
        from distributed import Client
    if not missing:
        return
    given = work.token, digest_of(code_facts())
    for k, text in _texts(Client, address, given, missing):
        put_text(shard_file(folder, k), text)
        yield k


def _texts(
    client_of: Any, address: str, given: tuple[Token, str], missing: Sequence[int]
) -> Iterator[tuple[int, str]]:
    """Numbers and texts of shards, as they come."""
    from distributed import as_completed

    left = list(reversed(missing))
    try:
        with client_of(address) as client:
            room = AHEAD * max(1, sum(client.nthreads().values()))
            ask = partial(client.submit, shard_text, *given, pure=False)
            waiting = as_completed([ask(left.pop()) for _ in missing[:room]])
            for future in waiting:
                found = future.result()
                if left:
                    waiting.add(ask(left.pop()))
                yield found
    except (StandoffError, GeneratorExit):
        raise
    except Exception as error:
        # Dask tells of a lost scheduler by errors of many classes.
        raise OSError(
            f"the cluster at {address} failed or was lost ({type(error).__name__}: {error})"
        ) from error


def shard_text(token: Token, code_digest: str, k: int) -> tuple[int, str]:
    """Return a shard's number and the text of its file, computed where this is called.

    Raises StandoffError if the job or the library here is another one.
    """
    if digest_of(code_facts()) != code_digest:
        raise StandoffError(
            f"a worker has another library, {code_facts()}: install the same versions everywhere",
            "cluster",
        )
    work = work_of(token)
    return k, text_of_shard(work, code_digest, k, work.computed(k))
