"""What the commands write, and where: refused before the work where it could not be written."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from standoff import whole_files
from standoff.cli.errors import CommandError, MissingExtra, WriteError
from standoff.whole_files import Writer as Writer
from standoff.whole_files import destination, kind_of

TABLE_ENDINGS = (".parquet",)
PLOT_ENDINGS = (".png", ".svg", ".pdf")


def check_results(
    output: Path | None, table: str, plot: Path | None = None, picture: str = ""
) -> None:
    """Refuse a table and a picture that could not be written after the run.

    Raises CommandError as of `check_target`, or a missing library.

    Parameters
    ----------
    output, plot : Path or None
        What ``-o`` and ``--plot`` named.
    table, picture : str
        The modules that write them, imported now: a missing library is reported before the run.
    """
    if output is not None:
        check_target(output, "-o", TABLE_ENDINGS)
    if plot is not None:
        check_target(plot, "--plot", PLOT_ENDINGS)
    try:
        for target, module in ((output, table), (plot, picture)):
            if target is not None:
                import_module(module)
    except ModuleNotFoundError as error:
        raise MissingExtra(str(error.name)) from error


def kind_of_picture(target: Path) -> str:
    """Return a picture's ending without its dot, as matplotlib takes it."""
    return target.suffix.lower().removeprefix(".")


def check_target(target: Path, option: str, endings: Sequence[str]) -> None:
    """Refuse a file that could not be written later; nothing is left behind.

    Raises CommandError if there is no name or the ending is not one of these, the folder is missing
    or cannot be written, or the target is not a regular file.

    Parameters
    ----------
    target : Path
        The file to be written.
    option : str
        The option that named it, for the message.
    endings : sequence of str
        The file name endings that are understood, lower case, with their dot.
    """
    check_named(target, option)
    if target.suffix.lower() not in endings:
        raise CommandError(
            f"{option} {target}: the ending '{target.suffix}' is not known here; "
            f"name a file that ends in {' or '.join(endings)}"
        )
    try:
        folder = destination(target).parent
    except whole_files.UnfitTarget as error:
        raise CommandError(f"{option} {error}") from error
    except OSError as error:
        raise CommandError(f"{option} {target}: {error.strerror}; name another") from error
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CommandError(
            f"{option} {target}: the folder {folder} cannot be written ({error.strerror}); "
            "name another, or change its permissions"
        ) from error


def check_named(target: Path, option: str) -> None:
    """Refuse a path without a file name: an empty string, which means the current folder, or /.

    Raises CommandError.
    """
    if not target.name:
        raise CommandError(
            f"{option}: '{target}' is a folder, which an empty name stands for too; name a file"
            if target == Path()
            else f"{option} {target}: is a folder; name a file in it"
        )


def picture_targets(plot: Path | None, names: Sequence[str]) -> list[Path]:
    """The files of the pictures of some bodies: the one of ``--plot``, or with each body's name at
    its end; none without the option.

    Raises CommandError if the option names no file of a known kind, or two bodies would be drawn to
    one.
    """
    if plot is None:
        return []
    if len(names) > 1:
        check_named(plot, "--plot")
    targets: list[Path] = []
    for name in names:
        plain = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in name)
        target = plot if len(names) == 1 else plot.with_name(f"{plot.stem}-{plain}{plot.suffix}")
        check_target(target, "--plot", PLOT_ENDINGS)
        if target in targets:
            raise CommandError(
                f"--plot {target}: two bodies would be drawn to this file; pick one with --body"
            )
        targets.append(target)
    return targets


def make_folder(folder: Path, option: str) -> None:
    """Make the folder of several files where there is none.

    Raises CommandError if it cannot be made, for instance because something else has its name.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        kind = kind_of(folder.lstat().st_mode)
        raise CommandError(f"{option} {folder}: is {kind}, not a folder; name a folder") from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise CommandError(
            f"{option} {folder}: the folder cannot be made ({reason}); name another"
        ) from error


def write_whole(files: Mapping[Path, Writer]) -> None:
    """Write all of `files`, or, if one fails, none.

    Raises WriteError if a file cannot be written, as on a full disk.
    """
    try:
        whole_files.write_whole(files)
    except OSError as error:
        names = ", ".join(map(str, files))
        raise WriteError(f"{names} could not be written: {error}") from error
