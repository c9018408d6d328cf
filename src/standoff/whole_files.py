"""Files that are written whole or not at all: the one place where this package writes any."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import BinaryIO

from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError, StandoffTypeError

Writer = Callable[[BinaryIO], object]
"""Writes the content of one file to the stream that it is given."""

KINDS: Mapping[Callable[[int], bool], str] = {
    stat.S_ISREG: "a file",
    stat.S_ISDIR: "a folder",
    stat.S_ISFIFO: "a FIFO",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a character device",
    stat.S_ISBLK: "a block device",
}


class UnfitTarget(OSError):
    """Not a regular file, and none can be made; the message names the target, why, and the fix."""


class MissingFolder(UnfitTarget, FileNotFoundError):
    """The folder of a target does not exist."""


def file_name(given: object) -> Path:
    """Return the path of a file to be written.

    Raises TypeError if it is neither a string nor a path. Raises ValueError if it is empty.
    """
    if not isinstance(given, str | Path):
        raise StandoffTypeError(
            f"path is {shown(given)}: give a file name, as a string or a Path.", "path", given
        )
    if given == "":
        raise StandoffError(
            "path is '': an empty string is not a file name; give a name, or leave it out.",
            "path",
            given,
        )
    return Path(given)


def kind_of(mode: int) -> str:
    """Return what `st_mode` says it is."""
    return next((name for test, name in KINDS.items() if test(mode)), "of an unknown kind")


def destination(target: Path) -> Path:
    """Return the regular file that is, or will be, written under a name: the end of its links.

    Raises UnfitTarget if it is something else, such as a folder, a FIFO or a device; if its folder
    does not exist; if no file can have the name. Raises OSError if the system cannot tell, as where
    links go in a circle.
    """
    try:
        mode = target.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return _new(target)
    except ValueError as error:  # a null character, or half of a surrogate pair
        raise UnfitTarget(f"{shown(str(target))} is not a file name: {error}") from error
    if not stat.S_ISREG(mode):
        cure = "a file in it" if stat.S_ISDIR(mode) else "a regular file or a new one"
        raise UnfitTarget(f"{target}: is {kind_of(mode)}; name {cure}")
    return Path(os.path.realpath(target))


def _new(target: Path) -> Path:
    end = Path(os.path.realpath(target))
    folder = end.parent if target.is_symlink() else target.parent
    if not folder.exists():
        raise MissingFolder(
            f"{target}: the folder {folder} does not exist; create it or name another"
        )
    if not folder.is_dir():
        kind = kind_of(folder.stat().st_mode)
        raise UnfitTarget(f"{target}: {folder} is {kind}, not a folder; name a folder")
    return end


def write_whole(files: Mapping[Path, Writer]) -> None:
    """Write all of `files`, or, if one fails, none.

    Each is written beside its destination under a temporary name and then moved onto it, so a
    reader sees the old file or the new one. A link is kept: the file that it leads to is replaced.
    The new file gets the permissions of the old one.

    Raises UnfitTarget if a target is neither a regular file nor new, or two of them lead to one
    file. Raises OSError if a file cannot be written, as on a full disk.
    """
    staged: dict[Path, Path] = {}
    try:
        ends = _ends(files)
        for end, write in ends.items():
            # A short name: the target's own may be as long as the file system allows.
            staged[end] = end.with_name(f".{secrets.token_hex(8)}.part")
            with staged[end].open("xb") as file:
                write(file)
            if end.exists():
                staged[end].chmod(stat.S_IMODE(end.stat().st_mode))
        for end, written in staged.items():
            os.replace(written, end)
    finally:
        for written in staged.values():
            written.unlink(missing_ok=True)


def _ends(files: Mapping[Path, Writer]) -> dict[Path, Writer]:
    """What writes each destination."""
    ends: dict[Path, Writer] = {}
    for target, write in files.items():
        end = destination(target)
        if end in ends:
            raise UnfitTarget(f"{target}: another of the files to write is {end} too; name two")
        ends[end] = write
    return ends
