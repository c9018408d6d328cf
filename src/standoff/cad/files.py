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
STATED = re.compile(
    rb"UNCERTAINTY_MEASURE_WITH_UNIT\s*\(\s*(?:POSITIVE_)?LENGTH_MEASURE\s*\(\s*"
    rb"(\d+\.?\d*(?:[Ee][-+]?\d+)?)\s*\)\s*,\s*#(\d+)"
)
UNIT = re.compile(
    rb"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.|CONVERSION_BASED_UNIT\s*\(\s*'(\w+)'"
)
PREFIXES = {"": 1.0, "MILLI": 0.001, "CENTI": 0.01, "DECI": 0.1, "MICRO": 0.000001, "KILO": 1e3}
UNITS_BY_NAME = {"INCH": 0.0254, "INCHES": 0.0254, "FOOT": 0.3048, "MILLIMETRE": 0.001}
"""Of units of length, in metres."""
STEP_START = b"ISO-10303-21"
STEP_END = b"END-ISO-10303-21"
CHUNK = 1 << 22


def is_cad_file(name: str | Path) -> bool:
    """Does its ending say so?"""
    return Path(name).suffix.lower() in ENDINGS


def existing(path: Any) -> Path:
    """A path to a file that is there and not empty.

    Raises StandoffTypeError: not a path. Raises FileNotFoundError. Raises CadError: an empty file,
    or a folder.
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


def stated_accuracy(file: Path) -> float:
    """The greatest accuracy that a STEP file states of its lengths, in metres; 0 if it states none.

    Its exporter's claim: how far what should meet may be apart.
    """
    text = file.read_bytes()
    found = 0.0
    for value, unit in {match.groups() for match in STATED.finditer(text)}:
        entity = re.search(rb"(?:^|[;\s])#%s\s*=([^;]*)" % unit, text)
        given = UNIT.search(entity[1]) if entity else None
        if given is not None:
            prefix, name = ((part or b"").decode().upper() for part in given.groups())
            metres = PREFIXES.get(prefix, 0.0) if not name else UNITS_BY_NAME.get(name, 0.0)
            found = max(found, float(value) * metres)
    return found


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
