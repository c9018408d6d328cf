"""``standoff soak``: long random runs that check every answer, and their failures' files."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from standoff.cli.errors import CommandError, ExitCode, MissingExtra, WriteError
from standoff.cli.facts import json_text
from standoff.cli.output import check_target, make_folder, write_whole
from standoff.cli.progress import progress_shown
from standoff.cli.terminal import tell
from standoff_studies.soak.certificates import run_certificates
from standoff_studies.soak.failures import Facts, read_failure, replay
from standoff_studies.soak.ledger import NAME, Ledger
from standoff_studies.soak.processes import Done, Tell, soak
from standoff_studies.soak.reading import written
from standoff_studies.soak.shapes import missing_library
from standoff_studies.soak.worlds import run_worlds

if TYPE_CHECKING:
    from standoff_studies.soak.options import SoakOptions

JOBS = 2
"""Default number of processes."""

FAILURE = "failure-{}.json"

SAVE_EVERY = 5.0
"""Seconds between two writes of the ledger."""


def run_soak(command: SoakOptions) -> int:
    """Run a soak, or rerun a failure, and print the counts.

    Raises
    ------
    CommandError
        If a number, the folder or the file cannot be used.
    WriteError
        If the ledger or a failure could not be written.
    """
    missing = missing_library()
    if missing:
        raise MissingExtra(missing, "formulas")
    if command.replay is not None:
        return _replay(command.replay)
    jobs = JOBS if command.jobs is None else command.jobs
    for name, value in (("pairs", command.pairs), ("frames", command.frames), ("jobs", jobs)):
        if value < 1:
            raise CommandError(f"--{name} {value}: give 1 or more")
    if command.seed < 0:
        raise CommandError(f"--seed {command.seed}: give 0 or more")
    if command.certificates is not None:
        return run_certificates(command.certificates, command.seed, command.output, command.json)
    if command.worlds is not None:
        return run_worlds(
            command.worlds, command.seed, command.frames, command.output, command.json
        )
    ledger = _ledger(command)
    started, before = time.perf_counter(), ledger.pairs_done()
    try:
        with progress_shown() as show:

            def tell_of(done: Done) -> None:
                million = ledger.tally.sums["certified"] / 1e6
                show(ledger.pairs_done(), command.pairs, f"{million:.1f} million certified")

            saver = _Saver(ledger, command.output, tell_of)
            failed = soak(ledger, command.pairs, jobs, saver.hear)
    except KeyboardInterrupt:
        _save(ledger, command.output)
        again = f"go on with --resume -o {command.output}"
        tell(f"standoff: interrupted at {ledger.pairs_done()} pairs; {again}", error=True)
        return ExitCode.INTERRUPTED
    _save(ledger, command.output)
    file = _write_failure(failed, command.output) if failed is not None else None
    if command.json:
        tell(json_text(ledger.facts() | {"failure": None if file is None else str(file)}))
    else:
        _print(ledger, time.perf_counter() - started, ledger.pairs_done() - before)
    if failed is not None:
        tell(f"standoff: {_told(failed.facts or {})}; {file} reproduces it", error=True)
        return ExitCode.FAILED
    return ExitCode.DONE


def _ledger(command: SoakOptions) -> Ledger:
    folder = command.output
    make_folder(folder, "-o")
    check_target(folder / NAME, "-o", [".json"])
    there = (folder / NAME).exists()
    if there and not command.resume:
        raise CommandError(
            f"-o {folder}: holds a soak already; go on with it by --resume, or name another folder"
        )
    if not there:
        return Ledger(command.seed, command.frames)
    try:
        return Ledger.read(folder, command.seed, command.frames)
    except (OSError, ValueError) as error:
        raise CommandError(f"--resume: {error}") from error


class _Saver:
    """Writes the ledger regularly, and shows the progress of the run."""

    def __init__(self, ledger: Ledger, folder: Path, show: Tell) -> None:
        self.ledger, self.folder, self.show = ledger, folder, show
        self.saved = time.monotonic()

    def hear(self, done: Done) -> None:
        self.show(done)
        if time.monotonic() - self.saved > SAVE_EVERY:
            _save(self.ledger, self.folder)
            self.saved = time.monotonic()


def _save(ledger: Ledger, folder: Path) -> None:
    try:
        ledger.write(folder)
    except OSError as error:
        raise WriteError(f"{folder / NAME} could not be written: {error}") from error


def _write_failure(failed: Done, folder: Path) -> Path:
    file = folder / FAILURE.format(failed.failed)
    write_whole({file: written(failed.facts or {})})
    return file


def _print(ledger: Ledger, seconds: float, pairs: int) -> None:
    tally = ledger.tally
    rate = f" ({pairs} of them in {seconds:.1f} s)" if pairs else ""
    tell(f"seed {ledger.seed}: {ledger.pairs_done()} pairs of {ledger.frames} frames{rate}")
    for line in tally.lines():
        tell(line)
    for pair, frame, status, names, distance in tally.examples:
        tell(f"pair {pair} frame {frame}: {status}, {names}, distance {distance}")


def _told(facts: Facts) -> str:
    if "round" in facts:
        return (
            f"round {facts['round']['number']} of the adversary failed: {facts['what']} "
            f"({facts['value']} where {facts['allowed']} is allowed)"
        )
    if "world" in facts:
        return f"world {facts['world']['number']} failed: {facts['what']}"
    if "case" not in facts:
        last = str(facts["what"]).strip().splitlines()[-1]
        return f"pair {facts['number']} failed: {last}"
    query = "a cold query at" if facts["cold"] else "at"
    return (
        f"pair {facts['case']['number']} failed {query} frame {facts['frame']}: {facts['what']} "
        f"({facts['value']} where {facts['allowed']} is allowed)"
    )


def _replay(file: Path) -> int:
    try:
        facts = read_failure(file)
        again = replay(facts)
    except OSError as error:
        raise CommandError(f"--replay {file}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise CommandError(f"--replay {file}: {error}") from error
    tell(f"the file says: {_told(facts)}")
    if again.breach is not None:
        miss = again.breach.miss
        tell(f"now the round fails: {miss.what} ({miss.value} where {miss.allowed} is allowed)")
    elif "round" in facts:
        tell("now no check of the round fails")
    elif again.world is not None:
        what, frame = again.world.what, again.world.frame
        tell(f"now the world fails at frame {frame}: {what} ({again.world.value})")
    elif "world" in facts:
        tell("now no check of the world fails")
    elif again.failure is not None:
        fault, query = again.failure.fault, "cold " if again.failure.cold else ""
        tell(
            f"now the pair fails at {query}frame {fault.frame}: {fault.what} ({fault.value} where "
            f"{fault.allowed} is allowed)"
        )
    else:
        tell("now no check of the pair fails")
    if again.step is not None:
        tell(f"the step alone, from the file's state, fails: {again.step.what}")
    failed = any(one is not None for one in again)
    return ExitCode.FAILED if failed else ExitCode.DONE
