"""Pictures in files of known formats, written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.whole_files import file_name, write_whole

FORMATS = ("png", "svg", "pdf")


def checked_file(path: object) -> Path:
    """Return the path of a picture's file.

    Raises
    ------
    TypeError
        If it is neither a string nor a Path.
    ValueError
        If it is empty, or its extension is not one of `FORMATS`.
    """
    target = file_name(path)
    if _ending(target) not in FORMATS:
        raise StandoffError(
            f"{target}: the ending '{target.suffix}' is not known here; name a file that ends "
            f"in .{', .'.join(FORMATS)}",
            "path",
            path,
        )
    return target


def write_picture(figure: Any, target: Path) -> None:
    """Write a figure, whole or not at all."""
    ending = _ending(target)
    write_whole({target: lambda file: figure.savefig(file, format=ending)})


def _ending(target: Path) -> str:
    return target.suffix.lower().removeprefix(".")
