"""Files that are written whole or not at all."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from standoff.cli.errors import CommandError, WriteError
from standoff.tracking import whole_files
from standoff.tracking.whole_files import Writer as Writer


def check_target(target: Path, option: str, endings: Sequence[str]) -> None:
    """Refuse a file that could not be written later; nothing is left behind.

    Parameters
    ----------
    target : Path
        The file to be written.
    option : str
        The option that named it, for the message.
    endings : sequence of str
        The file name endings that are understood, lower case, with their dot.

    Raises
    ------
    CommandError
        If the ending is another, the folder is missing or cannot be written, or the target is
        itself a folder.
    """
    if target.suffix.lower() not in endings:
        raise CommandError(
            f"{option} {target}: the ending '{target.suffix}' is not known here; "
            f"name a file that ends in {' or '.join(endings)}"
        )
    if target.is_dir():
        raise CommandError(f"{option} {target}: is a folder; name a file in it")
    folder = target.parent
    if not folder.exists():
        raise CommandError(
            f"{option} {target}: the folder {folder} does not exist; create it or name another"
        )
    if not folder.is_dir():
        raise CommandError(f"{option} {target}: {folder} is a file, no folder; name a folder")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CommandError(
            f"{option} {target}: the folder {folder} cannot be written ({error.strerror}); "
            "name another, or change its permissions"
        ) from error


def write_whole(files: Mapping[Path, Writer]) -> None:
    """Write all of `files`, or, if one fails, none.

    Raises
    ------
    WriteError
        If a file cannot be written, as on a full disk.
    """
    try:
        whole_files.write_whole(files)
    except OSError as error:
        names = ", ".join(map(str, files))
        raise WriteError(f"{names} could not be written: {error}") from error
