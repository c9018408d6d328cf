"""``standoff track`` of a scene with a world and no pair: all near pairs, frame by frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from standoff.clearance.facts import report_facts
from standoff.clearance.over_time import LeastOfAll, Walked, bounds_over, frames
from standoff.clearance.report import Report, Wanted, gap_text, no_clearance, report_on
from standoff.cli.arguments import TrackCommand
from standoff.cli.errors import CommandError, ExitCode
from standoff.cli.facts import json_text, world_facts
from standoff.cli.output import Writer, check_results, kind_of_picture, write_whole
from standoff.cli.progress import progress_bar
from standoff.cli.summary import frames_text, line, share_text, time_text
from standoff.cli.terminal import tell
from standoff.scene import Scene, SceneError, TrackSettings
from standoff.wording import at_least, counted
from standoff.world.state import WorldCounts

FIRST_PAIRS = 5
"""How many pairs are listed with their least; all of them with ``--verbose`` and in ``--json``."""

WORKS = ("tracked", "started", "resting", "bounded", "sought")
"""Counts of a world's frames that the summary adds up, in their order."""


def run_track_world(command: TrackCommand, scene: Scene, settings: TrackSettings) -> int:
    """Track all near pairs, write the files asked for, and print the summary.

    Raises SceneError, CommandError if the scene, an option or an output file is not usable. Raises
    WriteError if the files could not be written after all.
    """
    _check(command)
    if settings.minima is not None:
        raise SceneError(
            "is of a pair, and the scene has a [world] and none: leave it out, or add one",
            key="track.minima",
            file=scene.file,
        )
    output, plot = command.files.output, command.files.plot
    times = scene.times(settings)
    world = scene.world_with(settings=settings, times=times)
    check_results(output, "standoff.clearance.table", plot, "standoff.clearance.course_plot")
    least, rows = LeastOfAll(), None
    if output is not None:
        from standoff.clearance.table import NearPairs

        rows = NearPairs(world)
    try:
        with progress_bar() as progress:
            for time, answer in frames(scene, world, times, progress):
                least.add(time, answer)
                if rows is not None:
                    rows.add(time, answer)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error), key="world", file=scene.file) from error
    walked = least.walked()
    report = report_on(world, walked.near, bounds_over(world, walked.near), Wanted())
    files: dict[Path, Writer] = {}
    if output is not None and rows is not None:
        files[output] = lambda file: rows.write(scene, settings, file)
    if plot is not None:
        files[plot] = _drawn(scene, walked, report, kind_of_picture(plot))
    write_whole(files)
    if command.report.json:
        tell(json_text(_facts(scene, settings, walked, report, list(files))))
    else:
        verbose = command.report.verbose
        tell("\n".join(_lines(scene, settings, walked, report, list(files), verbose=verbose)))
    return ExitCode.DONE if report.certified else ExitCode.NOT_CERTIFIED


def _check(command: TrackCommand) -> None:
    """Refuse options of pairs.

    Raises CommandError.
    """
    if command.pair is not None:
        raise CommandError("--pair: the scene has a [world] and no pair; leave it out, or add one")
    if command.files.export is not None:
        raise CommandError(
            "--export: shows the motion of a pair, and the scene has a [world] and none; use "
            "--plot, or add a [pair]"
        )


def _drawn(scene: Scene, walked: Walked, report: Report, ending: str) -> Writer:
    from standoff.clearance.course_plot import course_figure

    figure = course_figure(walked, report, scene.title, scene.length_unit)
    return lambda file: figure.savefig(file, format=ending)


def totals(walked: Walked) -> WorldCounts:
    """Return the counts of all frames together; of the open pairs the most of a frame."""
    sums = [sum(column) for column in zip(*walked.counts, strict=True)]
    return WorldCounts(*sums)._replace(open=max(count.open for count in walked.counts))


def _facts(
    scene: Scene, settings: TrackSettings, walked: Walked, report: Report, written: list[Path]
) -> dict[str, Any]:
    return (
        world_facts(scene)
        | {
            "settings": settings.facts(),
            "frames": len(walked.times),
            "start": float(walked.times[0]),
            "end": float(walked.times[-1]),
            "certified_frames": len(walked.times) - walked.uncertified,
            "counts": totals(walked)._asdict(),
        }
        | report_facts(report)
        | {"files": [str(path) for path in written]}
    )


def _lines(
    scene: Scene,
    settings: TrackSettings,
    walked: Walked,
    report: Report,
    written: list[Path],
    *,
    verbose: bool,
) -> list[str]:
    unit, n = scene.length_unit, len(walked.times)
    near, count = len(report.rows), len(report.rows) + len(report.far)
    bodies = counted(len(report.world.bodies), "body", "bodies")
    total = totals(walked)
    k = int(walked.clearance.argmin())
    sound = n - walked.uncertified
    least = [
        f"{gap_text(row.answer)} {unit} at {time_text(row.nearest.time)}, {_names(row)}"
        for row in sorted(report.rows, key=lambda row: row.answer.distance)
    ]
    shown = least if verbose else least[:FIRST_PAIRS]
    more = len(least) - len(shown)
    work = [f"{getattr(total, name)} {name}" for name in WORKS if getattr(total, name) or verbose]
    return [
        line("scene", f"{scene.title}: {bodies}, {counted(count, 'pair')}"),
        *(line("", note) for note in scene.notes),
        line("law", settings.law.name),
        line("frames", frames_text(walked.times)),
        line(
            "clearance",
            f"{at_least(float(walked.clearance[k]))} {unit} at "
            f"{time_text(walked.times[k])}, proven for all pairs in all frames"
            if walked.clearance[k] > -np.inf
            else f"none is proven: {no_clearance(report)}, at {time_text(walked.times[k])}",
        ),
        *(line("closest" if i == 0 else "", text) for i, text in enumerate(shown)),
        *([line("", f"and {counted(more, 'more pair')}")] if more else []),
        line("certified", f"{sound} of {counted(n, 'frame')}, {share_text(sound, n)}"),
        *(
            [line("", f"{counted(total.uncertified, 'answer')} not certified")]
            if total.uncertified
            else []
        ),
        line(
            "near",
            f"{counted(near, 'pair')} within the horizon at some time, "
            f"{counted(total.open, 'pair')} of pieces open at most",
        ),
        line("work", f"pairs of pieces: {', '.join(work)}"),
        *(line("wrote" if i == 0 else "", str(path)) for i, path in enumerate(written)),
    ]


def _names(row: Any) -> str:
    answer = row.answer
    each = zip(answer.names, answer.pieces, strict=True)
    return " - ".join(" ".join(filter(None, words)) for words in each)
