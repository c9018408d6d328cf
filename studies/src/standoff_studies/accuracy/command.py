"""``standoff accuracy``: worst and median errors by pair of shapes."""

from __future__ import annotations

import time
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from standoff import __version__
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text
from standoff.cli.output import check_target, make_folder, write_whole
from standoff.cli.progress import progress_shown
from standoff.cli.terminal import tell
from standoff_studies.accuracy import report
from standoff_studies.accuracy.measuring import OURS, Row, measure
from standoff_studies.accuracy.peers.all_peers import all_peers
from standoff_studies.accuracy.peers.answer import Peer, not_installed
from standoff_studies.accuracy.solids import Kind, named

if TYPE_CHECKING:
    from standoff_studies.accuracy.options import AccuracyOptions

WIDTH = 140
"""Width of a table in characters if stdout is not a terminal."""

FILES = ("accuracy.parquet", "accuracy.md", "gaps.md", "depths.md", "accuracy.png")


def run_accuracy(command: AccuracyOptions) -> int:
    """Measure, print the tables, and write the files.

    Raises
    ------
    CommandError
        If a shape, a number or the folder cannot be used, or a library is missing.
    WriteError
        If a file could not be written.
    """
    try:
        kinds = named(command.shapes)
    except ValueError as error:
        raise CommandError(str(error)) from error
    if command.cases < 1:
        raise CommandError(f"--cases {command.cases}: give 1 or more")
    if command.seed < 0:
        raise CommandError(f"--seed {command.seed}: give 0 or more")
    if command.output is not None:
        _check_output(command.output)
    peers = all_peers() if command.peers else ()
    versions = {OURS: __version__, **_versions(peers)}
    started = time.perf_counter()
    rows = _measure(kinds, command, peers)
    run = report.Run(_text(command), command.cases, command.seed, versions, rows)
    written = [] if command.output is None else _write(command.output, run)
    seconds = time.perf_counter() - started
    if command.json:
        facts = {"standoff": __version__, "seconds": seconds, **report.facts(run)}
        tell(json_text({**facts, "files": [str(path) for path in written]}))
    else:
        _print(run, seconds)
        for path in written:
            tell(f"wrote {path}")
    bad = any(row.engine == OURS and row.verdict in ("wrong", "no answer") for row in rows)
    return ExitCode.NOT_CERTIFIED if bad else ExitCode.DONE


def _text(command: AccuracyOptions) -> str:
    """The command that reproduces the same numbers."""
    words = ["standoff accuracy", *(repr(name) for name in command.shapes)]
    words += [f"--cases {command.cases}", f"--seed {command.seed}"]
    return " ".join([*words, "--peers"] if command.peers else words)


def _check_output(folder: Path) -> None:
    make_folder(folder, "-o")
    for name in FILES:
        check_target(folder / name, "-o", [Path(name).suffix])


def _versions(peers: tuple[Peer, ...]) -> dict[str, str]:
    found: dict[str, str] = {}
    for peer in peers:
        try:
            found[peer.package] = peer.version
        except ModuleNotFoundError as error:
            raise CommandError(not_installed(peer.package)) from error
    return found


def _measure(
    kinds: tuple[Kind, ...], command: AccuracyOptions, peers: tuple[Peer, ...]
) -> list[Row]:
    try:
        with progress_shown() as show:
            total, number = len(kinds) * (len(kinds) + 1) // 2, count()

            def tell_of(pair: str) -> None:
                show(next(number), total, f"measuring {pair}")

            return list(measure(kinds, command.cases, command.seed, peers, tell_of))
    except ImportError as error:
        raise CommandError(str(error)) from error


def _write(folder: Path, run: report.Run) -> list[Path]:
    from standoff_studies.accuracy.drawing import draw

    targets = [folder / name for name in FILES]
    parquet, page, gaps, depths, picture = targets
    write_whole(
        {
            parquet: partial(report.write_parquet, run=run),
            page: partial(report.write_page, run=run),
            gaps: partial(report.write_levels, run=run, which="gaps"),
            depths: partial(report.write_levels, run=run, which="depths"),
            picture: partial(draw, rows=run.rows),
        }
    )
    return targets


def _print(run: report.Run, seconds: float) -> None:
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(width=WIDTH, highlight=False)
    pairs = _table("Standoff's worst errors by pair", report.PAIR_HEADER)
    for line in report.pair_rows(run.rows):
        pairs.add_row(*line)
    console.print(pairs)
    engines = _table("Errors by engine, median / worst", report.ENGINE_HEADER)
    for line in report.engine_rows(run.rows, by_level=False):
        engines.add_row(*line)
    console.print(engines)
    tell(f"{len(run.rows)} answers in {seconds:.1f} s; errors over the pair's size, normals in rad")


def _table(title: str, header: tuple[str, ...]) -> Table:
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    for number, heading in enumerate(header):
        table.add_column(heading, justify="left" if number == 0 else "right")
    return table
