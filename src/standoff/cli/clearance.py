"""``standoff clearance``: what is proven of all pairs of a scene's bodies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from standoff.clearance.checked_pairs import check, narrowed
from standoff.clearance.facts import report_facts
from standoff.clearance.over_time import bounds_over, walk
from standoff.clearance.report import Instants, Report, Wanted, report_on
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.check_cad import no_cad_file
from standoff.cli.clearance_files import check_files, files_of
from standoff.cli.clearance_lines import print_report
from standoff.cli.clearance_options import check_options, option_error, scope_of, wanted_by
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text, world_facts
from standoff.cli.output import write_whole
from standoff.cli.part_file import check_meshes
from standoff.cli.progress import progress_bar
from standoff.cli.terminal import tell
from standoff.scene import Scene, SceneError, load_scene
from standoff.scene.part_files import ENDINGS
from standoff.typing import Array
from standoff.world import World


def run_clearance(command: ClearanceCommand) -> int:
    """Print the clearance of all pairs; the exit code says whether all that is asked is proven.

    Raises SceneError, CommandError if the scene, an option or a file is not usable. Raises
    WriteError if the files could not be written after all.
    """
    check_options(command)
    check_meshes(command.scene, command.meshes)
    if command.scene.suffix.lower() in ENDINGS:
        from standoff.cli.clearance_assembly import run_on_assembly

        return run_on_assembly(command)
    no_cad_file(command.scene, command.cad)
    scene, wanted = load_scene(command.scene).as_world, wanted_by(command)
    times = scene.times() if command.motion else None
    world = scene.world_with(times=times)
    check_files(command)
    report, looked = _looked(command, scene, world, wanted, times)
    write_whole(files_of(command, scene, report, looked))
    written = [path for path in (command.files.page, command.files.plot) if path is not None]
    if command.report.json:
        tell(json_text(_facts(scene, report, looked, written)))
    else:
        listed = None if command.report.verbose else scope_of(command).closest
        print_report(scene, report, looked, written, listed)
    return ExitCode.NOT_CERTIFIED if report.failures else ExitCode.DONE


def _looked(
    command: ClearanceCommand, scene: Scene, world: World, wanted: Wanted, times: Array | None
) -> tuple[Report, Instants]:
    scope = scope_of(command)
    try:
        if times is not None:
            world = narrowed(world, scope, wanted)
            with progress_bar() as progress:
                walked = walk(scene, world, times, progress)
            bounds = bounds_over(world, walked.near)
            looked = Instants(float(times[0]), float(times[-1]), len(times))
            return report_on(world, walked.near, bounds, wanted), looked
        time = scene.instant(command.time)
        with progress_bar("distances of pairs") as progress:
            poses = scene.poses(world, time)
            report = check(world, poses, wanted, scope, time=time, progress=progress)
    except SceneError as error:
        if command.time is not None and error.key == "time":
            raise CommandError(f"--time: {error.problem}") from error
        raise
    except (ValueError, TypeError) as error:
        raise option_error(error) or SceneError(str(error), key="world", file=scene.file) from error
    return report, Instants(time, time, 1)


def _facts(scene: Scene, report: Report, looked: Instants, written: list[Path]) -> dict[str, Any]:
    return (
        world_facts(scene)
        | {"start": looked.start, "end": looked.end, "frames": looked.frames}
        | report_facts(report)
        | {"files": [str(path) for path in written]}
    )
