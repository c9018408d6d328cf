"""Files that a scene is read from: whether they are there, and what Python's parsers refuse."""

from __future__ import annotations

import re
import stat
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from standoff.checks.names import nearest
from standoff.nesting import TOML, text_problem, value_problem
from standoff.scene.errors import SceneError
from standoff.scene.reader import SceneTable, shown

NEAREST_FILE_CUTOFF = 0.8
"""Least likeness (difflib ratio, 0 to 1) of a file name that is suggested for another: file names
are similar because of their endings alone."""

NAMED = 3
"""Most keys that the place of too deep a nesting has, such as ``bodies.tool.size``."""


def file_problem(path: Path, name: str, folder: str = "the scene file") -> str | None:
    """Return why `path` cannot be read as a file, None where it can.

    Parameters
    ----------
    path : Path
    name : str
        What the user called it.
    folder : str
        What relative paths count from.
    """
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return _missing(path, name, folder)
    except (OSError, ValueError) as error:
        # Too long a name, a folder that may not be entered, a character that no name may have.
        reason = error.strerror if isinstance(error, OSError) else str(error)
        return f"no file {shown(name)}: {reason}; name another"
    if stat.S_ISDIR(mode):
        return f"{shown(name)} is a folder; name a file in it"
    return None if stat.S_ISREG(mode) else f"{shown(name)} is not a file on a disk; name one"


def _missing(path: Path, name: str, folder: str) -> str:
    if not path.parent.is_dir():
        return f"no file {shown(name)}: its folder does not exist; paths are relative to {folder}"
    try:
        beside: Sequence[str] = [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except OSError:
        beside = ()
    likely = nearest(path.name, beside, NEAREST_FILE_CUTOFF)
    if likely is not None:
        return f"no file {shown(name)}; did you mean '{likely}'?"
    return f"no file {shown(name)}; paths are relative to {folder}"


def existing_file(table: SceneTable, key: str, example: str) -> Path:
    """Return the file that `key` names, relative to the scene file.

    Raises SceneError if the key or the file is missing; `example` is the line to add.
    """
    name = table.text(key, example=example)
    path = (table.file.parent if table.file is not None else Path()) / name
    problem = file_problem(path, name)
    if problem is not None:
        raise table.error(problem, key)
    return path


def text_of(path: Path) -> str:
    """Return the text of a scene file, or raise SceneError."""
    problem = file_problem(path, str(path), "the current folder")
    if problem is not None:
        raise SceneError(problem)
    try:
        # Some editors write a byte order mark before the text.
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(
            f"is not text in UTF-8 (byte {error.start}); save it as UTF-8", file=path
        ) from error
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}", file=path) from error


def toml_tables(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises SceneError if it is not TOML, is nested too deeply, or holds a number of more digits than
    Python reads.
    """
    problem = text_problem(text, TOML)
    if problem:
        raise SceneError(problem)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"is not TOML: {error}") from error
    except ValueError as error:
        raise SceneError(beyond_python(text, error)) from error
    # Dotted keys nest tables without a bracket.
    problem, keys = value_problem(tables)
    if problem:
        raise SceneError(problem, key=".".join(keys[:NAMED]))
    return tables


def beyond_python(text: str, error: Exception) -> str:
    """Return the sentence about valid TOML or JSON that Python's parsers nevertheless refuse."""
    most = sys.get_int_max_str_digits()
    long = re.search(rf"\d[\d_]{{{most},}}", text) if most else None
    if long is None:
        return f"cannot be read: {error}"
    return (
        f"holds a whole number of more than {most} digits{_place(text, long)}; write a number "
        "within 1e308, such as 1.5e300"
    )


def _place(text: str, found: re.Match[str] | None) -> str:
    if found is None:
        return ""
    line = text.count("\n", 0, found.start()) + 1
    return f", {shown(found[0])} on line {line}"
