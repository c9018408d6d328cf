"""Rows of a sweep that a file gives: Parquet, CSV or NPY."""

from __future__ import annotations

import csv
import hashlib
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from standoff.checks.names import did_you_mean
from standoff.errors import StandoffError, of_extra
from standoff.typing import Array
from standoff.wording import printable

ENDINGS = (".parquet", ".csv", ".npy")


class SampleFile:
    """A file with a row of numbers for each row of a sweep.

    A Parquet or CSV file has named columns; others than those asked for are passed over. An NPY
    file is an array (n, columns), in their order. NPY and Parquet are read piece by piece.

    Raises StandoffError if the file is of another kind or another shape, or lacks a column. Raises
    OSError if it cannot be read. Raises ModuleNotFoundError if it is Parquet, and pyarrow is not
    installed.

    Parameters
    ----------
    file : Path
    columns : sequence of str
        The names of a row's numbers.
    """

    def __init__(self, file: Path, columns: Sequence[str]) -> None:
        self.file, self.columns = file, tuple(columns)
        ending = file.suffix.lower()
        if ending not in ENDINGS:
            raise self._error(f"ends in '{ending}': give a file that ends in {', '.join(ENDINGS)}")
        self._ends: NDArray[np.int64] | None = None  # of row groups, of what is read by them
        self._array: Array = np.empty((0, 0))
        self._group: tuple[int, Array] = (-1, np.empty((0, 0)))
        read = {".parquet": self._open_parquet, ".csv": self._read_csv, ".npy": self._map_npy}
        read[ending]()
        if self.rows == 0:
            raise self._error("has no rows")

    def _error(self, problem: str) -> StandoffError:
        return StandoffError(f"{printable(str(self.file))}: {problem}", "file", self.file)

    def _map_npy(self) -> None:
        try:
            found = np.load(self.file, mmap_mode="r", allow_pickle=False)
        except (ValueError, EOFError) as error:
            raise self._error(f"is not an NPY file of numbers ({error})") from error
        if found.ndim != 2 or found.shape[1] != len(self.columns) or found.dtype.kind not in "fiu":
            raise self._error(
                f"holds {found.dtype} of shape {found.shape}: give numbers of shape "
                f"(n, {len(self.columns)}), the columns {', '.join(self.columns)}"
            )
        self._array = found
        self.rows = len(found)

    def _read_csv(self) -> None:
        with self.file.open(encoding="utf-8-sig", newline="") as stream:
            lines = csv.reader(stream)
            names = [name.strip() for name in next(lines, [])]
            at = [self._place(name, names) for name in self.columns]
            rows = [self._numbers(lines.line_num, row, at) for row in lines if row]
        self._array = np.array(rows).reshape(-1, len(at))
        self.rows = len(rows)

    def _numbers(self, line: int, row: list[str], at: list[int]) -> list[float]:
        try:
            return [float(row[k]) for k in at]
        except (ValueError, IndexError) as error:
            raise self._error(
                f"line {line} is not a number for each of {', '.join(self.columns)}"
            ) from error

    def _open_parquet(self) -> None:
        with of_extra("pyarrow"):
            import pyarrow as pa
            import pyarrow.parquet as pq
        try:
            self._parquet = pq.ParquetFile(self.file)
        except (pa.ArrowException, UnicodeDecodeError) as error:
            raise self._error(f"is not a readable Parquet file ({error})") from error
        schema = self._parquet.schema_arrow
        for name in self.columns:
            kind = schema.types[self._place(name, schema.names)]
            if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
                raise self._error(f"the column {name!r} is of {kind}, not of numbers")
        sizes = [self._parquet.metadata.row_group(k).num_rows for k in range(self._groups)]
        self._ends = np.cumsum(sizes, dtype=np.int64)
        self.rows = int(sum(sizes))

    @property
    def _groups(self) -> int:
        return int(self._parquet.num_row_groups)

    def _place(self, name: str, names: Sequence[str]) -> int:
        if list(names).count(name) != 1:
            what = "several columns" if name in names else "no column"
            raise self._error(f"has {what} {name!r}.{did_you_mean(name, names)}")
        return list(names).index(name)

    def numbers(self, first: int, end: int) -> Array:
        """Return rows first .. end - 1, shape (end - first, columns).

        Raises StandoffError: at a number that is missing or not finite.
        """
        if self._ends is None:
            found = np.array(self._array[first:end], dtype=np.float64)
        else:
            groups = range(
                int(np.searchsorted(self._ends, first, side="right")),
                int(np.searchsorted(self._ends, end, side="left")) + 1,
            )
            start = int(self._ends[groups[0] - 1]) if groups[0] else 0
            parts = [self._of_group(k) for k in groups]
            found = parts[0] if len(parts) == 1 else np.concatenate(parts)
            found = found[first - start : end - start]
        bad = np.flatnonzero(~np.isfinite(found).all(axis=1))
        if len(bad):
            column = int(np.flatnonzero(~np.isfinite(found[bad[0]]))[0])
            value = float(found[bad[0], column])
            told = "missing or nan" if math.isnan(value) else str(value)
            raise self._error(
                f"row {first + int(bad[0])}, from 0, is {told} in {self.columns[column]!r}: give "
                "finite numbers"
            )
        return found

    def _of_group(self, k: int) -> Array:
        if self._group[0] != k:
            table = self._parquet.read_row_group(k, columns=list(self.columns))
            columns = [table.column(name).to_numpy() for name in self.columns]
            self._group = k, np.stack(columns, axis=1).astype(np.float64)
        return self._group[1]

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file's content."""
        with self.file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
