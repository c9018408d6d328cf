"""``standoff track``: a run over all frames, its summary and its files."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from standoff.cli.arguments import TrackCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text, recording_facts
from standoff.cli.output import Writer, check_target, write_whole
from standoff.cli.summary import recording_lines
from standoff.scene import (
    Recording,
    Scene,
    SceneError,
    TrackSettings,
    load_scene,
    prepare,
    record,
)
from standoff.scene.settings import SAMPLES
from standoff.tracking import Proximity

TABLE_ENDINGS = (".parquet",)
PLOT_ENDINGS = (".png", ".svg", ".pdf")


def run_track(command: TrackCommand) -> int:
    """Track, write the files asked for, and print the summary.

    Everything that can be refused is refused before the first frame.

    Raises
    ------
    SceneError, CommandError
        If the scene, an option or an output file is not usable.
    WriteError
        If the files could not be written after all.
    """
    scene = load_scene(command.scene)
    settings = _settings(scene, command)
    prepare(scene, settings)
    _check_files(command)
    recording = record(scene, settings, _watch)
    write_whole(_files(command, scene, settings, recording))
    written = [path for path in (command.output, command.plot) if path is not None]
    if command.json:
        print(json_text(recording_facts(scene, settings, recording, written)))
    else:
        print("\n".join(recording_lines(scene, settings, recording, written)))
    return ExitCode.DONE if recording.certified.all() else ExitCode.NOT_CERTIFIED


def _settings(scene: Scene, command: TrackCommand) -> TrackSettings:
    step: object = command.step
    if command.step is not None and command.step != SAMPLES:
        try:
            step = float(command.step)
        except ValueError:
            step = command.step  # refused with the other settings, in the same words
    names = ("law", "predictor", "integrator", "gain", "start", "duration")
    given = {name: getattr(command, name) for name in names} | {"step": step}
    try:
        return scene.settings.overridden(given)
    except SceneError as error:
        raise CommandError(f"--{error.key}: {error.problem}") from error


def _check_files(command: TrackCommand) -> None:
    if command.output is not None:
        check_target(command.output, "-o", TABLE_ENDINGS)
        # Imported now, so that a missing library is told before the run.
        import standoff.cli.parquet
    if command.plot is not None:
        check_target(command.plot, "--plot", PLOT_ENDINGS)
        import standoff.cli.plot  # noqa: F401


def _files(
    command: TrackCommand, scene: Scene, settings: TrackSettings, recording: Recording
) -> dict[Path, Writer]:
    files: dict[Path, Writer] = {}
    if command.output is not None:
        from standoff.cli.parquet import write_table

        files[command.output] = lambda path: write_table(path, scene, settings, recording)
    if command.plot is not None:
        from standoff.cli.plot import write_plot

        ending = command.plot.suffix.lower().removeprefix(".")
        files[command.plot] = lambda path: write_plot(path, ending, scene, recording)
    return files


def _watch(answers: Iterable[Proximity], total: int) -> Iterable[Proximity]:
    """Show a progress bar on stderr where that is a terminal."""
    return _with_bar(answers, total) if sys.stderr.isatty() else answers


def _with_bar(answers: Iterable[Proximity], total: int) -> Iterator[Proximity]:
    with Progress(console=Console(stderr=True), transient=True) as bar:
        # The kernels are compiled before the first answer and kept on disk for later runs.
        task = bar.add_task("starting (the very first run compiles)", total=total)
        for answer in answers:
            bar.update(task, advance=1, description="tracking")
            yield answer
