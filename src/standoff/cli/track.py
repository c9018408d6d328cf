"""``standoff track``: a run over all frames, its summary and its files."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from standoff.cli.arguments import TrackCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import pairs_text, recording_facts
from standoff.cli.output import Writer, check_results, check_target, kind_of_picture, write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.selection import chosen, target_of
from standoff.cli.summary import recording_lines
from standoff.cli.terminal import tell
from standoff.progress import Progress
from standoff.recording import Recording
from standoff.scene import (
    Scene,
    SceneError,
    TrackSettings,
    load_scene,
    prepare,
    record,
)
from standoff.scene.files import toml_tables
from standoff.view.formats import ENDINGS, FILMS, writer_of
from standoff.world.shapes import is_solid


def run_track(command: TrackCommand) -> int:
    """Track, write the files asked for, and print the summary.

    Everything that can be refused is refused before the first frame.

    Raises SceneError, CommandError if the scene, an option or an output file is not usable. Raises
    WriteError if the files could not be written after all.
    """
    whole = load_scene(command.scene)
    if not whole.pairs:
        from standoff.cli.track_world import run_track_world

        return run_track_world(command, whole, settings_of(whole, command))
    scenes = chosen(whole, command.pair)
    runs = [_TrackedRun.of(scene, command, scenes) for scene in scenes]
    for run in runs:
        prepare(run.scene, run.settings)
    for run in runs:
        run.check_files()
    with progress_bar() as progress:
        recordings = [record(run.scene, run.settings, progress) for run in runs]
    done = list(zip(runs, recordings, strict=True))
    with progress_bar("drawing the film") as drawn:
        files = [run.files(told, drawn).items() for run, told in done]
        write_whole({path: write for each in files for path, write in each})
    if command.report.json:
        tell(
            pairs_text(
                whole,
                [
                    recording_facts(run.scene, run.settings, told, run.written())
                    for run, told in done
                ],
            )
        )
    else:
        verbose = command.report.verbose
        texts = [
            "\n".join(recording_lines(run.scene, told, run.written(), verbose=verbose))
            for run, told in done
        ]
        tell("\n\n".join(texts))
    certified = all(recording.certified.all() for recording in recordings)
    return ExitCode.DONE if certified else ExitCode.NOT_CERTIFIED


class _TrackedRun(NamedTuple):
    """One pair to be tracked, and where its results go."""

    scene: Scene
    settings: TrackSettings
    output: Path | None
    plot: Path | None
    export: Path | None

    @classmethod
    def of(cls, scene: Scene, command: TrackCommand, scenes: tuple[Scene, ...]) -> _TrackedRun:
        output = target_of(command.files.output, "-o", scene, scenes)
        plot = target_of(command.files.plot, "--plot", scene, scenes)
        export = target_of(command.files.export, "--export", scene, scenes)
        return cls(scene, settings_of(scene, command), output, plot, export)

    def check_files(self) -> None:
        check_results(self.output, "standoff.recording.file", self.plot, "standoff.recording.plot")
        if self.export is not None:
            check_target(self.export, "--export", ENDINGS)
            if self.export.suffix.lower() in FILMS and any(map(is_solid, self.scene.pair_shapes)):
                raise CommandError(
                    f"--export {self.export}: films draw convex bodies alone, and one body of the "
                    "pair is a solid that need not be; name a file that ends in .html or .rrd"
                )
            try:
                writer_of(self.export)
            except ModuleNotFoundError as error:
                raise CommandError(str(error)) from error

    def files(self, recording: Recording, drawn: Progress) -> dict[Path, Writer]:
        files: dict[Path, Writer] = {}
        if self.output is not None:
            from standoff.recording.file import write_table

            files[self.output] = lambda file: write_table(recording, file)
        if self.plot is not None:
            from standoff.recording.plot import write_plot

            ending = kind_of_picture(self.plot)
            files[self.plot] = lambda file: write_plot(recording, file, ending)
        if self.export is not None:
            write = writer_of(self.export, drawn)
            files[self.export] = lambda file: write(recording, file)
        return files

    def written(self) -> list[Path]:
        return [path for path in (self.output, self.plot, self.export) if path is not None]


def settings_of(scene: Scene, command: TrackCommand) -> TrackSettings:
    """Return the scene's settings with the command's in their place.

    Raises CommandError if an option is not one that a scene could have.
    """
    times = vars(command.times)
    texts = vars(command.options) | vars(command.paper_options) | vars(command.solid_options)
    texts |= {"step": times["step"]}
    given = {name: None if text is None else _value(text) for name, text in texts.items()}
    given |= {"law": command.options.law, "start": times["start"], "duration": times["duration"]}
    try:
        return scene.settings.overridden(given)
    except SceneError as error:
        raise CommandError(f"--{error.key}: {error.problem}") from error


def _value(text: str) -> object:
    """What a scene would read there: a number, a truth value, an inline table, else the text."""
    try:
        return float(text) if not text.lstrip("+-").isdigit() else int(text)
    except ValueError:
        pass
    try:
        return toml_tables(f"value = {text}")["value"]
    except SceneError:
        return text
