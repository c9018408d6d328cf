"""``standoff view``: a scene in the browser."""

from __future__ import annotations

import webbrowser
from typing import Any

from standoff.cli.arguments import ViewCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.part_file import check_meshes, parts_of
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.scene import Scene, SceneError, load_scene
from standoff.scene.file_content import is_simulation
from standoff.scene.part_files import ENDINGS
from standoff.view.gallery import scenes_in
from standoff.view.minima_asked import MinimaAsked
from standoff.view.moving_world import MovingWorld, moving_world
from standoff.view.opening import Shown, has_solids, of_scene, page_of, simulation_of
from standoff.world import World


def run_view(command: ViewCommand) -> int:
    """Serve the page until it is interrupted.

    Raises CommandError if viser is not installed, or the port is not available. Raises SceneError
    if the scene is not usable.
    """
    check_meshes(command.scene, command.meshes)
    if command.scene.suffix.lower() in ENDINGS:
        return _serve(command, *_file(command))
    if is_simulation(command.scene):
        return _serve(command, *_simulation(command))
    scene = load_scene(command.scene)
    what: Scene | MovingWorld = scene
    if command.pair is not None:
        try:
            what = scene.select(command.pair)
        except SceneError as error:
            raise CommandError(f"--pair: {error.problem}") from error
    else:
        what = of_scene(scene)
    if command.gallery is not None and not isinstance(what, Scene):
        raise CommandError(
            "--gallery: the page of a world opens no other scenes; leave it out, or name a --pair"
        )
    solids = isinstance(what, Scene) and has_solids(what)
    if command.gallery is not None and solids:
        raise CommandError("--gallery: the page of solids opens no other scenes; leave it out")
    for option, given in (("--minima", command.minima), ("--patch", command.patch)):
        if given is not None and not solids:
            raise CommandError(f"{option}: it is for a pair with a solid that need not be convex")
    asked = MinimaAsked(command.minima, command.patch)
    others = scenes_in(command.gallery or scene.file.parent)
    return _serve(command, what, scene.title, {"others": others, "asked": asked})


def _file(command: ViewCommand) -> tuple[Shown, str, dict[str, Any]]:
    """The parts of a file where it has them, and its name."""
    for name in ("pair", "gallery", "minima", "patch"):
        if getattr(command, name) is not None:
            raise CommandError(f"--{name}: the page of a file shows all its parts; leave it out")
    parts = parts_of(command.scene, command.meshes)
    for note in (*parts.notes, *parts.refusals):
        tell(note)
    shapes = {name: part.shape for name, part in parts.found.items()}
    places = {name: part.pose for name, part in parts.found.items()}
    world = moving_world(World(shapes), places)
    return world._replace(title=command.scene.name, unit=parts.unit), command.scene.name, {}


def _simulation(command: ViewCommand) -> tuple[Shown, str, dict[str, Any]]:
    """A simulation that has been run, and its title."""
    for name in ("pair", "gallery", "minima", "patch"):
        if getattr(command, name) is not None:
            raise CommandError(
                f"--{name}: the page of a simulation shows all its bodies and contacts, and opens "
                "no other scenes; leave it out"
            )
    with progress_bar("simulating") as progress:
        given = simulation_of(command.scene, progress)
    return given, given.title, {}


def _serve(command: ViewCommand, what: Shown, title: str, given: dict[str, Any]) -> int:
    """Serve a page until it is interrupted."""
    try:
        page = page_of(what, host=command.host, port=command.port, **given)
    except (ModuleNotFoundError, StandoffError) as error:
        raise CommandError(str(error)) from error
    with page:
        tell(f"{title}: open {page.address}")
        tell("The address holds the token of this run. Ctrl+C ends it.")
        if command.open:
            webbrowser.open(page.address)
        try:
            page.wait()
        except KeyboardInterrupt:
            tell("closed")
    return ExitCode.DONE
