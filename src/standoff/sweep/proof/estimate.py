"""What a proof will take at most, from a few of its queries."""

from __future__ import annotations

import os
import time
from typing import NamedTuple

from standoff.checks.numbers import whole_number
from standoff.sweep.proof.proof import Proof, check_proof
from standoff.sweep.proof.search import search
from standoff.sweep.proof.summary import Kind

TRIED = 20_000
"""Queries that are tried."""


class ProofEstimate(NamedTuple):
    """What a proof will take at most.

    Attributes
    ----------
    queries, shards : int
    tried : int
        Queries that were taken for it, over the whole box.
    query_seconds : float
        Time of a query on one processor, with what belongs to it, s.
    processes : int
        Workers that have a processor of their own.
    seconds : float
        Time until all queries are spent, s; a box that is proven or decided earlier takes less.
    proven, violated : float
        Shares of the box after the queries that were tried.
    """

    queries: int
    shards: int
    tried: int
    query_seconds: float
    processes: int
    seconds: float
    proven: float
    violated: float


def estimated_proof(proof: Proof, workers: int = 1) -> ProofEstimate:
    """Try some queries, and tell what all of them will take; writes nothing.

    Raises TypeError, ValueError: no proof, or a number of workers that is not positive.

    Parameters
    ----------
    proof : Proof
    workers : int
        As of `run_proof`.
    """
    check_proof(proof)
    whole_number(workers, "workers")
    proof.box.look(proof.box.whole)  # compiles, where that is still to be done
    queries = min(TRIED, proof.effort.queries)
    began = time.perf_counter()
    found = search(proof.box, proof.box.whole, queries, proof.most)
    each = (time.perf_counter() - began) / max(1, found.queries)
    processes = max(1, min(workers, os.cpu_count() or 1, proof.shards))
    done = found.queries < queries
    most = found.queries if done else proof.effort.queries
    return ProofEstimate(
        queries=proof.effort.queries,
        shards=proof.shards,
        tried=found.queries,
        query_seconds=each,
        processes=processes,
        seconds=each * most / processes,
        proven=float(found.share(Kind.PROVEN)),
        violated=float(found.share(Kind.VIOLATED)),
    )
