"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Mapping
from pathlib import Path

Writer = Callable[[Path], None]
"""Writes one file at the path that it is given."""


def write_whole(files: Mapping[Path, Writer]) -> None:
    """Write all of `files`, or, if one fails, none.

    Each is written beside its target under a name of its own and then moved onto it, which a
    reader sees at once.

    Raises
    ------
    OSError
        If a file cannot be written, as on a full disk.
    """
    staged: dict[Path, Path] = {}
    try:
        for target, write in files.items():
            staged[target] = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
            write(staged[target])
        for target, written in staged.items():
            os.replace(written, target)
    finally:
        for written in staged.values():
            written.unlink(missing_ok=True)
