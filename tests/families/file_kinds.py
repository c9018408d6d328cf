"""What may stand at a path and is not a regular file."""

from __future__ import annotations

import contextlib
import os
import socket
import stat
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

NULL_DEVICE = (1, 3)
"""Major and minor number of Linux's null device: a node of its own, never the machine's."""


def _socket(path: Path) -> None:
    with contextlib.chdir(path.parent), socket.socket(socket.AF_UNIX) as end:
        end.bind(path.name)  # the name alone: a socket's path must be short


def _device(path: Path) -> None:
    os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(*NULL_DEVICE))


MAKERS: Mapping[str, Callable[[Path], None]] = {
    "folder": Path.mkdir,
    "FIFO": lambda path: os.mkfifo(path),
    "socket": _socket,
    "character device": _device,
}
"""By the word that a message has for it."""


def make(kind: str, path: Path) -> None:
    """Make one; the test is skipped where the system or the user cannot."""
    try:
        MAKERS[kind](path)
    except (AttributeError, PermissionError) as error:
        pytest.skip(f"no {kind} can be made here: {error}")


def link(path: Path, to: Path | str) -> None:
    """Make a symbolic link; the test is skipped where the system or the user cannot."""
    try:
        path.symlink_to(to)
    except (NotImplementedError, OSError) as error:
        pytest.skip(f"no link can be made here: {error}")


def looks(path: Path) -> tuple[int, int]:
    """What `path` itself is, and which: a replaced one differs."""
    found = path.lstat()
    return stat.S_IFMT(found.st_mode), found.st_ino
