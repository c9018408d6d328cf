"""The one error that a scene raises."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.wording import printable

SHOWN_CHARACTERS = 120
"""Longest key that a message repeats, in characters; `SceneError.key` has all of it."""


class SceneError(StandoffError):
    """A scene that cannot be used, with the place and the cure.

    Attributes
    ----------
    file : Path or None
        The file that holds the fault; None where a program or the command line gave the value.
    key : str
        Dotted path of the key, such as ``bodies.tool.semi_axes``; empty for the whole file.
        `argument` is the same.
    problem : str
        What is wrong, with the offending value, and what to write instead.
    """

    def __init__(
        self, problem: str, *, key: str = "", file: Path | None = None, value: Any = None
    ) -> None:
        self.problem = problem
        self.key = key
        self.file = file
        place = key if len(key) <= SHOWN_CHARACTERS else key[: SHOWN_CHARACTERS - 1] + "…"
        # On one line each: their names are not ours.
        parts = (printable(str(file or "")), printable(place), problem)
        message = ": ".join(part for part in parts if part)
        super().__init__(message, key, value)

    def found_in(self, file: Path) -> SceneError:
        """Return the same error with `file` named, unless it names one already."""
        if self.file is not None:
            return self
        return SceneError(self.problem, key=self.key, file=file, value=self.value)
