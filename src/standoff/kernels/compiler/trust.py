"""Which folders are safe to take machine code from: Numba unpickles it, and it is run."""

from __future__ import annotations

import os
import stat
from pathlib import Path

HERE = Path(__file__).parent


def others_can_write(folder: Path) -> str | None:
    """Why a folder is not safe from other users, or None.

    It, and each folder above it, must belong to this user or to root, or to the owner of the
    package, and nobody else may write to it; a folder where users may delete only their own files
    (sticky, such as the system's temporary one) is safe as a parent.
    """
    if os.name != "posix":
        return None  # Windows: the rights of a user's own folders are inherited
    trusted = {0, os.getuid(), HERE.stat().st_uid}
    for level, each in enumerate((folder, *folder.parents)):
        try:
            state = each.stat()
        except OSError:
            continue
        if state.st_uid not in trusted:
            return f"{each} belongs to another user (uid {state.st_uid})"
        shared = state.st_mode & stat.S_IWOTH or (
            state.st_mode & stat.S_IWGRP and not _own_group(state.st_gid)
        )
        if shared and not (level > 0 and state.st_mode & stat.S_ISVTX):
            return f"other users can write to {each}"
    return None


def _own_group(gid: int) -> bool:
    """Is a group that of this user alone?"""
    import grp
    import pwd

    try:
        user = pwd.getpwuid(os.getuid())
        return gid == user.pw_gid and set(grp.getgrgid(gid).gr_mem) <= {user.pw_name}
    except KeyError:
        return False
