"""``standoff distance``: one cold query."""

from __future__ import annotations

from standoff.cli.arguments import DistanceCommand
from standoff.cli.errors import ExitCode
from standoff.cli.facts import answer_facts, json_text
from standoff.cli.summary import answer_lines
from standoff.scene import load_scene, query


def run_distance(command: DistanceCommand) -> int:
    """Print the certified distance at one instant; the exit code says whether it is certified.

    Raises
    ------
    SceneError
        If the scene, or the instant, is not usable.
    """
    scene = load_scene(command.scene)
    time, answer = query(scene, command.time)
    if command.json:
        print(json_text(answer_facts(scene, time, answer)))
    else:
        print("\n".join(answer_lines(scene, time, answer)))
    return ExitCode.DONE if answer.certified else ExitCode.NOT_CERTIFIED
