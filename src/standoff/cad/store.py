"""Finished parts of CAD files on disk, so that a file is read once.

A file of the store is named by the digest of all that its content follows from: the bytes read, the
options, and the code that reads. It begins with a digest of itself, which reading compares. Python
unpickles what it holds: a folder that other users can write to is refused, as for machine code.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from standoff.cad.limits import STALE, STORE_MEGABYTES, TRIMMED_TO
from standoff.checks.real_numbers import shown
from standoff.errors import StandoffError
from standoff.kernels.compiler.notices import say
from standoff.kernels.compiler.trust import others_can_write
from standoff.version import __version__
from standoff.whole_files import write_whole

FOLDER, SIZE = "STANDOFF_CACHE_DIR", "STANDOFF_CACHE_SIZE"
"""Environment variables: where the store is, and how many megabytes it may have; 0: there is none.
"""

START = b"standoff part 1\n"
"""Of each file, with the number of the format."""

ENDING = ".part"
LIBRARY = Path(__file__).parents[1]
READERS = ("bodies", "cad", "checks", "geometry", "kernels", "motion", "solids")
"""Packages that a finished part follows from."""


class StoredFile(NamedTuple):
    """A file of the store, its size in bytes, and when it was used last, s."""

    file: Path
    size: int
    used: float


def folder() -> Path:
    """Where the store is: what STANDOFF_CACHE_DIR or NUMBA_CACHE_DIR name, or else the user's.

    Raises OSError: they name none, and the user has no home.
    """
    if named := os.environ.get(FOLDER):
        return Path(named)
    if named := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(named) / "parts"
    try:
        home = Path.home()
    except RuntimeError as error:
        raise FileNotFoundError(f"{error} Name a folder in {FOLDER}.") from error
    if sys.platform == "win32":
        caches = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        caches = home / "Library" / "Caches"
    else:
        caches = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return caches / "standoff" / "parts"


def most_bytes() -> int:
    """How large the store may be; 0: it is not used.

    Raises StandoffError: STANDOFF_CACHE_SIZE is no number, or below zero.
    """
    given = os.environ.get(SIZE, str(STORE_MEGABYTES))
    try:
        return int(1e6 * _not_below_zero(float(given)))
    except (ValueError, OverflowError) as error:
        raise StandoffError(
            f"{SIZE} = {shown(given)}: give a number of megabytes; 0 keeps nothing.", SIZE, given
        ) from error


def _not_below_zero(number: float) -> float:
    if not number >= 0.0:
        raise ValueError
    return number


@lru_cache(maxsize=1)
def code_digest() -> bytes:
    """Of all that reads parts: the library's sources, and the versions of what it uses."""
    spec = find_spec("OCP")
    origin = None if spec is None or spec.origin is None else Path(spec.origin)
    theirs = None if origin is None else (str(origin), origin.stat().st_mtime_ns)
    used = (__version__, sys.version_info[:2], np.__version__, theirs)
    digest = hashlib.sha256(START + repr(used).encode())
    for package in READERS:
        for source in sorted((LIBRARY / package).rglob("*.py")):
            name = source.relative_to(LIBRARY).as_posix()
            digest.update(name.encode() + b"\0" + source.read_bytes())
    return digest.digest()


def key_of(content: bytes, *given: Any) -> str:
    """The name of what follows from some bytes and from options."""
    digest = hashlib.sha256(code_digest() + repr(given).encode() + b"\0")
    digest.update(content)
    return digest.hexdigest()


def taken(key: str) -> bytes | None:
    """What the store has under a name; None where it has nothing, or that is damaged."""
    if not _usable():
        return None
    file = folder() / (key + ENDING)
    try:
        kept = file.read_bytes()
    except OSError:
        return None
    content = kept[len(START) + 32 :]
    if kept[: len(START) + 32] != START + _seal(key, content):
        say(f"{file}: damaged, or changed by hand; it is made again.")
        with suppress(OSError):
            file.unlink()
        return None
    with suppress(OSError):  # what can't be marked as used goes earlier
        os.utime(file)
    return content


def put(key: str, content: bytes) -> None:
    """Keep something under a name, whole or not at all; where that fails, one line says so."""
    if not _usable():
        return
    if len(content) > most_bytes():
        _unkept(f"a part has {len(content) / 1e6:.0f} MB, {SIZE} allows {most_bytes() / 1e6:g}")
        return
    file = folder() / (key + ENDING)
    try:
        write_whole({file: lambda stream: stream.write(START + _seal(key, content) + content)})
    except OSError as error:
        _unkept(str(error))


def _seal(key: str, content: bytes) -> bytes:
    return hashlib.sha256(key.encode() + content).digest()


def entries() -> list[StoredFile]:
    """The files of the store, those used last at the end."""
    return sorted((e for e in _listed() if not _written(e)), key=lambda entry: entry.used)


def _listed() -> Iterator[StoredFile]:
    with suppress(OSError), os.scandir(folder()) as found:
        for each in found:
            with suppress(OSError):  # another program removed it
                if each.name.endswith(ENDING) and each.is_file(follow_symlinks=False):
                    state = each.stat()
                    yield StoredFile(Path(each.path), state.st_size, state.st_mtime)


def _written(entry: StoredFile) -> bool:
    """Is it a file that `write_whole` has not finished?"""
    return entry.file.name.startswith(".")


def trim() -> None:
    """Remove what was used longest ago until the store is within its size, and what writers that
    were killed left."""
    if not _usable():
        return
    kept, old = entries(), time.time() - STALE
    left, most = sum(entry.size for entry in kept), most_bytes()
    gone = [entry for entry in _listed() if _written(entry) and entry.used < old]
    for entry in kept if left > most else ():
        if left <= TRIMMED_TO * most:
            break
        gone.append(entry)
        left -= entry.size
    for entry in gone:
        with suppress(OSError):  # another program's, or open elsewhere on Windows
            entry.file.unlink()


def clear() -> int:
    """Remove all files of the store; returns how many. Raises OSError where one can't be."""
    found = entries()
    for entry in found:
        entry.file.unlink(missing_ok=True)
    return len(found)


def _usable() -> bool:
    if not most_bytes():
        return False
    try:
        folder().mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError as error:
        _unkept(str(error))
        return False
    why = others_can_write(folder().resolve())
    if why is not None:
        _refuse(str(folder()), why)
    return why is None


@lru_cache(maxsize=16)
def _refuse(where: str, why: str) -> None:
    say(
        f"not using the store of parts {where}: {why}, and what is in it would be run. Remove that "
        f"permission (chmod go-w), or name another folder in {FOLDER}."
    )


@lru_cache(maxsize=1)
def _unkept(why: str) -> None:
    say(f"finished parts could not be kept ({why}): each reading makes them again.")
