"""The folder of a sweep: its lock, its manifest, and its shards, each whole or not there."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from standoff.errors import StandoffError
from standoff.sweep.code import code_facts
from standoff.sweep.digests import digest_of
from standoff.sweep.shard import NotThisShard, read_shard, text_of_shard
from standoff.sweep.work import ShardTotals, ShardWork
from standoff.whole_files import write_whole
from standoff.wording import printable

FORMAT, VERSION = "standoff sweep", 1

MANIFEST, REPORT, SHARDS, LOCK = "manifest.json", "report.json", "shards", ".lock"

SHOWN = 60
"""Longest value that a message about a changed job repeats, in characters."""

Tell = Callable[[str], None]


class FolderError(StandoffError):
    """A folder that cannot be used for a job; the message says why, and what to do."""


def shard_file(folder: Path, k: int) -> Path:
    """Return the file of a shard; sorted by name they are in their order."""
    return folder / SHARDS / f"{k:09d}.json"


def indented(facts: Mapping[str, Any]) -> str:
    """Return strict JSON for readers."""
    return json.dumps(facts, indent=2, allow_nan=False, ensure_ascii=True) + "\n"


def put_text(file: Path, text: str) -> None:
    """Write a file whole, or not at all.

    Raises OSError if it cannot be written, as on a full disk.
    """
    write_whole({file: lambda stream: stream.write(text.encode("utf-8"))})


def manifest_of(work: ShardWork) -> dict[str, Any]:
    """Return what the manifest of a job says."""
    code = code_facts()
    return {
        "format": FORMAT,
        "version": VERSION,
        "job_sha256": work.digest,
        "code_sha256": digest_of(code),
        **work.counts,
        "job": work.facts,
        "code": code,
    }


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder while a sweep runs in it; the lock ends with the process, however that ends.

    Raises FolderError if another process holds it. Raises OSError if the lock's file cannot be
    made.
    """
    try:
        import fcntl
    except ModuleNotFoundError as error:
        raise FolderError(
            "a sweep needs the file locks of POSIX, which this system lacks: run it on Linux or "
            "macOS, or in WSL",
            "folder",
            folder,
        ) from error
    file = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderError(
                f"{_named(folder)}: another sweep runs in this folder; wait until it ends, or name "
                "another folder",
                "folder",
                folder,
            ) from error
        yield
    finally:
        os.close(file)


def refuse_others(folder: Path) -> None:
    """Refuse a folder that holds files and no sweep.

    Raises FolderError.
    """
    if (folder / MANIFEST).exists():
        return
    others = sorted(entry.name for entry in folder.iterdir() if entry.name != LOCK)
    others = [name for name in others if not (name.startswith(".") and name.endswith(".part"))]
    if others:
        raise FolderError(
            f"{_named(folder)}: holds {printable(others[0])} and no sweep; name a new folder",
            "folder",
            folder,
        )


def prepare(folder: Path, work: ShardWork) -> None:
    """Make the folder ready for the job: new, or with shards of the same job and code.

    Call it while the folder is `locked`.

    Raises FolderError if what is there is of another job, or by another version. Raises OSError if
    it cannot be written.
    """
    wanted = manifest_of(work)
    file = folder / MANIFEST
    if file.exists():
        _check_manifest(folder, wanted)
    for left in (*folder.glob(".*.part"), *(folder / SHARDS).glob(".*.part")):
        left.unlink(missing_ok=True)  # of a process that was killed
    if not file.exists():
        put_text(file, indented(wanted))  # first of all: without it, the folder is no sweep's
    (folder / SHARDS).mkdir(exist_ok=True)


def _check_manifest(folder: Path, wanted: dict[str, Any]) -> None:
    file = folder / MANIFEST
    try:
        found = json.loads(file.read_bytes())
        if not isinstance(found, dict) or found["format"] != FORMAT:
            raise ValueError("of another format")
        job, code = found["job"], found["code"]
    except (ValueError, KeyError, TypeError) as error:
        raise FolderError(
            f"{_named(file)}: is not a manifest of a sweep ({error}); name a new folder",
            "folder",
            folder,
        ) from error
    for what, old, new in (("job", job, wanted["job"]), ("library", code, wanted["code"])):
        # As JSON has it: tuples are lists.
        changed = list(_changes(old, json.loads(json.dumps(new))))
        if changed:
            raise FolderError(
                f"{_named(folder)}: was begun by another {what}: {'; '.join(changed)}. Name a new "
                "folder, or put back what was changed",
                "folder",
                folder,
            )


def _changes(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """What differs in plain data, a sentence each."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            below = f"{place}.{key}" if place else str(key)
            yield from _changes(old.get(key), new.get(key), below)
    elif old != new:
        was, now = (printable(_short(value)) for value in (old, new))
        yield f"{printable(place)} was {was} and is {now}"


def _short(value: Any) -> str:
    text = "missing" if value is None else json.dumps(value)
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 1]}…"


def _named(file: Path) -> str:
    return printable(str(file))


def make_shard(work: ShardWork, folder: Path, k: int) -> int:
    """Compute a shard and write its file; returns its number.

    Raises OSError if it cannot be written, as on a full disk: then it is not there.
    """
    text = text_of_shard(work, digest_of(code_facts()), k, work.computed(k))
    put_text(shard_file(folder, k), text)
    return k


def kept_shard(work: ShardWork, folder: Path, k: int) -> ShardTotals | None:
    """Return what a shard's file holds, None where there is none.

    Raises NotThisShard if it is damaged, or of something else.
    """
    try:
        text = shard_file(folder, k).read_bytes()
    except FileNotFoundError:
        return None
    return read_shard(work, digest_of(code_facts()), k, text)


def missing_shards(work: ShardWork, folder: Path, tell: Tell) -> list[int]:
    """Return the numbers of shards that are to be computed; damaged ones are told and removed."""
    missing = []
    for k in range(work.shards):
        try:
            whole = kept_shard(work, folder, k) is not None
        except NotThisShard as error:
            file = shard_file(folder, k)
            tell(f"{_named(file)} cannot be used, {error}: it is computed again")
            os.unlink(file)
            whole = False
        if not whole:
            missing.append(k)
    return missing
