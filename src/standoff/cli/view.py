"""``standoff view``: a scene in the browser."""

from __future__ import annotations

import webbrowser

from standoff.cli.arguments import ViewCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.terminal import tell
from standoff.errors import StandoffError
from standoff.scene import SceneError, load_scene
from standoff.view.gallery import scenes_in


def run_view(command: ViewCommand) -> int:
    """Serve the page until it is interrupted.

    Raises
    ------
    CommandError
        If viser is not installed, or the port is not available.
    SceneError
        If the scene is not usable.
    """
    try:
        from standoff.view.page import Page
    except ModuleNotFoundError as error:
        raise CommandError(str(error)) from error
    scene = load_scene(command.scene)
    if command.pair is not None:
        try:
            scene = scene.select(command.pair)
        except SceneError as error:
            raise CommandError(f"--pair: {error.problem}") from error
    try:
        others = scenes_in(command.gallery or scene.file.parent)
        page = Page(scene, host=command.host, port=command.port, others=others)
    except StandoffError as error:
        raise CommandError(str(error)) from error
    with page:
        tell(f"{scene.title}: open {page.address}")
        tell("The address holds the token of this run. Ctrl+C ends it.")
        if command.open:
            webbrowser.open(page.address)
        try:
            page.wait()
        except KeyboardInterrupt:
            tell("closed")
    return ExitCode.DONE
