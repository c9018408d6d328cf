"""``standoff automaton``: a pair's modes, switching functions and resets, listed or drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from standoff.automaton.branch_text import branches_mermaid, branches_text
from standoff.automaton.graph import Automaton, automaton
from standoff.automaton.parallel import SolidAutomaton, solid_automaton
from standoff.automaton.text import automaton_mermaid, automaton_text
from standoff.cli.arguments import AutomatonCommand
from standoff.cli.errors import CommandError, ExitCode, MissingExtra
from standoff.cli.output import Writer, check_named, check_target, write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.selection import chosen, target_of
from standoff.cli.terminal import tell
from standoff.recording import Recording
from standoff.scene import Scene, SceneError, TrackSettings, load_scene, prepare, record
from standoff.scene.reader import unknown_name
from standoff.world.shapes import is_solid

ENDINGS = {"text": ".txt", "mermaid": ".mmd", "svg": ".svg"}
"""Each format, and the ending of its files."""

TEXTS: Mapping[str, Callable[[Automaton, tuple[str, str]], str]] = {
    "text": automaton_text,
    "mermaid": automaton_mermaid,
}
BRANCH_TEXTS: Mapping[str, Callable[[SolidAutomaton, tuple[str, str]], str]] = {
    "text": branches_text,
    "mermaid": branches_mermaid,
}


def run_automaton(command: AutomatonCommand) -> int:
    """List or draw the automata of the scene's pairs.

    Raises SceneError, CommandError if the scene, an option or the output file is not usable. Raises
    WriteError if the files could not be written.
    """
    form = _format(command)
    if command.minima is not None and not command.visited:
        raise CommandError(
            "--minima: it says which local minima are followed; add --visited, or leave it out"
        )
    scenes = chosen(load_scene(command.scene), command.pair)
    targets = [target_of(command.output, "-o", scene, scenes) for scene in scenes]
    for target in targets:
        if target is not None:
            check_target(target, "-o", [ENDINGS[form]])
    if form == "svg":
        _check_plotting()
    runs = _runs(scenes, command.minima) if command.visited else []
    automata = _automata(scenes, runs)
    files = {
        target: _writer(form, scene, found)
        for target, scene, found in zip(targets, scenes, automata, strict=True)
        if target is not None
    }
    write_whole(files)
    for target in files:
        tell(f"wrote {target}")
    if not files:
        tell("\n\n".join(_text(form, m, s) for s, m in zip(scenes, automata, strict=True)))
    certified = all(run.certified.all() for run in runs)
    return ExitCode.DONE if certified else ExitCode.NOT_CERTIFIED


def _format(command: AutomatonCommand) -> str:
    """The format that is asked for, by name or by the file's ending."""
    if command.format is None:
        if command.output is None:
            return "text"
        check_named(command.output, "-o")
        ending = command.output.suffix.lower()
        found = next((form for form, known in ENDINGS.items() if known == ending), None)
        if found is None:
            raise CommandError(
                f"-o {command.output}: the ending '{command.output.suffix}' is not known here; "
                f"name a file that ends in {' or '.join(ENDINGS.values())}"
            )
        return found
    if command.format not in ENDINGS:
        raise CommandError(f"--format: {unknown_name(command.format, ENDINGS, 'format')}")
    if command.format == "svg" and command.output is None:
        raise CommandError("--format svg: a picture needs a file; add -o automaton.svg")
    return command.format


def _check_plotting() -> None:
    """Report a missing library before the run."""
    try:
        import standoff.automaton.picture  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name)) from error


def _runs(scenes: tuple[Scene, ...], minima: float | None) -> list[Recording]:
    settings = [_settings(scene, minima) for scene in scenes]
    for scene, each in zip(scenes, settings, strict=True):
        prepare(scene, each)
    with progress_bar() as progress:
        return [record(scene, each, progress) for scene, each in zip(scenes, settings, strict=True)]


def _settings(scene: Scene, minima: float | None) -> TrackSettings:
    """The scene's settings with the command's; a pair with a solid needs its local minima."""
    if minima is None:
        settings = scene.settings
    else:
        try:
            settings = scene.settings.overridden({"minima": minima})
        except SceneError as error:
            raise CommandError(f"--{error.key}: {error.problem}") from error
    if settings.minima is None and any(map(is_solid, scene.pair_shapes)):
        raise CommandError(
            f"--visited: {scene.selected.name} has a solid that need not be convex, and the "
            "automaton of solids follows each local minimum; say up to which distance: add "
            "--minima LENGTH, or minima = LENGTH to the scene's [track]"
        )
    return settings


def _automata(scenes: tuple[Scene, ...], runs: list[Recording]) -> list[Automaton | SolidAutomaton]:
    return [run.automaton() for run in runs] or [_bare(scene) for scene in scenes]


def _bare(scene: Scene) -> Automaton | SolidAutomaton:
    """What a pair's bodies or solids allow."""
    a, b = scene.pair_shapes
    if not (is_solid(a) or is_solid(b)):
        return automaton(*scene.pair_bodies)
    for shape in (a, b):
        if shape.dimension != 3:
            raise SceneError(
                f"{shape.name} is planar, and of solids that need not be convex only those in "
                "space have an automaton",
                key="pair",
                file=scene.file,
            )
    solids: list[Any] = [getattr(shape, "given", shape) for shape in (a, b)]
    return solid_automaton(*solids)


def _text(form: str, found: Automaton | SolidAutomaton, scene: Scene) -> str:
    if isinstance(found, SolidAutomaton):
        return BRANCH_TEXTS[form](found, scene.pair)
    return TEXTS[form](found, scene.pair)


def _writer(form: str, scene: Scene, found: Automaton | SolidAutomaton) -> Writer:
    if form == "svg":
        from standoff.automaton.picture import write_automaton

        title = f"{scene.title}: modes of {scene.pair[0]} and {scene.pair[1]}"
        return lambda file: write_automaton(file, "svg", found, scene.pair, title)

    text = _text(form, found, scene) + "\n"
    return lambda file: file.write(text.encode())
