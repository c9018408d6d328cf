"""Pose samples from a file: TUM trajectories, CSV tables and Parquet tables."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from standoff.checks.real_numbers import SHOWN_CHARACTERS, shown
from standoff.errors import StandoffError, StandoffTypeError
from standoff.motion.pose import Pose
from standoff.motion.samples import PoseSamples
from standoff.motion.samples_table import COLUMNS as _COLUMNS
from standoff.motion.samples_table import parquet_rows

_NUMBER = re.compile(
    r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|inf(?:inity)?|nan)", re.I
)
"""A number as TUM and CSV files write it; those that are not allowed here are refused by name."""

_TUM_HEADER = "timestamp tx ty tz qx qy qz qw"


def read_pose_samples(file: str | os.PathLike[str]) -> PoseSamples:
    """Read a recorded motion.

    ``.tum`` and ``.txt``: a TUM trajectory, ``timestamp tx ty tz qx qy qz qw`` on each line,
    separated by blanks. ``.csv``: a header that names the columns ``t,x,y,z,qx,qy,qz,qw`` in any
    order, then one sample a line. Empty lines and lines that begin with ``#`` are ignored.
    ``.parquet``: a table with the columns ``time`` (or ``timestamp``, ``t``), ``x y z`` (or
    ``tx ty tz``) and ``qx qy qz qw``; others are ignored. Times are in seconds and must
    increase strictly; the quaternions' scalar is ``qw``.

    Parameters
    ----------
    file : str or path

    Returns
    -------
    PoseSamples
        Its `repaired` counts the quaternions whose norm was off 1, by up to 1e-3, and that were
        normalised.

    Raises
    ------
    TypeError
        If `file` is neither a string nor a path.
    FileNotFoundError, IsADirectoryError, OSError
        If there is no such file, or it cannot be looked up or read.
    ValueError
        If the ending is none of these or the content is not as above; the message names file and
        line, or row.
    ModuleNotFoundError
        If the file is Parquet and pyarrow is not installed.
    """
    given: object = file
    if not isinstance(given, str | os.PathLike):
        raise StandoffTypeError(
            f"file is {shown(given)}: give a file name, as a string or a path", "file", file
        )
    path = Path(file)
    noun, rows = _rows_of(path)
    times, poses = _timed(path, noun, rows)
    try:
        return PoseSamples(times, poses)
    except ValueError as error:
        raise StandoffError(f"{path}: {error}", "file", path) from error


def _timed(
    path: Path, noun: str, rows: Iterator[tuple[int, list[float]]]
) -> tuple[list[float], list[Pose]]:
    """Times, which must increase, and poses of a file's samples."""
    times: list[float] = []
    poses: list[Pose] = []
    for line, values in rows:
        t, x, y, z, qx, qy, qz, qw = values
        if times and t <= times[-1]:
            raise _fault(
                path,
                line,
                f"time {t!r} does not come after {times[-1]!r}, the one before; sort the {noun}s "
                "by time, and keep one of each",
                noun,
            )
        times.append(t)
        try:
            poses.append(Pose.from_xyzw((qx, qy, qz, qw), (x, y, z)))
        except ValueError as error:
            problem = f"{error}; the columns are {' '.join(_COLUMNS)}"
            raise _fault(path, line, problem, noun) from error
    return times, poses


def _rows_of(path: Path) -> tuple[str, Iterator[tuple[int, list[float]]]]:
    """Return what a sample's place is called, and the samples: place, numbers by `_COLUMNS`."""
    ending = path.suffix.lower()
    if ending not in (".tum", ".txt", ".csv", ".parquet"):
        raise StandoffError(
            f"{_told(path)}: the ending {shown(ending)} is not a format of pose samples; use .tum "
            "(or .txt) for a TUM trajectory, .csv for a text table with a header, .parquet for a "
            "Parquet one",
            "file",
            path,
        )
    _check_file(path)
    if ending == ".parquet":
        return "row", parquet_rows(path)
    lines = _content_lines(path)
    return "line", _table(path, lines) if ending == ".csv" else _trajectory(path, lines)


def _check_file(path: Path) -> None:
    if os.path.isdir(path):
        raise IsADirectoryError(f"{path} is a folder: give a file of pose samples")
    # Unlike a path's own `exists`, this one takes names that no file can have, such as a long one.
    if not os.path.exists(path):
        raise FileNotFoundError(
            f"{_told(path)}: no such file; the path is relative to the folder {Path.cwd()}"
        )


def _content_lines(path: Path) -> list[tuple[int, str]]:
    try:
        # Spreadsheets write a byte order mark before the first column's name.
        content = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise OSError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise StandoffError(
            f"{path}: not a text file in UTF-8 ({error.reason})", "file", path
        ) from error
    numbered = enumerate(content.splitlines(), 1)
    return [(n, text) for n, text in numbered if text.strip() and not text.lstrip().startswith("#")]


def _trajectory(path: Path, lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, list[float]]]:
    for line, text in lines:
        fields = text.split()
        if len(fields) != len(_COLUMNS):
            raise _fault(
                path, line, f"{len(fields)} columns, not {len(_COLUMNS)}: give {_TUM_HEADER}"
            )
        yield line, _numbers(path, line, fields)


def _table(path: Path, lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, list[float]]]:
    rows = ((line, _cells(text)) for line, text in lines)
    line, header = next(rows, (1, []))
    if sorted(header) != sorted(_COLUMNS):
        raise _fault(
            path,
            line,
            f"the header is {','.join(header)!r}: name the columns {','.join(_COLUMNS)}, in any "
            "order, each once and no others",
        )
    order = [header.index(column) for column in _COLUMNS]
    for line, fields in rows:
        if len(fields) != len(header):
            raise _fault(path, line, f"{len(fields)} columns, where the header names {len(header)}")
        yield line, _numbers(path, line, [fields[k] for k in order])


def _cells(text: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([text]))]


def _numbers(path: Path, line: int, fields: list[str]) -> list[float]:
    values = []
    for column, field in zip(_COLUMNS, fields, strict=True):
        # Python alone would also read 5_0 as 50, and the digits of other scripts.
        if _NUMBER.fullmatch(field) is None:
            raise _fault(
                path, line, f"{column} is {shown(field)}, not a number; write it like -12.5e-3"
            )
        value = float(field)
        if not math.isfinite(value):
            raise _fault(
                path, line, f"{column} is {shown(field)}; leave out samples without a pose"
            )
        values.append(value)
    return values


def _told(path: Path) -> str:
    """A path as a message repeats it; `shown` would put it in quotes."""
    text = str(path)
    return text if len(text) <= SHOWN_CHARACTERS else text[: SHOWN_CHARACTERS - 1] + "…"


def _fault(path: Path, line: int, problem: str, noun: str = "line") -> StandoffError:
    return StandoffError(f"{path}, {noun} {line}: {problem}", "file", path)
