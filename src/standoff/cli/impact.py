"""``standoff impact``: the first time at which a pair comes to a clearance."""

from __future__ import annotations

import math

from standoff.cli.arguments import ImpactCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import impact_facts, pairs_text
from standoff.cli.selection import chosen
from standoff.cli.summary import impact_lines
from standoff.cli.terminal import tell
from standoff.impact import Impact, ImpactStatus
from standoff.scene import Scene, SceneError, first_impact, load_scene


def run_impact(command: ImpactCommand) -> int:
    """Print the pairs' times of impact; the exit code says whether all are decided.

    Raises SceneError, CommandError if the scene or an option is not usable.
    """
    whole = load_scene(command.scene)
    scenes = chosen(whole, command.pair)
    # All are asked before any is told: a pair that is refused ends the command.
    told = [(scene, _found(scene, command)) for scene in scenes]
    if command.report.json:
        tell(pairs_text(whole, [impact_facts(*found) for found in told]))
    else:
        verbose = command.report.verbose
        texts = ["\n".join(impact_lines(*found, verbose=verbose)) for found in told]
        tell("\n\n".join(texts))
    decided = all(found.status is not ImpactStatus.UNDECIDED for _, found in told)
    return ExitCode.DONE if decided else ExitCode.NOT_CERTIFIED


def _found(scene: Scene, command: ImpactCommand) -> Impact:
    given = vars(command.times)
    try:
        settings = scene.settings.overridden(given)
    except SceneError as error:
        raise CommandError(f"--{error.key}: {error.problem}") from error
    if not 0.0 <= command.clearance < math.inf:
        raise CommandError(f"--clearance: must be zero or more and finite, got {command.clearance}")
    try:
        return first_impact(scene, settings, command.clearance)
    except SceneError as error:
        option = error.key.removeprefix("track.")
        if given.get(option) is None:
            raise
        raise CommandError(f"--{option}: {error.problem}") from error
