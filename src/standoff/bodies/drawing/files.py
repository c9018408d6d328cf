"""Pictures in files of known formats, written whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.whole_files import file_name, write_whole

FORMATS = ("png", "svg", "pdf")


def checked_file(path: object) -> Path:
    """Return the path of a picture's file.

    Raises TypeError if it is neither a string nor a Path. Raises ValueError if it is empty, or its
    extension is not one of `FORMATS`.
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


def drawn(path: object, draw: Callable[[], Any]) -> Any:
    """A figure, also written to a file if one is named, whole or not at all; the name is checked
    before anything is drawn.

    Raises TypeError, ValueError as `checked_file`.
    """
    target = None if path is None else checked_file(path)
    figure = draw()
    if target is not None:
        ending = _ending(target)
        write_whole({target: lambda file: figure.savefig(file, format=ending)})
    return figure


def _ending(target: Path) -> str:
    return target.suffix.lower().removeprefix(".")
