"""The files that ``standoff clearance`` writes: of a scene, or of an assembly in its place."""

from __future__ import annotations

from pathlib import Path

from standoff.clearance.assembly import Source
from standoff.clearance.report import Instants, Report
from standoff.cli.arguments import ClearanceCommand
from standoff.cli.errors import MissingExtra
from standoff.cli.output import PLOT_ENDINGS, Writer, check_target, kind_of_picture


def check_files(command: ClearanceCommand) -> None:
    """Refuse files that could not be written, and import what draws them.

    Raises WriteError, MissingExtra.
    """
    if command.files.page is not None:
        check_target(command.files.page, "--page", (".html",))
    if command.files.plot is not None:
        check_target(command.files.plot, "--plot", PLOT_ENDINGS)
    if command.files.page is not None or command.files.plot is not None:
        try:
            import standoff.clearance.page  # noqa: F401
        except ModuleNotFoundError as error:
            raise MissingExtra(str(error.name)) from error


def files_of(
    command: ClearanceCommand, scene: Source, report: Report, looked: Instants
) -> dict[Path, Writer]:
    """What writes each file that is asked for."""
    files: dict[Path, Writer] = {}
    page, plot = command.files.page, command.files.plot
    if page is not None:
        from standoff.clearance.page import page_of

        text = page_of(scene, report, looked)
        files[page] = lambda file: file.write(text.encode())
    if plot is not None:
        from standoff.clearance.matrix import matrix_figure

        figure = matrix_figure(report, scene.title, scene.length_unit)
        ending = kind_of_picture(plot)
        files[plot] = lambda file: figure.savefig(file, format=ending)
    return files
