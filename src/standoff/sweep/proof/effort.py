"""What a proof may take."""

from __future__ import annotations

from typing import NamedTuple

from standoff.scene.reader import SceneTable

MOST_SHARDS = 1 << 20


class Effort(NamedTuple):
    """What a proof may take, as a job's table ``[prove]`` says.

    Attributes
    ----------
    finest : float or None
        Cells whose points move by no more than this are left open: length; a thousandth of what
        they move in the whole box if not given.
    queries : int
        Most distances that are asked for, in all.
    shards : int
        Parts of the box, a power of two.
    """

    finest: float | None = None
    queries: int = 100_000_000
    shards: int = 64


def effort_of(top: SceneTable) -> Effort:
    """Return what a job's table ``[prove]`` says.

    Raises SceneError: what it says cannot be.
    """
    if "prove" not in top:
        return Effort()
    table, usual = top.table("prove"), Effort()
    table.expect("finest", "queries", "shards")
    finest = table.positive("finest") if "finest" in table else None
    queries = table.count("queries", usual.queries)
    shards = table.count("shards", usual.shards)
    if shards & (shards - 1) or shards > MOST_SHARDS:
        raise table.error(
            f"must be a power of two, up to {MOST_SHARDS}: the box is halved again and again, got "
            f"{shards}",
            "shards",
        )
    return Effort(finest, queries, shards)
