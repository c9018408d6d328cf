"""``standoff warmup``: all kernels compiled ahead."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from standoff import __version__
from standoff.cli.arguments import WarmupCommand
from standoff.cli.errors import ExitCode
from standoff.cli.facts import json_text
from standoff.cli.progress import progress_shown
from standoff.cli.terminal import tell
from standoff.kernels.compiler.entry import Entry
from standoff.kernels.compiler.notices import WORK, parts, told_elsewhere
from standoff.kernels.entries.preparing import every_entry, kept_in, name_of, was_compiled


class Ready(NamedTuple):
    """What became of an entry."""

    name: str
    what: str
    seconds: float
    compiled: bool
    error: str = ""

    @property
    def how(self) -> str:
        if self.error:
            return "failed"
        return "compiled" if self.compiled else "loaded"


def run_warmup(command: WarmupCommand) -> int:
    """Load or compile every entry, and report each when it is done."""
    entries = list(every_entry())
    done: list[Ready] = []
    started = time.perf_counter()
    try:
        with told_elsewhere(), progress_shown() as show:
            for number, entry in enumerate(parts(entries), 1):
                show(number - 1, len(entries), f"{name_of(entry)}, {WORK[entry.work].what}")
                done.append(_ready(entry))
                _tell(done[-1], f"{number}/{len(entries)}", command.json)
    except KeyboardInterrupt:
        tell(
            f"standoff: interrupted after {len(done)} of {len(entries)}; these need not be "
            "compiled again",
            error=True,
        )
        return ExitCode.INTERRUPTED
    ready = [entry for entry in entries if entry.ready]
    folder = kept_in(ready[-1]) if ready else None
    tell(_json(done, folder, started) if command.json else _total(done, folder, started))
    return _ended(done, folder)


def _ready(entry: Entry) -> Ready:
    started = time.perf_counter()
    error = ""
    try:
        entry.prepare()
    except Exception as raised:  # whatever Numba or LLVM raises: the others are tried all the same
        error = f"{type(raised).__name__}: {raised}"
    seconds = time.perf_counter() - started
    compiled = entry.ready and was_compiled(entry)
    return Ready(name_of(entry), WORK[entry.work].what, seconds, compiled, error)


def _tell(one: Ready, place: str, to_stderr: bool) -> None:
    name = one.name.rpartition(".")[2]
    line = f"{place:>5} {one.seconds:6.2f} s  {one.how:<8}  {name}: {one.what}"
    tell(line, error=to_stderr)


def _total(done: Sequence[Ready], folder: Path | None, started: float) -> str:
    if not done:
        return "nothing to compile: NUMBA_DISABLE_JIT=1 runs the kernels as plain Python"
    count = {how: sum(one.how == how for one in done) for how in ("compiled", "loaded")}
    seconds = time.perf_counter() - started
    kept = "kept nowhere" if folder is None else f"kept in {folder}"
    return (
        f"{count['compiled']} compiled, {count['loaded']} loaded, in {seconds:.1f} s; "
        f"what is compiled is {kept}"
    )


def _json(done: Sequence[Ready], folder: Path | None, started: float) -> str:
    return json_text(
        {
            "standoff": __version__,
            "seconds": time.perf_counter() - started,
            "folder": None if folder is None else str(folder),
            "entries": [one._asdict() | {"error": one.error or None} for one in done],
        }
    )


def _ended(done: Sequence[Ready], folder: Path | None) -> ExitCode:
    failed = [one for one in done if one.error]
    for one in failed:
        tell(f"standoff: {one.name} could not be compiled: {one.error}", error=True)
    if failed:
        return ExitCode.NOT_COMPILED
    if folder is None and any(one.compiled for one in done):
        tell(
            "standoff: the machine code could not be kept: name a folder of your own in "
            "NUMBA_CACHE_DIR",
            error=True,
        )
        return ExitCode.NOT_WRITTEN
    return ExitCode.DONE
