"""Pose samples from a Parquet table, whichever of the usual names its columns have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standoff.errors import StandoffError

if TYPE_CHECKING:
    import pyarrow as pa

COLUMNS = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
"""The columns of pose samples, in the order of a TUM trajectory."""

ALIASES = {
    "t": ("time", "timestamp", "t"),
    "x": ("x", "tx"),
    "y": ("y", "ty"),
    "z": ("z", "tz"),
}
"""What a table may call its columns; the quaternion's have one name each."""


def parquet_rows(path: Path) -> Iterator[tuple[int, list[float]]]:
    """Yield each sample's row number, from 1, and its eight numbers in the order of `COLUMNS`.

    Time is in seconds, or has one of Arrow's types of instants and durations, which say their unit.

    Raises ValueError if the file is not Parquet, a column is missing, named twice or not of
    numbers, or a value is missing or not finite. Raises ModuleNotFoundError if pyarrow is not
    installed.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{path}: reading Parquet needs pyarrow, which is not installed; install the extra "
            "'cli': pip install 'standoff[cli]'"
        ) from error
    try:
        names = pq.read_schema(path).names
        chosen = [_column_of(path, column, names) for column in COLUMNS]
        table = pq.read_table(path, columns=chosen)
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        # Damaged pages are an OSError too; nothing tells them from a disk's failure.
        raise StandoffError(
            f"{path}: is not a readable Parquet file ({error})", "file", path
        ) from error
    seconds = _seconds(path, chosen[0], table.column(chosen[0]))
    numbers = [_numbers(path, name, table.column(name)) for name in chosen[1:]]
    return _rows(path, chosen, [seconds, *numbers])


def _column_of(path: Path, column: str, names: list[str]) -> str:
    """Return the name under which the table has a column."""
    known = ALIASES.get(column, (column,))
    found = [name for name in names if name in known]
    if len(found) != 1:
        trouble = f"has {' and '.join(found)}" if found else f"has no column {' or '.join(known)}"
        raise StandoffError(
            f"{path}: {trouble}; its columns are {', '.join(names)}: name one time, x y z or "
            "tx ty tz, and qx qy qz qw",
            "file",
            path,
        )
    return found[0]


def _seconds(path: Path, name: str, column: pa.ChunkedArray) -> list[Any]:
    import pyarrow as pa

    kind = column.type
    if pa.types.is_integer(kind):
        raise StandoffError(
            f"{path}, column {name}: whole numbers ({kind}) do not say whether they count seconds "
            "or parts of them; store seconds as double, or instants as a timestamp",
            "file",
            path,
        )
    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind):
        unit = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[kind.unit]
        ticks = column.cast(pa.int64()).to_pylist()
        # Whole seconds apart from the rest, so that instants far from the epoch keep their digits.
        return [None if tick is None else tick // unit + tick % unit / unit for tick in ticks]
    return _numbers(path, name, column)


def _numbers(path: Path, name: str, column: pa.ChunkedArray) -> list[Any]:
    import pyarrow as pa

    if not (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)):
        raise StandoffError(
            f"{path}, column {name}: holds {column.type}: give double", "file", path
        )
    values: list[Any] = column.to_pylist()
    return values


def _rows(
    path: Path, names: list[str], columns: list[list[Any]]
) -> Iterator[tuple[int, list[float]]]:
    for row, values in enumerate(zip(*columns, strict=True), 1):
        for name, value in zip(names, values, strict=True):
            if value is None or not math.isfinite(value):
                told = "empty" if value is None else str(value)
                raise StandoffError(
                    f"{path}, row {row}: {name} is {told}; leave out samples without a pose",
                    "file",
                    path,
                )
        yield row, [float(value) for value in values]
