"""``standoff clearance``: what is proven of all pairs of a scene's bodies."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from standoff.cad.files import is_cad_file
from standoff.clearance.facts import report_facts
from standoff.clearance.fits import load_fits
from standoff.clearance.over_time import bounds_over, walk
from standoff.clearance.report import Looked, Report, Wanted, bounds_of, nearest_of, report_on
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.clearance_files import check_files, files_of
from standoff.cli.clearance_lines import print_report
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text, world_facts
from standoff.cli.output import write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.scene import Scene, SceneError, load_scene
from standoff.scene.reader import Array
from standoff.world import World


def run_clearance(command: ClearanceCommand) -> int:
    """Print the clearance of all pairs; the exit code says whether all that is asked is proven.

    Raises
    ------
    SceneError, CommandError
        If the scene, an option or a file is not usable.
    WriteError
        If the files could not be written after all.
    """
    _check(command)
    if is_cad_file(command.scene):
        from standoff.cli.clearance_assembly import run_on_assembly

        return run_on_assembly(command)
    scene = load_scene(command.scene).as_world
    wanted = Wanted(command.min, None if command.allow is None else load_fits(command.allow))
    times = scene.times() if command.motion else None
    world = scene.world_with(_horizon(command, scene), times=times)
    check_files(command)
    report, looked = _looked(command, scene, world, wanted, times)
    write_whole(files_of(command, scene, report, looked))
    written = [path for path in (command.files.page, command.files.plot) if path is not None]
    if command.report.json:
        tell(json_text(_facts(scene, report, looked, written)))
    else:
        print_report(scene, report, looked, written, verbose=command.report.verbose)
    return ExitCode.NOT_CERTIFIED if report.failures else ExitCode.DONE


def _check(command: ClearanceCommand) -> None:
    """Refuse numbers that are none, and options that do not go together.

    Raises
    ------
    CommandError
    """
    if command.min is not None and not 0.0 <= command.min < math.inf:
        raise CommandError(f"--min: must be zero or more and finite, got {command.min}")
    if command.within is not None and not command.within > 0.0:
        raise CommandError(f"--within: must be above zero, got {command.within}")
    if command.motion and command.time is not None:
        raise CommandError("--time and --motion: give one of them, an instant or all frames")


def _horizon(command: ClearanceCommand, scene: Scene) -> float | None:
    """The horizon that is asked for, or the scene's; no less than what every pair must keep."""
    own = math.inf if scene.rules is None else scene.rules.within
    within = own if command.within is None else command.within
    return within if command.min is None else max(within, command.min)


def _looked(
    command: ClearanceCommand, scene: Scene, world: World, wanted: Wanted, times: Array | None
) -> tuple[Report, Looked]:
    try:
        if times is not None:
            with progress_bar() as progress:
                walked = walk(scene, world, times, progress)
            bounds = bounds_over(world, walked.near)
            looked = Looked(float(times[0]), float(times[-1]), len(times))
            return report_on(world, walked.near, bounds, wanted), looked
        time = scene.instant(command.time)
        answer = world.distances(scene.poses(world, time))
    except SceneError as error:
        if command.time is not None and error.key == "time":
            raise CommandError(f"--time: {error.problem}") from error
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="world", file=scene.file) from error
    near = nearest_of(answer, time)
    return report_on(world, near, bounds_of(world, answer, near), wanted), Looked(time, time, 1)


def _facts(scene: Scene, report: Report, looked: Looked, written: list[Path]) -> dict[str, Any]:
    return (
        world_facts(scene)
        | {"start": looked.start, "end": looked.end, "frames": looked.frames}
        | report_facts(report)
        | {"files": [str(path) for path in written]}
    )
