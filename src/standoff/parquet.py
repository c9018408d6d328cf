"""Tables as Parquet files, with JSON in them that tells of what they are."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from standoff.errors import of_extra

with of_extra("pyarrow"):
    import pyarrow as pa
    import pyarrow.parquet as pq

__all__ = ["METADATA", "pa", "pq", "table", "vectors", "write"]

METADATA = b"standoff"
"""Key of the schema's metadata under which the JSON text stands."""


def table(columns: Mapping[str, Any], facts: Mapping[str, Any]) -> pa.Table:
    """Return a table of PyArrow with its facts.

    Raises TypeError, ValueError: facts that JSON cannot hold.
    """
    text = json.dumps(dict(facts), ensure_ascii=False, allow_nan=False)
    return pa.table(dict(columns)).replace_schema_metadata({METADATA: text})


def write(columns: Mapping[str, Any], facts: Mapping[str, Any], file: BinaryIO) -> None:
    """Write a table to a stream; the same columns and facts give the same file, byte for byte."""
    pq.write_table(table(columns, facts), file)


def vectors(values: NDArray[np.float64]) -> pa.Array:
    """Return rows of one length (n, k) as one column."""
    flat = pa.array(np.ascontiguousarray(values).ravel())
    return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
