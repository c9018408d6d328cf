"""Checks of a file before OpenCASCADE sees it: its place, length, end and number of entities."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from standoff.cad.limits import MOST_ENTITIES
from standoff.checks.real_numbers import shown
from standoff.errors import CadError, StandoffTypeError

ENDINGS = {
    ".step": "step",
    ".stp": "step",
    ".p21": "step",
    ".brep": "brep",
    ".brp": "brep",
    ".rle": "brep",
    ".iges": "iges",
    ".igs": "iges",
}
"""The kinds of files by their endings."""

ENTITY = re.compile(rb"(?:^|[;\s])#(\d+)\s*=")
STEP_START = b"ISO-10303-21"
STEP_END = b"END-ISO-10303-21"
CHUNK = 1 << 22


def is_cad_file(name: str | Path) -> bool:
    """Does its ending say so?"""
    return Path(name).suffix.lower() in ENDINGS


def existing(path: Any) -> Path:
    """A path to a file that is there and not empty.

    Raises
    ------
    StandoffTypeError
        Not a path.
    FileNotFoundError
    CadError
        An empty file, or a folder.
    """
    if not isinstance(path, str | Path) or not str(path):
        raise StandoffTypeError(f"path = {shown(path)}: give the path of a file.", "path", path)
    file = Path(path)
    if not file.exists():
        raise FileNotFoundError(f"{file}: there is no such file.")
    if not file.is_file():
        raise CadError(f"{file} is a folder: give a file.", "path", path)
    if file.stat().st_size == 0:
        raise CadError(f"{file} is empty.", "path", path)
    return file


def check_step(file: Path) -> None:
    """Raise CadError for what is no STEP file, is cut off, has no entities, or too many."""
    with file.open("rb") as stream:
        head = stream.read(4096).lstrip(b"\xef\xbb\xbf \t\r\n")
    if not head.startswith(STEP_START):
        raise CadError(f"{file} is no STEP file: it does not begin with {STEP_START.decode()}.")
    count, last, lines = 0, b"", 0
    tail = b""
    with file.open("rb") as stream:
        while chunk := stream.read(CHUNK):
            text = tail + chunk
            cut = max(text.rfind(b";") + 1, len(text) - CHUNK)
            text, tail = text[:cut], text[cut:]
            found = ENTITY.findall(text)
            count, last = count + len(found), found[-1] if found else last
            lines += text.count(b"\n")
            if count > MOST_ENTITIES:
                raise CadError(
                    f"{file} has more than {MOST_ENTITIES} entities (standoff.cad.limits."
                    f"MOST_ENTITIES; {count} are within its first {stream.tell()} of "
                    f"{file.stat().st_size} bytes): split it, or export fewer parts."
                )
            ending = text[-200:] + tail
    if STEP_END not in ending:
        raise CadError(
            f"{file} is cut off: it ends in line {lines + 1} after entity #{last.decode() or '?'}, "
            f"without {STEP_END.decode()}; save or copy it again."
        )
    if not count:
        raise CadError(f"{file} has no entities.")


def check_lines(file: Path, kind: str, start: bytes | None) -> None:
    """Raise CadError for a file of too many lines, or that does not begin as its kind does."""
    with file.open("rb") as stream:
        head = stream.read(4096)
        if start is not None and start not in head:
            raise CadError(f"{file} is no {kind} file: it does not begin with {start.decode()!r}.")
        lines = head.count(b"\n")
        while chunk := stream.read(CHUNK):
            lines += chunk.count(b"\n")
            if lines > MOST_ENTITIES:
                raise CadError(
                    f"{file} has more than {MOST_ENTITIES} lines (standoff.cad.limits."
                    "MOST_ENTITIES): split it, or export fewer parts."
                )
