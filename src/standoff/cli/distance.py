"""``standoff distance``: one cold query."""

from __future__ import annotations

from standoff.cli.arguments import DistanceCommand
from standoff.cli.errors import ExitCode
from standoff.cli.facts import answer_facts, pairs_text
from standoff.cli.selection import chosen
from standoff.cli.summary import answer_lines
from standoff.cli.terminal import tell
from standoff.scene import load_scene, query


def run_distance(command: DistanceCommand) -> int:
    """Print the pairs' certified distances at one instant; the exit code says whether they are
    certified.

    Raises SceneError if the scene, or the instant, is not usable.
    """
    whole = load_scene(command.scene)
    scenes = chosen(whole, command.pair)
    # All are asked before any is told: a pair that is refused ends the command.
    answers = [query(scene, command.time) for scene in scenes]
    told = list(zip(scenes, answers, strict=True))
    if command.report.json:
        tell(pairs_text(whole, [answer_facts(scene, *answer) for scene, answer in told]))
    else:
        verbose = command.report.verbose
        texts = ["\n".join(answer_lines(scene, *answer, verbose=verbose)) for scene, answer in told]
        tell("\n\n".join(texts))
    certified = all(answer.certified for _, answer in answers)
    return ExitCode.DONE if certified else ExitCode.NOT_CERTIFIED
